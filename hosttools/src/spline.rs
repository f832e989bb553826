//! Cubic splines of one variable: interpolating (clamped or not-a-knot ends) and smoothing (Reinsch).
//!
//! Both return the second derivatives M_i at the knots; on a segment of length h with u = t - t_i
//!
//! ```text
//! f(u) = f_i + b u + M_i u² / 2 + (M_{i+1} - M_i) u³ / (6 h),
//! b    = (f_{i+1} - f_i) / h - h (2 M_i + M_{i+1}) / 6
//! ```
//!
//! Sources: de Boor, A Practical Guide to Splines, ch. IV; Reinsch, Smoothing by spline functions (1967);
//! Green and Silverman, Nonparametric Regression and Generalized Linear Models, section 2.3.

/// What is known of the function at an end of its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The third derivative is continuous across the second knot.
    NotAKnot,
    /// The first derivative is given.
    Slope(f64),
}

/// Coefficients `[c0, c1, c2, c3]` of one segment, c0 + c1 u + c2 u² + c3 u³ with u = t - t_i.
pub type Cubic = [f64; 4];

/// The segments of the cubic spline through `values` at the strictly increasing `knots` (at least two).
pub fn interpolate(knots: &[f64], values: &[f64], first: End, last: End) -> Vec<Cubic> {
    segments(knots, values, &interpolation_moments(knots, values, first, last))
}

/// The smoothing spline that minimises Σ (f(t_i) - value_i)² + λ ∫ f''² dt, natural at its ends:
/// its values at the knots and its segments. `penalty` is λ (m³ for lengths in metres), 0 interpolates.
pub fn smooth(knots: &[f64], values: &[f64], penalty: f64) -> (Vec<f64>, Vec<Cubic>) {
    let n = knots.len();
    if n < 3 {
        return (values.to_vec(), segments(knots, values, &vec![0.0; n]));
    }
    // (R + λ QᵀQ) γ = Qᵀ y,   f = y - λ Q γ   (Green and Silverman 2.9, 2.10), a pentadiagonal system
    let h: Vec<f64> = knots.windows(2).map(|w| w[1] - w[0]).collect();
    let q = |j: usize| (1.0 / h[j], -1.0 / h[j] - 1.0 / h[j + 1], 1.0 / h[j + 1]);
    let m = n - 2;
    let mut diagonal = vec![0.0; m];
    let mut upper = vec![0.0; m];
    let mut upper2 = vec![0.0; m];
    let mut moments: Vec<f64> = vec![0.0; m];
    for j in 0..m {
        let (a, b, c) = q(j);
        diagonal[j] = (h[j] + h[j + 1]) / 3.0 + penalty * (a * a + b * b + c * c);
        if j + 1 < m {
            let (a1, b1, _) = q(j + 1);
            upper[j] = h[j + 1] / 6.0 + penalty * (b * a1 + c * b1);
        }
        if j + 2 < m {
            upper2[j] = penalty * c * q(j + 2).0;
        }
        moments[j] = a * values[j] + b * values[j + 1] + c * values[j + 2];
    }
    solve_pentadiagonal(&mut diagonal, &mut upper, &mut upper2, &mut moments);
    let mut fitted = values.to_vec();
    for j in 0..m {
        let (a, b, c) = q(j);
        fitted[j] -= penalty * a * moments[j];
        fitted[j + 1] -= penalty * b * moments[j];
        fitted[j + 2] -= penalty * c * moments[j];
    }
    let mut full = vec![0.0; n];
    full[1..=m].copy_from_slice(&moments);
    let cubics = segments(knots, &fitted, &full);
    (fitted, cubics)
}

fn segments(knots: &[f64], values: &[f64], moments: &[f64]) -> Vec<Cubic> {
    (0..knots.len() - 1)
        .map(|i| {
            let h = knots[i + 1] - knots[i];
            let (m0, m1) = (moments[i], moments[i + 1]);
            [values[i], (values[i + 1] - values[i]) / h - h * (2.0 * m0 + m1) / 6.0, m0 / 2.0, (m1 - m0) / (6.0 * h)]
        })
        .collect()
}

