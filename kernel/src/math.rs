//! The kernel's only square root, sines and cosines: the same bits on every target, the same work for every argument.

#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
pub(crate) use crate::lanes::{Four, Mask, Quad, Two};
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
pub(crate) use crate::simd::{Four, Mask, Quad, Two};

use crate::instructions::{Baseline, Instructions, Quads};

/// Largest angle of yaw and roll that is computed, rad; larger ones are clamped and flagged.
pub const ANGLE_LIMIT: f64 = 0.125;

/// An angle within [`ANGLE_LIMIT`] with its functions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle {
    /// The angle, clamped to +-[`ANGLE_LIMIT`], rad.
    pub value: f64,
    /// sin of it.
    pub sin: f64,
    /// cos of it.
    pub cos: f64,
    /// 1 - cos of it, without the cancellation.
    pub versine: f64,
    /// Whether the angle was clamped.
    pub limited: bool,
}

impl Angle {
    /// Series of sine and versine, the truncated terms below 2.4e-17 of the result at [`ANGLE_LIMIT`].
    ///
    /// Measured against libm over the whole domain: sine within 2.3e-16 relative (one unit in the last place), cosine
    /// within 1.2e-16, versine within 4.5e-16 (libm's rounding of 2 sin^2 included).
    #[inline]
    #[must_use]
    pub fn new(angle: f64) -> Self {
        let [angle, _] = Self::pair(Baseline, Two::all(angle));
        angle
    }

    /// Two angles at once.
    ///
    /// ```text
    /// sin x     = x - x³/3! + x⁵/5! - x⁷/7! + x⁹/9!          = x + x p(-1/3!, 1/5!, -1/7!, 1/9!)
    /// 1 - cos x = x²/2! - x⁴/4! + x⁶/6! - x⁸/8! + x¹⁰/10!    = x² / 2 + x² p(-1/4!, 1/6!, -1/8!, 1/10!)
    /// ```
    ///
    /// with p(a, b, c, d) = x² ((a + x² b) + x⁴ (c + x² d)), for the sines and the versines together.
    #[inline(always)]
    pub(crate) fn pair<I: Instructions>(with: I, angles: Two) -> [Self; 2] {
        let x = angles.at_least(Two::all(-ANGLE_LIMIT)).at_most(Two::all(ANGLE_LIMIT));
        let squares = x * x;
        let join = |halves| I::Quad::join(with, halves);
        let both = |sine: f64, versine: f64| join([Two::all(sine), Two::all(versine)]);
        let t = join([squares, squares]);
        let low = both(-1.0 / 6.0, -1.0 / 24.0) + t * both(1.0 / 120.0, 1.0 / 720.0);
        let high = both(-1.0 / 5040.0, -1.0 / 40_320.0) + t * both(1.0 / 362_880.0, 1.0 / 3_628_800.0);
        let p = t * (low + (t * t) * high);
        let factor = join([x, squares]);
        let [sin, versine] = (factor * both(1.0, 0.5) + factor * p).halves();
        let cos = Two::all(1.0) - versine;
        let limited = x.differs(angles);
        let ([x0, x1], [s0, s1], [c0, c1]) = (x.numbers(), sin.numbers(), cos.numbers());
        let [v0, v1] = versine.numbers();
        [
            Self { value: x0, sin: s0, cos: c0, versine: v0, limited: limited & 1 != 0 },
            Self { value: x1, sin: s1, cos: c1, versine: v1, limited: limited & 2 != 0 },
        ]
    }
}

/// The greater of a number and a bound: one instruction where `f64::max` takes several for NaN, which gives the bound.
#[inline(always)]
pub(crate) fn at_least(x: f64, bound: f64) -> f64 {
    if x > bound { x } else { bound }
}

/// The lesser of a number and a bound.
#[inline(always)]
pub(crate) fn at_most(x: f64, bound: f64) -> f64 {
    if x < bound { x } else { bound }
}

/// Rounds to `f32`, for results that need no more.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounding to the result's precision is the purpose")]
pub(crate) fn single(x: f64) -> f32 {
    x as f32
}

/// Square root of a number that is not negative, correctly rounded.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    let [root, ..] = Four::all(x).sqrt().numbers();
    root
}

/// The greater of two numbers, the second if one of them is NaN. By the vectors' instruction: the compiler makes
/// branches of comparisons where that saves it a division.
#[inline(always)]
pub(crate) fn greater(x: f32, y: f32) -> f32 {
    let [greater, ..] = Four::all(x).at_least(Four::all(y)).numbers();
    greater
}

/// The lesser of two numbers, the second if one of them is NaN.
#[inline(always)]
pub(crate) fn lesser(x: f32, y: f32) -> f32 {
    -greater(-x, -y)
}

