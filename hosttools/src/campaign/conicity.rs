//! Equivalent conicity to EN 15302 (UIC 519): the taper of the coned wheelset whose kinematic motion has the same
//! wavelength at the same amplitude.
//!
//! The method is that of the standard's Annex B, the integration of the nonlinear differential equation of the kinematic
//! motion over the rolling radius difference Δr(y) = r_right - r_left of the rigid contact:
//!
//! ```text
//! y″ + Δr(y) / (e r₀) = 0,   S(y) = ∫ Δr dy,   y′ = √(2 (S(y_max) - S(y)) / (e r₀))
//! λ = 2 ∫ dy / y′ from y_min to y_max,   S(y_min) = S(y_max),   y_max - y_min = 2 ŷ
//! tan γ_e = 2 π² e r₀ / λ²            (Klingel: λ = 2 π √(e r₀ / (2 tan γ)))
//! ```
//! e is the distance of the tape circles (1500 mm on standard gauge), r₀ the nominal radius; both drop out of the result.
//! The rigid contact is found with the roll of the wheelset, which the standard leaves out.

use std::f64::consts::PI;

use crate::pair::Pair;
use crate::rigid::two_wheels;

/// Amplitude (m) of the usual figure.
pub const AMPLITUDE: f64 = 3e-3;
/// Farthest lateral position (m) that is looked at, and steps (m) between, as the standard wants them or finer.
const FARTHEST: f64 = 10e-3;
const STEP: f64 = 0.05e-3;
/// Steps of the integral over half a wavelength.
const PHASES: usize = 2000;

/// The rolling radius difference over the lateral position, linear between evenly spaced points.
#[derive(Debug, Clone, PartialEq)]
pub struct RadiusDifference {
    first: f64,
    step: f64,
    values: Vec<f64>,
    /// S at the points.
    integral: Vec<f64>,
}

impl RadiusDifference {
    /// Of values (m) at `first`, `first + step`... (m); at least two.
    pub fn new(first: f64, step: f64, values: Vec<f64>) -> Self {
        let mut sum = 0.0;
        let parts = values.windows(2).map(|w| 0.5 * step * (w[0] + w[1]));
        let integral = std::iter::once(0.0).chain(parts.map(|part| {
            sum += part;
            sum
        }));
        Self { first, step, integral: integral.collect(), values }
    }

    /// Of the rigid contact of a pair, as far to both sides as both wheels touch.
    pub fn of(pair: &Pair) -> Self {
        let difference = |y: f64| two_wheels(pair, y, 0.0).map(|r| r.right.wheel.radius - r.left.wheel.radius);
        let steps = (FARTHEST / STEP).round() as i32;
        let side = |sign: f64, from: i32| {
            (from..=steps).map_while(move |i| difference(sign * STEP * f64::from(i))).collect::<Vec<f64>>()
        };
        let (left, right) = (side(-1.0, 1), side(1.0, 0));
        let first = -STEP * left.len() as f64;
        Self::new(first, STEP, left.into_iter().rev().chain(right).collect())
    }

    fn last(&self) -> f64 {
        self.first + self.step * (self.values.len() - 1) as f64
    }

    /// S(y), quadratic between the points.
    fn integral(&self, y: f64) -> f64 {
        let place = ((y - self.first) / self.step).clamp(0.0, (self.values.len() - 1) as f64);
        let cell = (place as usize).min(self.values.len() - 2);
        let (a, b) = (self.values[cell], self.values[cell + 1]);
        let t = place - cell as f64;
        self.integral[cell] + self.step * t * (a + 0.5 * t * (b - a))
    }

