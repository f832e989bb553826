//! Polach's closed form.

use core::f32::consts::{FRAC_PI_2, PI};

use crate::creep::linear::cubic;
use crate::creep::{Case, CreepForces, Creepages, Elasticity, Forces, Patch};
use crate::math::{Number, arctangent_ratio, rising};

/// Polach's closed form for creep forces with spin.
///
/// O. Polach, A fast wheel-rail forces calculation computer code, Vehicle System Dynamics supplement 33 (1999); Wear 258
/// (2005) with both reduction factors kA = kS = 1, clean rails. With s = |(ξ, η)|, and the creepage that spin adds at the
/// leading edge counted where it adds, η' = η + φ a if |η + φ a| > |η|, else η, and s' = |(ξ, η')|:
///
/// ```text
/// C   = sqrt((C11 ξ / s)² + (C22 η / s)²)
/// ε   = G π a b C s' / (4 μ N)
/// F   = (2 μ N / π) (ε / (1 + ε²) + atan ε)
/// ε_s = (8/3) G b sqrt(a b) C23 |η'| / (k μ N)         k = 1 + 6.3 (1 - e^(-a/b))
/// δ   = (ε_s² - 1) / (ε_s² + 1)
/// F_s = (9/16) a μ N k (ε_s (-δ³/3 + δ²/2 - 1/6) + (1 - δ²)^1.5 / 3)
/// Fx  = -F ξ / s'
/// Fy  = -(F η + F_s φ) / s'
/// ```
///
/// The published formulas have no moment, and with spin against the lateral creepage F_s alone would feed power in. As
/// in the linear theory the moment takes it back, and adds the spin's own M' = G (a b)² C33 φ, shortened like F or, where
/// that is less, by Shen, Hedrick and Elkins' cubic to 3π/16 μ N sqrt(a b), the moment of a round patch that spins in
/// place:
///
/// ```text
/// Mz  = F_s η / s' - min(F / F_linear, cubic) M'
/// ```
///
/// The force is cut to μN where the two parts together exceed it.
#[must_use]
pub fn polach(patch: &Patch, elasticity: &Elasticity, creepages: &Creepages, friction: f32) -> CreepForces {
    Case::of(patch, elasticity, creepages, friction).polach().into()
}

/// [`polach`] of four contacts at once, to the bit, in little more than the time of one where the processor has vectors.
/// Places that are left free are contacts of zeros.
#[must_use]
pub fn polach_four(
    patches: &[Patch; 4],
    elasticity: &Elasticity,
    creepages: &[Creepages; 4],
    friction: &[f32; 4],
) -> [CreepForces; 4] {
    Case::of_four(patches, elasticity, creepages, friction).polach().each()
}

impl<N: Number> Case<N> {
    #[inline(always)]
    fn polach(&self) -> Forces<N> {
        let Self { xi, eta, turn, bound, unit, flexibilities: [f11, f22, f23], .. } = *self;
        let (all, square, none) = (N::all, |x: N| x * x, N::all(0.0));
        // |η'|, s², s'; creepages below 1e-12 are none.
        let spin_across = turn * self.slenderness;
        let lateral = (eta + spin_across).size().no_less(eta.size());
        let least = all(1e-24);
        let s_squared = (square(xi) + square(eta)).no_less(least);
        let whole = (square(xi) + square(lateral)).no_less(least).root();
        // C = sqrt((C11 ξ / s)² + (C22 η / s)²), with one division
        let c = ((square(f22 * xi) + square(f11 * eta)) / (s_squared * square(f11 * f22))).root();
        // ε = G π a b C s' / (4 μ N)
        let epsilon = all(0.25 * PI) * self.stiffness * (c * whole);
        // F / s' = G a b C ½ (1 / (1 + ε²) + atan(ε) / ε)
        let saturation = saturation(epsilon);
        let along = unit * c * saturation;
        // k = 1 + 6.3 (1 - e^(-a/b))
        let k = all(1.0) + all(6.3) * rising(self.ratio);
        // F_s / (a s'), with ε_s = (8/3) G b sqrt(a b) C23 |η'| / (k μ N), where b sqrt(a b) = a b sqrt(b / a)
        let spin = spin_saturation(all(8.0 / 3.0) * self.stiffness * self.breadth * lateral, f23 * k);
        let across = (all(9.0 / 16.0) * bound * k / whole) * spin;
        // M' over 3π/16 μ N sqrt(a b), bent as Shen, Hedrick and Elkins bend; with M' = G a b sqrt(a b) C33 sqrt(a b) φ
        let own = self.c33() * turn;
        let bent = cubic(all(16.0 / (3.0 * PI)) * self.stiffness * own.size());
        Forces([
            none - along * xi,
            none - (along * eta + across * spin_across),
            across * self.a * eta - saturation.no_more(bent) * (unit * self.mean * own),
        ])
        .within(bound)
        .times(self.valid)
    }
}

/// F / F_linear = ½ (1 / (1 + ε²) + atan(ε) / ε). With r = min(ε, 1/ε), t = r² and p(t) = atan(r) / r:
///
/// ```text
/// ε <= 1:   ½ (1 / (1 + t) + p(t))
/// ε > 1:    ½ (t / (1 + t) + r π/2 - t p(t))
/// ```
#[inline(always)]
fn saturation<N: Number>(epsilon: N) -> N {
    let (all, one) = (N::all, N::all(1.0));
    let epsilon = epsilon.no_more(all(1e18));
    let reciprocal = one / epsilon.no_less(one);
    let r = epsilon.no_more(one) * reciprocal;
    let t = r * r;
    let (p, q) = (arctangent_ratio(t), one / (one + t));
    // One beyond one, else zero: both cases are computed.
    let beyond = ((epsilon - one).no_less(all(0.0)) * all(1e10)).no_more(one);
    let great = reciprocal * all(FRAC_PI_2) + t * (q - p);
    all(0.5) * ((one - beyond) * (q + p) + beyond * great)
}

/// ε_s (-δ³/3 + δ²/2 - 1/6) + (1 - δ²)^1.5 / 3 of the quotient ε_s; with t = 1 - δ = 2 / (1 + ε_s²) nothing cancels at
/// large ε_s:
///
/// ```text
/// ε_s (t³/3 - t²/2) + (t (2 - t))^1.5 / 3
/// ```
#[inline(always)]
fn spin_saturation<N: Number>(dividend: N, divisor: N) -> N {
    let all = N::all;
    let epsilon = (dividend / divisor).no_more(all(1e8));
    let squared = divisor * divisor;
    let t = (squared + squared) / (squared + dividend * dividend);
    let rest = (t * (all(2.0) - t)).no_less(all(0.0));
    epsilon * (t * t * (t * all(1.0 / 3.0) - all(0.5))) + rest * rest.root() * all(1.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::single;

    #[test]
    fn saturation_over_all_creepages() {
        let mut worst = 0.0_f64;
        for i in 0..=40_000_u32 {
            // From 1e-8 to 1e8.
            let epsilon = single(libm::pow(10.0, f64::from(i) / 2500.0 - 8.0));
            let e = f64::from(epsilon);
            let exact = 0.5 * (1.0 / (1.0 + e * e) + libm::atan(e) / e);
            worst = worst.max((f64::from(saturation(epsilon)) / exact - 1.0).abs());
        }
        std::println!("saturation off by at most {worst:.1e}");
        assert!(worst < 5e-7);
        assert_eq!((saturation(0.0), saturation(f32::MAX) < 1e-17), (1.0, true));
    }
}
