//! What the direct solver says of one side's table: nearly all of the work, and the part that shards divide.

use flangeway::SLOTS;

use super::axes::{Axes, REFINEMENT};
use super::checkpoint::Checkpoint;
use super::fit::{self, Points};
use super::half_space;
use super::rigid_map;
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
    /// The rigid map, as in the image.
    pub(super) rigid: Vec<[f32; 4]>,
    /// States at the nodes of the records.
    pub(super) nodes: Vec<[SlotState; SLOTS]>,
    /// Poses inside the cells that node values are fitted to; none where they are sampled.
    pub(super) points: Points,
    /// The half-space solver's answers at the nodes; none where the table is by another one.
    pub(super) half_space: Vec<[SlotState; SLOTS]>,
}

impl Solved {
    /// All of a side's table.
    pub(super) fn new(sampler: &mut Sampler<'_>, pair: &Pair, axes: &Axes, values: NodeValues) -> Result<Self> {
        let all: Vec<usize> = (0..axes.lateral.len() - 1).collect();
        let (mut solved, points) = Self::around(sampler, pair, axes, values, &all)?;
        points.into_iter().for_each(|next| solved.points.append(next));
        Ok(solved)
    }

    /// The parts of these lateral intervals. The pairs are the one that the table is prepared with and its own.
    pub(super) fn intervals(
        sampler: &mut Sampler<'_>,
        [preparing, pair]: [&Pair; 2],
        axes: &Axes,
        values: NodeValues,
        lateral: &[usize],
    ) -> Result<Vec<Self>> {
        let (mut solved, points) = Self::around(sampler, preparing, axes, values, lateral)?;
        let around = axes.around(lateral);
        let half_space = half_space::solve(sampler, pair, &around, &mut Checkpoint::none())?;
        solved.half_space = spread(&half_space, &around, axes);
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
        let rigid = rigid_map::map(sampler, axes);
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
                fit::draw(&fit::Drawing::new(pair, sampler.side, axes, &rigid)?, axes, &nodes, lateral)
            }
            NodeValues::Sampled => lateral.iter().map(|_| Points::default()).collect(),
        };
        Ok((Self { rigid, nodes, ..Self::default() }, points))
    }

    /// The part of one interval, without its poses.
    fn interval(&self, axes: &Axes, interval: usize) -> Self {
        let [rigid, nodes] = lengths(axes);
        let refined = usize::from(REFINEMENT[0]);
        let last = usize::from(interval + 2 == axes.lateral.len());
        let rows = refined * interval..refined * (interval + 1) + last;
        let part = |all: &[[SlotState; SLOTS]]| {
            all.get(nodes * interval..nodes * (interval + 1 + last)).unwrap_or_default().to_vec()
        };
        Self {
            rigid: self.rigid[rigid * rows.start..rigid * rows.end].to_vec(),
            nodes: part(&self.nodes),
            half_space: part(&self.half_space),
            points: Points::default(),
        }
    }

    /// Appends the part of the interval that follows.
    pub(super) fn append(&mut self, mut next: Self) {
        self.rigid.append(&mut next.rigid);
        self.nodes.append(&mut next.nodes);
        self.points.append(next.points);
        self.half_space.append(&mut next.half_space);
    }

    /// Whether this is all of a table of these axes.
    pub(super) fn fits(&self, axes: &Axes) -> bool {
        let [rigid, nodes] = lengths(axes);
        let rows = axes.rigid()[0].len();
        (self.rigid.len(), self.nodes.len()) == (rigid * rows, nodes * axes.lateral.len())
            && (self.half_space.is_empty() || self.half_space.len() == self.nodes.len())
            && self.points.places.len() == self.points.points.len()
            && self.points.places.iter().all(|place| place.is_in(axes))
    }
}

/// Nodes in a row of the rigid map, and of the records in a plane, at one lateral node.
fn lengths(axes: &Axes) -> [usize; 2] {
    let [_, yaw] = axes.rigid().map(<[f64]>::len);
    [yaw, axes.nodes() / axes.lateral.len()]
}

/// States at the nodes of some lateral nodes, put where they belong among those of all; none of none.
fn spread(part: &[[SlotState; SLOTS]], around: &Axes, axes: &Axes) -> Vec<[SlotState; SLOTS]> {
    if part.is_empty() {
        return Vec::new();
    }
    let [_, plane] = lengths(axes);
    let mut planes = part.chunks(plane);
    let mut taken = around.lateral.iter().peekable();
    let absent = vec![[SlotState::ABSENT; SLOTS]; plane];
    let of = |u: &f64| taken.next_if_eq(&u).and_then(|_| planes.next()).unwrap_or(&absent).to_vec();
    axes.lateral.iter().flat_map(of).collect()
}
