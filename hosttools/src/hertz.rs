//! Hertz's contact of two smooth elastic bodies, from the indentation.
//!
//! Near the contact the gap is z = A x² + B y² with A ≤ B half the principal combined curvatures. With e the
//! eccentricity of the contact ellipse, semi-axes a ≥ b, b² = (1 - e²) a², and K(e), E(e) the complete elliptic
//! integrals (Johnson, Contact Mechanics, 1985, eqs. 4.26 to 4.32):
//!
//! ```text
//! A / B = [K - E] / [E / (1 - e²) - K]
//! a = c_a √(δ / (A + B)),  b = c_b √(δ / (A + B)),  N = c_N E* δ^1.5 / √(A + B)
//! c_b = √(E / K),  c_a = c_b / √(1 - e²),  c_N = 2 π c_a / (3 K)
//! ```

use std::f64::consts::PI;

/// Smallest A / B that is told apart; a contact longer than this is as good as a line.
const SMALLEST_RATIO: f64 = 1e-8;

/// Hertz's coefficients of one pair of principal curvatures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// c_N: N = c_N E* δ^1.5 / √(A + B).
    pub normal: f64,
    /// c_a of the longer semi-axis, which lies along the smaller curvature A.
    pub long: f64,
    /// c_b of the shorter semi-axis.
    pub short: f64,
}

/// Elastic constants of wheel and rail (equal steels, as in the paper).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus (Pa).
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

impl Material {
    /// E* (Pa): 1 / E* = 2 (1 - ν²) / E for equal materials, which is G / (1 - ν).
    pub fn contact_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 - self.poisson_ratio * self.poisson_ratio)
    }
}

/// Complete elliptic integrals K and E for the complementary modulus `k1` = √(1 - e²) in (0, 1], by the
/// arithmetic-geometric mean (Abramowitz and Stegun 17.6): K = π / (2 a_n), E = K (1 - Σ 2^(n-1) c_n²).
pub(crate) fn elliptic(k1: f64) -> (f64, f64) {
    let (mut a, mut b) = (1.0, k1);
    let mut sum = 0.5 * (1.0 - k1 * k1);
    let mut power = 0.5;
    for _ in 0..8 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
    }
    let k = PI / (2.0 * a);
    (k, k * (1.0 - sum))
}

/// A / B as a function of k1 = b / a.
fn curvature_ratio(k1: f64) -> f64 {
    if k1 > 0.9999 {
        // The quotient is 0 / 0 for the circle; its expansion: A / B = k1^1.5 to second order in 1 - k1.
        return k1 * k1.sqrt();
    }
    let (k, e) = elliptic(k1);
    (k - e) / (e / (k1 * k1) - k)
}

/// Hertz's coefficients for the ratio of principal curvatures A / B, taken into (0, 1].
pub fn coefficients(ratio: f64) -> Coefficients {
    let ratio = ratio.clamp(SMALLEST_RATIO, 1.0);
    // Secant steps on log(A / B) against log(b / a): the two are nearly proportional (b / a ≈ (A / B)^(2/3)).
    let target = libm::log(ratio);
    let mut x = target / 1.5;
    let mut slope = 1.5;
    let mut value = libm::log(curvature_ratio(libm::exp(x)));
    for _ in 0..12 {
        let step = (target - value) / slope;
        if step.abs() < 1e-13 {
            break;
        }
        let next = (x + step).min(0.0);
        let at_next = libm::log(curvature_ratio(libm::exp(next)));
        if next != x && at_next != value {
            slope = ((at_next - value) / (next - x)).clamp(0.5, 3.0);
        }
        (x, value) = (next, at_next);
    }
    let k1 = libm::exp(x);
    let (k, e) = elliptic(k1);
    let short = (e / k).sqrt();
    let long = short / k1;
    Coefficients { normal: 2.0 * PI * long / (3.0 * k), long, short }
}

/// Normal force N = C δ₊^1.5 (N) of a stiffness C (N m^-1.5) and an indentation δ (m), none of a gap.
pub fn normal_force(stiffness: f64, indentation: f64) -> f64 {
    let delta = indentation.max(0.0);
    stiffness * delta * delta.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Johnson's table in the form of the angle θ, cos θ = |A - B| / (A + B): θ, c_N, c_a, c_b.
    const TABLE: [[f64; 4]; 9] = [
        [5.0, 8.24206, 20.6248, 0.4370],
        [10.0, 4.76161, 10.1058, 0.4753],
        [20.0, 2.84154, 4.9108, 0.5304],
        [30.0, 2.15405, 3.2041, 0.5785],
        [45.0, 1.68736, 2.0838, 0.6531],
        [60.0, 1.46865, 1.5345, 0.7406],
        [70.0, 1.38999, 1.3030, 0.8111],
        [80.0, 1.34702, 1.1317, 0.8958],
        [90.0, 1.33333, 1.0, 1.0],
    ];

    #[test]
    fn every_row_of_the_published_table() {
        for [theta, c_n, c_a, c_b] in TABLE {
            let cosine = libm::cos(f64::to_radians(theta));
            let c = coefficients((1.0 - cosine) / (1.0 + cosine));
            for (got, printed) in [(c.normal, c_n), (c.long, c_a), (c.short, c_b)] {
                assert!((got / printed - 1.0).abs() < 1e-4, "theta {theta}: {got} against {printed}");
            }
        }
    }

    #[test]
    fn the_solved_examples() {
        let modulus =
            |g: f64, nu: f64| Material { youngs_modulus: 2.0 * g * (1.0 + nu), poisson_ratio: nu }.contact_modulus();
        // G 82000, ν 0.28, A 0.8464e-3, B 0.2406e-2, δ 0.0926682: a 8, b 4, N 82000, p0 1223.5 (mm, N, MPa)
        let (a, b, delta) = (0.8464e-3, 0.2406e-2, 0.0926682);
        let c = coefficients(a / b);
        let scale = f64::sqrt(delta / (a + b));
        let force = c.normal * modulus(82000.0, 0.28) * libm::pow(delta, 1.5) / f64::sqrt(a + b);
        assert!((c.long * scale / 8.0 - 1.0).abs() < 3e-4 && (c.short * scale / 4.0 - 1.0).abs() < 3e-4);
        assert!((force / 82000.0 - 1.0).abs() < 3e-4, "{force}");
        let pressure = 1.5 * force / (PI * c.long * c.short * scale * scale);
        assert!((pressure / 1223.5 - 1.0).abs() < 3e-4, "{pressure}");
        // G 200, ν 0.42, A = B = 0.01, δ 0.02: a = b = 1, N 9.1954
        let c = coefficients(1.0);
        let force = c.normal * modulus(200.0, 0.42) * libm::pow(0.02, 1.5) / 0.02_f64.sqrt();
        assert!((force / 9.1954 - 1.0).abs() < 1e-5 && (c.long - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_ratio_is_inverted_over_its_whole_domain() {
        for i in 0..=80 {
            let ratio = libm::pow(10.0, -8.0 * f64::from(i) / 80.0);
            let c = coefficients(ratio);
            assert!((curvature_ratio(c.short / c.long) / ratio - 1.0).abs() < 1e-8, "{ratio}");
            assert!((c.short / c.long - 1.0).abs() > 0.0 || ratio == 1.0);
        }
    }
}
