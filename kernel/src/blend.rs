//! Multilinear blend of the sixteen records around a place in the table, in integers.
//!
//! Sums of integers are exact, so their order does not matter: the portable path below and the vector instructions of
//! [`simd`](crate::simd) and [`arm`](crate::arm) give the same bits. What is left for `f32` is the vertical fraction and
//! the scale, the same few operations a lane in the same order everywhere.
//!
//! The eight edges' weights are the differences of a running sum S that ends at -2²⁷, so their sum is exact however they
//! round. The *coarse* weights, which every lane is blended with, are those of floor(S / 2¹²); the *fine* ones, of the 12
//! bits below, are added for the lanes that make the force ([`FINE`]): a step of 2⁻¹⁵ of the distance between two nodes
//! would show in the slope of the force over 10 nm, and implicit integrators take such slopes. Weights are negative,
//! because -32768 fits an `i16` and 32768 does not.
//!
//! Measured against the same blend in `f64` over random records and weights (a test sweeps it), in quantisation steps:
//! lanes with fine weights at most 0.0078, rms 0.0008; all others at most 6.9, rms 0.72, if neighbours differ by the
//! whole range of `i16`, and in proportion less if they differ less. (It cannot be 14: each of the seven inner sums is less
//! than a coarse weight's step off, and moves a lane by that much of the difference of two neighbours, two steps.)

use core::mem::MaybeUninit;

use crate::axis::Places;
use crate::channel::{BLOCK, Channel, Channels, LANES, SLOTS, Scales, Slot};
use crate::corners::eight;
use crate::instructions::{Instructions, Quads};
use crate::layout::{RECORD, stored};
use crate::math::{Quad, Two, single};

/// Bits of the fine weights.
pub(crate) const FINE_BITS: u32 = 12;
/// Sum of all weights, -2²⁷.
pub(crate) const ONE: f64 = -134_217_728.0;
/// One step of the fine weights in steps of the coarse ones, 2⁻¹².
pub(crate) const FINE_STEP: f32 = 1.0 / 4096.0;
/// One step of a record in steps of a blended lane, -2⁻¹⁵, negative as the weights are.
const STEP: f32 = -1.0 / 32_768.0;

/// Blocks of four lanes that are blended with fine weights: those with a slot's indentation and its C.
pub(crate) const FINE: [bool; LANES / BLOCK] = [true, true, false, false, false, false, false, false];

#[expect(clippy::indexing_slicing, reason = "evaluated by the compiler")]
const _: () = {
    let mut slot = 0;
    while slot < Slot::ALL.len() {
        // Indentations are the first lanes; see `fractions`.
        assert!(Channel::Indentation.lane(Slot::ALL[slot]) == slot);
        assert!(FINE[Channel::Indentation.lane(Slot::ALL[slot]) / BLOCK]);
        assert!(FINE[Channel::Stiffness.lane(Slot::ALL[slot]) / BLOCK]);
        slot += 1;
    }
};

/// Scales of the lanes: value = offset + step * blended lane, the step divided by what the weights sum to.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(crate) struct LaneScales {
    pub(crate) offsets: [f32; LANES],
    pub(crate) steps: [f32; LANES],
}

impl LaneScales {
    /// Lanes without a scale keep their integers.
    pub(crate) const NONE: Self = Self { offsets: [0.0; LANES], steps: [STEP; LANES] };

    /// Scales of a record's integers, the other lanes left as they are.
    pub(crate) fn fill(&mut self, scales: &Scales) {
        for (slot, scales) in Slot::ALL.into_iter().zip(scales) {
            for (channel, scale) in Channel::ALL.into_iter().zip(scales) {
                let lane = channel.lane(slot);
                if let (Some(offset), Some(step)) = (self.offsets.get_mut(lane), self.steps.get_mut(lane)) {
                    (*offset, *step) = (scale.offset, scale.step * STEP);
                }
            }
        }
    }

    /// Has contact angles multiplied by a side's sign.
    pub(crate) fn turn_angles(&mut self, sign: f32) {
        for lane in Slot::ALL.map(|slot| Channel::Angle.lane(slot)) {
            for scale in [self.offsets.get_mut(lane), self.steps.get_mut(lane)].into_iter().flatten() {
                *scale *= sign;
            }
        }
    }
}