/// e^-x for x from 0 to 80, within 4e-7 relative (measured).
///
/// With n = floor(x / ln 2) and the rest r in [0, ln 2), 2^-n is an exponent and e^-r a series about the middle.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "n is 0 to 115"
)]
pub(crate) fn exp_negative(x: f32) -> f32 {
    let n = (x * core::f32::consts::LOG2_E) as u32;
    // ln 2 in two parts, the first exact in few bits, so that the rest loses nothing.
    let r = x - n as f32 * 0.693_359_4 - n as f32 * -2.121_944_4e-4;
    // e^-r = e^(-1/3) e^t with t = 1/3 - r
    let t = 1.0 / 3.0 - r;
    let low = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0)));
    let series = low + (t * t) * (t * t) * (1.0 / 24.0 + t * (1.0 / 120.0 + t * (1.0 / 720.0)));
    f32::from_bits((127 - n) << 23) * (0.716_531_3 * series)
}

/// Arctangent of a number that is not negative and below 1e18, within 3e-7 relative (measured).
#[inline]
pub(crate) fn arctangent(x: f32) -> f32 {
    // atan x = 2 atan(x / (1 + sqrt(1 + x²))), and for x > 1 the complement of the reciprocal's.
    let y = lesser(x, 1.0) / greater(x, 1.0);
    let half = y / (1.0 + sqrt(1.0 + y * y));
    let t = half * half;
    // h - h³/3 + h⁵/5 - h⁷/7 + h⁹/9 - h¹¹/11 + h¹³/13 - h¹⁵/15
    let tail = 1.0 / 9.0 + t * (-1.0 / 11.0 + t * (1.0 / 13.0 + t * (-1.0 / 15.0)));
    let series = 1.0 + t * (-1.0 / 3.0 + t * (1.0 / 5.0 + t * (-1.0 / 7.0 + t * tail)));
    let angle = 2.0 * half * series;
    let right = core::f32::consts::FRAC_PI_2 * f32::from(u8::from(x > 1.0));
    (right - angle).abs()
}

/// Sine and cosine of a contact angle, held within ±2 rad: four doublings of [`Angle`]'s series, within 2e-15 (measured).
#[inline]
pub(crate) fn sine_cosine(angle: f64) -> (f64, f64) {
    let Angle { sin: mut s, versine: mut v, .. } = Angle::new(angle * (1.0 / 16.0));
    for _ in 0..4 {
        // sin 2x = 2 sin x cos x, 1 - cos 2x = 2 sin² x
        (s, v) = (2.0 * s * (1.0 - v), 2.0 * s * s);
    }
    (s, 1.0 - v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest relative error of `f` against `truth` over the whole domain.
    fn worst(f: impl Fn(f64) -> f64, truth: impl Fn(f64) -> f64) -> f64 {
        let n = 200_001_u32;
        (0..=n)
            .map(|i| ANGLE_LIMIT * (2.0 * f64::from(i) / f64::from(n) - 1.0))
            .map(|x| (f(x) - truth(x)).abs() / truth(x).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn sine_cosine_versine_over_the_whole_domain() {
        let sin = worst(|x| Angle::new(x).sin, libm::sin);
        let cos = worst(|x| Angle::new(x).cos, libm::cos);
        let versine = worst(|x| Angle::new(x).versine, |x| 2.0 * libm::sin(x / 2.0) * libm::sin(x / 2.0));
        std::println!("largest relative error: sin {sin:.2e}, cos {cos:.2e}, versine {versine:.2e}");
        assert!(sin < 2.3e-16 && cos < 1.2e-16 && versine < 4.5e-16);
    }

    #[test]
    fn odd_and_even_to_the_bit_and_clamped() {
        for x in [0.0, 1e-9, 0.003, 0.1, 0.125, 0.2] {
            let (p, n) = (Angle::new(x), Angle::new(-x));
            assert_eq!((p.sin, p.cos, p.versine), (-n.sin, n.cos, n.versine));
            assert_eq!(p.limited, x > ANGLE_LIMIT);
        }
        assert_eq!(Angle::new(0.2).sin, Angle::new(0.125).sin);
    }

    #[test]
    fn exponential_arctangent_and_large_angles() {
        let n = 200_000_u32;
        let relative = |got: f32, truth: f64| (f64::from(got) / truth - 1.0).abs();
        let (mut exp, mut atan, mut angle) = (0.0_f64, 0.0_f64, 0.0_f64);
        for i in 1..=n {
            let part = f64::from(i) / f64::from(n);
            let x = single(80.0 * part);
            exp = exp.max(relative(exp_negative(x), libm::exp(-f64::from(x))));
            let x = single(libm::pow(10.0, 16.0 * part - 8.0));
            atan = atan.max(relative(arctangent(x), libm::atan(f64::from(x))));
            let x = 4.0 * part - 2.0;
            let (s, c) = sine_cosine(x);
            angle = angle.max((s - libm::sin(x)).abs()).max((c - libm::cos(x)).abs());
        }
        std::println!("largest error: exp {exp:.1e}, atan {atan:.1e} (relative), sine and cosine {angle:.1e}");
        assert!(exp < 4e-7 && atan < 3e-7 && angle < 2e-15);
        assert_eq!(arctangent(0.0), 0.0);
    }
}
