//! The poses that node values are fitted to: a few columns of heights in every cell, more where a contact appears,
//! ends or moves on.

use flangeway::{AxisName, CHANNELS, Coordinates, SLOTS, Side};
use rayon::prelude::*;

use crate::compile::axes::{Axes, REFINEMENT};
use crate::compile::quantise;
use crate::compile::stencil::Place;
use crate::error::Result;
use crate::hertz;
use crate::image::{OwnedAxis, OwnedRigidMap};
use crate::pair::Pair;
use crate::progress;
use crate::verify::{LOADS, stream};

/// Columns along each of lateral, yaw and roll in a cell, and in a cell that needs more.
const COLUMNS: usize = 2;
const MORE_COLUMNS: usize = 4;
/// Relative force error of the sampled values from which on a cell needs more.
const ROUGH: f64 = 0.02;
/// Heights in a column, log-uniform from this share of the highest node to this many times it: at constant C the
/// load is then log-uniform too, as `verify` draws it.
const HEIGHTS: usize = 10;
const HEIGHT_SHARES: [f64; 2] = [0.05, 3.0];
/// Largest load (N) that is looked at: some more than `verify` draws, so that its largest are not at the end.
const LARGEST_LOAD: f64 = 1.3 * LOADS[1];
/// Seed of the places inside the cells.
const SEED: u64 = 0xf17;

/// A pose by the direct solver.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(in crate::compile) struct Point {
    /// Square root of its share of the table's volume.
    pub(super) weight: f32,
    /// Channels of the slots that are near the rail.
    pub(super) slots: [Option<[f32; CHANNELS]>; SLOTS],
}

impl Point {
    /// Normal force of a slot (N).
    pub(super) fn slot_force(&self, slot: usize) -> f64 {
        let Some([delta, stiffness, ..]) = self.slots[slot] else { return 0.0 };
        hertz::normal_force(f64::from(stiffness), f64::from(delta))
    }

    /// Total normal force (N).
    pub(super) fn force(&self) -> f64 {
        (0..SLOTS).map(|slot| self.slot_force(slot)).sum()
    }
}

/// Poses and where they lie.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(in crate::compile) struct Points {
    pub(in crate::compile) places: Vec<Place>,
    pub(in crate::compile) points: Vec<Point>,
}

impl Points {
    /// Appends the poses of the cells that follow.
    pub(in crate::compile) fn append(&mut self, mut next: Self) {
        self.places.append(&mut next.places);
        self.points.append(&mut next.points);
    }
}

/// Draws poses in the cells of a side's table.
pub(in crate::compile) struct Drawing<'a> {
    pair: &'a Pair,
    side: Side,
    map: OwnedRigidMap,
    /// Lateral, yaw, roll, vertical.
    nodes: [&'a [f64]; 4],
    axes: [OwnedAxis; 4],
}

impl<'a> Drawing<'a> {
    /// A side's table, by its axes and rigid map.
    pub(in crate::compile) fn new(pair: &'a Pair, side: Side, axes: &'a Axes, rigid: &[[f32; 4]]) -> Result<Self> {
        Ok(Self {
            pair,
            side,
            map: OwnedRigidMap::new([&axes.lateral, &axes.yaw, &axes.roll], REFINEMENT, rigid)?,
            nodes: [&axes.lateral, &axes.yaw, &axes.roll, &axes.vertical],
            axes: [
                OwnedAxis::new(AxisName::Lateral, &axes.lateral)?,
                OwnedAxis::new(AxisName::Yaw, &axes.yaw)?,
                OwnedAxis::new(AxisName::RollOffset, &axes.roll)?,
                OwnedAxis::new(AxisName::Vertical, &axes.vertical)?,
            ],
        })
    }

