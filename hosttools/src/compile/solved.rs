//! What the direct solver says of one side's table: nearly all of the work, and the part that shards divide.

use flangeway::SLOTS;

use super::axes::{Axes, REFINEMENT};
use super::fit::{self, Points};
use super::rigid_maps;
use super::sampler::Sampler;
use crate::contact::SlotState;
use crate::error::Result;
use crate::pair::Pair;
use crate::recipe::NodeValues;

/// A side's table before fitting and quantising, or the part of it that belongs to an interval of the lateral axis:
/// the interval's first node with all that lies behind it up to the next one, the last interval's with both ends. All
/// arrays run along the lateral axis first, so intervals in their order make up the whole.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Solved {
    /// The rigid maps, as in the image.
    pub(super) roll: Vec<f32>,
    pub(super) vertical: Vec<f32>,
    /// States at the nodes of the records.
    pub(super) nodes: Vec<[SlotState; SLOTS]>,
    /// Poses inside the cells that node values are fitted to; none where they are sampled.
    pub(super) points: Points,
}

impl Solved {
    /// All of a side's table.
    pub(super) fn new(sampler: &mut Sampler<'_>, pair: &Pair, axes: &Axes, values: NodeValues) -> Result<Self> {
        let all: Vec<usize> = (0..axes.lateral.len() - 1).collect();
        let (mut solved, points) = Self::around(sampler, pair, axes, values, &all)?;
        points.into_iter().for_each(|next| solved.points.append(next));
        Ok(solved)
    }

    /// The parts of these lateral intervals.
    pub(super) fn intervals(
        sampler: &mut Sampler<'_>,
        pair: &Pair,
        axes: &Axes,
        values: NodeValues,
        lateral: &[usize],
    ) -> Result<Vec<Self>> {
        let (solved, points) = Self::around(sampler, pair, axes, values, lateral)?;
        let part = |(&interval, points): (&usize, Points)| Self { points, ..solved.interval(axes, interval) };
        Ok(lateral.iter().zip(points).map(part).collect())
    }

    /// Arrays of the whole table, filled where these lateral intervals need it, and their poses to fit to.
    fn around(
        sampler: &mut Sampler<'_>,
        pair: &Pair,
        axes: &Axes,
        values: NodeValues,
        lateral: &[usize],
    ) -> Result<(Self, Vec<Points>)> {
        sampler.prepare(&axes.around(lateral))?;
        let (roll, vertical) = rigid_maps::maps(sampler, axes);
        let mut nodes: Vec<[SlotState; SLOTS]> = Vec::with_capacity(axes.nodes());
        for &u in &axes.lateral {
            for &yaw in &axes.yaw {
                for &roll in &axes.roll {
                    nodes.extend(axes.vertical.iter().map(|&z| sampler.states(u, yaw, roll, z)));
                }
            }
        }
        let points = match values {
            NodeValues::Fitted => {
                fit::draw(&fit::Drawing::new(pair, sampler.side, axes, &roll, &vertical)?, axes, &nodes, lateral)
            }
            NodeValues::Sampled => lateral.iter().map(|_| Points::default()).collect(),
        };
        Ok((Self { roll, vertical, nodes, points: Points::default() }, points))
    }

    /// The part of one interval, without its poses.
    fn interval(&self, axes: &Axes, interval: usize) -> Self {
        let [roll, vertical, nodes] = lengths(axes);
        let refined = usize::from(REFINEMENT[0]);
        let last = usize::from(interval + 2 == axes.lateral.len());
        let rows = refined * interval..refined * (interval + 1) + last;
        Self {
            roll: self.roll[roll * rows.start..roll * rows.end].to_vec(),
            vertical: self.vertical[vertical * rows.start..vertical * rows.end].to_vec(),
            nodes: self.nodes[nodes * interval..nodes * (interval + 1 + last)].to_vec(),
            points: Points::default(),
        }
    }

    /// Appends the part of the interval that follows.
    pub(super) fn append(&mut self, mut next: Self) {
        self.roll.append(&mut next.roll);
        self.vertical.append(&mut next.vertical);
        self.nodes.append(&mut next.nodes);
        self.points.append(next.points);
    }

    /// Whether this is all of a table of these axes.
    pub(super) fn fits(&self, axes: &Axes) -> bool {
        let [roll, vertical, nodes] = lengths(axes);
        let rows = axes.rigid()[0].len();
        let counts = (self.roll.len(), self.vertical.len(), self.nodes.len());
        counts == (roll * rows, vertical * rows, nodes * axes.lateral.len())
            && self.points.places.len() == self.points.points.len()
            && self.points.places.iter().all(|place| place.is_in(axes))
    }
}

/// Values of rigid roll and rigid height in a row of the rigid maps, and nodes of the records in a plane, at one lateral
/// node.
fn lengths(axes: &Axes) -> [usize; 3] {
    let [_, yaw, roll] = axes.rigid().map(<[f32]>::len);
    [yaw, yaw * roll, axes.nodes() / axes.lateral.len()]
}
