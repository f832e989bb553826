//! The rigid maps of a side: roll of the wheelset at rest, and height at which the one wheel touches.

use flangeway::Side;
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{Axes, bar};
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::rigid;

/// `roll[lateral][yaw]` (rad) and `vertical[lateral][yaw][roll offset]` (m) on the rigid axes.
pub(super) fn solve(recipe: &Recipe, pair: &Pair, side: Side, axes: &Axes) -> Result<(Vec<f32>, Vec<f32>)> {
    let [lateral, yaw, roll_offset] = axes.rigid();
    let plane = lateral.len() * yaw.len();
    let node = |k: usize| (f64::from(lateral[k / yaw.len()]), f64::from(yaw[k % yaw.len()]));
    let misses = |u: f64| {
        let message = format!("a wheel misses its rail at a lateral position of {:.3} mm", 1e3 * u);
        Error::field(&recipe.path, "grid.lateral_m.range", message)
    };
    let solve = |k: usize| {
        let (u, yaw) = node(k);
        // The map is stored in single precision; everything after it starts from the stored value.
        let roll = rigid::at_displacement(pair, side, u, yaw).ok_or_else(|| misses(u))?.roll as f32;
        let height = |offset: &f32| {
            let roll = f64::from(roll) + f64::from(*offset);
            rigid::touching_displacement(pair, side, u, yaw, roll).map(|w| w as f32).ok_or_else(|| misses(u))
        };
        Ok((roll, roll_offset.iter().map(height).collect::<Result<Vec<f32>>>()?))
    };
    let solved: Vec<(f32, Vec<f32>)> =
        (0..plane).into_par_iter().progress_with(bar(plane, "rigid contact")).map(solve).collect::<Result<_>>()?;
    let (roll, vertical): (Vec<f32>, Vec<Vec<f32>>) = solved.into_iter().unzip();
    Ok((roll, vertical.concat()))
}
