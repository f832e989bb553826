//! What a 32-bit ARM core with the M profile's DSP extension and an FPU does in fewer instructions, with the same bits:
//! the blend by multiply-accumulate of 16-bit halves, and the square root.
//!
//! A record is read by words of two lanes. SMLABB and SMLATB multiply the lower or the upper half of a word by a weight
//! and add it to a sum, where loading a lane and multiplying it take two instructions; the compiler knows them by the
//! shape of the expression. SMLAD takes two products at once, of neighbouring halves: those would have to be lanes of
//! two records, and putting them side by side costs the instructions it saves.
#![expect(clippy::indexing_slicing, reason = "indices are constants once inlined, and the arrays' sizes are known")]

use core::sync::atomic::{Ordering, compiler_fence};

use crate::blend::{BLOCK, Cell, Edges, FINE, FINE_STEP, LaneScales, Lanes, edges, float, fractions, weights};
use crate::channel::LANES;
use crate::layout::RECORD;

/// Lanes in a word.
const HALVES: usize = 2;
/// Words of a block of four lanes, which is summed at once: its eight sums, two words, an edge and its weight fit the
/// core's registers.
const WORDS: usize = BLOCK / HALVES;

/// [`portable`](crate::blend::portable) by words.
#[inline(always)]
pub(crate) fn blend(records: &[[u8; RECORD]], cell: &Cell, scales: &LaneScales, lanes: &mut Lanes) {
    let edges = edges(records, cell);
    let weights = weights(cell);
    let (coarse, fine) = (weights.map(|w| i32::from(w.coarse)), weights.map(|w| i32::from(w.fine)));
    if let [a, b, c, d, e, f, g, h] = lanes.0.as_chunks_mut().0 {
        // One after the other: interleaved by the compiler they would spill registers.
        *a = block::<0>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *b = block::<1>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *c = block::<2>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *d = block::<3>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *e = block::<4>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *f = block::<5>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *g = block::<6>(&edges, [&coarse, &fine], cell, scales);
        compiler_fence(Ordering::SeqCst);
        *h = block::<7>(&edges, [&coarse, &fine], cell, scales);
    }
}

/// Lanes 4 B to 4 B + 4.
#[inline(always)]
fn block<const B: usize>(
    edges: &Edges<'_>,
    [coarse, fine]: [&[i32; 8]; 2],
    cell: &Cell,
    scales: &LaneScales,
) -> [f32; BLOCK] {
    let [mut base, mut rise] = base_and_rise(sums::<B>(edges, coarse));
    if FINE[B] {
        let [base_fine, rise_fine] = base_and_rise(sums::<B>(edges, fine));
        for i in 0..BLOCK {
            base[i] += base_fine[i] * FINE_STEP;
            rise[i] += rise_fine[i] * FINE_STEP;
        }
    }
    let t = fractions(cell, B);
    let of = |numbers: &[f32; LANES], i| numbers[B * BLOCK + i];
    core::array::from_fn(|i| of(&scales.offsets, i) + of(&scales.steps, i) * (base[i] + t[i] * rise[i]))
}

/// Sums of a block's lanes over the edges, at their lower and upper nodes.
#[inline(always)]
fn sums<const B: usize>(edges: &Edges<'_>, weights: &[i32; 8]) -> [[i32; BLOCK]; 2] {
    let mut sums = [[0; BLOCK]; 2];
    for (nodes, weight) in edges.iter().zip(weights) {
        for (record, sums) in nodes.iter().zip(&mut sums) {
            for (word, sums) in sums.as_chunks_mut::<HALVES>().0.iter_mut().enumerate() {
                let [low, high] = halves(record, B * WORDS + word);
                let [first, second] = sums;
                *first += low * weight;
                *second += high * weight;
            }
        }
    }
    sums
}

/// The two lanes of a word.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is what is wanted")]
fn halves(record: &[u8; RECORD], word: usize) -> [i32; HALVES] {
    let word = i32::from_le_bytes(record.as_chunks().0.get(word).copied().unwrap_or_default());
    [i32::from(word as i16), word >> 16]
}

/// Values at the lower node and rises to the upper one.
#[inline(always)]
fn base_and_rise([low, high]: [[i32; BLOCK]; 2]) -> [[f32; BLOCK]; 2] {
    let mut rise = high;
    rise.iter_mut().zip(low).for_each(|(high, low)| *high -= low);
    [low.map(float), rise.map(float)]
}

/// Square root of a number that is not negative, correctly rounded as libm's is. Without the standard library Rust has no
/// stable name for the instruction.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    let root: u32;
    // SAFETY: the ABI passes floats in the FPU's registers, so there is one, and each has this instruction. It changes
    // core registers alone: s0 is put back. Operands in the FPU's registers are known for those with double precision only.
    unsafe {
        core::arch::asm!(
            "vmov {kept}, s0",
            "vmov s0, {root}",
            "vsqrt.f32 s0, s0",
            "vmov {root}, s0",
            "vmov s0, {kept}",
            root = inout(reg) x.to_bits() => root,
            kept = out(reg) _,
            options(pure, nomem, nostack),
        );
    }
    f32::from_bits(root)
}
