//! The kernel's only square root, sines and cosines: the same bits on every target, the same work for every argument.

use core::ops::{Add, Div, Mul, Sub};

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
    /// Sine and versine by polynomials.
    ///
    /// Measured against libm over the whole domain: sine within 1.8e-15 relative, cosine within 1.2e-16, versine within
    /// 7e-16 (libm's rounding of 2 sin^2 included). A wheel at 0.75 m from the centre is so moved by 2e-16 m.
    #[inline]
    #[must_use]
    pub fn new(angle: f64) -> Self {
        let ([angle, _], _) = Self::pair(Baseline, Two::all(angle));
        angle
    }

    /// Two angles at once, and in bit i whether angle i was clamped.
    ///
    /// ```text
    /// sin x = x (1 + p(x²))        1 - cos x = x² (1/2 + q(x²))
    /// ```
    ///
    /// with p and q of the form t ((a + t b) + t² c), of least relative error over the domain (Remez), for the sines and the
    /// versines together. The coefficients are near -1/3!, 1/5!, -1/7! and -1/4!, 1/6!, -1/8!.
    #[inline(always)]
    pub(crate) fn pair<I: Instructions>(with: I, angles: Two) -> ([Self; 2], u32) {
        let x = angles.at_least(Two::all(-ANGLE_LIMIT)).at_most(Two::all(ANGLE_LIMIT));
        let join = |halves| I::Quad::join(with, halves);
        let both = |sine: f64, versine: f64| join([Two::all(sine), Two::all(versine)]);
        let twice = join([x, x]).held();
        let t = twice * twice;
        let low = both(-0.166_666_666_664_738_45, -0.041_666_666_666_473_83)
            + t * both(0.008_333_332_584_404_593, 0.001_388_888_813_992_647);
        let p = t * (low + (t * t) * both(-0.000_198_330_005_544_807_9, -2.479_331_774_056_942e-5));
        let ([x, _], [_, squares]) = (twice.halves(), t.halves());
        let [sin, versine] = (join([x, squares]) * (both(1.0, 0.5) + p)).halves();
        let cos = Two::all(1.0) - versine;
        let limited = x.differs(angles).bits();
        let ([x0, x1], [s0, s1], [c0, c1]) = (x.numbers(), sin.numbers(), cos.numbers());
        let [v0, v1] = versine.numbers();
        let pair = [
            Self { value: x0, sin: s0, cos: c0, versine: v0, limited: limited & 1 != 0 },
            Self { value: x1, sin: s1, cos: c1, versine: v1, limited: limited & 2 != 0 },
        ];
        (pair, limited)
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
    let [lesser, ..] = Four::all(x).at_most(Four::all(y)).numbers();
    lesser
}

/// One number, or four that take the same operations: the same bits of each.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The same in every place.
    fn all(x: f32) -> Self;
    /// The greater of each number and a bound; the bound for NaN.
    fn no_less(self, bound: Self) -> Self;
    /// The lesser of each number and a bound; the bound for NaN.
    fn no_more(self, bound: Self) -> Self;
    /// Square roots of numbers that are not negative, correctly rounded.
    fn root(self) -> Self;

    /// Magnitudes.
    #[inline(always)]
    fn size(self) -> Self {
        self.no_less(Self::all(0.0) - self)
    }
}

impl Number for f32 {
    #[inline(always)]
    fn all(x: f32) -> Self {
        x
    }

    #[inline(always)]
    fn no_less(self, bound: Self) -> Self {
        greater(self, bound)
    }

    #[inline(always)]
    fn no_more(self, bound: Self) -> Self {
        lesser(self, bound)
    }

    #[inline(always)]
    fn root(self) -> Self {
        sqrt(self)
    }
}

impl Number for Four {
    #[inline(always)]
    fn all(x: f32) -> Self {
        Self::all(x)
    }

    #[inline(always)]
    fn no_less(self, bound: Self) -> Self {
        self.at_least(bound)
    }

