//! Where the nodes go: the compiler refines the axis that buys most, until the bytes are spent.
//!
//! Every candidate is a real table, read by the real kernel and judged on poses whose force is known, so the search
//! minimises what `verify` measures. It depends on the recipe alone and starts and ends the same on every machine.

use super::axes::Axes;
use super::trial::{self, Trial};
use super::{Assembled, Compiler};
use crate::error::Result;
use crate::recipe::{Nodes, Recipe};

/// What ended the refinement of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// The counts were given.
    Counts,
    /// The byte budget.
    Bytes,
    /// The error target.
    Error,
    /// No refinement was worth its bytes any more.
    Resolved,
}

impl std::fmt::Display for Bound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Counts => "given node counts",
            Self::Bytes => "max_bytes",
            Self::Error => "max_force_error_p95",
            Self::Resolved => "nothing left that more nodes improve",
        })
    }
}

/// Share of the lateral nodes that one step adds.
const LATERAL_STEP: f64 = 0.12;
/// A step must improve the score by this much for each unit of the logarithm of bytes.
const LEAST_GAIN: f64 = 0.02;

/// An axis, by its place in a trial's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    Lateral,
    Yaw,
    Roll,
    Vertical,
}

const DIRECTIONS: [Direction; 4] = [Direction::Lateral, Direction::Yaw, Direction::Roll, Direction::Vertical];

/// Refines the axes that the recipe leaves to the compiler.
pub(super) fn refine(recipe: &Recipe, compiler: &mut Compiler<'_>) -> Result<(Assembled, Bound)> {
    let grid = &recipe.grid;
    let free: Vec<Direction> = DIRECTIONS
        .into_iter()
        .zip([&grid.lateral_m, &grid.yaw_rad, &grid.roll_rad, &grid.vertical_m])
        .filter(|(_, axis)| axis.nodes == Nodes::Auto)
        .map(|(direction, _)| direction)
        .collect();
    let budget = usize::try_from(grid.max_bytes).unwrap_or(usize::MAX);
    let trials = trial::draw(recipe, compiler.pair);
    let mut best = compiler.assemble(Axes::coarsest(recipe, compiler.pair.sides())?)?;
    let mut errors = trial::errors(&best.image, &trials)?;
    loop {
        let (score, figures) = trial::score(&errors);
        if grid.max_force_error_p95.is_some_and(|target| figures.p95 <= target) {
            return Ok((best, Bound::Error));
        }
        let mut chosen: Option<(f64, Assembled, Vec<f64>)> = None;
        let mut fits = false;
        let weights: [fn(f64) -> f64; 2] = [|error| error, |error| error * error];
        let steps = free.iter().flat_map(|&direction| weights.map(|weight| (direction, weight)));
        for (direction, weight) in steps {
            let blame: Vec<f64> = errors.iter().map(|&error| weight(error)).collect();
            let Some(axes) = step(&best.axes, direction, &trials, &blame, budget, compiler.pair.sides()) else {
                continue;
            };
            fits = true;
            let candidate = compiler.assemble(axes)?;
            let its_errors = trial::errors(&candidate.image, &trials)?;
            let cost = libm::log(candidate.image.len() as f64 / best.image.len() as f64);
            let gain = (score - trial::score(&its_errors).0) / cost;
            if chosen.as_ref().is_none_or(|(most, ..)| gain > *most) {
                chosen = Some((gain, candidate, its_errors));
            }
        }
        match chosen {
            Some((gain, candidate, its_errors)) if gain > LEAST_GAIN => (best, errors) = (candidate, its_errors),
            _ => return Ok((best, if fits { Bound::Resolved } else { Bound::Bytes })),
        }
    }
}

/// The axes after one refinement in a direction, where it fits the budget.
fn step(
    axes: &Axes,
    direction: Direction,
    trials: &[Trial],
    weights: &[f64],
    budget: usize,
    sides: usize,
) -> Option<Axes> {
    let nodes = match direction {
        Direction::Lateral => &axes.lateral,
        Direction::Yaw => &axes.yaw,
        Direction::Roll => &axes.roll,
        Direction::Vertical => &axes.vertical,
    };
    // Intervals by the error that lies in them.
    let mut blame = vec![0.0; nodes.len() - 1];
    for (trial, weight) in trials.iter().zip(weights) {
        let x = trial.coordinates[direction as usize];
        let above = nodes.partition_point(|&node| f64::from(node) <= x);
        blame[above.clamp(1, nodes.len() - 1) - 1] += weight;
    }
    let mut order: Vec<usize> = (0..blame.len()).collect();
    order.sort_by(|&a, &b| blame[b].total_cmp(&blame[a]).then(a.cmp(&b)));
    let mut count = match direction {
        Direction::Lateral => ((nodes.len() as f64 * LATERAL_STEP).ceil() as usize).clamp(4, order.len()),
        Direction::Roll => order.len(),
        Direction::Yaw | Direction::Vertical => 1,
    };
    loop {
        let refined = with_midpoints(nodes, &order[..count]);
        let axes = match direction {
            Direction::Lateral => Axes::new(refined, axes.yaw.clone(), axes.roll.clone(), axes.vertical.clone()),
            Direction::Yaw => Axes::new(axes.lateral.clone(), refined, axes.roll.clone(), axes.vertical.clone()),
            Direction::Roll => Axes::new(axes.lateral.clone(), axes.yaw.clone(), refined, axes.vertical.clone()),
            Direction::Vertical => Axes::new(axes.lateral.clone(), axes.yaw.clone(), axes.roll.clone(), refined),
        };
        if axes.bytes(sides) <= budget && axes.searchable() {
            return Some(axes);
        }
        // The last bytes go to as many lateral nodes as they hold.
        if direction != Direction::Lateral || count == 1 {
            return None;
        }
        count -= 1;
    }
}

/// The nodes with the middles of these intervals.
fn with_midpoints(nodes: &[f32], intervals: &[usize]) -> Vec<f32> {
    let middle = |&i: &usize| ((f64::from(nodes[i]) + f64::from(nodes[i + 1])) / 2.0) as f32;
    let mut refined: Vec<f32> = nodes.iter().copied().chain(intervals.iter().map(middle)).collect();
    refined.sort_by(f32::total_cmp);
    refined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn midpoints_land_between_their_neighbours() {
        assert_eq!(with_midpoints(&[0.0, 1.0, 4.0], &[1, 0]), [0.0, 0.5, 1.0, 2.5, 4.0]);
    }
}
