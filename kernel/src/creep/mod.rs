//! Creep forces: what a contact's relative motion does to it.
//!
//! Four laws, all of the same [`Patch`], [`Elasticity`] and [`Creepages`], all with fixed work:
//!
//! | law | what it is | instructions |
//! | --- | --- | --- |
//! | [`kalker_linear`] | Kalker's linear theory, no saturation | fewest |
//! | [`shen_hedrick_elkins`] | the linear resultant bent by a cubic to the bound μN | few |
//! | [`polach`] | closed form, spin included | few |
//! | [`fastsim`] | Kalker's simplified theory on a grid of NX by NY elements | some 40 for each four elements |
//!
//! **Signs.** Creepages are the velocity of the wheel's material relative to the rail's, divided by the speed; forces
//! act on the **wheel**, so they oppose the creepages. The axes of the contact plane are x forward, y along the contact's
//! tangent to the right, and their normal n = x × y, down into the rail; spin and spin moment turn x towards y. CONTACT
//! prints the creepages of the rail against the wheel and the forces on the rail in its wheel-rail module: all signs
//! turned, and the same law.
//!
//! Rolling is towards +x; a vehicle that runs backwards is described in a track frame turned round.
//!
//! **Inputs that are no numbers**, negative forces, semi-axes or friction give zero forces, never NaN. Creepages beyond
//! [`CREEPAGE_LIMIT`] are clamped there: everything has long slid.

mod coefficients;
mod fastsim;
mod friction;
mod linear;
mod polach;

pub use coefficients::Coefficients;
pub use fastsim::fastsim;
pub use friction::Friction;
pub use linear::{kalker_linear, shen_hedrick_elkins};
pub use polach::polach;

use crate::contact::Contact;
use crate::header::Material;
use crate::math::{single, sqrt};

/// Largest creepage that is computed; spin times the patch's mean semi-axis is held by the same.
pub const CREEPAGE_LIMIT: f32 = 10.0;

/// Creepages of a contact, wheel relative to rail, divided by speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Creepages {
    /// Longitudinal creepage ξ, positive where the wheel's surface moves forward on the rail.
    pub longitudinal: f32,
    /// Lateral creepage η along the contact's tangent, positive to the right.
    pub lateral: f32,
    /// Spin creepage φ about the contact's normal (down), positive from x towards y, 1/m.
    pub spin: f32,
}

/// Forces on the wheel in the contact plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct CreepForces {
    /// Longitudinal force Fx, positive forward, N.
    pub longitudinal: f32,
    /// Lateral force Fy along the contact's tangent, positive to the right, N.
    pub lateral: f32,
    /// Spin moment Mz about the contact's normal (down), positive from x towards y, N m.
    pub spin_moment: f32,
}

impl CreepForces {
    /// No force.
    pub const NONE: Self = Self { longitudinal: 0.0, lateral: 0.0, spin_moment: 0.0 };

    /// Magnitude of the force in the contact plane, N.
    #[must_use]
    pub fn magnitude(&self) -> f32 {
        sqrt(self.longitudinal * self.longitudinal + self.lateral * self.lateral)
    }

    /// All three times a number.
    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        Self {
            longitudinal: self.longitudinal * factor,
            lateral: self.lateral * factor,
            spin_moment: self.spin_moment * factor,
        }
    }

    /// These forces, or none.
    #[inline(always)]
    fn only_if(self, valid: bool) -> Self {
        // Bits, so that no branch is made of it and a NaN is not multiplied.
        let mask = u32::from(valid).wrapping_neg();
        let kept = |x: f32| f32::from_bits(x.to_bits() & mask);
        Self { longitudinal: kept(self.longitudinal), lateral: kept(self.lateral), spin_moment: kept(self.spin_moment) }
    }

    /// The force no longer than the bound, the moment shortened with it.
    #[inline(always)]
    fn within(self, bound: f32) -> Self {
        let magnitude = self.magnitude();
        self.times(bound / greater(magnitude, bound))
    }
}

/// Power that the creep forces feed into the wheel against the rail, W = V (ξ Fx + η Fy + φ Mz): never positive, since
/// friction takes it; its negative is the heat, W.
#[must_use]
pub fn power(speed: f64, creepages: &Creepages, forces: &CreepForces) -> f64 {
    let product = |a: f32, b: f32| f64::from(a) * f64::from(b);
    speed
        * (product(creepages.longitudinal, forces.longitudinal)
            + product(creepages.lateral, forces.lateral)
            + product(creepages.spin, forces.spin_moment))
}

