//! Creep forces: what a contact's relative motion does to it.
//!
//! Four laws, all of the same [`Patch`], [`Elasticity`] and [`Creepages`], all with fixed work:
//!
//! | law | what it is | instructions |
//! | --- | --- | --- |
//! | [`kalker_linear`] | Kalker's linear theory, no saturation | 230 |
//! | [`shen_hedrick_elkins`] | the linear resultant bent by a cubic to the bound μN | 276 |
//! | [`polach`] | closed form, spin included | 495 |
//! | [`fastsim`] | Kalker's simplified theory on a grid of NX by NY elements, strip theory's tractions | 2,555 on 10 by 10, 6,936 on 20 by 20 |
//!
//! **Signs.** Creepages are the velocity of the wheel's material relative to the rail's, divided by the speed; forces
//! act on the **wheel**, so they oppose the creepages. The axes of the contact plane are x forward, y along the contact's
//! tangent to the right, and their normal n = x × y, down into the rail; spin and spin moment turn x towards y. CONTACT
//! prints the creepages of the rail against the wheel and the forces on the rail in its wheel-rail module: all signs
//! turned, and the same law.
//!
//! Rolling is towards +x; a vehicle that runs backwards is described in a track frame turned round.
//!
//! ```
//! use flangeway::creep::{Creepages, Elasticity, Patch, fastsim, power};
//!
//! let patch = Patch { semi_axes: [6e-3, 4e-3], normal_force: 60e3 };
//! let creepages = Creepages { longitudinal: 1e-3, lateral: -5e-4, spin: 0.1 };
//! let forces = fastsim::<10, 10>(&patch, &Elasticity::STEEL, &creepages, 0.3);
//! assert!(forces.longitudinal < 0.0 && power(20.0, &creepages, &forces) < 0.0);
//! ```
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
use crate::math::{Mask, Two, greater, lesser, single, sqrt};

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

    /// These forces, or none. By masks, so that no branch is made of it.
    #[inline(always)]
    fn only_if(self, valid: Mask) -> Self {
        let pair = |x: f32, y: f32| Two::new([f64::from(x), f64::from(y)]).where_all(valid).single();
        let ([longitudinal, lateral], [spin_moment, _]) =
            (pair(self.longitudinal, self.lateral), pair(self.spin_moment, 0.0));
        Self { longitudinal, lateral, spin_moment }
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
    valid: Mask,
}

impl Case {
    #[inline(always)]
    fn new(patch: &Patch, elasticity: &Elasticity, creepages: &Creepages, friction: f32) -> Self {
        let Patch { semi_axes: [a, b], normal_force } = *patch;
        let Elasticity { shear_modulus, poisson_ratio } = *elasticity;
        let Creepages { longitudinal: xi, lateral: eta, spin: phi } = *creepages;
        let (whole, axes) = (Range::new(f32::MIN_POSITIVE, f32::MAX), Range::new(1e-9, 1e3));
        let product = friction * normal_force;
        let (bounds, shears, ratios) = (Range::new(1e-9, 1e12), Range::new(1.0, 1e15), Range::new(0.0, 0.5));
        let valid = Range::hold([axes, axes], [a, b])
            .and(Range::hold([bounds, shears], [product, shear_modulus]))
            .and(Range::hold([ratios, whole], [poisson_ratio, normal_force]))
            .and(finite(xi, eta))
            .and(finite(phi, friction));
        let (a, b, bound, g) = (axes.of(a), axes.of(b), bounds.of(product), shears.of(shear_modulus));
        let mean = sqrt(a * b);
        let limit = Range::new(-CREEPAGE_LIMIT, CREEPAGE_LIMIT);
        Self {
            a,
            b,
            mean,
            unit: g * (a * b),
            bound,
            creepages: Creepages {
                longitudinal: limit.of(xi),
                lateral: limit.of(eta),
                spin: limit.of(phi * mean) / mean,
            },
            coefficients: Coefficients::of(a / b, ratios.of(poisson_ratio)),
            valid,
        }
    }
}

/// Numbers that are taken.
#[derive(Clone, Copy)]
struct Range {
    low: f32,
    high: f32,
}

impl Range {
    #[inline(always)]
    const fn new(low: f32, high: f32) -> Self {
        Self { low, high }
    }

    /// The nearest number of the range; an end for NaN.
    #[inline(always)]
    fn of(self, x: f32) -> f32 {
        lesser(greater(x, self.low), self.high)
    }

    /// Whether two numbers lie in their ranges: nothing is left when what is taken for them is subtracted.
    #[inline(always)]
    fn hold([first, second]: [Self; 2], [x, y]: [f32; 2]) -> Mask {
        let taken = Two::new([f64::from(first.of(x)), f64::from(second.of(y))]);
        (Two::new([f64::from(x), f64::from(y)]) - taken).abs().within(Two::all(0.0))
    }
}

/// Whether two numbers are finite.
#[inline(always)]
fn finite(x: f32, y: f32) -> Mask {
    Two::new([f64::from(x), f64::from(y)]).abs().within(Two::all(f64::from(f32::MAX)))
}
