//! Four `f64`, as [`crate::lanes::Quad`]: in two vectors of 128 bits, or in one of 256 where there is AVX2.

use core::arch::x86_64::*;
use core::ops::{Add, Mul, Sub};

use super::hold::{held, made};
use super::{Avx2, Four, Two};
use crate::blend::ONE;
use crate::instructions::Quads;

/// Four `f64` that take the same operations.
#[derive(Clone, Copy)]
pub(crate) struct Quad([__m128d; 2]);

impl Quad {
    #[inline(always)]
    pub(crate) fn all(x: f64) -> Self {
        Self::new([x; 4])
    }

    #[inline(always)]
    pub(crate) fn new([a, b, c, d]: [f64; 4]) -> Self {
        Self::join([Two::new([a, b]), Two::new([c, d])])
    }

    #[inline(always)]
    pub(crate) fn of_singles(bytes: &[u8; 16]) -> Self {
        // SAFETY: SSE2 as above; the pointers are those of 8 bytes each, and the loads ask for no alignment.
        let half = |bytes: &[u8; 8]| unsafe { _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(bytes.as_ptr().cast()))) };
        let [low, high] = *bytes.as_chunks().0 else { return Self::all(0.0) };
        Self([half(&low), half(&high)])
    }

    #[inline(always)]
    pub(crate) fn join([low, high]: [Two; 2]) -> Self {
        Self([low.0, high.0])
    }

    #[inline(always)]
    pub(crate) fn halves(self) -> [Two; 2] {
        self.0.map(Two)
    }

    #[inline(always)]
    pub(crate) fn single(self) -> Four {
        let [low, high] = self.0;
        Four(unsafe { _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)) })
    }

    #[inline(always)]
    pub(crate) fn all_within(self, limit: f64) -> bool {
        unsafe {
            // Not at most: what is no number is not.
            let [low, high] = self.0.map(|x| _mm_cmpnle_pd(_mm_andnot_pd(_mm_set1_pd(-0.0), x), _mm_set1_pd(limit)));
            _mm_movemask_pd(made(_mm_or_pd(low, high))) == 0
        }
    }

    /// Rounded to the nearest integers, half to even.
    #[inline(always)]
    pub(crate) fn rounded(self) -> __m128i {
        let [low, high] = self.0;
        unsafe { _mm_unpacklo_epi64(_mm_cvtpd_epi32(low), _mm_cvtpd_epi32(high)) }
    }
}

impl Add for Quad {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        both(self, other, |a, b| a + b)
    }
}

impl Sub for Quad {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        both(self, other, |a, b| a - b)
    }
}

impl Mul for Quad {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        both(self, other, |a, b| a * b)
    }
}

/// An operation on the halves.
#[inline(always)]
fn both(a: Quad, b: Quad, f: impl Fn(Two, Two) -> Two) -> Quad {
    let ([a_low, a_high], [b_low, b_high]) = (a.halves(), b.halves());
    Quad::join([f(a_low, b_low), f(a_high, b_high)])
}

/// [`Quad`] in one vector. Whoever has one has had an [`Avx2`] to make it with.
#[derive(Clone, Copy)]
pub(crate) struct WideQuad(__m256d);

// SAFETY of every block below: there is AVX2, and with it AVX.
impl Quads<Avx2> for WideQuad {
    #[inline(always)]
    fn all(_: Avx2, x: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn of_singles(_: Avx2, bytes: &[u8; 16]) -> Self {
        // The pointer is that of sixteen bytes, and the load asks for no alignment.
        Self(unsafe { _mm256_cvtps_pd(_mm_castsi128_ps(_mm_loadu_si128(bytes.as_ptr().cast()))) })
    }

    #[inline(always)]
    fn held(self) -> Self {
        Self(unsafe { _mm256_castsi256_pd(held(_mm256_castpd_si256(self.0))) })
    }

    #[inline(always)]
    fn join(_: Avx2, [low, high]: [Two; 2]) -> Self {
        Self(unsafe { _mm256_set_m128d(high.0, low.0) })
    }

    #[inline(always)]
    fn halves(self) -> [Two; 2] {
        unsafe { [Two(_mm256_castpd256_pd128(self.0)), Two(_mm256_extractf128_pd::<1>(self.0))] }
    }

    #[inline(always)]
    fn all_within(self, limit: f64) -> bool {
        unsafe {
            // Not at most: what is no number is not.
            let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
            _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_NLE_UQ>(size, _mm256_set1_pd(limit))) == 0
        }
    }

    #[inline(always)]
    fn running_sums(with: Avx2, plane: Two, roll: f64) -> [Self; 2] {
        let numbers = |[a, b, c, d]: [f64; 4]| Self(unsafe { _mm256_set_pd(d, c, b, a) });
        let plane = unsafe { _mm256_castpd128_pd256(plane.0) };
        let [u, p] = unsafe { [_mm256_permute4x64_pd::<0x00>(plane), _mm256_permute4x64_pd::<0x55>(plane)] }.map(Self);
        // The quarters' begins: 0, 0 + (half - 0) p, half, half + (1 - half) p
        let half = u * numbers([0.0, 0.0, ONE, ONE]);
        let length = numbers([0.0, 0.0, 0.0, ONE]) + u * numbers([0.0, ONE, 0.0, -ONE]);
        let begin = half + length * p;
        // A quarter ends where the next begins: the second at half, the last at the whole, which half + (1 - half) is
        // however 1 - half rounds.
        let end = Self(unsafe { _mm256_unpackhi_pd(begin.0, (half + length).0) });
        [begin + (end - begin) * Self::all(with, roll), end]
    }
}

impl WideQuad {
    /// Rounded to the nearest integers, half to even.
    #[inline(always)]
    pub(crate) fn rounded(self) -> __m128i {
        unsafe { _mm256_cvtpd_epi32(self.0) }
    }
}

impl Add for WideQuad {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(unsafe { _mm256_add_pd(self.0, other.0) })
    }
}

impl Sub for WideQuad {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(unsafe { _mm256_sub_pd(self.0, other.0) })
    }
}

impl Mul for WideQuad {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(unsafe { _mm256_mul_pd(self.0, other.0) })
    }
}
