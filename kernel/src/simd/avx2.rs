//! Whether there is AVX2, and lookups compiled for it: what is inlined into them may use its instructions, and vectors
//! of 128 bits get their three-operand forms.

use core::arch::x86_64::*;
use core::mem::{MaybeUninit, offset_of};

use super::{Four, Two, WideQuad};
use crate::axis::{BinBytes, Cells};
use crate::blend::{Cell, Edges, LaneScales};
use crate::channel::{Channels, SLOTS};
use crate::contact::{Contact, Contacts};
use crate::instructions::{Eight, Instructions};
use crate::pose::{Pose, Side};
use crate::rigid::Coordinates;
use crate::table::ContactTable;

/// That the processor, and the operating system for the vectors' upper halves, has AVX2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// Asks the processor (Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 14.7.1).
    pub(crate) fn found() -> Option<Self> {
        let there = cfg!(target_feature = "avx2") || (!cfg!(miri) && ask());
        there.then_some(Self(()))
    }

    #[inline(always)]
    pub(crate) fn contacts_into(self, table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
        // SAFETY: `self` says that there is AVX2. The same below.
        unsafe { contacts_into(self, table, side, pose, contacts) }
    }

    #[inline(always)]
    pub(crate) fn channels(self, table: &ContactTable<'_>, side: Side, at: &Coordinates) -> Channels {
        unsafe { channels(self, table, side, at) }
    }

    #[inline(always)]
    pub(crate) fn contacts_many(self, table: &ContactTable<'_>, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        unsafe { contacts_many(self, table, wheels, contacts) }
    }
}

impl Instructions for Avx2 {
    type Quad = WideQuad;

    #[inline(always)]
    fn blend<'p>(
        self,
        edges: &Edges<'_>,
        cell: &Cell<WideQuad>,
        scales: &LaneScales,
        place: &'p mut MaybeUninit<Channels>,
    ) -> &'p Channels {
        super::blend_256(self, edges, cell, scales, place)
    }

    #[inline(always)]
    fn cells(self, a: &BinBytes, b: &BinBytes) -> Cells {
        // The pointers are those of sixteen bytes each, and the loads ask for no alignment.
        unsafe {
            let [a, b] = [_mm_loadu_si128(a.as_ptr().cast()), _mm_loadu_si128(b.as_ptr().cast())];
            let numbers = _mm256_cvtps_pd(_mm_castsi128_ps(_mm_unpacklo_epi32(a, b)));
            let offsets = _mm_add_epi32(a, b);
            Cells {
                start: Two(_mm256_castpd256_pd128(numbers)),
                reciprocal: Two(_mm256_extractf128_pd::<1>(numbers)),
                records: _mm_extract_epi32::<2>(offsets).cast_unsigned(),
                rigid: _mm_extract_epi32::<3>(offsets).cast_unsigned(),
            }
        }
    }

    #[inline(always)]
    fn integer_parts(self, numbers: Two, factors: &[u32; 4]) -> (u32, Two) {
        // The pointer is that of sixteen bytes, and the load asks for no alignment.
        unsafe {
            let products =
                _mm_mullo_epi32(_mm_cvttpd_epi32(numbers.0), _mm_loadu_si128(factors.as_ptr().cast::<__m128i>()));
            let sum = _mm_cvtsi128_si32(_mm_hadd_epi32(products, products));
            (sum.cast_unsigned(), Two(_mm_round_pd::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(numbers.0)))
        }
    }

    #[inline(always)]
    fn transposed(self, [[a, b, c, d], [e, f, g, h]]: [[Four; 4]; 2]) -> [impl Eight; SLOTS] {
        // SAFETY: there is AVX2. The same below.
        unsafe {
            let join = |low: Four, high: Four| _mm256_set_m128(high.0, low.0);
            let (a, b, c, d) = (join(a, e), join(b, f), join(c, g), join(d, h));
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            [
                WideEight(_mm256_shuffle_ps::<0b01_00_01_00>(ab, cd)),
                WideEight(_mm256_shuffle_ps::<0b11_10_11_10>(ab, cd)),
                WideEight(_mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high)),
            ]
        }
    }
}

/// Eight `f32`.
struct WideEight(__m256);

impl Eight for WideEight {
    #[inline(always)]
    fn write(self, contact: &mut Contact) {
        const _: () =
            assert!(offset_of!(Contact, semi_axes) == size_of::<[f32; 8]>() && offset_of!(Contact, normal_force) == 0);
        // The contact begins with eight `f32`, all that the store writes; it asks for no alignment.
        unsafe { _mm256_storeu_ps((&raw mut *contact).cast(), self.0) }
    }
}

#[target_feature(enable = "avx2")]
fn channels(avx2: Avx2, table: &ContactTable<'_>, side: Side, at: &Coordinates) -> Channels {
    table.channels_by(avx2, side, at)
}

#[target_feature(enable = "avx2")]
fn contacts_into(avx2: Avx2, table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    table.look_up(avx2, side, pose, contacts);
}

#[target_feature(enable = "avx2")]
fn contacts_many(avx2: Avx2, table: &ContactTable<'_>, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
    table.look_up_many(avx2, wheels, contacts);
}

#[allow(unused_unsafe, reason = "asking is safe from Rust 1.93 on")]
fn ask() -> bool {
    // Leaf 1: ECX bit 27, the operating system has enabled XGETBV; bit 28, AVX. Leaf 7: EBX bit 5, AVX2.
    const SAVED_AND_AVX: u32 = 3 << 27;
    const AVX2: u32 = 1 << 5;
    // XCR0: the system saves the lower (bit 1) and upper (bit 2) halves of the vectors.
    const HALVES: u64 = 3 << 1;
    #[target_feature(enable = "xsave")]
    fn saved() -> u64 {
        unsafe { _xgetbv(0) }
    }
    // SAFETY: every x86-64 processor has CPUID, and XGETBV is called only where it says so.
    unsafe {
        __cpuid(0).eax >= 7
            && __cpuid(1).ecx & SAVED_AND_AVX == SAVED_AND_AVX
            && saved() & HALVES == HALVES
            && __cpuid_count(7, 0).ebx & AVX2 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Bin;
    use crate::instructions::Baseline;
    use crate::layout::Strides;

    #[test]
    fn same_parts_and_cells_as_without() {
        let Some(avx2) = Avx2::found() else { return };
        let numbers = [0.0, 0.5, 0.999_999, 1.0, 3.25, 14.999, 15.0];
        for a in numbers {
            for b in numbers {
                let factors = [70_000, 16, 0, 0];
                let (two, same) = (Two::new([a, b]), |(sum, whole): (u32, Two)| (sum, whole.numbers()));
                let parts = same(avx2.integer_parts(two, &factors));
                assert_eq!(parts, same(Baseline.integer_parts(two, &factors)));
                let (sum, [x, y]) = parts;
                assert_eq!((f64::from(sum), x, y), (70_000.0 * x + 16.0 * y, a.trunc(), b.trunc()));
            }
        }
        let bin = |cell, start| Bin::new(cell, start, 3, Strides { records: 640, rigid: 48 }).to_bytes();
        for (a, b) in [(bin(0, 0), bin(7, 21)), (bin(5, 15), bin(1, 3))] {
            let of = |Cells { start, reciprocal, records, rigid }: Cells| {
                (start.numbers(), reciprocal.numbers(), records, rigid)
            };
            assert_eq!(of(avx2.cells(&a, &b)), of(Baseline.cells(&a, &b)));
        }
    }
}
