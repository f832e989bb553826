//! Multilinear blend of the sixteen records around a place in the table.
//!
//! Sums run over the corners in a fixed order, one product and one sum a corner and lane, never fused: a version with
//! vector instructions that keeps this order gives the same bits.

use crate::axis::Place;
use crate::channel::{CHANNELS, LANES};
use crate::layout::RECORD;
use crate::math::single;

/// The cell of the records' grid that a coordinate lies in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    /// First records of the cell's eight vertical edges; the upper node's record follows the lower node's.
    pub(crate) edges: [usize; 8],
    /// Weights of the edges.
    pub(crate) weights: [f32; 8],
    /// Position between the vertical nodes, 0 to 1.
    pub(crate) fraction: f32,
    /// The same outside the axis, not clamped.
    pub(crate) unclamped: f32,
}

impl Cell {
    /// The cell at these places of a grid with `counts` nodes (lateral, yaw, roll offset, vertical; vertical varies
    /// fastest).
    #[inline]
    pub(crate) fn new(places: &[Place; 4], counts: [usize; 4]) -> Self {
        let [lateral, yaw, roll, vertical] = places;
        let [_, yaws, rolls, verticals] = counts;
        let (yaw_stride, roll_stride) = (rolls * verticals, verticals);
        let lateral_stride = yaws * yaw_stride;
        let base = lateral.cell * lateral_stride + yaw.cell * yaw_stride + roll.cell * roll_stride + vertical.cell;
        let edge = |i: usize, j: usize, k: usize| base + i * lateral_stride + j * yaw_stride + k * roll_stride;
        let (u, p, r) = (single(lateral.fraction), single(yaw.fraction), single(roll.fraction));
        let (u0, p0, r0) = (1.0 - u, 1.0 - p, 1.0 - r);
        Self {
            edges: [
                edge(0, 0, 0),
                edge(0, 0, 1),
                edge(0, 1, 0),
                edge(0, 1, 1),
                edge(1, 0, 0),
                edge(1, 0, 1),
                edge(1, 1, 0),
                edge(1, 1, 1),
            ],
            weights: [
                u0 * p0 * r0,
                u0 * p0 * r,
                u0 * p * r0,
                u0 * p * r,
                u * p0 * r0,
                u * p0 * r,
                u * p * r0,
                u * p * r,
            ],
            fraction: single(vertical.fraction),
            unclamped: single(vertical.unclamped),
        }
    }
}

const NOTHING: [u8; RECORD] = [0; RECORD];

/// The record at an index; a record of zeros beyond the last, which a checked table never asks for.
#[inline]
pub(crate) fn record(records: &[[u8; RECORD]], index: usize) -> &[u8; RECORD] {
    records.get(index).unwrap_or(&NOTHING)
}

/// Adds weight * record to the sums.
#[inline]
fn add(sums: &mut [f32; LANES], weight: f32, record: &[u8; RECORD]) {
    for (sum, bytes) in sums.iter_mut().zip(record.as_chunks().0) {
        *sum += weight * f32::from(i16::from_le_bytes(*bytes));
    }
}

/// Blended lanes, still in quantisation steps:
///
/// ```text
/// lower = Σ weight_k q_k    over the eight edges, at their lower node; upper likewise
/// q     = lower + t (upper - lower)
/// ```
///
/// with t not clamped for the indentations, clamped for everything else.
#[inline]
pub(crate) fn blend(records: &[[u8; RECORD]], cell: &Cell) -> [f32; LANES] {
    let mut lower = [0.0; LANES];
    let mut upper = [0.0; LANES];
    for (edge, weight) in cell.edges.iter().zip(cell.weights) {
        add(&mut lower, weight, record(records, *edge));
        add(&mut upper, weight, record(records, edge + 1));
    }
    let mut blended = [0.0; LANES];
    for ((q, low), high) in blended.iter_mut().zip(&lower).zip(&upper) {
        *q = low + cell.fraction * (high - low);
    }
    // The first channel of each slot.
    let slots = blended.chunks_exact_mut(CHANNELS).zip(lower.chunks_exact(CHANNELS)).zip(upper.chunks_exact(CHANNELS));
    for ((q, low), high) in slots {
        if let ([q, ..], [low, ..], [high, ..]) = (q, low, high) {
            *q = low + cell.unclamped * (high - low);
        }
    }
    blended
}
