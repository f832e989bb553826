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
    let axes = [&grid.lateral_m, &grid.yaw_rad, &grid.roll_rad, &grid.vertical_m];
    let free = DIRECTIONS.into_iter().zip(axes).filter(|(_, axis)| axis.nodes == Nodes::Auto).map(|(d, _)| d).collect();
    let search = Search {
        free,
        budget: usize::try_from(grid.max_bytes).unwrap_or(usize::MAX),
        sides: compiler.pair.sides(),
        target: grid.max_force_error_p95,
        trials: trial::draw(recipe, compiler.pair),
    };
    let coarsest = search.candidate(compiler, Axes::coarsest(recipe, search.sides)?)?;
    let (best, bound) = search.grow(compiler, coarsest)?;
    Ok((best.table, bound))
}

/// A table and how it fared.
struct Candidate {
    table: Assembled,
    errors: Vec<f64>,
    score: f64,
    p95: f64,
}

/// What the search is given.
struct Search {
    free: Vec<Direction>,
    budget: usize,
    sides: usize,
    target: Option<f64>,
    trials: Vec<Trial>,
}

impl Search {
    fn candidate(&self, compiler: &mut Compiler<'_>, axes: Axes) -> Result<Candidate> {
        let table = compiler.assemble(axes)?;
        let errors = trial::errors(&table.image, &self.trials)?;
        let (score, figures) = trial::score(&errors);
        Ok(Candidate { table, errors, score, p95: figures.p95 })
    }

    /// Takes the refinement with the largest gain for its bytes, until none fits or is worth it.
    fn grow(&self, compiler: &mut Compiler<'_>, mut best: Candidate) -> Result<(Candidate, Bound)> {
        // Where the error is: its sum finds what is wrong everywhere, its square what is wrong in places.
        let weights: [fn(f64) -> f64; 2] = [|error| error, |error| error * error];
        loop {
            if self.target.is_some_and(|target| best.p95 <= target) {
                return Ok((best, Bound::Error));
            }
            let mut chosen: Option<(f64, Candidate)> = None;
            let mut fits = false;
            for (&direction, weight) in self.free.iter().flat_map(|d| weights.map(|weight| (d, weight))) {
                let Some(axes) = self.step(&best, direction, weight) else { continue };
                fits = true;
                let candidate = self.candidate(compiler, axes)?;
                let cost = libm::log(candidate.table.image.len() as f64 / best.table.image.len() as f64);
                let gain = (best.score - candidate.score) / cost;
                if chosen.as_ref().is_none_or(|(most, _)| gain > *most) {
                    chosen = Some((gain, candidate));
                }
            }
            match chosen {
                Some((gain, candidate)) if gain > LEAST_GAIN => best = candidate,
                _ => return Ok((best, if fits { Bound::Resolved } else { Bound::Bytes })),
            }
        }
    }

    /// Sum of the weights of the trials in each interval of an axis.
    fn blame(&self, nodes: &[f32], direction: Direction, weights: &[f64]) -> Vec<f64> {
        let mut blame = vec![0.0; nodes.len() - 1];
        for (trial, weight) in self.trials.iter().zip(weights) {
            let x = trial.coordinates[direction as usize];
            let above = nodes.partition_point(|&node| f64::from(node) <= x);
            blame[above.clamp(1, nodes.len() - 1) - 1] += weight;
        }
        blame
    }

    /// The axes after one refinement in a direction, where it fits the budget.
    fn step(&self, best: &Candidate, direction: Direction, weight: fn(f64) -> f64) -> Option<Axes> {
        let axes = &best.table.axes;
        let nodes = match direction {
            Direction::Lateral => &axes.lateral,
            Direction::Yaw => &axes.yaw,
            Direction::Roll => &axes.roll,
            Direction::Vertical => &axes.vertical,
        };
        let weights: Vec<f64> = best.errors.iter().map(|&error| weight(error)).collect();
        let blame = self.blame(nodes, direction, &weights);
        let mut order: Vec<usize> = (0..blame.len()).collect();
        order.sort_by(|&a, &b| blame[b].total_cmp(&blame[a]).then(a.cmp(&b)));
        let mut count = match direction {
            Direction::Lateral => ((nodes.len() as f64 * LATERAL_STEP).ceil() as usize).clamp(4, order.len().max(4)),
            _ => 1,
        };
        count = count.min(order.len());
        loop {
            let refined = with_midpoints(nodes, &order[..count]);
            let (lateral, yaw, roll, vertical) =
                (axes.lateral.clone(), axes.yaw.clone(), axes.roll.clone(), axes.vertical.clone());
            let axes = match direction {
                Direction::Lateral => Axes::new(refined, yaw, roll, vertical),
                Direction::Yaw => Axes::new(lateral, refined, roll, vertical),
                Direction::Roll => Axes::new(lateral, yaw, refined, vertical),
                Direction::Vertical => Axes::new(lateral, yaw, roll, refined),
            };
            if axes.bytes(self.sides) <= self.budget && axes.searchable() {
                return Some(axes);
            }
            // The last bytes go to as many lateral nodes as they hold.
            if count == 1 {
                return None;
            }
            count -= 1;
        }
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
