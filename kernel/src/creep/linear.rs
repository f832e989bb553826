//! Kalker's linear theory, and its saturation by Shen, Hedrick and Elkins.

use crate::creep::{Case, CreepForces, Creepages, Elasticity, Forces, Patch};
use crate::math::Number;

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
    let case = Case::of(patch, elasticity, creepages, 1.0);
    case.linear().times(case.valid).into()
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
    let case = Case::of(patch, elasticity, creepages, friction);
    let linear = case.linear();
    linear.times(cubic(linear.magnitude() / case.bound)).within(case.bound).times(case.valid).into()
}

/// What the linear resultant is shortened by: 1 - τ/3 + τ²/27 up to τ = 3, where it is 1/3, then 1/τ.
#[inline(always)]
pub(super) fn cubic<N: Number>(tau: N) -> N {
    let (all, three) = (N::all, N::all(3.0));
    let bent = tau.no_more(three);
    (all(1.0) - bent * all(1.0 / 3.0) + bent * bent * all(1.0 / 27.0)) * (three / tau.no_less(three))
}

impl<N: Number> Case<N> {
    /// C33 of the simplified theory: 32/(15 π) (b/a)^1.5 C23.
    #[inline(always)]
    pub(super) fn c33(&self) -> N {
        const FACTOR: f32 = 32.0 / (15.0 * core::f32::consts::PI);
        let [.., f23] = self.flexibilities;
        N::all(FACTOR) * (self.inverse * self.breadth) / f23
    }

    #[inline(always)]
    fn linear(&self) -> Forces<N> {
        let Self { unit, mean, xi, eta, turn, flexibilities, .. } = *self;
        let [c11, c22, c23] = flexibilities.map(|flexibility| N::all(1.0) / flexibility);
        let none = N::all(0.0);
        Forces([
            // Fx = -G a b C11 ξ
            none - unit * (c11 * xi),
            // Fy = -G a b (C22 η + sqrt(a b) C23 φ)
            none - unit * (c22 * eta + c23 * turn),
            // Mz = G a b sqrt(a b) (C23 η - sqrt(a b) C33 φ)
            unit * mean * (c23 * eta - self.c33() * turn),
        ])
    }
}