/// The cell of the records' grid that a coordinate lies in.
#[derive(Clone, Copy)]
pub(crate) struct Cell<Q = Quad> {
    /// Where the cell's first record begins, bytes.
    base: u32,
    /// Bytes from one node to the next along lateral, yaw and roll offset.
    strides: [u32; 3],
    /// Running sum of the edges' weights, after edges 0, 2, 4, 6 and after edges 1, 3, 5, 7; the last one is -2²⁷.
    pub(crate) sums: [Q; 2],
    /// Position between the vertical nodes, 0 to 1.
    pub(crate) fraction: f32,
    /// The same outside the axis, not clamped.
    pub(crate) unclamped: f32,
}

impl<Q> Cell<Q> {
    /// The cell at these places (lateral and yaw, roll offset and vertical) of a grid with these strides (bytes); vertical
    /// varies fastest.
    #[inline(always)]
    pub(crate) fn new<I>(with: I, plane: &Places, section: &Places, strides: [u32; 3]) -> Self
    where
        I: Instructions<Quad = Q>,
        Q: Quads<I>,
    {
        let ([roll_fraction, fraction], [_, unclamped]) = (section.fraction.numbers(), section.unclamped().numbers());
        Self {
            base: plane.records + section.records,
            strides,
            sums: Q::running_sums(with, plane.fraction, roll_fraction),
            fraction: single(fraction),
            unclamped: single(unclamped),
        }
    }
}

/// Running sums of the weights (u or 1 - u)(p or 1 - p)(r or 1 - r) with r fastest, times -2²⁷, from that of upr on: by
/// splitting the whole in two along u, each half along p, each quarter along r.
///
/// ```text
/// half     = u
/// quarters = 0 + (half - 0) p,  half + (1 - half) p
/// eighths  = 0 + (quarter - 0) r,  quarter + (half - quarter) r  and so on
/// ```
///
/// Answers the eighths, and where each ends: at the next quarter.
#[inline(always)]
pub(crate) fn running_sums(plane: Two, roll: f64) -> [Quad; 2] {
    let [u, p] = plane.numbers();
    let half = ONE * u;
    let (begin, end) = (Two::new([0.0, half]), Two::new([half, ONE]));
    let quarters = begin + (end - begin) * Two::all(p);
    let join = |of| Quad::join(Two::transpose(of));
    let (begin, end) = (join([begin, quarters]), join([quarters, end]));
    [begin + (end - begin) * Quad::all(roll), end]
}

/// The two records of each of a cell's vertical edges, the lower one first.
pub(crate) type Edges<'a> = [&'a [u8; 2 * RECORD]; 8];

/// The records of a cell from its last edge to its first, roll offset fastest, then yaw, then lateral; every cell of a
/// checked table has them.
#[inline(always)]
pub(crate) fn edges<'a, Q>(records: &'a [u8], cell: &Cell<Q>) -> Option<Edges<'a>> {
    let [a, b, c, d, e, f, g, h] = eight(records, cell.base, cell.strides)?;
    Some([h, g, f, e, d, c, b, a])
}

/// Fractions between the vertical nodes by lane of a block: not clamped for a slot's indentation.
#[inline(always)]
pub(crate) fn fractions(cell: &Cell, block: usize) -> [f32; BLOCK] {
    let of = |i: usize| {
        let lane = block * BLOCK + i;
        if lane < SLOTS { cell.unclamped } else { cell.fraction }
    };
    [of(0), of(1), of(2), of(3)]
}

/// Blended lanes:
///
/// ```text
/// W_k   = S_k - S_(k-1)                     coarse and fine part
/// lower = Σ W_k q_k    over the eight edges, at their lower node; upper likewise
/// q     = lower + t (upper - lower)
/// value = offset + step q
/// ```
///
/// with t not clamped for the indentations, clamped for everything else.
#[cfg_attr(
    all(
        any(target_arch = "arm", all(target_arch = "x86_64", target_feature = "sse2")),
        not(feature = "portable"),
        not(test)
    ),
    expect(dead_code, reason = "see simd and arm")
)]
#[inline(always)]
pub(crate) fn portable<'p>(
    edges: &Edges<'_>,
    cell: &Cell,
    scales: &LaneScales,
    place: &'p mut MaybeUninit<Channels>,
) -> &'p Channels {
    let weights = weights(cell);
    let lanes = place.write(Channels::ZERO);
    for (block, out) in lanes.0.as_chunks_mut::<BLOCK>().0.iter_mut().enumerate() {
        let fine = FINE.get(block).copied().unwrap_or_default();
        let t = fractions(cell, block);
        for (i, (value, t)) in out.iter_mut().zip(t).enumerate() {
            let lane = block * BLOCK + i;
            let scale = |numbers: &[f32; LANES]| numbers.get(lane).copied().unwrap_or_default();
            let (low, high) = sums(edges, &weights, lane, |w| w.coarse);
            let (mut base, mut rise) = (float(low), float(high - low));
            if fine {
                let (low, high) = sums(edges, &weights, lane, |w| w.fine);
                base += float(low) * FINE_STEP;
                rise += float(high - low) * FINE_STEP;
            }
            *value = scale(&scales.offsets) + scale(&scales.steps) * (base + t * rise);
        }
    }
    lanes
}

