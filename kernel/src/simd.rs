//! The kernel's only processor instructions by name, for x86-64: SSE2, which every such processor has, and AVX2 where
//! the processor that it runs on has it. The same bits as the portable paths; tests hold them together.
//!
//! An intrinsic is unsafe to call because its instruction might not exist. Here each of them does: the module is
//! compiled only where the whole program may use SSE2, and whoever calls for AVX2 has an [`Avx2`] to show. Only
//! loads, stores and the prefetch take pointers, and those are made from references to as many bytes as they touch.

mod avx2;
mod blend;
mod hold;
mod quad;

use core::arch::x86_64::*;
use core::ops::{Add, Div, Mul, Sub};

use crate::layout::RECORD;
use hold::made;

pub(crate) use avx2::Avx2;
pub(crate) use blend::{blend_128, blend_256};
pub(crate) use hold::{escape, opaque};
pub(crate) use quad::{Quad, WideQuad};

/// Four `f32` that take the same operations; as [`crate::lanes::Four`].
#[derive(Clone, Copy)]
pub(crate) struct Four(__m128);

/// Two `f64` that take the same operations; as [`crate::lanes::Two`].
#[derive(Clone, Copy)]
pub(crate) struct Two(__m128d);

// SAFETY of every block up to the end of this file: the instructions are SSE2's, and this module is compiled only where the
// whole program may use SSE2. Only loads and the prefetch touch memory, see there.
impl Four {
    /// Four zeros.
    // SAFETY: any sixteen bytes are four `f32`.
    pub(crate) const ZERO: Self = Self(unsafe { core::mem::transmute::<[f32; 4], __m128>([0.0; 4]) });

    /// By one load, where the compiler would put overlapping ones together from parts.
    #[inline(always)]
    pub(crate) fn load(numbers: &[f32; 4]) -> Self {
        // SAFETY: SSE2 as above; the pointer is that of four `f32`, and the load asks for no alignment.
        Self(unsafe { _mm_loadu_ps(numbers.as_ptr()) })
    }

    #[inline(always)]
    pub(crate) fn all(x: f32) -> Self {
        Self(unsafe { _mm_set1_ps(x) })
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> [f32; 4] {
        numbers(self.0)
    }

    #[inline(always)]
    pub(crate) fn at_least(self, bound: Self) -> Self {
        Self(unsafe { _mm_max_ps(self.0, bound.0) })
    }

    #[inline(always)]
    pub(crate) fn at_most(self, bound: Self) -> Self {
        Self(unsafe { _mm_min_ps(self.0, bound.0) })
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(unsafe { _mm_sqrt_ps(self.0) })
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "four bits")]
    pub(crate) fn above_zero(self) -> usize {
        unsafe { _mm_movemask_ps(_mm_cmplt_ps(_mm_setzero_ps(), self.0)) as usize }
    }

    #[inline(always)]
    pub(crate) fn spread(self) -> [Self; 4] {
        unsafe {
            let x = _mm_castps_si128(self.0);
            [
                Self(_mm_castsi128_ps(_mm_shuffle_epi32::<0x00>(x))),
                Self(_mm_castsi128_ps(_mm_shuffle_epi32::<0x55>(x))),
                Self(_mm_castsi128_ps(_mm_shuffle_epi32::<0xaa>(x))),
                Self(_mm_castsi128_ps(_mm_shuffle_epi32::<0xff>(x))),
            ]
        }
    }

    #[inline(always)]
    pub(crate) fn fourths([a, b, c]: [Self; 3]) -> Self {
        Self(unsafe { _mm_shuffle_ps::<0b11_11_11_10>(_mm_unpackhi_ps(a.0, b.0), c.0) })
    }

    #[inline(always)]
    pub(crate) fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        unsafe {
            let (ab, cd) = (_mm_unpacklo_ps(a.0, b.0), _mm_unpacklo_ps(c.0, d.0));
            let (ab_high, cd_high) = (_mm_unpackhi_ps(a.0, b.0), _mm_unpackhi_ps(c.0, d.0));
            [
                Self(_mm_movelh_ps(ab, cd)),
                Self(_mm_movehl_ps(cd, ab)),
                Self(_mm_movelh_ps(ab_high, cd_high)),
                Self(_mm_movehl_ps(cd_high, ab_high)),
            ]
        }
    }
}

impl Add for Four {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(unsafe { _mm_add_ps(self.0, other.0) })
    }
}

impl Sub for Four {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(unsafe { _mm_sub_ps(self.0, other.0) })
    }
}

impl Mul for Four {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(unsafe { _mm_mul_ps(self.0, other.0) })
    }
}

impl Div for Four {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(unsafe { _mm_div_ps(self.0, other.0) })
    }
}

impl Two {
    #[inline(always)]
    pub(crate) fn new([a, b]: [f64; 2]) -> Self {
        Self(unsafe { _mm_set_pd(b, a) })
    }

