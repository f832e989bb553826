//! What a 32-bit ARM core with the M profile's DSP extension and an FPU does in fewer instructions, with the same bits:
//! the blend by multiply-accumulate of 16-bit halves, and the square root.
//!
//! A record is read by words of two lanes. SMLABB and SMLATB multiply the lower or the upper half of a word by a weight
//! and add it to a sum, where loading a lane and multiplying it take two instructions; the compiler knows them by the
//! shape of the expression. SMLAD takes two products at once, of neighbouring halves: those would have to be lanes of
//! two records, and putting them side by side costs the instructions it saves.
//!
//! The blend is a loop over eight lanes at a time: unrolled as a whole it would be 3.5 KB larger and no faster.
#![expect(clippy::indexing_slicing, reason = "indices are constants, and the arrays' sizes are known")]

use core::mem::MaybeUninit;
use core::sync::atomic::{Ordering, compiler_fence};

use crate::blend::{Cell, Edges, FINE, FINE_STEP, LaneScales, float, fractions, weights};
use crate::channel::{BLOCK, Channels, LANES};
use crate::layout::{RECORD, stored_block};

/// Lanes in a word.
const HALVES: usize = 2;
/// Blocks in a turn of the loop. A block is summed at once: its eight sums, a word, an edge and its weight fit the core's
/// registers.
const TURN: usize = 2;
/// Bytes from a turn's first block in a record to its second one, and those of both with what lies between.
const APART: usize = 2 * BLOCK * (stored_block(1) - stored_block(0));
const TURN_BYTES: usize = APART + 2 * BLOCK;
/// Words from an edge's lower record to its upper one.
const RECORD_WORDS: usize = RECORD / 4;

const _: () = {
    let mut block = 0;
    while block < FINE.len() {
        assert!(FINE[block] == (block < TURN));
        block += 1;
    }
};

/// [`portable`](crate::blend::portable) by words.
#[inline(always)]
pub(crate) fn blend<'p>(
    edges: &Edges<'_>,
    cell: &Cell,
    scales: &LaneScales,
    place: &'p mut MaybeUninit<Channels>,
) -> &'p Channels {
    // To be written over. Of a number that the compiler does not know to be zero: it would call a routine, which takes
    // several times as long as storing them.
    let lanes = place.write(Channels([core::hint::black_box(0.0); LANES]));
    let weights = weights(cell);
    let weights = [weights.map(|w| i32::from(w.coarse)), weights.map(|w| i32::from(w.fine))];
    let scales = scales.offsets.as_chunks().0.iter().zip(scales.steps.as_chunks().0);
    for (turn, (out, (offsets, steps))) in lanes.0.as_chunks_mut().0.iter_mut().zip(scales).enumerate() {
        let t = if turn == 0 { fractions(cell, 0) } else { fractions(cell, 1) };
        block::<0>(edges, &weights, turn, t, [offsets, steps], out);
        block::<1>(edges, &weights, turn, fractions(cell, 1), [offsets, steps], out);
        // Keeps the compiler from interleaving turns, which would spill registers. It costs nothing.
        compiler_fence(Ordering::SeqCst);
    }
    lanes
}

/// Block B of a turn's: offset + step (base + t rise), see [`portable`](crate::blend::portable).
#[inline(always)]
fn block<const B: usize>(
    edges: &Edges<'_>,
    [coarse, fine]: &[[i32; 8]; 2],
    turn: usize,
    t: [f32; BLOCK],
    [offsets, steps]: [&[f32; BLOCK * TURN]; 2],
    out: &mut [f32; BLOCK * TURN],
) {
    let [mut base, mut rise] = base_and_rise(sums::<B>(edges, coarse, turn));
    // The lanes with fine weights are those of the first turn.
    if turn == 0 {
        let [base_fine, rise_fine] = base_and_rise(sums::<B>(edges, fine, turn));
        base = with_fine(base, base_fine);
        rise = with_fine(rise, rise_fine);
    }
    for (i, (base, rise)) in base.into_iter().zip(rise).enumerate() {
        let lane = B * BLOCK + i;
        out[lane] = offsets[lane] + steps[lane] * (base + t[i] * rise);
    }
}

/// The fine weights' share added.
#[inline(always)]
fn with_fine([a, b, c, d]: [f32; BLOCK], [e, f, g, h]: [f32; BLOCK]) -> [f32; BLOCK] {
    [a + e * FINE_STEP, b + f * FINE_STEP, c + g * FINE_STEP, d + h * FINE_STEP]
}

/// Sums of a block's lanes over the edges, at their lower and upper nodes.
#[inline(always)]
fn sums<const B: usize>(edges: &Edges<'_>, weights: &[i32; 8], turn: usize) -> [[i32; BLOCK]; 2] {
    let mut sums = [[0; BLOCK]; 2];
    for (nodes, weight) in edges.iter().zip(weights) {
        // From the turn's lanes at the lower node to those at the upper one, at fixed distances from one place.
        let span = nodes.get(2 * BLOCK * stored_block(TURN * turn)..).and_then(<[_]>::first_chunk);
        let span: &[u8; RECORD + TURN_BYTES] = span.unwrap_or(&[0; RECORD + TURN_BYTES]);
        for (node, sums) in sums.iter_mut().enumerate() {
            for (word, sums) in sums.as_chunks_mut::<HALVES>().0.iter_mut().enumerate() {
                let [low, high] = halves(span, node * RECORD_WORDS + B * APART / 4 + word);
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
fn halves(bytes: &[u8], word: usize) -> [i32; HALVES] {
    let word = i32::from_le_bytes(bytes.as_chunks().0.get(word).copied().unwrap_or_default());
    [i32::from(word as i16), word >> 16]
}

/// Values at the lower node, and rises to the upper one.
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
