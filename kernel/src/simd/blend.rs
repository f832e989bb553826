//! The blend by vectors of 128 or 256 bits. Why its instructions may be called: see the module above.
#![expect(clippy::indexing_slicing, reason = "indices are constants once inlined, and the arrays' sizes are known")]

use core::arch::x86_64::*;
use core::mem::MaybeUninit;
use core::sync::atomic::{Ordering, compiler_fence};

use super::hold::{escape, held, made, settled};
use super::{Avx2, Quad, WideQuad};
use crate::blend::{Cell, Edges, FINE, FINE_BITS, FINE_MASK, FINE_STEP, LaneScales, fractions};
use crate::channel::{BLOCK, Channels, LANES, SLOTS};
use crate::layout::{RECORD, stored_block};

/// Weights of the edges: pairs of `i16` for two neighbouring edges.
struct Weights {
    coarse: __m128i,
    fine: __m128i,
}

impl Weights {
    /// Of the running sums, rounded to the nearest integers, half to even, as `whole` does.
    #[inline(always)]
    fn new([even, odd]: [__m128i; 2]) -> Self {
        unsafe {
            let (low, high) = (_mm_unpacklo_epi32(even, odd), _mm_unpackhi_epi32(even, odd));
            let (coarse, mask) = (|sums| _mm_srai_epi32::<{ FINE_BITS as i32 }>(sums), _mm_set1_epi32(FINE_MASK));
            Self {
                coarse: differences(_mm_packs_epi32(coarse(low), coarse(high))),
                fine: differences(_mm_packs_epi32(_mm_and_si128(low, mask), _mm_and_si128(high, mask))),
            }
        }
    }
}

/// sum - before for eight running sums.
#[inline(always)]
fn differences(sums: __m128i) -> __m128i {
    unsafe { _mm_sub_epi16(sums, _mm_slli_si128::<2>(sums)) }
}

/// Lanes 8 V to 8 V + 8 of an edge's lower (node 0) or upper record.
#[inline(always)]
fn load_128<const V: usize>(edge: &[u8; 2 * RECORD], node: usize) -> __m128i {
    let bytes: &[[u8; 16]; 8] = edge.as_chunks().0.first_chunk().unwrap_or(&[[0; 16]; 8]);
    // The pointer is that of sixteen bytes, and the load asks for no alignment.
    unsafe { _mm_loadu_si128(bytes[4 * node + V].as_ptr().cast()) }
}

/// Lanes 16 V to 16 V + 16 of an edge's lower (node 0) or upper record.
#[inline(always)]
fn load_256<const V: usize>(edge: &[u8; 2 * RECORD], node: usize) -> __m256i {
    let bytes: &[[u8; 32]; 4] = edge.as_chunks().0.first_chunk().unwrap_or(&[[0; 32]; 4]);
    // The pointer is that of thirty-two bytes, and the load asks for no alignment.
    unsafe { _mm256_loadu_si256(bytes[2 * node + V].as_ptr().cast()) }
}

/// Weights as vectors: pairs of `i16` for edges 0 and 1, 2 and 3, 4 and 5, 6 and 7, repeated over the vector.
#[inline(always)]
fn pairs(w: __m128i) -> [__m128i; 4] {
    unsafe {
        [
            _mm_shuffle_epi32::<0x00>(w),
            _mm_shuffle_epi32::<0x55>(w),
            _mm_shuffle_epi32::<0xaa>(w),
            _mm_shuffle_epi32::<0xff>(w),
        ]
    }
}

/// The edges' records, two edges together.
type EdgePairs<'a> = [[&'a [u8; 2 * RECORD]; 2]; 4];

#[inline(always)]
const fn edge_pairs<'a>([a, b, c, d, e, f, g, h]: &Edges<'a>) -> EdgePairs<'a> {
    [[a, b], [c, d], [e, f], [g, h]]
}

/// Four sums at the lower node and the rise to the upper node, as `f32`.
#[inline(always)]
fn base_and_rise([low, high]: [__m128i; 2]) -> [__m128; 2] {
    unsafe { [_mm_cvtepi32_ps(low), _mm_cvtepi32_ps(_mm_sub_epi32(high, low))] }
}

/// [`portable`](crate::blend::portable) with vectors of 128 bits.
#[inline(always)]
pub(crate) fn blend_128<'p>(
    edges: &Edges<'_>,
    cell: &Cell,
    scales: &LaneScales,
    place: &'p mut MaybeUninit<Channels>,
) -> &'p Channels {
    let edges = edge_pairs(edges);
    let weights = Weights::new(cell.sums.map(Quad::rounded));
    let coarse = pairs(weights.coarse);
    // In memory until they are wanted: with them there would be too few registers for the sums.
    let mut fine = weights.fine;
    let fine = &*escape(&mut fine);
    // The fences keep the compiler from interleaving the four, which would spill registers. They cost nothing.
    eight::<2>(&edges, &coarse, fine, cell, scales, place);
    compiler_fence(Ordering::SeqCst);
    eight::<3>(&edges, &coarse, fine, cell, scales, place);
    compiler_fence(Ordering::SeqCst);
    eight::<1>(&edges, &coarse, fine, cell, scales, place);
    compiler_fence(Ordering::SeqCst);
    eight::<0>(&edges, &coarse, fine, cell, scales, place);
    compiler_fence(Ordering::SeqCst);
    // The four have written all of it.
    unsafe { place.assume_init_ref() }
}

