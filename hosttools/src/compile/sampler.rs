//! What the compiler has asked the direct solver so far, on one side.
//!
//! The search for good axes compiles many tables whose nodes are mostly the same. A node's answer depends on its own
//! coordinates alone, so everything is solved once and kept.

use std::collections::HashMap;

use flangeway::{SLOTS, Side};
use rayon::prelude::*;

use super::axes::Axes;
use crate::contact::SlotState;
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::{progress, rigid};

/// Coordinates of a node (m or rad), by their bits.
type Key<const N: usize> = [u32; N];

fn key<const N: usize>(coordinates: [f32; N]) -> Key<N> {
    coordinates.map(f32::to_bits)
}

/// Where the wheel touches at one place of the rigid maps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Displacement w of the tape-circle point (m).
    pub(super) vertical: f32,
    /// Wheel-profile coordinate of the contact (m).
    pub(super) profile: f64,
}

/// Answers of the direct solver, by node.
pub(super) struct Sampler<'a> {
    recipe: &'a Recipe,
    pair: &'a Pair,
    pub(super) side: Side,
    /// Roll of the wheelset at rest, by lateral displacement and yaw.
    rest: HashMap<Key<2>, f32>,
    /// By lateral displacement, yaw and roll offset.
    touches: HashMap<Key<3>, Touch>,
    /// By lateral displacement, yaw and roll offset: the states at each height.
    columns: HashMap<Key<3>, HashMap<u32, [SlotState; SLOTS]>>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(recipe: &'a Recipe, pair: &'a Pair, side: Side) -> Self {
        Self { recipe, pair, side, rest: HashMap::new(), touches: HashMap::new(), columns: HashMap::new() }
    }

    /// Solves whatever these axes need and is not yet known.
    pub(super) fn prepare(&mut self, axes: &Axes) -> Result<()> {
        let [lateral, yaw, roll] = axes.rigid();
        self.solve_rest(lateral, yaw)?;
        self.solve_touches(lateral, yaw, roll)?;
        self.solve_columns(axes);
        Ok(())
    }

    pub(super) fn rest(&self, u: f32, yaw: f32) -> f32 {
        self.rest.get(&key([u, yaw])).copied().unwrap_or_default()
    }

    pub(super) fn touch(&self, u: f32, yaw: f32, roll: f32) -> Touch {
        self.touches.get(&key([u, yaw, roll])).copied().unwrap_or(Touch { vertical: 0.0, profile: 0.0 })
    }

    pub(super) fn states(&self, u: f32, yaw: f32, roll: f32, vertical: f32) -> [SlotState; SLOTS] {
        let column = self.columns.get(&key([u, yaw, roll]));
        column.and_then(|column| column.get(&vertical.to_bits())).copied().unwrap_or([SlotState::ABSENT; SLOTS])
    }

    /// The canonical pose at lateral displacement, yaw and roll offset in which the wheel just touches.
    pub(super) fn touching_pose(&self, [u, yaw, offset]: [f32; 3]) -> flangeway::Pose {
        let geometry = self.pair.body(self.side).wheel().geometry();
        let vertical = f64::from(self.touch(u, yaw, offset).vertical);
        let at = flangeway::Displacement { lateral: f64::from(u), vertical };
        flangeway::pose_with(geometry, &at, f64::from(yaw), f64::from(self.rest(u, yaw)) + f64::from(offset))
    }

    fn misses(&self, u: f32) -> Error {
        let message = format!("a wheel misses its rail at a lateral position of {:.3} mm", 1e3 * u);
        Error::field(&self.recipe.path, "grid.lateral_m.range", message)
    }

    fn solve_rest(&mut self, lateral: &[f32], yaw: &[f32]) -> Result<()> {
        let all = lateral.iter().flat_map(|&u| yaw.iter().map(move |&yaw| [u, yaw]));
        let missing: Vec<[f32; 2]> = all.filter(|&at| !self.rest.contains_key(&key(at))).collect();
        let solve = |&[u, yaw]: &[f32; 2]| {
            let found = rigid::at_displacement(self.pair, self.side, f64::from(u), f64::from(yaw));
            // The map is stored in single precision; everything after it starts from the stored value.
            Ok((key([u, yaw]), found.ok_or_else(|| self.misses(u))?.roll as f32))
        };
        let solved: Vec<_> = progress::parallel(&missing, "rigid contact", solve).collect::<Result<_>>()?;
        self.rest.extend(solved);
        Ok(())
    }

    fn solve_touches(&mut self, lateral: &[f32], yaw: &[f32], roll: &[f32]) -> Result<()> {
        let plane = lateral.iter().flat_map(|&u| yaw.iter().map(move |&yaw| (u, yaw)));
        let all = plane.flat_map(|(u, yaw)| roll.iter().map(move |&roll| [u, yaw, roll]));
        let missing: Vec<[f32; 3]> = all.filter(|&at| !self.touches.contains_key(&key(at))).collect();
        let solve = |&[u, yaw, offset]: &[f32; 3]| {
            let roll = f64::from(self.rest(u, yaw)) + f64::from(offset);
            let found = rigid::touching_displacement(self.pair, self.side, f64::from(u), f64::from(yaw), roll);
            let (w, point) = found.ok_or_else(|| self.misses(u))?;
            Ok((key([u, yaw, offset]), Touch { vertical: w as f32, profile: point.wheel.s }))
        };
        let solved: Vec<_> = progress::parallel(&missing, "touching", solve).collect::<Result<_>>()?;
        self.touches.extend(solved);
        Ok(())
    }

    /// The direct solver at the nodes of the records; the silhouette and its search serve a whole column of heights.
    fn solve_columns(&mut self, axes: &Axes) {
        let plane = axes.lateral.iter().flat_map(|&u| axes.yaw.iter().map(move |&yaw| (u, yaw)));
        let all = plane.flat_map(|(u, yaw)| axes.roll.iter().map(move |&roll| [u, yaw, roll]));
        let lacking = |at: [f32; 3]| {
            let known = self.columns.get(&key(at));
            let heights = axes.vertical.iter().copied();
            let lacks = |z: &f32| known.is_none_or(|known| !known.contains_key(&z.to_bits()));
            (at, heights.filter(lacks).collect::<Vec<f32>>())
        };
        let missing: Vec<([f32; 3], Vec<f32>)> = all.map(lacking).filter(|(_, heights)| !heights.is_empty()).collect();
        let solve = |(at, heights): &([f32; 3], Vec<f32>)| {
            let pose = self.touching_pose(*at);
            let mut column = self.pair.column(self.side, &pose);
            let states = |&z: &f32| (z.to_bits(), column.slots(pose.vertical + f64::from(z)));
            (key(*at), heights.iter().map(states).collect::<Vec<_>>())
        };
        let solved: Vec<_> = progress::parallel(&missing, "sampling", solve).collect();
        for (at, states) in solved {
            self.columns.entry(at).or_default().extend(states);
        }
    }
}