/// Weights of an edge.
#[derive(Clone, Copy)]
pub(crate) struct EdgeWeights {
    pub(crate) coarse: i16,
    pub(crate) fine: i16,
}

/// Weights of a cell's edges.
#[inline(always)]
pub(crate) fn weights(cell: &Cell) -> [EdgeWeights; 8] {
    let mut before = 0;
    let [[[a, c], [e, g]], [[b, d], [f, h]]] = cell.sums.map(|sums| sums.halves().map(Two::numbers));
    [a, b, c, d, e, f, g, h].map(|sum| {
        let sum = whole(sum);
        let weights = EdgeWeights {
            coarse: short((sum >> FINE_BITS) - (before >> FINE_BITS)),
            fine: short((sum & FINE_MASK) - (before & FINE_MASK)),
        };
        before = sum;
        weights
    })
}

/// Sums of a lane over the edges, at their lower and upper nodes.
#[inline(always)]
fn sums(edges: &Edges<'_>, weights: &[EdgeWeights; 8], lane: usize, of: impl Fn(&EdgeWeights) -> i16) -> (i32, i32) {
    edges.iter().zip(weights).fold((0, 0), |(lower, upper), (pair, weights)| {
        let q = |at| i32::from(i16::from_le_bytes(pair.as_chunks().0.get(at).copied().unwrap_or_default()));
        let weight = i32::from(of(weights));
        (lower + weight * q(stored(lane)), upper + weight * q(LANES + stored(lane)))
    })
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "weights lie within i16")]
fn short(weight: i32) -> i16 {
    weight as i16
}

/// A sum as `f32`, rounded.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "rounding is the purpose")]
pub(crate) fn float(sum: i32) -> f32 {
    sum as f32
}

/// Mask of the fine weights' bits.
pub(crate) const FINE_MASK: i32 = (1 << FINE_BITS) - 1;