    #[inline(always)]
    fn no_more(self, bound: Self) -> Self {
        self.at_most(bound)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// 1 - e^-x for x from 0 on, within 3e-7 relative (measured); from 16 on one.
///
/// By a polynomial at x/16 that interpolates at Chebyshev's nodes, and four doublings: with m = 1 - e^-x, that of 2x is
/// m (2 - m), which makes no relative error greater.
#[inline(always)]
pub(crate) fn rising<N: Number>(x: N) -> N {
    let all = N::all;
    let z = (x * all(1.0 / 16.0)).no_more(all(1.0));
    let low = all(0.999_999_94) - z * all(0.499_995_17);
    let high = all(0.166_609_67) - z * all(0.041_418_765) + z * z * (all(0.007_837_363_5) - z * all(0.000_912_545_37));
    let mut rising = z * (low + z * z * high);
    for _ in 0..4 {
        rising = rising * (all(2.0) - rising);
    }
    rising
}

/// (atan x) / x by t = x² from 0 to 1, within 2e-7 relative (measured).
///
/// A polynomial that interpolates at Chebyshev's nodes, one at zero.
#[inline(always)]
pub(crate) fn arctangent_ratio<N: Number>(t: N) -> N {
    let pair = |a: f32, b: f32| N::all(a) + t * N::all(b);
    let square = t * t;
    let low = pair(-0.333_333_22, 0.199_986_82) + square * pair(-0.142_570_45, 0.108_657_59);
    let high = pair(-0.080_096_82, 0.048_914_32) + square * pair(-0.020_026_747, 0.003_866_738_9);
    N::all(1.0) + t * (low + (square * square) * high)
}

/// Sine and cosine of a contact angle, held within ±2 rad, within 1e-15 (measured).
///
/// ```text
/// sin x = x + x³ p(x²)      cos x = 1 - x²/2 + x⁴ q(x²)
/// ```
///
/// p and q of eighth order together, polynomials that interpolate at Chebyshev's nodes.
#[inline]
pub(crate) fn sine_cosine(angle: f64) -> (f64, f64) {
    let x = at_most(at_least(angle, -2.0), 2.0);
    let square = x * x;
    let t = Two::all(square);
    let pair = |a: [f64; 2], b: [f64; 2]| Two::new(a) + t * Two::new(b);
    let t2 = t * t;
    let low = pair(
        [-0.166_666_666_666_666_66, 0.041_666_666_666_666_664],
        [0.008_333_333_333_332_827, -0.001_388_888_888_888_863_6],
    ) + t2
        * pair(
            [-0.000_198_412_698_410_038_35, 2.480_158_730_145_384e-5],
            [2.755_731_917_074_493_4e-6, -2.755_731_919_727_581e-7],
        );
    let high = pair(
        [-2.505_210_314_992_311e-8, 2.087_675_436_159_672_5e-9],
        [1.605_876_403_535_828e-10, -1.147_060_526_848_511_6e-11],
    ) + t2
        * pair(
            [-7.638_866_923_181_49e-13, 4.775_317_599_409_767e-14],
            [2.682_859_306_943_873e-15, -1.497_490_050_051_443_3e-16],
        );
    let [p, q] = (low + (t2 * t2) * high).numbers();
    (x + x * square * p, 1.0 - (0.5 * square - square * square * q))
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
        assert!(sin < 1.8e-15 && cos < 1.2e-16 && versine < 7e-16);
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
        let (mut rise, mut atan, mut angle) = (0.0_f64, 0.0_f64, 0.0_f64);
        for i in 1..=n {
            let part = f64::from(i) / f64::from(n);
            let x = single(16.0 * part);
            rise = rise.max(relative(rising(x), -libm::expm1(-f64::from(x))));
            let root = libm::sqrt(f64::from(single(part)));
            atan = atan.max(relative(arctangent_ratio(single(part)), libm::atan(root) / root));
            let x = 4.0 * part - 2.0;
            let (s, c) = sine_cosine(x);
            angle = angle.max((s - libm::sin(x)).abs()).max((c - libm::cos(x)).abs());
        }
        std::println!("largest error: atan {atan:.1e} (relative), 1 - e^-x {rise:.1e}, sine and cosine {angle:.1e}");
        assert!(atan < 2e-7 && rise < 3e-7 && angle < 1e-15);
        assert_eq!((arctangent_ratio(0.0), rising(0.0)), (1.0, 0.0));
        assert!((rising(100.0) - 1.0).abs() < 2e-7);
        assert_eq!(sine_cosine(0.0), (0.0, 1.0));
    }
}