    #[inline(always)]
    pub(crate) fn apart(a: &f64, b: &f64) -> Self {
        Self(unsafe { _mm_loadh_pd(made(_mm_load_sd(a)), b) })
    }

    #[inline(always)]
    pub(crate) fn all(x: f64) -> Self {
        Self(unsafe { _mm_set1_pd(x) })
    }

    #[inline(always)]
    pub(crate) fn numbers(self) -> [f64; 2] {
        unsafe { [_mm_cvtsd_f64(self.0), _mm_cvtsd_f64(_mm_unpackhi_pd(self.0, self.0))] }
    }

    #[inline(always)]
    pub(crate) fn at_least(self, bound: Self) -> Self {
        Self(unsafe { _mm_max_pd(self.0, bound.0) })
    }

    #[inline(always)]
    pub(crate) fn at_most(self, bound: Self) -> Self {
        Self(unsafe { _mm_min_pd(self.0, bound.0) })
    }

    #[inline(always)]
    pub(crate) fn single(self) -> [f32; 2] {
        let single = Four(unsafe { _mm_cvtpd_ps(self.0) });
        let [a, b, ..] = single.numbers();
        [a, b]
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(unsafe { _mm_andnot_pd(_mm_set1_pd(-0.0), self.0) })
    }

    #[inline(always)]
    pub(crate) fn within(self, limit: Self) -> Mask {
        Mask(unsafe { _mm_cmple_pd(self.0, limit.0) })
    }

    #[inline(always)]
    pub(crate) fn where_all(self, mask: Mask) -> Self {
        unsafe {
            let both = _mm_and_pd(mask.0, _mm_shuffle_pd::<1>(mask.0, mask.0));
            Self(_mm_and_pd(self.0, both))
        }
    }

    #[inline(always)]
    pub(crate) fn differs(self, other: Self) -> Mask {
        Mask(made(unsafe { _mm_cmpneq_pd(self.0, other.0) }))
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, clippy::cast_possible_truncation, reason = "two integers below 2^31")]
    pub(crate) fn truncate(self) -> [usize; 2] {
        let both = unsafe { _mm_cvtsi128_si64(_mm_cvttpd_epi32(self.0)) } as u64;
        [both as u32 as usize, (both >> 32) as usize]
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, clippy::cast_possible_truncation, reason = "two integers below 2^31")]
    pub(crate) fn integer_parts(self) -> ([u32; 2], Self) {
        unsafe {
            let parts = _mm_cvttpd_epi32(self.0);
            let both = _mm_cvtsi128_si64(parts) as u64;
            ([both as u32, (both >> 32) as u32], Self(_mm_cvtepi32_pd(parts)))
        }
    }

    #[inline(always)]
    pub(crate) fn of_singles(bytes: &[u8; 8]) -> Self {
        // The pointer is that of eight bytes, and the load asks for no alignment.
        Self(unsafe { _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(bytes.as_ptr().cast()))) })
    }

    #[inline(always)]
    pub(crate) fn transpose([a, b]: [Self; 2]) -> [Self; 2] {
        unsafe { [Self(_mm_unpacklo_pd(a.0, b.0)), Self(_mm_unpackhi_pd(a.0, b.0))] }
    }
}

/// What comparisons of two `f64` say.
#[derive(Clone, Copy)]
pub(crate) struct Mask(__m128d);

impl Mask {
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        unsafe { _mm_movemask_pd(self.0) }.cast_unsigned()
    }

    #[inline(always)]
    pub(crate) fn bits_of_both(self, next: Self) -> u32 {
        unsafe {
            // Saturation leaves all ones and all zeros as they are.
            let both = _mm_packs_epi32(_mm_castpd_si128(self.0), _mm_castpd_si128(next.0));
            _mm_movemask_ps(_mm_castsi128_ps(both)).cast_unsigned()
        }
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        Self(unsafe { _mm_and_pd(self.0, other.0) })
    }
}

impl Add for Two {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(unsafe { _mm_add_pd(self.0, other.0) })
    }
}

impl Sub for Two {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(unsafe { _mm_sub_pd(self.0, other.0) })
    }
}

impl Mul for Two {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(unsafe { _mm_mul_pd(self.0, other.0) })
    }
}

impl Div for Two {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(unsafe { _mm_div_pd(self.0, other.0) })
    }
}

/// Asks for the cache line that holds a record's first byte.
#[inline(always)]
pub(crate) fn prefetch(record: &[u8; RECORD]) {
    // SAFETY: SSE2 as above; a prefetch reads nothing that the program can see, whatever the pointer.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(record.as_ptr().cast()) }
}

/// A vector's four numbers.
#[inline(always)]
fn numbers(x: __m128) -> [f32; 4] {
    unsafe {
        [
            _mm_cvtss_f32(x),
            _mm_cvtss_f32(_mm_shuffle_ps::<0x55>(x, x)),
            _mm_cvtss_f32(_mm_shuffle_ps::<0xaa>(x, x)),
            _mm_cvtss_f32(_mm_shuffle_ps::<0xff>(x, x)),
        ]
    }
}
