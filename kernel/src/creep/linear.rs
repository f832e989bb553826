//! Kalker's linear theory, and its saturation by Shen, Hedrick and Elkins.

use crate::creep::{Case, CreepForces, Creepages, Elasticity, Patch};
use crate::math::{greater, lesser};

/// Kalker's linear theory: no saturation, for creepages much smaller than those of sliding.
///
/// Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), for forces on the wheel:
///
/// ```text
/// Fx = -G a b C11 ξ
/// Fy = -G a b (C22 η + sqrt(a b) C23 φ)
/// Mz =  G a b sqrt(a b) (C23 η - sqrt(a b) C33 φ)
/// ```
///
/// C33 is not in the table of coefficients; it is taken from the simplified theory, whose tractions without slip give
/// `C33 = 32/(15 π) (b/a)^1.5 C23`.
#[must_use]
pub fn kalker_linear(patch: &Patch, elasticity: &Elasticity, creepages: &Creepages) -> CreepForces {
    let case = Case::new(patch, elasticity, creepages, 1.0);
    case.linear().only_if(case.valid)
}

/// Shen, Hedrick and Elkins: Kalker's linear force bent to the bound μN by a cubic, its direction kept.
///
/// Z. Y. Shen, J. K. Hedrick, J. A. Elkins, A comparison of alternative creep force models for rail vehicle dynamic
/// analysis (8th IAVSD symposium, 1983). With τ = |F'| / (μ N), F' the linear force:
///
/// ```text
/// |F| = μ N (τ - τ²/3 + τ³/27)   for τ < 3,  else μ N
/// ```
///
/// The spin moment is shortened in the same proportion. Good for little spin, as on treads.
#[must_use]
pub fn shen_hedrick_elkins(
    patch: &Patch,
    elasticity: &Elasticity,
    creepages: &Creepages,
    friction: f32,
) -> CreepForces {
    let case = Case::new(patch, elasticity, creepages, friction);
    let linear = case.linear();
    linear.times(cubic(linear.magnitude() / case.bound)).within(case.bound).only_if(case.valid)
}

/// What the linear resultant is shortened by: 1 - τ/3 + τ²/27 up to τ = 3, where it is 1/3, then 1/τ.
#[inline(always)]
pub(super) fn cubic(tau: f32) -> f32 {
    let bent = lesser(tau, 3.0);
    (1.0 - bent * (1.0 / 3.0) + bent * bent * (1.0 / 27.0)) * (3.0 / greater(tau, 3.0))
}

impl Case {
    /// C33 of the simplified theory.
    #[inline(always)]
    pub(super) fn c33(&self) -> f32 {
        // 32/(15 π) (b/a)^1.5 C23, with (b/a)^1.5 = (b/a) sqrt(a b) / a
        const FACTOR: f32 = 32.0 / (15.0 * core::f32::consts::PI);
        FACTOR * (self.b / self.a) * (self.mean / self.a) * self.coefficients.c23
    }

    #[inline(always)]
    fn linear(&self) -> CreepForces {
        let Creepages { longitudinal: xi, lateral: eta, spin } = self.creepages;
        let (c, phi) = (&self.coefficients, self.mean * spin);
        CreepForces {
            // Fx = -G a b C11 ξ
            longitudinal: -self.unit * (c.c11 * xi),
            // Fy = -G a b (C22 η + sqrt(a b) C23 φ)
            lateral: -self.unit * (c.c22 * eta + c.c23 * phi),
            // Mz = G a b sqrt(a b) (C23 η - sqrt(a b) C33 φ)
            spin_moment: self.unit * self.mean * (c.c23 * eta - self.c33() * phi),
        }
    }
}
