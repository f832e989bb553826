//! Creep forces: what a contact's relative motion does to it.
//!
//! Four laws, all of the same [`Patch`], [`Elasticity`] and [`Creepages`], all with fixed work:
//!
//! | law | what it is | instructions |
//! | --- | --- | --- |
//! | [`kalker_linear`] | Kalker's linear theory, no saturation | 151 |
//! | [`shen_hedrick_elkins`] | the linear resultant bent by a cubic to the bound μN | 190 |
//! | [`polach`] | closed form, spin included | 370; [`polach_four`] 512 for four contacts |
//! | [`fastsim`] | Kalker's simplified theory on a grid of NX by NY elements, strip theory's tractions | 2,477 on 10 by 10, 6,831 on 20 by 20 |
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
pub use polach::{polach, polach_four};

use crate::contact::Contact;
use crate::header::Material;
use crate::math::{Four, Number, single, sqrt};
use coefficients::{Column, along};

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
}

/// Longitudinal and lateral forces and spin moments on the way: of one contact, or of four.
#[derive(Clone, Copy)]
struct Forces<N>([N; 3]);

impl<N: Number> Forces<N> {
    /// All three times a number.
    #[inline(always)]
    fn times(self, factor: N) -> Self {
        Self(self.0.map(|force| force * factor))
    }

    /// Magnitude of the force in the contact plane.
    #[inline(always)]
    fn magnitude(&self) -> N {
        let [x, y, _] = self.0;
        (x * x + y * y).root()
    }

    /// The force no longer than the bound, the moment shortened with it.
    #[inline(always)]
    fn within(self, bound: N) -> Self {
        self.times(bound / self.magnitude().no_less(bound))
    }
}

impl From<Forces<f32>> for CreepForces {
    #[inline(always)]
    fn from(Forces([longitudinal, lateral, spin_moment]): Forces<f32>) -> Self {
        Self { longitudinal, lateral, spin_moment }
    }
}