/// Second derivatives at the knots: the usual tridiagonal system, with its first and last row by the end conditions.
fn interpolation_moments(knots: &[f64], values: &[f64], first: End, last: End) -> Vec<f64> {
    let n = knots.len();
    let h: Vec<f64> = knots.windows(2).map(|w| w[1] - w[0]).collect();
    let slope: Vec<f64> = (0..n - 1).map(|i| (values[i + 1] - values[i]) / h[i]).collect();
    let mut lower = vec![0.0; n];
    let mut diagonal = vec![1.0; n];
    let mut upper = vec![0.0; n];
    let mut right = vec![0.0; n];
    for i in 1..n - 1 {
        lower[i] = h[i - 1] / 6.0;
        diagonal[i] = (h[i - 1] + h[i]) / 3.0;
        upper[i] = h[i] / 6.0;
        right[i] = slope[i] - slope[i - 1];
    }
    // Slope s at t_0: h (2 M_0 + M_1) / 6 = slope_0 - s; not-a-knot: M_0 = M_1 - h_0 (M_2 - M_1) / h_1.
    if let End::Slope(s) = first {
        (diagonal[0], upper[0], right[0]) = (h[0] / 3.0, h[0] / 6.0, slope[0] - s);
    } else if n > 3 {
        let ratio = h[0] / h[1];
        diagonal[1] += lower[1] * (1.0 + ratio);
        upper[1] -= lower[1] * ratio;
        lower[1] = 0.0;
    }
    if let End::Slope(s) = last {
        (lower[n - 1], diagonal[n - 1], right[n - 1]) = (h[n - 2] / 6.0, h[n - 2] / 3.0, s - slope[n - 2]);
    } else if n > 3 {
        let ratio = h[n - 2] / h[n - 3];
        diagonal[n - 2] += upper[n - 2] * (1.0 + ratio);
        lower[n - 2] -= upper[n - 2] * ratio;
        upper[n - 2] = 0.0;
    }
    for i in 1..n {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    let mut moments = vec![0.0; n];
    for i in (0..n).rev() {
        let known = if i + 1 < n { upper[i] * moments[i + 1] } else { 0.0 };
        moments[i] = (right[i] - known) / diagonal[i];
    }
    if first == End::NotAKnot && n > 3 {
        moments[0] = moments[1] - h[0] / h[1] * (moments[2] - moments[1]);
    }
    if last == End::NotAKnot && n > 3 {
        moments[n - 1] = moments[n - 2] + h[n - 2] / h[n - 3] * (moments[n - 2] - moments[n - 3]);
    }
    moments
}

/// Solves a symmetric positive definite pentadiagonal system in place (LDLᵀ), the answer in `right`.
fn solve_pentadiagonal(diagonal: &mut [f64], upper: &mut [f64], upper2: &mut [f64], right: &mut [f64]) {
    let n = diagonal.len();
    for i in 0..n {
        if i >= 2 {
            diagonal[i] -= diagonal[i - 2] * upper2[i - 2] * upper2[i - 2];
        }
        if i >= 1 {
            diagonal[i] -= diagonal[i - 1] * upper[i - 1] * upper[i - 1];
            upper[i] -= diagonal[i - 1] * upper[i - 1] * upper2[i - 1];
        }
        upper[i] /= diagonal[i];
        upper2[i] /= diagonal[i];
    }
    for i in 0..n {
        if i >= 1 {
            right[i] -= upper[i - 1] * right[i - 1];
        }
        if i >= 2 {
            right[i] -= upper2[i - 2] * right[i - 2];
        }
    }
    for (value, pivot) in right.iter_mut().zip(diagonal.iter()) {
        *value /= pivot;
    }
    for i in (0..n).rev() {
        if i + 1 < n {
            right[i] -= upper[i] * right[i + 1];
        }
        if i + 2 < n {
            right[i] -= upper2[i] * right[i + 2];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: [f64; 7] = [0.0, 0.3, 0.5, 1.1, 1.6, 1.7, 2.4];

    fn cubic(t: f64) -> f64 {
        1.0 - 2.0 * t + 0.5 * t * t + 0.7 * t * t * t
    }

    fn check(cubics: &[Cubic], expected: impl Fn(f64) -> f64, tolerance: f64) {
        for (i, c) in cubics.iter().enumerate() {
            let u = 0.4 * (KNOTS[i + 1] - KNOTS[i]);
            let got = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
            assert!((got - expected(KNOTS[i] + u)).abs() < tolerance, "segment {i}: {got}");
        }
    }

    #[test]
    fn both_end_conditions_reproduce_a_cubic() {
        let values = KNOTS.map(cubic);
        let slope = |t: f64| -2.0 + t + 2.1 * t * t;
        check(&interpolate(&KNOTS, &values, End::NotAKnot, End::NotAKnot), cubic, 1e-13);
        check(&interpolate(&KNOTS, &values, End::Slope(slope(0.0)), End::Slope(slope(2.4))), cubic, 1e-13);
        check(&interpolate(&KNOTS, &values, End::NotAKnot, End::Slope(slope(2.4))), cubic, 1e-13);
    }

    #[test]
    fn smoothing_keeps_a_line_and_moves_values_with_the_penalty() {
        let line = KNOTS.map(|t| 3.0 - t);
        let (fitted, cubics) = smooth(&KNOTS, &line, 10.0);
        assert!(fitted.iter().zip(line).all(|(a, b)| (a - b).abs() < 1e-12));
        check(&cubics, |t| 3.0 - t, 1e-12);
        let noisy = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0];
        let rms =
            |penalty| smooth(&KNOTS, &noisy, penalty).0.iter().zip(noisy).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        assert!(rms(0.0) < 1e-20 && rms(1e-3) < rms(1e-1) && rms(1e-1) < rms(10.0));
    }
}
