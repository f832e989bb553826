//! Several numbers that take the same operations, without the processor's vector instructions; `simd` has the same with
//! them, and gives the same bits.

use core::ops::{Add, Div, Mul, Sub};

#[cfg(all(target_arch = "arm", target_abi = "eabihf", not(feature = "portable")))]
use crate::arm::sqrt;
use crate::math::{at_least, at_most, single};
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf", not(feature = "portable"))))]
use libm::sqrtf as sqrt;

/// Four `f32`.
#[derive(Clone, Copy)]
pub(crate) struct Four([f32; 4]);

/// Two `f64`.
#[derive(Clone, Copy)]
pub(crate) struct Two([f64; 2]);

/// What comparisons of two `f64` say.
#[derive(Clone, Copy)]
pub(crate) struct Mask([bool; 2]);

/// Four `f64`.
#[derive(Clone, Copy)]
pub(crate) struct Quad([f64; 4]);

impl Four {
    /// Four zeros.
    pub(crate) const ZERO: Self = Self([0.0; 4]);

    #[inline(always)]
    pub(crate) fn load(numbers: &[f32; 4]) -> Self {
        Self(*numbers)
    }

    /// Four times the same.
    #[inline(always)]
    pub(crate) fn all(x: f32) -> Self {
        Self([x; 4])
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> [f32; 4] {
        self.0
    }

    /// The greater of each number and a bound; the bound for NaN.
    #[inline(always)]
    pub(crate) fn at_least(self, bound: Self) -> Self {
        with4(self, bound, |x, bound| if x > bound { x } else { bound })
    }

    /// The lesser of each number and a bound; the bound for NaN.
    #[inline(always)]
    pub(crate) fn at_most(self, bound: Self) -> Self {
        with4(self, bound, |x, bound| if x < bound { x } else { bound })
    }

    /// Square roots of numbers that are not negative, correctly rounded.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(self.0.map(sqrt))
    }

    /// Bit i says whether number i is above zero.
    #[inline(always)]
    pub(crate) fn above_zero(self) -> usize {
        let [a, b, c, d] = self.0.map(|x| usize::from(x > 0.0));
        a | b << 1 | c << 2 | d << 3
    }

    /// Each number four times.
    #[inline(always)]
    pub(crate) fn spread(self) -> [Self; 4] {
        self.0.map(Self::all)
    }

    /// The fourth numbers of three, the last of them twice.
    #[inline(always)]
    pub(crate) fn fourths(of: [Self; 3]) -> Self {
        let [a, b, c] = of.map(|Self([.., fourth])| fourth);
        Self([a, b, c, c])
    }

    /// Rows as columns.
    #[inline(always)]
    pub(crate) fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a.0, b.0);
        let ([c0, c1, c2, c3], [d0, d1, d2, d3]) = (c.0, d.0);
        [Self([a0, b0, c0, d0]), Self([a1, b1, c1, d1]), Self([a2, b2, c2, d2]), Self([a3, b3, c3, d3])]
    }
}

#[inline(always)]
fn with4(a: Four, b: Four, f: impl Fn(f32, f32) -> f32) -> Four {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a.0, b.0);
    Four([f(a0, b0), f(a1, b1), f(a2, b2), f(a3, b3)])
}

impl Add for Four {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        with4(self, other, |a, b| a + b)
    }
}

impl Sub for Four {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        with4(self, other, |a, b| a - b)
    }
}

impl Mul for Four {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        with4(self, other, |a, b| a * b)
    }
}

impl Div for Four {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        with4(self, other, |a, b| a / b)
    }
}

impl Two {
    #[inline(always)]
    pub(crate) fn new(numbers: [f64; 2]) -> Self {
        Self(numbers)
    }

    /// Two numbers that may have been written just now, one by one: each is read by itself. A processor that reads them as a
    /// vector waits until they have reached the cache.
    #[inline(always)]
    pub(crate) const fn apart(a: &f64, b: &f64) -> Self {
        Self([*a, *b])
    }