    /// The poses of the cells in these intervals of the lateral axis, one interval after the other; `error` tells how
    /// far the table is off at one. None where the vertical axis ends without contact.
    pub(super) fn points(&self, lateral: &[usize], error: impl Fn(&Place, &Point) -> f64 + Sync) -> Vec<Points> {
        if self.highest() <= 0.0 {
            return lateral.iter().map(|_| Points::default()).collect();
        }
        let [yaw, roll] = [1, 2].map(|axis| self.nodes[axis].len() - 1);
        let plane = yaw * roll;
        let cells: Vec<[usize; 3]> =
            lateral.iter().flat_map(|&cell| (0..plane).map(move |n| [cell, n / roll, n % roll])).collect();
        let draw = |cell: &[usize; 3]| {
            let few = self.cell(*cell, COLUMNS);
            if few.iter().any(|(place, point)| error(place, point) > ROUGH) {
                self.cell(*cell, MORE_COLUMNS)
            } else {
                few
            }
        };
        let mut drawn: Vec<Vec<(Place, Point)>> = progress::parallel(&cells, "poses to fit", draw).collect();
        let together = |cells: &mut [Vec<(Place, Point)>]| {
            let (places, points) = cells.iter_mut().flat_map(std::mem::take).unzip();
            Points { places, points }
        };
        drawn.par_chunks_mut(plane).map(together).collect()
    }

    /// Height (m) of the highest node above touching.
    fn highest(&self) -> f64 {
        let [.., vertical] = self.nodes;
        vertical.last().copied().map_or(0.0, f64::from)
    }

    /// Poses of one cell: `columns`³ columns, one anywhere in each part of it.
    fn cell(&self, cell: [usize; 3], columns: usize) -> Vec<(Place, Point)> {
        let ends = |axis: usize| [cell[axis], cell[axis] + 1].map(|i| self.nodes[axis][i]);
        let volume: f64 = (0..3)
            .map(|axis| {
                let nodes = self.nodes[axis];
                let [from, to] = ends(axis);
                (to - from) / (nodes[nodes.len() - 1] - nodes[0]) * (nodes.len() - 1) as f64
            })
            .product();
        let count = columns.pow(3);
        let weight = (volume / count as f64).sqrt() as f32;
        let number = (0..3).fold(0, |n, axis| n * self.nodes[axis].len() + cell[axis]);
        let column = |k: usize| {
            let mut uniform = stream(SEED, 64 * number + k);
            let parts = [k % columns, k / columns % columns, k / columns / columns];
            let fractions = parts.map(|part| (part as f64 + uniform([0.0, 1.0])) / columns as f64);
            let at = |axis: usize| {
                let [from, to] = ends(axis);
                from + (to - from) * fractions[axis]
            };
            let here = Coordinates { lateral: at(0), yaw: at(1), roll_offset: at(2), vertical: 0.0 };
            let heights: [f64; HEIGHTS] = std::array::from_fn(|h| (h as f64 + uniform([0.0, 1.0])) / HEIGHTS as f64);
            self.column(&here, heights, weight)
        };
        (0..count).flat_map(column).collect()
    }

    /// Poses at several heights, each given as 0 to 1 over the heights looked at.
    fn column(&self, at: &Coordinates, heights: [f64; HEIGHTS], weight: f32) -> Vec<(Place, Point)> {
        let [low, high] = HEIGHT_SHARES.map(|share| share * self.highest());
        let pose = self.map.view().pose(self.pair.body(self.side).wheel().geometry(), at);
        let mut column = self.pair.column(self.side, &pose);
        let [lateral, yaw, roll, vertical] = self.axes.each_ref().map(OwnedAxis::view);
        let plane = [lateral.locate(at.lateral), yaw.locate(at.yaw), roll.locate(at.roll_offset)];
        let point = |share: f64| {
            let above = low * libm::pow(high / low, share);
            let states = column.slots(pose.vertical + above);
            let slots = states.map(|state| state.present.then(|| quantise::values(&state).map(|v| v as f32)));
            let [u, yaw, roll] = plane;
            (Place::new(&[u, yaw, roll, vertical.locate(above)]), Point { weight, slots })
        };
        heights.into_iter().map(point).take_while(|(_, point)| point.force() < LARGEST_LOAD).collect()
    }
}