    /// tan γ_e at an amplitude (m); none where the wheelset does not come back: it steers away from the centre, or the
    /// amplitude is beyond the contact.
    pub fn conicity(&self, amplitude: f64) -> Option<f64> {
        // The centre c of the motion: S(c + ŷ) = S(c - ŷ), which rises with c.
        let uneven = |c: f64| self.integral(c + amplitude) - self.integral(c - amplitude);
        let (mut low, mut high) = (self.first + amplitude, self.last() - amplitude);
        if low >= high || uneven(low) > 0.0 || uneven(high) < 0.0 {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if uneven(middle) < 0.0 { low = middle } else { high = middle }
        }
        let centre = 0.5 * (low + high);
        // With y = c + ŷ sin θ the integral has no singular ends: λ √(2 / (e r₀)) = 2 ∫ ŷ cos θ / √(S_max - S) dθ.
        let top = 0.5 * (self.integral(centre + amplitude) + self.integral(centre - amplitude));
        let mut sum = 0.0;
        for k in 0..PHASES {
            let phase = PI * ((k as f64 + 0.5) / PHASES as f64 - 0.5);
            let left = top - self.integral(centre + amplitude * libm::sin(phase));
            if left <= 0.0 {
                return None;
            }
            sum += amplitude * libm::cos(phase) / left.sqrt();
        }
        let wavelength = 2.0 * sum * PI / PHASES as f64;
        // 2 π² e r₀ / λ² with λ² = wavelength² e r₀ / 2
        Some(4.0 * PI * PI / (wavelength * wavelength))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_has_its_taper() {
        for taper in [0.01, 0.05, 0.3] {
            let values = (-100..=100).map(|i| 2.0 * taper * 1e-4 * f64::from(i)).collect();
            let cone = RadiusDifference::new(-10e-3, 1e-4, values);
            for amplitude in [1e-3, 3e-3, 8e-3] {
                let found = cone.conicity(amplitude).unwrap();
                assert!((found / taper - 1.0).abs() < 1e-5, "{taper}: {found}");
            }
            assert_eq!(cone.conicity(11e-3), None);
        }
    }

    #[test]
    fn a_cubic_difference_has_the_wavelength_of_duffings_oscillator() {
        // Δr = k y³: λ ∝ Γ(1/4)² / ŷ, tan γ_e = 2 π³ k ŷ² / Γ(1/4)⁴
        let k = 3.0e3;
        let y = |i: i32| 2e-5 * f64::from(i);
        let values = (-400..=400).map(|i| k * y(i).powi(3)).collect();
        let found = RadiusDifference::new(y(-400), 2e-5, values).conicity(4e-3).unwrap();
        let gamma = 3.625_609_908_221_908_f64;
        let expected = k * 16e-6 * 2.0 * PI.powi(3) / gamma.powi(4);
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }

    #[test]
    fn a_wheelset_that_steers_away_has_none() {
        let values = (-100..=100).map(|i| -1e-5 * f64::from(i)).collect();
        assert_eq!(RadiusDifference::new(-10e-3, 1e-4, values).conicity(3e-3), None);
    }

    /// EN 15302, Annex E, case E.1: reference wheel A on reference rail A, Δr (mm) for y = 0 to 5 mm in steps of 0.1 mm, and tan γ_e at
    /// whole amplitudes (mm).
    const E1: [f64; 51] = [
        0.000, 0.032, 0.051, 0.071, 0.092, 0.116, 0.142, 0.167, 0.197, 0.227, 0.257, 0.292, 0.328, 0.361, 0.402, 0.443,
        0.481, 0.527, 0.574, 0.616, 0.667, 0.719, 0.766, 0.822, 0.879, 0.931, 0.992, 1.055, 1.111, 1.177, 1.236, 1.299,
        1.346, 1.407, 1.471, 1.539, 1.598, 1.673, 1.752, 1.834, 1.906, 1.995, 2.088, 2.185, 2.286, 2.373, 2.481, 2.593,
        2.709, 2.808, 2.931,
    ];
    const E1_CONICITY: [[f64; 2]; 4] = [[1.0, 0.125], [2.0, 0.155], [3.0, 0.188], [4.0, 0.216]];

    #[test]
    fn the_published_difference_gives_the_published_conicity() {
        let values: Vec<f64> = E1[1..].iter().rev().map(|r| -1e-3 * r).chain(E1.map(|r| 1e-3 * r)).collect();
        let published = RadiusDifference::new(-5e-3, 1e-4, values);
        for [amplitude, expected] in E1_CONICITY {
            let found = published.conicity(1e-3 * amplitude).unwrap();
            println!("{amplitude} mm: {found:.4}, published {expected}");
            assert!((found - expected).abs() < 0.003, "{amplitude} mm: {found}, published {expected}");
        }
    }
}