/// Wear index Tγ = |ξ Fx| + |η Fy|, N (work a metre of track, J/m). The spin moment's work is left out, as is usual.
#[must_use]
pub fn wear_index(creepages: &Creepages, forces: &CreepForces) -> f64 {
    let product = |a: f32, b: f32| (f64::from(a) * f64::from(b)).abs();
    product(creepages.longitudinal, forces.longitudinal) + product(creepages.lateral, forces.lateral)
}

/// An elliptic contact patch and its normal force.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Patch {
    /// Semi-axes a along x and b across, m.
    pub semi_axes: [f32; 2],
    /// Normal force N, N.
    pub normal_force: f32,
}

impl From<&Contact> for Patch {
    fn from(contact: &Contact) -> Self {
        Self { semi_axes: contact.semi_axes, normal_force: contact.normal_force }
    }
}

/// Elastic constants of wheel and rail (the same for both).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Elasticity {
    /// Shear modulus G, Pa.
    pub shear_modulus: f32,
    /// Poisson's ratio ν.
    pub poisson_ratio: f32,
}

impl Elasticity {
    /// Steel as CONTACT's examples have it: G = 82 GPa, ν = 0.28.
    pub const STEEL: Self = Self { shear_modulus: 82.0e9, poisson_ratio: 0.28 };
}

impl From<&Material> for Elasticity {
    /// G = E / (2 (1 + ν))
    fn from(material: &Material) -> Self {
        let shear_modulus = material.young_modulus / (2.0 * (1.0 + material.poisson_ratio));
        Self { shear_modulus: single(shear_modulus), poisson_ratio: single(material.poisson_ratio) }
    }
}

/// A case as the laws take it: every number in its range, and whether it was so.
#[derive(Clone, Copy)]
struct Case {
    /// Semi-axes a and b, m.
    a: f32,
    b: f32,
    /// sqrt(a b), m.
    mean: f32,
    /// G a b, N: the unit of Kalker's linear forces.
    unit: f32,
    /// μ N, N.
    bound: f32,
    creepages: Creepages,
    coefficients: Coefficients,
    valid: bool,
}

impl Case {
    #[inline(always)]
    fn new(patch: &Patch, elasticity: &Elasticity, creepages: &Creepages, friction: f32) -> Self {
        let [a, b] = patch.semi_axes;
        let bound = friction * patch.normal_force;
        let g = elasticity.shear_modulus;
        let Creepages { longitudinal: xi, lateral: eta, spin: phi } = *creepages;
        let inside = |x: f32, low: f32, high: f32| (x >= low) & (x <= high);
        let positive = |x: f32| inside(x, f32::MIN_POSITIVE, f32::MAX);
        let valid = inside(a, 1e-9, 1e3)
            & inside(b, 1e-9, 1e3)
            & positive(friction)
            & positive(patch.normal_force)
            & inside(bound, 1e-9, 1e12)
            & inside(g, 1.0, 1e15)
            & inside(elasticity.poisson_ratio, 0.0, 0.5)
            & xi.is_finite()
            & eta.is_finite()
            & phi.is_finite();
        let or_one = |x: f32| if valid { x } else { 1.0 };
        let (a, b, bound, g) = (or_one(a), or_one(b), or_one(bound), or_one(g));
        let mean = sqrt(a * b);
        let held = |x: f32, limit: f32| lesser(greater(or_one(x), -limit), limit);
        Self {
            a,
            b,
            mean,
            unit: g * (a * b),
            bound,
            creepages: Creepages {
                longitudinal: held(xi, CREEPAGE_LIMIT),
                lateral: held(eta, CREEPAGE_LIMIT),
                spin: held(phi, CREEPAGE_LIMIT / mean),
            },
            coefficients: Coefficients::of(a / b, if valid { elasticity.poisson_ratio } else { 0.25 }),
            valid,
        }
    }
}

/// The greater of two numbers, the second if one of them is NaN.
#[inline(always)]
fn greater(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}

/// The lesser of two numbers, the second if one of them is NaN.
#[inline(always)]
fn lesser(x: f32, y: f32) -> f32 {
    if x < y { x } else { y }
}