/// The two blocks that lie one after the other in a record, from 8 V on.
#[inline(always)]
fn eight<const V: usize>(
    edges: &EdgePairs<'_>,
    coarse: &[__m128i; 4],
    fine: &__m128i,
    cell: &Cell,
    scales: &LaneScales,
    place: &mut MaybeUninit<Channels>,
) {
    unsafe {
        let blocks = [stored_block(2 * V), stored_block(2 * V + 1)];
        let fine = pairs(*fine);
        // [block][lower or upper node]
        let mut sums = [[_mm_setzero_si128(); 2]; 2];
        let mut fine_sums = sums;
        for node in 0..2 {
            for ((pair, coarse), fine) in edges.iter().zip(coarse).zip(&fine) {
                let [a, b] = pair.map(|edge| load_128::<V>(edge, node));
                for (half, q) in [_mm_unpacklo_epi16(a, b), _mm_unpackhi_epi16(a, b)].into_iter().enumerate() {
                    let (sum, fine_sum) = (&mut sums[half][node], &mut fine_sums[half][node]);
                    *sum = _mm_add_epi32(*sum, _mm_madd_epi16(q, *coarse));
                    if FINE[blocks[half]] {
                        *fine_sum = _mm_add_epi32(*fine_sum, _mm_madd_epi16(q, *fine));
                    }
                }
            }
        }
        let place: *mut f32 = place.as_mut_ptr().cast();
        for (block, sums, fine_sums) in [(blocks[0], sums[0], fine_sums[0]), (blocks[1], sums[1], fine_sums[1])] {
            let [mut base, mut rise] = base_and_rise(sums);
            if FINE[block] {
                let [base_fine, rise_fine] = base_and_rise(fine_sums);
                base = _mm_add_ps(base, _mm_mul_ps(base_fine, _mm_set1_ps(FINE_STEP)));
                rise = _mm_add_ps(rise, _mm_mul_ps(rise_fine, _mm_set1_ps(FINE_STEP)));
            }
            let q = _mm_add_ps(base, _mm_mul_ps(four(fractions(cell, block)), rise));
            let of = |numbers: &[f32; LANES]| four(numbers.as_chunks().0.get(block).copied().unwrap_or_default());
            let values = _mm_add_ps(of(&scales.offsets), _mm_mul_ps(of(&scales.steps), q));
            // A block of the lanes, which are aligned.
            _mm_store_ps(place.add(BLOCK * block), values);
        }
    }
}

/// Four numbers as a vector.
#[inline(always)]
fn four([a, b, c, d]: [f32; 4]) -> __m128 {
    unsafe { _mm_set_ps(d, c, b, a) }
}

/// [`portable`](crate::blend::portable) with vectors of 256 bits.
#[inline(always)]
pub(crate) fn blend_256<'p>(
    _: Avx2,
    edges: &Edges<'_>,
    cell: &Cell<WideQuad>,
    scales: &LaneScales,
    place: &'p mut MaybeUninit<Channels>,
) -> &'p Channels {
    unsafe {
        let edges = edge_pairs(edges);
        // In memory until they are wanted, as with 128 bits: where the last two lanes will be.
        let t: *mut f32 = place.as_mut_ptr().cast::<f32>().add(LANES - 2);
        (*t, *t.add(1)) = (cell.fraction, cell.unclamped);
        let [coarse, fine] = wide_pairs(cell.sums.map(WideQuad::rounded));
        let ([mut first, second], fine) = sixteen::<0>(&edges, &coarse, &fine);
        let step = _mm256_set1_ps(FINE_STEP);
        let clamped = _mm256_broadcast_ss(&*t);
        let unclamped = _mm256_blend_ps::<UNCLAMPED>(clamped, _mm256_broadcast_ss(&*t.add(1)));
        first.base = _mm256_add_ps(first.base, _mm256_mul_ps(fine.base, step));
        first.rise = _mm256_add_ps(first.rise, _mm256_mul_ps(fine.rise, step));
        first.store::<0>(unclamped, scales, place);
        second.store::<1>(clamped, scales, place);
        compiler_fence(Ordering::SeqCst);
        let ([third, fourth], _) = sixteen::<1>(&edges, &coarse, &[_mm256_setzero_si256(); 4]);
        third.store::<2>(clamped, scales, place);
        fourth.store::<3>(clamped, scales, place);
        // The four have written all of it.
        place.assume_init_ref()
    }
}

/// The lanes of the first eight whose vertical fraction is not clamped: the indentations.
const UNCLAMPED: i32 = (1 << SLOTS) - 1;
const _: () = assert!(FINE[0] && FINE[1] && !FINE[2] && !FINE[3]);