    /// Twice the same.
    #[inline(always)]
    pub(crate) fn all(x: f64) -> Self {
        Self([x; 2])
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> [f64; 2] {
        self.0
    }

    /// The greater of each number and a bound; the bound for NaN.
    #[inline(always)]
    pub(crate) fn at_least(self, bound: Self) -> Self {
        with2(self, bound, at_least)
    }

    /// The lesser of each number and a bound; the bound for NaN.
    #[inline(always)]
    pub(crate) fn at_most(self, bound: Self) -> Self {
        with2(self, bound, at_most)
    }

    /// Rounded to `f32`.
    #[inline(always)]
    pub(crate) fn single(self) -> [f32; 2] {
        self.0.map(single)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    /// Where a number is at most its limit.
    #[inline(always)]
    pub(crate) fn within(self, limit: Self) -> Mask {
        let ([a, b], [c, d]) = (self.0, limit.0);
        Mask([a <= c, b <= d])
    }

    /// These where the mask holds for both, zeros otherwise; without a branch.
    #[inline(always)]
    pub(crate) fn where_all(self, mask: Mask) -> Self {
        let [a, b] = mask.0;
        let mask = u64::from(a & b).wrapping_neg();
        Self(self.0.map(|x| f64::from_bits(x.to_bits() & mask)))
    }

    /// Where numbers differ.
    #[inline(always)]
    pub(crate) fn differs(self, other: Self) -> Mask {
        let ([a, b], [c, d]) = (self.0, other.0);
        Mask([a != c, b != d])
    }

    /// The integer parts of numbers from 0 to 2^31.
    #[inline(always)]
    pub(crate) fn truncate(self) -> [usize; 2] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates")]
        self.0.map(|x| x as u32 as usize)
    }

    /// The integer parts of numbers from 0 to 2^31, and the same as `f64`.
    #[inline(always)]
    pub(crate) fn integer_parts(self) -> ([u32; 2], Self) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates")]
        let parts = self.0.map(|x| x as u32);
        (parts, Self(parts.map(f64::from)))
    }

    /// Two little-endian `f32`.
    #[inline(always)]
    pub(crate) fn of_singles(bytes: &[u8; 8]) -> Self {
        let [a, b, c, d, e, f, g, h] = *bytes;
        Self([[a, b, c, d], [e, f, g, h]].map(|bytes| f64::from(f32::from_le_bytes(bytes))))
    }

    /// Rows as columns.
    #[inline(always)]
    pub(crate) fn transpose([a, b]: [Self; 2]) -> [Self; 2] {
        let ([a0, a1], [b0, b1]) = (a.0, b.0);
        [Self([a0, b0]), Self([a1, b1])]
    }
}

impl Mask {
    /// Bit i for comparison i.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        let [a, b] = self.0;
        u32::from(a) | u32::from(b) << 1
    }

    /// Those of another mask after its own.
    #[inline(always)]
    pub(crate) fn bits_of_both(self, next: Self) -> u32 {
        self.bits() | next.bits() << 2
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        Self([a & c, b & d])
    }
}

impl Quad {
    #[inline(always)]
    pub(crate) fn new(numbers: [f64; 4]) -> Self {
        Self(numbers)
    }

    /// Four times the same.
    #[inline(always)]
    pub(crate) fn all(x: f64) -> Self {
        Self([x; 4])
    }

    /// Four little-endian `f32`.
    #[inline(always)]
    pub(crate) fn of_singles(bytes: &[u8; 16]) -> Self {
        let mut numbers = [0.0; 4];
        for (number, bytes) in numbers.iter_mut().zip(bytes.as_chunks().0) {
            *number = f64::from(f32::from_le_bytes(*bytes));
        }
        Self(numbers)
    }