/// A number within ±2³¹ rounded to the nearest integer, half to even: adding 1.5 · 2⁵² leaves it in the low bits.
#[inline(always)]
fn whole(x: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "the integer is in the low 32 bits")]
    let low = (x + 6_755_399_441_055_744.0).to_bits() as i32;
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instructions::Baseline;
    use std::vec::Vec;

    /// Any numbers: a linear congruential stream.
    struct Stream(u64);

    impl Stream {
        fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 32) as u32
        }

        /// 0 to 1 by all bits of an `f64`: both ends, small ones and such near a half now and then, whose complements round.
        fn fraction(&mut self) -> f64 {
            let [high, low] = [(); 2].map(|()| f64::from(self.next()));
            let any = (high + low / 4_294_967_296.0) / 4_294_967_296.0;
            match self.next() % 16 {
                0 => 0.0,
                1 => 1.0,
                2 => any * libm::exp2(-f64::from(self.next() % 64)),
                3 => 0.5 - any * libm::exp2(-1.0 - f64::from(self.next() % 64)),
                _ => any,
            }
        }
    }

    /// The first cell of a grid of 2 x 2 x 2 x 2 nodes.
    fn first_cell([u, p, r, t]: [f64; 4]) -> Cell {
        cell_of(Baseline, [u, p, r, t])
    }

    fn cell_of<I: Instructions>(with: I, [u, p, r, t]: [f64; 4]) -> Cell<I::Quad> {
        let strides = [8, 4, 2].map(|records| u32::try_from(records * RECORD).unwrap());
        Cell::new(with, &Places::first([u, p]), &Places::first([r, t]), strides)
    }

    /// The corners' product weights and the vertical lines, in `f64`.
    fn exact(records: &[[u8; RECORD]], [u, p, r, t]: [f64; 4], lane: usize) -> f64 {
        let q = |index: usize| f64::from(i16::from_le_bytes(records[index].as_chunks().0[stored(lane)]));
        let weight = |k: usize| {
            let side = |t: f64, bit: usize| if k >> bit & 1 == 1 { t } else { 1.0 - t };
            side(u, 2) * side(p, 1) * side(r, 0)
        };
        (0..8).map(|k| weight(k) * (q(2 * k) + t * (q(2 * k + 1) - q(2 * k)))).sum()
    }

    /// Calls `check` with random records, fractions and the blend in quantisation steps.
    fn sweep(mut check: impl FnMut(&[[u8; RECORD]], [f64; 4], &Channels)) {
        let mut stream = Stream(1);
        let scales = LaneScales::NONE;
        for round in 0..20_000 {
            let records: Vec<[u8; RECORD]> = (0..16)
                .map(|_| {
                    core::array::from_fn(|i| match round % 4 {
                        // The extremes of the integers, and anything.
                        0 => [[255, 127], [0, 128]][stream.next() as usize / 7 % 2][i % 2],
                        _ => stream.next().to_le_bytes()[1],
                    })
                })
                .collect();
            let [u, p, r, t] = core::array::from_fn(|_| stream.fraction());
            let cell = first_cell([u, p, r, t]);
            let mut places = [MaybeUninit::uninit(); 2];
            let [place, other] = &mut places;
            let edges = edges(records.as_flattened(), &cell).unwrap();
            let lanes = portable(&edges, &cell, &scales, place);
            check(&records, [u, p, r, t], lanes);
            let bits = |lanes: &Channels| lanes.0.map(f32::to_bits);
            let same = |other: &Channels| assert_eq!(bits(lanes), bits(other));
            same(crate::arm::blend(&edges, &cell, &scales, other));
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
            {
                same(crate::simd::blend_128(&edges, &cell, &scales, other));
                if let Some(avx2) = crate::simd::Avx2::found() {
                    let cell = cell_of(avx2, [u, p, r, t]);
                    same(avx2.blend(&edges, &cell, &scales, other));
                }
            }
        }
    }

    #[test]
    fn error_against_f64_and_same_bits_in_all_paths() {
        // Largest, sum of squares and count, of coarse and fine lanes.
        let mut errors = [(0.0_f64, 0.0_f64, 0.0_f64); 2];
        sweep(|records, fractions, lanes| {
            for (lane, found) in lanes.0.iter().enumerate() {
                let error = (f64::from(*found) - exact(records, fractions, lane)).abs();
                let (largest, squares, count) = &mut errors[usize::from(FINE[lane / BLOCK])];
                (*largest, *squares, *count) = (largest.max(error), *squares + error * error, *count + 1.0);
            }
        });
        let [coarse, fine] = errors.map(|(largest, squares, count)| (largest, libm::sqrt(squares / count)));
        std::println!("error in steps, largest and rms: coarse {coarse:?}, fine {fine:?}");
        assert!(coarse.0 < COARSE_ERROR && coarse.1 < COARSE_RMS, "{coarse:?}");
        assert!(fine.0 < FINE_ERROR && fine.1 < FINE_RMS, "{fine:?}");
    }

    /// Measured errors in quantisation steps, rounded up; the module's documentation quotes them.
    const COARSE_ERROR: f64 = 6.9;
    const COARSE_RMS: f64 = 0.72;
    const FINE_ERROR: f64 = 0.0078;
    const FINE_RMS: f64 = 0.0008;

    #[test]
    fn equal_corners_blend_to_themselves() {
        let mut stream = Stream(2);
        let scales = LaneScales::NONE;
        for value in [i16::MIN, -1, 0, 1, 12_345, i16::MAX] {
            let mut record = [0; RECORD];
            record.as_chunks_mut().0.fill(value.to_le_bytes());
            for _ in 0..1000 {
                let [u, p, r, t] = core::array::from_fn(|_| stream.fraction());
                let cell = first_cell([u, p, r, t]);
                let mut place = MaybeUninit::uninit();
                let records = [record; 16];
                let edges = edges(records.as_flattened(), &cell).unwrap();
                let lanes = portable(&edges, &cell, &scales, &mut place);
                assert_eq!(lanes.0, [f32::from(value); LANES]);
            }
        }
    }
}
