//! Polach's closed form.

use core::f32::consts::{FRAC_2_PI, PI};

use crate::creep::linear::cubic;
use crate::creep::{Case, CreepForces, Creepages, Elasticity, Patch};
use crate::math::{arctangent, exp_negative, greater, lesser, sqrt};

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
    let case = Case::new(patch, elasticity, creepages, friction);
    let Case { a, b, mean, unit, bound, coefficients: c, .. } = case;
    let Creepages { longitudinal: xi, lateral: eta, spin: phi } = case.creepages;
    // |η'|, s, s'; creepages below 1e-12 are none.
    let lateral = greater((eta + phi * a).abs(), eta.abs());
    let s = greater(sqrt(xi * xi + eta * eta), 1e-12);
    let whole = greater(sqrt(xi * xi + lateral * lateral), 1e-12);
    // C = sqrt((C11 ξ / s)² + (C22 η / s)²)
    let (c_x, c_y) = (c.c11 * (xi / s), c.c22 * (eta / s));
    let stiffness = sqrt(c_x * c_x + c_y * c_y);
    // ε = G π a b C s' / (4 μ N)
    let epsilon = lesser(unit * PI * 0.25 * (stiffness * whole) / bound, 1e8);
    // F = (2 μ N / π) (ε / (1 + ε²) + atan ε), as its linear part (4/π) μ N ε and what is left of that
    let e = greater(epsilon, 1e-6);
    let saturation = 0.5 * (1.0 / (1.0 + e * e) + arctangent(e) / e);
    let force = 2.0 * FRAC_2_PI * bound * (epsilon * saturation);
    // k = 1 + 6.3 (1 - e^(-a/b))
    let k = 1.0 + 6.3 * (1.0 - exp_negative(lesser(a / b, 80.0)));
    // F_s / (9/16 a μ N k)
    let spin_force = 9.0 / 16.0 * a * bound * k * spin_saturation(unit, mean / a, c.c23 * lateral, k * bound);
    let (along, across) = (force / whole, spin_force / whole);
    // M' over 3π/16 μ N sqrt(a b), bent as Shen, Hedrick and Elkins bend.
    let moment = unit * (mean * mean) * case.c33() * phi;
    let bent = cubic(moment.abs() / (3.0 * PI / 16.0 * bound * mean));
    CreepForces {
        longitudinal: -along * xi,
        lateral: -(along * eta + across * phi),
        spin_moment: across * eta - lesser(saturation, bent) * moment,
    }
    .within(bound)
    .only_if(case.valid)
}

/// ε_s (-δ³/3 + δ²/2 - 1/6) + (1 - δ²)^1.5 / 3; with t = 1 - δ = 2 / (1 + ε_s²) nothing cancels at large ε_s:
///
/// ```text
/// ε_s (t³/3 - t²/2) + (t (2 - t))^1.5 / 3
/// ```
#[inline(always)]
fn spin_saturation(unit: f32, slenderness: f32, creepage: f32, bound: f32) -> f32 {
    // ε_s = (8/3) G b sqrt(a b) C23 |η'| / (k μ N), where G b sqrt(a b) = G a b sqrt(a b) / a
    let epsilon = lesser(8.0 / 3.0 * unit * slenderness * creepage / bound, 1e8);
    let t = 2.0 / (1.0 + epsilon * epsilon);
    let rest = greater(t * (2.0 - t), 0.0);
    epsilon * (t * t * (t * (1.0 / 3.0) - 0.5)) + rest * sqrt(rest) * (1.0 / 3.0)
}