    #[inline(always)]
    pub(crate) fn join([low, high]: [Two; 2]) -> Self {
        let ([a, b], [c, d]) = (low.0, high.0);
        Self([a, b, c, d])
    }

    #[inline(always)]
    pub(crate) fn halves(self) -> [Two; 2] {
        let [a, b, c, d] = self.0;
        [Two([a, b]), Two([c, d])]
    }

    /// Rounded to `f32`.
    #[inline(always)]
    pub(crate) fn single(self) -> Four {
        Four(self.0.map(single))
    }

    /// Whether all are at most this large.
    #[inline(always)]
    pub(crate) fn all_within(self, limit: f64) -> bool {
        let [a, b, c, d] = self.0.map(|x| x.abs() <= limit);
        a & b & c & d
    }
}

#[inline(always)]
fn with2(a: Two, b: Two, f: impl Fn(f64, f64) -> f64) -> Two {
    let ([a0, a1], [b0, b1]) = (a.0, b.0);
    Two([f(a0, b0), f(a1, b1)])
}

impl Add for Two {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        with2(self, other, |a, b| a + b)
    }
}

impl Sub for Two {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        with2(self, other, |a, b| a - b)
    }
}

impl Mul for Two {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        with2(self, other, |a, b| a * b)
    }
}

impl Div for Two {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        with2(self, other, |a, b| a / b)
    }
}

#[inline(always)]
fn with_quad(a: Quad, b: Quad, f: impl Fn(f64, f64) -> f64) -> Quad {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a.0, b.0);
    Quad([f(a0, b0), f(a1, b1), f(a2, b2), f(a3, b3)])
}

impl Add for Quad {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        with_quad(self, other, |a, b| a + b)
    }
}

impl Sub for Quad {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        with_quad(self, other, |a, b| a - b)
    }
}

impl Mul for Quad {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        with_quad(self, other, |a, b| a * b)
    }
}

#[cfg(all(test, target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
mod tests {
    use super::*;
    use crate::simd;

    const NUMBERS: [f64; 12] = [0.0, -0.0, 1.0, -1.5, 0.1, 1e-3, 4095.9, 1e9, 1e300, 1e-300, f64::MIN_POSITIVE, 0.3];

