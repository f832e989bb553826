//! What the compiler has asked the direct solver so far, on one side.
//!
//! The search for good axes compiles many tables whose nodes are mostly the same. A node's answer depends on its own
//! coordinates alone, so everything is solved once and kept.

use std::collections::HashMap;

use flangeway::{SLOTS, Side};
use rayon::prelude::*;

use super::axes::Axes;
use super::rigid_map::{self, OFFSETS, RigidNode, Touch};
use crate::contact::SlotState;
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::{progress, rigid};

/// Coordinates of a node (m or rad), by their bits.
type Key<const N: usize> = [u64; N];

fn key<const N: usize>(coordinates: [f64; N]) -> Key<N> {
    coordinates.map(f64::to_bits)
}

/// Answers of the direct solver, by node.
pub(super) struct Sampler<'a> {
    recipe: &'a Recipe,
    pair: &'a Pair,
    pub(super) side: Side,
    /// By lateral displacement and yaw.
    rigid: HashMap<Key<2>, RigidNode>,
    /// By lateral displacement, yaw and roll offset: the states at each height.
    columns: HashMap<Key<3>, HashMap<u64, [SlotState; SLOTS]>>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(recipe: &'a Recipe, pair: &'a Pair, side: Side) -> Self {
        Self { recipe, pair, side, rigid: HashMap::new(), columns: HashMap::new() }
    }

    /// Solves whatever these axes need and is not yet known.
    pub(super) fn prepare(&mut self, axes: &Axes) -> Result<()> {
        self.solve_rigid(axes)?;
        self.solve_columns(axes);
        Ok(())
    }

    /// The rigid contact at a lateral displacement and yaw.
    pub(super) fn rigid(&self, u: f64, yaw: f64) -> RigidNode {
        self.rigid.get(&key([u, yaw])).copied().unwrap_or_default()
    }

    pub(super) fn states(&self, u: f64, yaw: f64, roll: f64, vertical: f64) -> [SlotState; SLOTS] {
        let column = self.columns.get(&key([u, yaw, roll]));
        column.and_then(|column| column.get(&vertical.to_bits())).copied().unwrap_or([SlotState::ABSENT; SLOTS])
    }

    /// The canonical pose at lateral displacement, yaw and roll offset with zeta = 0: there the wheel touches, but for
    /// what the height's parabola leaves out.
    pub(super) fn touching_pose(&self, [u, yaw, offset]: [f64; 3]) -> flangeway::Pose {
        let geometry = self.pair.body(self.side).wheel().geometry();
        let rigid = self.rigid(u, yaw);
        let at = flangeway::Displacement { lateral: u, vertical: rigid.height(offset) };
        flangeway::pose_with(geometry, &at, yaw, rigid.roll() + offset)
    }

    fn misses(&self, u: f64) -> Error {
        let message = format!("a wheel misses its rail at a lateral position of {:.3} mm", 1e3 * u);
        Error::field(&self.recipe.path, "grid.lateral_m.range", message)
    }

    fn solve_rigid(&mut self, axes: &Axes) -> Result<()> {
        let [lateral, yaw] = axes.rigid();
        let offsets = rigid_map::offsets(&axes.roll);
        let all = lateral.iter().flat_map(|&u| yaw.iter().map(move |&yaw| [u, yaw]));
        let missing: Vec<[f64; 2]> = all.filter(|&at| !self.rigid.contains_key(&key(at))).collect();
        let solve = |&[u, yaw]: &[f64; 2]| {
            let found = rigid::at_displacement(self.pair, self.side, u, yaw).ok_or_else(|| self.misses(u))?;
            // The map is stored in single precision; everything after it starts from the stored value.
            let roll = found.roll as f32;
            let mut touches = [Touch::default(); OFFSETS];
            for (touch, offset) in touches.iter_mut().zip(offsets) {
                let roll = f64::from(roll) + offset;
                let found = rigid::touching_displacement(self.pair, self.side, u, yaw, roll);
                let (vertical, point) = found.ok_or_else(|| self.misses(u))?;
                *touch = Touch { vertical, profile: point.wheel.s };
            }
            Ok((key([u, yaw]), RigidNode::new(roll, &offsets, &touches)))
        };
        let solved: Vec<_> = progress::parallel(&missing, "rigid contact", solve).collect::<Result<_>>()?;
        self.rigid.extend(solved);
        Ok(())
    }

    /// The direct solver at the nodes of the records; the silhouette and its search serve a whole column of heights.
    fn solve_columns(&mut self, axes: &Axes) {
        let plane = axes.lateral.iter().flat_map(|&u| axes.yaw.iter().map(move |&yaw| (u, yaw)));
        let all = plane.flat_map(|(u, yaw)| axes.roll.iter().map(move |&roll| [u, yaw, roll]));
        let lacking = |at: [f64; 3]| {
            let known = self.columns.get(&key(at));
            let heights = axes.vertical.iter().copied();
            let lacks = |z: &f64| known.is_none_or(|known| !known.contains_key(&z.to_bits()));
            (at, heights.filter(lacks).collect::<Vec<f64>>())
        };
        let missing: Vec<([f64; 3], Vec<f64>)> = all.map(lacking).filter(|(_, heights)| !heights.is_empty()).collect();
        let solve = |(at, heights): &([f64; 3], Vec<f64>)| {
            let pose = self.touching_pose(*at);
            let mut column = self.pair.column(self.side, &pose);
            let states = |&z: &f64| (z.to_bits(), column.slots(pose.vertical + z));
            (key(*at), heights.iter().map(states).collect::<Vec<_>>())
        };
        let solved: Vec<_> = progress::parallel(&missing, "sampling", solve).collect();
        for (at, states) in solved {
            self.columns.entry(at).or_default().extend(states);
        }
    }
}