impl Forces<Four> {
    /// Each contact's own.
    #[inline(always)]
    fn each(self) -> [CreepForces; 4] {
        let [x, y, moment] = self.0;
        Four::transpose([x, y, moment, moment]).map(|of| {
            let [longitudinal, lateral, spin_moment, _] = of.numbers();
            CreepForces { longitudinal, lateral, spin_moment }
        })
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

/// An elliptic contact patch and its normal force; by default none, which has no creep forces.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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

/// A case, or four, as the laws take it: every number in its range, and whether it was so.
#[derive(Clone, Copy)]
struct Case<N> {
    /// Semi-axis a, m.
    a: N,
    /// a / b and b / a.
    ratio: N,
    inverse: N,
    /// sqrt(a / b) and sqrt(b / a).
    slenderness: N,
    breadth: N,
    /// sqrt(a b), m.
    mean: N,
    /// G a b, N: the unit of Kalker's linear forces.
    unit: N,
    /// μ N, N.
    bound: N,
    /// G a b / (μ N)
    stiffness: N,
    /// ξ, η, and φ sqrt(a b).
    xi: N,
    eta: N,
    turn: N,
    /// 1/C11, 1/C22, 1/C23.
    flexibilities: [N; 3],
    /// 1 for a case, 0 for what is none.
    valid: N,
}

impl Case<f32> {
    #[inline(always)]
    fn of(patch: &Patch, elasticity: &Elasticity, creepages: &Creepages, friction: f32) -> Self {
        let Patch { semi_axes: [a, b], normal_force } = *patch;
        let Creepages { longitudinal, lateral, spin } = *creepages;
        Self::new([a, b, normal_force], elasticity, [longitudinal, lateral, spin], friction, |column, place| {
            let [f11, f22, f23, _] = column.flexibilities(place).numbers();
            [f11, f22, f23]
        })
    }
}

impl Case<Four> {
    #[inline(always)]
    fn of_four(
        [p0, p1, p2, p3]: &[Patch; 4],
        elasticity: &Elasticity,
        [c0, c1, c2, c3]: &[Creepages; 4],
        friction: &[f32; 4],
    ) -> Self {
        let patch = |of: &Patch| Four::load(&[of.semi_axes[0], of.semi_axes[1], of.normal_force, 0.0]);
        let [a, b, normal, _] = Four::transpose([patch(p0), patch(p1), patch(p2), patch(p3)]);
        let creepage = |of: &Creepages| Four::load(&[of.longitudinal, of.lateral, of.spin, 0.0]);
        let [xi, eta, phi, _] = Four::transpose([creepage(c0), creepage(c1), creepage(c2), creepage(c3)]);
        Self::new([a, b, normal], elasticity, [xi, eta, phi], Four::load(friction), |column, (whole, share)| {
            let ([w0, w1, w2, w3], [s0, s1, s2, s3]) = (whole.numbers(), share.numbers());
            let row = |whole: f32, share: f32| column.flexibilities((whole, share));
            let [f11, f22, f23, _] = Four::transpose([row(w0, s0), row(w1, s1), row(w2, s2), row(w3, s3)]);
            [f11, f22, f23]
        })
    }
}

impl<N: Number> Case<N> {
    #[inline(always)]
    fn new(
        [a, b, normal]: [N; 3],
        elasticity: &Elasticity,
        [xi, eta, phi]: [N; 3],
        friction: N,
        flexibilities: impl FnOnce(Column, (N, N)) -> [N; 3],
    ) -> Self {
        let Elasticity { shear_modulus, poisson_ratio } = *elasticity;
        let (whole, axes) = (Range::<N>::new(f32::MIN_POSITIVE, f32::MAX), Range::<N>::new(1e-9, 1e3));
        let (bounds, shears) = (Range::<N>::new(1e-9, 1e12), Range::<f32>::new(1.0, 1e15));
        let (ratios, limit) = (Range::<f32>::new(0.0, 0.5), Range::<N>::new(-CREEPAGE_LIMIT, CREEPAGE_LIMIT));
        let product = friction * normal;
        // 0 x is zero, and NaN for what is not finite.
        let zero = N::all(0.0);
        let finite = (zero * xi + zero * eta) + (zero * phi + zero * friction);
        let beyond = (axes.beyond(a) + axes.beyond(b)) + (bounds.beyond(product) + whole.beyond(normal));
        let beyond_material = shears.beyond(shear_modulus) + ratios.beyond(poisson_ratio);
        let beyond = (beyond + finite) + N::all(beyond_material);
        // Even the least number, twice times this, is more than one; and NaN becomes one.
        let great = N::all(1e38);
        let valid = N::all(1.0) - (beyond * great * great).no_more(N::all(1.0));
        let (a, b, bound, g) = (axes.of(a), axes.of(b), bounds.of(product), shears.of(shear_modulus));
        let (ratio, inverse) = (a / b, b / a);
        let slenderness = ratio.root();
        let mean = b * slenderness;
        let unit = N::all(g) * (a * b);
        Self {
            a,
            ratio,
            inverse,
            slenderness,
            breadth: inverse.root(),
            mean,
            unit,
            bound,
            stiffness: unit / bound,
            xi: limit.of(xi),
            eta: limit.of(eta),
            turn: limit.of(phi * mean),
            flexibilities: flexibilities(Column::of(ratios.of(poisson_ratio)), along(ratio, inverse)),
            valid,
        }
    }
}

/// Numbers that are taken.
#[derive(Clone, Copy)]
struct Range<N> {
    low: N,
    high: N,
}

impl<N: Number> Range<N> {
    #[inline(always)]
    fn new(low: f32, high: f32) -> Self {
        Self { low: N::all(low), high: N::all(high) }
    }

    /// The nearest number of the range; an end for NaN.
    #[inline(always)]
    fn of(self, x: N) -> N {
        x.no_less(self.low).no_more(self.high)
    }

    /// How far a number is beyond its range: exactly zero inside, NaN for NaN.
    #[inline(always)]
    fn beyond(self, x: N) -> N {
        (x - self.of(x)).size()
    }
}