    /// Every operation on every two numbers gives the bits of the vector instructions.
    #[test]
    fn same_bits_as_vector_instructions() {
        for a in NUMBERS {
            for b in NUMBERS {
                let (x, y) = (Two([a, b]), Two([b, 0.25]));
                let (v, w) = (simd::Two::new([a, b]), simd::Two::new([b, 0.25]));
                let (q, r) = (Quad::join([x, y]), simd::Quad::new([a, b, b, 0.25]));
                let (p, t) = (Quad::all(b), simd::Quad::all(b));
                let halves = |q: Quad, r: simd::Quad| {
                    let ([x, y], [v, w]) = (q.halves(), r.halves());
                    [(x, v), (y, w)]
                };
                let quads = [halves(q + p, r + t), halves(q - p, r - t), halves(q * p, r * t)];
                let pairs = [
                    (x + y, v + w),
                    (x - y, v - w),
                    (x * y, v * w),
                    (x / y, v / w),
                    (x.at_least(y), v.at_least(w)),
                    (x.at_most(y), v.at_most(w)),
                    (x.abs(), v.abs()),
                    (Two::apart(&a, &b), simd::Two::apart(&a, &b)),
                    (x.where_all(x.within(y).and(y.abs().within(x))), v.where_all(v.within(w).and(w.abs().within(v)))),
                    (Two::transpose([x, y])[0], simd::Two::transpose([v, w])[0]),
                    (Two::transpose([x, y])[1], simd::Two::transpose([v, w])[1]),
                ];
                for (index, (x, v)) in pairs.into_iter().chain(quads.into_iter().flatten()).enumerate() {
                    let bits = |numbers: [f64; 2]| numbers.map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() });
                    assert_eq!(bits(x.numbers()), bits(v.numbers()), "operation {index} of {a} and {b}");
                }
                assert_eq!(x.differs(y).bits(), v.differs(w).bits());
                let both = (x.differs(y).bits_of_both(y.differs(y)), v.differs(w).bits_of_both(w.differs(w)));
                assert_eq!(both.0, both.1);
                let both = (y.differs(y).bits_of_both(x.differs(y)), w.differs(w).bits_of_both(v.differs(w)));
                assert_eq!(both.0, both.1);
                assert_eq!(x.single().map(f32::to_bits), v.single().map(f32::to_bits));
                assert_eq!(q.single().numbers().map(f32::to_bits), r.single().numbers().map(f32::to_bits));
                assert_eq!(q.all_within(1e9), r.all_within(1e9));
                let limited = |x: f64| x.clamp(0.0, 4095.0);
                let (x, v) = (Two([limited(a), limited(b)]), simd::Two::new([limited(a), limited(b)]));
                assert_eq!(x.truncate(), v.truncate());
                let (parts, whole) = (x.integer_parts(), v.integer_parts());
                assert_eq!((parts.0, parts.1.numbers()), (whole.0, whole.1.numbers()));
                let numbers = [a, b, 0.5 * a, 3.0].map(single);
                let (x, v) = (Four(numbers), simd::Four::load(&numbers));
                let (y, w) = (Four::all(single(b)), simd::Four::all(single(b)));
                let zero = (Four::all(0.0), simd::Four::all(0.0));
                let pairs = [
                    (x + y, v + w),
                    (x - y, v - w),
                    (x * y, v * w),
                    (x / y, v / w),
                    (x.at_least(y), v.at_least(w)),
                    (x.at_most(y), v.at_most(w)),
                    (x.at_least(zero.0).sqrt(), v.at_least(zero.1).sqrt()),
                    (Four::fourths([x, y, x]), simd::Four::fourths([v, w, v])),
                    (Four::transpose([x, y, x, y])[3], simd::Four::transpose([v, w, v, w])[3]),
                ];
                for (index, (x, v)) in pairs.into_iter().enumerate() {
                    let bits = |numbers: [f32; 4]| numbers.map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() });
                    assert_eq!(bits(x.numbers()), bits(v.numbers()), "operation {index} of {a} and {b}");
                }
                assert_eq!(x.above_zero(), v.above_zero());
            }
        }
        assert_eq!(Four::load(&[1.0, 2.0, 3.0, 4.0]).numbers(), simd::Four::load(&[1.0, 2.0, 3.0, 4.0]).numbers());
        let spread = Quad::new([1.0, 2.0, 3.0, 4.0]).single().spread().map(Four::numbers);
        assert_eq!(spread, simd::Quad::new([1.0, 2.0, 3.0, 4.0]).single().spread().map(simd::Four::numbers));
        assert_eq!(spread, [1.0, 2.0, 3.0, 4.0].map(|x| [x; 4]));
        let bytes: [u8; 16] = core::array::from_fn(|i| [0x9a, 0x99, 0x59, 0x40, 0xcd, 0xcc, 0x4c, 0xbe][i % 8]);
        let singles = Quad::of_singles(&bytes).halves().map(Two::numbers);
        assert_eq!(singles, simd::Quad::of_singles(&bytes).halves().map(simd::Two::numbers));
        assert_eq!(singles, [[f64::from(3.4_f32), f64::from(-0.2_f32)]; 2]);
        let pair = bytes.first_chunk().unwrap();
        assert_eq!(Two::of_singles(pair).numbers(), singles[0]);
        assert_eq!(simd::Two::of_singles(pair).numbers(), singles[0]);
        assert_eq!(Four::ZERO.numbers(), simd::Four::ZERO.numbers());
        assert_eq!(Two::new([2.0; 2]).numbers(), Two::all(2.0).numbers());
    }
}
