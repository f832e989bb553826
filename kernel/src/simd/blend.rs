//! The blend by vectors of 128 or 256 bits. Why its instructions may be called: see the module above.
#![expect(clippy::indexing_slicing, reason = "indices are constants once inlined, and the arrays' sizes are known")]

use core::arch::x86_64::*;
use core::sync::atomic::{Ordering, compiler_fence};

use super::{Quad, numbers};
use crate::blend::{BLOCK, Cell, FINE, FINE_BITS, FINE_MASK, FINE_STEP, LaneScales, Lanes, edges, fractions};
use crate::channel::LANES;
use crate::layout::RECORD;

#[cfg(not(target_feature = "avx2"))]
pub(crate) use blend_128 as widest;
#[cfg(target_feature = "avx2")]
pub(crate) use blend_256 as widest;

/// Weights of the edges: pairs of `i16` for two neighbouring edges.
struct Weights {
    coarse: __m128i,
    fine: __m128i,
}

impl Weights {
    #[inline(always)]
    fn new(cell: &Cell) -> Self {
        unsafe {
            // Rounded to the nearest integer, half to even, as `whole` does.
            let [even, odd] = cell.sums.map(Quad::rounded);
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

/// Sixteen bytes of an edge's lower (node 0) or upper record: lanes 8 V to 8 V + 8.
#[cfg(any(test, not(target_feature = "avx2")))]
#[inline(always)]
fn load_128<const V: usize>(edge: &[u8; 2 * RECORD], node: usize) -> __m128i {
    let bytes: &[[u8; 16]; 8] = edge.as_chunks().0.first_chunk().unwrap_or(&[[0; 16]; 8]);
    // The pointer is that of sixteen bytes, and the load asks for no alignment.
    unsafe { _mm_loadu_si128(bytes[4 * node + V].as_ptr().cast()) }
}

/// Thirty-two bytes of an edge's lower (node 0) or upper record: lanes 16 V to 16 V + 16.
#[cfg(target_feature = "avx2")]
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
fn edge_pairs<'a>(records: &'a [[u8; RECORD]], cell: &Cell) -> Option<EdgePairs<'a>> {
    let [a, b, c, d, e, f, g, h] = edges(records, cell)?;
    Some([[a, b], [c, d], [e, f], [g, h]])
}

/// Four sums at the lower node and the rise to the upper node, as `f32`.
#[cfg(any(test, not(target_feature = "avx2")))]
#[inline(always)]
fn base_and_rise([low, high]: [__m128i; 2]) -> [__m128; 2] {
    unsafe { [_mm_cvtepi32_ps(low), _mm_cvtepi32_ps(_mm_sub_epi32(high, low))] }
}

/// [`portable`](crate::blend::portable) with vectors of 128 bits.
#[cfg(any(test, not(target_feature = "avx2")))]
#[inline(always)]
pub(crate) fn blend_128(records: &[[u8; RECORD]], cell: &Cell, scales: &LaneScales) -> Option<Lanes> {
    let edges = edge_pairs(records, cell)?;
    let weights = Weights::new(cell);
    let weights = (pairs(weights.coarse), pairs(weights.fine));
    let mut lanes = Lanes::ZERO;
    if let [a, b, c, d, e, f, g, h] = lanes.0.as_chunks_mut().0 {
        // The fences keep the compiler from interleaving the four, which would spill registers. They cost nothing.
        [*a, *b] = eight::<0>(&edges, &weights, cell, scales);
        compiler_fence(Ordering::SeqCst);
        [*c, *d] = eight::<1>(&edges, &weights, cell, scales);
        compiler_fence(Ordering::SeqCst);
        [*e, *f] = eight::<2>(&edges, &weights, cell, scales);
        compiler_fence(Ordering::SeqCst);
        [*g, *h] = eight::<3>(&edges, &weights, cell, scales);
    }
    Some(lanes)
}

/// Lanes 8 V to 8 V + 8.
#[cfg(any(test, not(target_feature = "avx2")))]
#[inline(always)]
fn eight<const V: usize>(
    edges: &EdgePairs<'_>,
    (coarse, fine): &([__m128i; 4], [__m128i; 4]),
    cell: &Cell,
    scales: &LaneScales,
) -> [[f32; BLOCK]; 2] {
    unsafe {
        // [lanes 0 to 4 or 4 to 8][lower or upper node]
        let mut sums = [[_mm_setzero_si128(); 2]; 2];
        let mut fine_sums = sums;
        for ((pair, coarse), fine) in edges.iter().zip(coarse).zip(fine) {
            for node in 0..2 {
                let [a, b] = pair.map(|edge| load_128::<V>(edge, node));
                for (half, q) in [_mm_unpacklo_epi16(a, b), _mm_unpackhi_epi16(a, b)].into_iter().enumerate() {
                    let (sum, fine_sum) = (&mut sums[half][node], &mut fine_sums[half][node]);
                    *sum = _mm_add_epi32(*sum, _mm_madd_epi16(q, *coarse));
                    if FINE[2 * V + half] {
                        *fine_sum = _mm_add_epi32(*fine_sum, _mm_madd_epi16(q, *fine));
                    }
                }
            }
        }
        let value = |half: usize| {
            let block = 2 * V + half;
            let [mut base, mut rise] = base_and_rise(sums[half]);
            if FINE[block] {
                let [base_fine, rise_fine] = base_and_rise(fine_sums[half]);
                base = _mm_add_ps(base, _mm_mul_ps(base_fine, _mm_set1_ps(FINE_STEP)));
                rise = _mm_add_ps(rise, _mm_mul_ps(rise_fine, _mm_set1_ps(FINE_STEP)));
            }
            let q = _mm_add_ps(base, _mm_mul_ps(four(fractions(cell, block)), rise));
            let of = |numbers: &[f32; LANES]| four(numbers.as_chunks().0.get(block).copied().unwrap_or_default());
            numbers(_mm_add_ps(of(&scales.offsets), _mm_mul_ps(of(&scales.steps), q)))
        };
        [value(0), value(1)]
    }
}

/// Four numbers as a vector.
#[inline(always)]
fn four([a, b, c, d]: [f32; 4]) -> __m128 {
    unsafe { _mm_set_ps(d, c, b, a) }
}

/// [`portable`](crate::blend::portable) with vectors of 256 bits.
#[cfg(target_feature = "avx2")]
#[inline(always)]
pub(crate) fn blend_256(records: &[[u8; RECORD]], cell: &Cell, scales: &LaneScales) -> Option<Lanes> {
    unsafe {
        let edges = edge_pairs(records, cell)?;
        let weights = Weights::new(cell);
        let wide = |w: __m128i| pairs(w).map(|pair| _mm256_broadcastsi128_si256(pair));
        let weights = (wide(weights.coarse), wide(weights.fine));
        let mut lanes = Lanes::ZERO;
        if let [low, high] = lanes.0.as_chunks_mut().0 {
            *low = sixteen::<0>(&edges, &weights, cell, scales);
            compiler_fence(Ordering::SeqCst);
            *high = sixteen::<1>(&edges, &weights, cell, scales);
        }
        Some(lanes)
    }
}

/// Lanes 16 V to 16 V + 16. Unpacking works within halves of the vector: what is `half` 0 here is blocks 0 and 2 of
/// the four, `half` 1 blocks 1 and 3.
#[cfg(target_feature = "avx2")]
#[inline(always)]
fn sixteen<const V: usize>(
    edges: &EdgePairs<'_>,
    (coarse, fine): &([__m256i; 4], [__m256i; 4]),
    cell: &Cell,
    scales: &LaneScales,
) -> [f32; 4 * BLOCK] {
    unsafe {
        let mut sums = [[_mm256_setzero_si256(); 2]; 2];
        let mut fine_sums = sums;
        let is_fine = |half: usize| [FINE[4 * V + half], FINE[4 * V + half + 2]];
        for ((pair, coarse), fine) in edges.iter().zip(coarse).zip(fine) {
            for node in 0..2 {
                let [a, b] = pair.map(|edge| load_256::<V>(edge, node));
                for (half, q) in [_mm256_unpacklo_epi16(a, b), _mm256_unpackhi_epi16(a, b)].into_iter().enumerate() {
                    let (sum, fine_sum) = (&mut sums[half][node], &mut fine_sums[half][node]);
                    *sum = _mm256_add_epi32(*sum, _mm256_madd_epi16(q, *coarse));
                    if is_fine(half) != [false; 2] {
                        *fine_sum = _mm256_add_epi32(*fine_sum, _mm256_madd_epi16(q, *fine));
                    }
                }
            }
        }
        let base_and_rise =
            |[low, high]: [__m256i; 2]| [_mm256_cvtepi32_ps(low), _mm256_cvtepi32_ps(_mm256_sub_epi32(high, low))];
        let blended = |half: usize| {
            let [mut base, mut rise] = base_and_rise(sums[half]);
            if is_fine(half) != [false; 2] {
                // Zero, and so nothing added, in a block that has no fine weights.
                let [low, high] = is_fine(half);
                let step = [if low { FINE_STEP } else { 0.0 }, if high { FINE_STEP } else { 0.0 }];
                let step = _mm256_set_m128(_mm_set1_ps(step[1]), _mm_set1_ps(step[0]));
                let [base_fine, rise_fine] = base_and_rise(fine_sums[half]);
                base = _mm256_add_ps(base, _mm256_mul_ps(base_fine, step));
                rise = _mm256_add_ps(rise, _mm256_mul_ps(rise_fine, step));
            }
            let t = [four(fractions(cell, 4 * V + half)), four(fractions(cell, 4 * V + half + 2))];
            _mm256_add_ps(base, _mm256_mul_ps(_mm256_set_m128(t[1], t[0]), rise))
        };
        let (even, odd) = (blended(0), blended(1));
        let in_order = [_mm256_permute2f128_ps::<0x20>(even, odd), _mm256_permute2f128_ps::<0x31>(even, odd)];
        let mut values = [0.0; 4 * BLOCK];
        for (index, (q, out)) in in_order.into_iter().zip(values.as_chunks_mut().0).enumerate() {
            let of = |numbers: &[f32; LANES]| {
                let [a, b, c, d, e, f, g, h] = numbers.as_chunks().0.get(2 * V + index).copied().unwrap_or_default();
                _mm256_set_ps(h, g, f, e, d, c, b, a)
            };
            let value = _mm256_add_ps(of(&scales.offsets), _mm256_mul_ps(of(&scales.steps), q));
            let [a, b, c, d] = numbers(_mm256_castps256_ps128(value));
            let [e, f, g, h] = numbers(_mm256_extractf128_ps::<1>(value));
            *out = [a, b, c, d, e, f, g, h];
        }
        values
    }
}
