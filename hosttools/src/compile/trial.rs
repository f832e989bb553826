//! The poses on which the compiler compares axes: the direct solver's answer is known, a candidate table is asked.

use flangeway::{ContactTable, Pose, Side};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::verify::{LOADS, Quantiles, height_for_load, stream};
use crate::{progress, rigid};

/// Poses, and the seed of their drawing, which no user of `verify` is likely to name.
const COUNT: usize = 6000;
const SEED: u64 = 0x5eed_0f74_b1e5;

/// A pose with its total normal force by the direct solver.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    side: Side,
    /// As the kernel is asked.
    pose: Pose,
    /// Canonical coordinates: lateral displacement of the tape-circle point, yaw, roll offset, height above touching.
    pub(super) coordinates: [f64; 4],
    force: f64,
}

/// Draws trials as `verify` draws samples: coordinates uniform over the recipe's ranges, load log-uniform.
pub(super) fn draw(recipe: &Recipe, pair: &Pair) -> Vec<Trial> {
    let grid = &recipe.grid;
    let draw = |&index: &usize| {
        let side = if pair.sides() == 2 && index % 2 == 1 { Side::Left } else { Side::Right };
        let mut uniform = stream(SEED, index);
        let (u, yaw) = (uniform(grid.lateral_m.range), uniform(grid.yaw_rad.range));
        let offset = uniform(grid.roll_rad.range);
        let load = libm::exp(uniform(LOADS.map(libm::log)));
        let roll = rigid::at_displacement(pair, side, u, yaw)?.roll + offset;
        let (touching, _) = rigid::touching_displacement(pair, side, u, yaw, roll)?;
        let geometry = pair.body(side).wheel().geometry();
        let at = flangeway::Displacement { lateral: u, vertical: touching };
        let pose = flangeway::pose_with(geometry, &at, yaw, roll);
        let mut column = pair.column(side, &pose);
        let vertical = height_for_load(&mut column, load)?;
        let force = column.total_force(vertical);
        let coordinates = [u, yaw, offset, vertical - pose.vertical];
        let sign = side.sign();
        let pose = Pose { lateral: sign * pose.lateral, yaw: sign * yaw, vertical, roll: sign * roll };
        Some(Trial { side, pose, coordinates, force })
    };
    let indices: Vec<usize> = (0..COUNT).collect();
    progress::parallel(&indices, "trial poses", draw).filter_map(|trial| trial).collect()
}

/// Relative force errors of a table on the trials, in their order.
pub(super) fn errors(image: &[u8], trials: &[Trial]) -> Result<Vec<f64>> {
    let table = ContactTable::new(image).map_err(|e| Error::field("", "table", e.to_string()))?;
    let error = |t: &Trial| {
        let found = f64::from(table.contacts(t.side, &t.pose).total_normal_force());
        (found - t.force).abs() / t.force.max(LOADS[0])
    };
    Ok(trials.par_iter().map(error).collect())
}

/// One figure to compare tables by: the mean logarithm of median, rms, 95 % and 99 % quantile, so that halving any of
/// them is worth the same.
pub(super) fn score(errors: &[f64]) -> (f64, Quantiles) {
    let figures = Quantiles::of(errors.to_vec());
    let parts = [figures.median, figures.rms, figures.p95, figures.p99];
    (parts.iter().map(|v| libm::log(v.max(1e-9))).sum::<f64>() / 4.0, figures)
}