/// Coarse and fine weights of the edges as [`pairs`] for vectors of 256 bits.
#[inline(always)]
fn wide_pairs([even, odd]: [__m128i; 2]) -> [[__m256i; 4]; 2] {
    const COARSE: i32 = FINE_BITS as i32;
    unsafe {
        // Coarse sums in the lower half, fine ones in the upper. The low halves of numbers take turns, so no packing is
        // needed: a weight has no need of what is above its 16 bits.
        let [even, odd] = [_mm256_broadcastsi128_si256(even), _mm256_broadcastsi128_si256(odd)];
        let even = _mm256_srlv_epi32(even, _mm256_setr_epi32(COARSE, COARSE, COARSE, COARSE, 0, 0, 0, 0));
        let odd = _mm256_sllv_epi32(
            odd,
            _mm256_setr_epi32(16 - COARSE, 16 - COARSE, 16 - COARSE, 16 - COARSE, 16, 16, 16, 16),
        );
        let mask = FINE_MASK | FINE_MASK << 16;
        let sums = _mm256_and_si256(
            _mm256_blend_epi16::<0b1010_1010>(even, odd),
            _mm256_setr_epi32(-1, -1, -1, -1, mask, mask, mask, mask),
        );
        // sum - before, as in `differences`.
        let both = _mm256_sub_epi16(sums, _mm256_bslli_epi128::<2>(sums));
        // The lower half by itself, which to repeat is quick; a shuffle of the whole vector is not.
        let low = made(_mm256_castpd256_pd128(_mm256_castsi256_pd(both)));
        let coarse = _mm256_broadcastsi128_si256(_mm_castpd_si128(low));
        let fine = _mm256_permute4x64_epi64::<0b11_10_11_10>(both);
        [wide_spread(held(coarse)), wide_spread(held(fine))]
    }
}

/// [`pairs`] of both halves.
#[inline(always)]
fn wide_spread(w: __m256i) -> [__m256i; 4] {
    unsafe {
        [
            _mm256_shuffle_epi32::<0x00>(w),
            _mm256_shuffle_epi32::<0x55>(w),
            _mm256_shuffle_epi32::<0xaa>(w),
            _mm256_shuffle_epi32::<0xff>(w),
        ]
    }
}

/// Eight lanes at the lower node, and their rise to the upper one.
struct Eight {
    base: __m256,
    rise: __m256,
}

impl Eight {
    #[inline(always)]
    fn new([low, high]: [__m256i; 2]) -> Self {
        unsafe { Self { base: _mm256_cvtepi32_ps(low), rise: _mm256_cvtepi32_ps(_mm256_sub_epi32(high, low)) } }
    }

    /// Lanes 8 E to 8 E + 8 in their units: offset + step (base + t rise).
    #[inline(always)]
    fn store<const E: usize>(&self, t: __m256, scales: &LaneScales, place: &mut MaybeUninit<Channels>) {
        let of = |numbers: &[f32; LANES]| numbers.as_chunks().0.get(E).copied().unwrap_or([0.0; 2 * BLOCK]);
        let (offsets, steps) = (of(&scales.offsets), of(&scales.steps));
        // The pointers are those of eight `f32` each, and neither loads nor store ask for alignment.
        unsafe {
            let (offsets, steps) = (_mm256_loadu_ps(offsets.as_ptr()), _mm256_loadu_ps(steps.as_ptr()));
            let q = _mm256_add_ps(self.base, _mm256_mul_ps(t, self.rise));
            let place: *mut f32 = place.as_mut_ptr().cast();
            _mm256_storeu_ps(place.add(2 * BLOCK * E), _mm256_add_ps(offsets, _mm256_mul_ps(steps, q)));
        }
    }
}

/// Lanes 16 V to 16 V + 16. Unpacking works within halves of the vector: of the four blocks in a record it gives the first
/// and the third, which are the first two of the channels' order, then the other two. The first eight, where V is 0, by the
/// fine weights too.
#[inline(always)]
fn sixteen<const V: usize>(edges: &EdgePairs<'_>, coarse: &[__m256i; 4], fine: &[__m256i; 4]) -> ([Eight; 2], Eight) {
    unsafe {
        // At the lower node and at the upper one.
        let zero = [_mm256_setzero_si256(); 2];
        let (mut first, mut second, mut first_fine) = (zero, zero, zero);
        for node in 0..2 {
            for (([a, b], coarse), fine) in edges.iter().zip(coarse).zip(fine) {
                let a = load_256::<V>(a, node);
                let low = _mm256_unpacklo_epi16(a, load_256::<V>(b, node));
                first[node] = _mm256_add_epi32(first[node], _mm256_madd_epi16(low, *coarse));
                if V == 0 {
                    first_fine[node] = settled(_mm256_add_epi32(first_fine[node], _mm256_madd_epi16(low, *fine)));
                }
                // Then read b again: from memory, unpacking is one instruction.
                first[node] = settled(first[node]);
                let high = _mm256_unpackhi_epi16(a, load_256::<V>(b, node));
                second[node] = settled(_mm256_add_epi32(second[node], _mm256_madd_epi16(high, *coarse)));
            }
        }
        ([Eight::new(first), Eight::new(second)], Eight::new(first_fine))
    }
}
