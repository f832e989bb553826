//! Where the nodes go: the compiler refines the axis that buys most, until the bytes are spent.
//!
//! Every candidate is a real table, read by the real kernel and judged on poses whose force is known, so the search
//! minimises what `verify` measures. It depends on the recipe alone and starts and ends the same on every machine.

use super::Compiler;
use super::axes::{Axes, BINS_A_NODE};
use super::trial::{self, Trial};
use crate::error::Result;
use crate::recipe::{NodeValues, Nodes, Recipe};

/// What ended the refinement of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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

/// Share of an axis' nodes that one step adds, and the fewest lateral ones.
const STEP: f64 = 0.12;
const LEAST_LATERAL_STEP: usize = 4;
/// A step must improve the score by this much for each unit of the logarithm of bytes.
const LEAST_GAIN: f64 = 0.02;
/// Steps in a row without that gain before the search gives up: a kink of the force may need two or three nodes.
const PATIENCE: usize = 7;
/// How much less the 95 % quantile of fitted node values can be than that of sampled ones, which the search looks at.
const FIT_GAIN: f64 = 2.5;

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
pub(super) fn refine(recipe: &Recipe, compiler: &mut Compiler<'_>) -> Result<(Axes, Bound)> {
    let grid = &recipe.grid;
    let axes = [&grid.lateral_m, &grid.yaw_rad, &grid.roll_rad, &grid.vertical_m];
    let free = DIRECTIONS.into_iter().zip(axes).filter(|(_, axis)| axis.nodes == Nodes::Auto).map(|(d, _)| d).collect();
    let search = Search {
        free,
        budget: usize::try_from(grid.max_bytes).unwrap_or(usize::MAX),
        sides: compiler.pair.sides(),
        target: grid.max_force_error_p95,
        node_values: grid.node_values,
        trials: trial::draw(recipe, compiler.pair),
    };
    let coarsest = search.candidate(compiler, Axes::coarsest(recipe, search.sides)?)?;
    search.grow(compiler, coarsest)
}

/// Axes, and how a table of them fared whose node values are sampled, not fitted: a fit takes seconds and gains about
/// the same for all.
struct Candidate {
    axes: Axes,
    bytes: f64,
    errors: Vec<f64>,
    score: f64,
    p95: f64,
}

impl Candidate {
    /// Gain in score over another candidate for each unit of the logarithm of bytes.
    fn gain_over(&self, other: &Self) -> f64 {
        (other.score - self.score) / libm::log(self.bytes / other.bytes)
    }
}

/// What the search is given.
struct Search {
    free: Vec<Direction>,
    budget: usize,
    sides: usize,
    target: Option<f64>,
    node_values: NodeValues,
    trials: Vec<Trial>,
}

impl Search {
    fn candidate(&self, compiler: &mut Compiler<'_>, axes: Axes) -> Result<Candidate> {
        let table = compiler.assemble(axes, NodeValues::Sampled)?;
        let errors = trial::errors(&table.image, &self.trials)?;
        let (score, figures) = trial::score(&errors);
        // Not the bins: halving the finest interval doubles them, once, for all that is halved as finely later.
        let bytes = table.axes.bytes_at_nodes(self.sides) as f64;
        Ok(Candidate { axes: table.axes, bytes, errors, score, p95: figures.p95 })
    }

    /// Whether a table of these axes meets the error target.
    fn reaches_target(&self, compiler: &mut Compiler<'_>, candidate: &Candidate) -> Result<bool> {
        Ok(match (self.target, self.node_values) {
            (None, _) => false,
            (Some(target), NodeValues::Sampled) => candidate.p95 <= target,
            (Some(target), NodeValues::Fitted) => {
                candidate.p95 <= FIT_GAIN * target && {
                    let table = compiler.assemble(candidate.axes.clone(), NodeValues::Fitted)?;
                    trial::score(&trial::errors(&table.image, &self.trials)?).1.p95 <= target
                }
            }
        })
    }

    /// Refines step by step, each time what gains most for its bytes, and returns the best axes on the way: until the
    /// target is reached, no step fits the budget, or [`PATIENCE`] steps in a row have brought nothing.
    fn grow(&self, compiler: &mut Compiler<'_>, coarsest: Candidate) -> Result<(Axes, Bound)> {
        let (mut best, mut now, mut idle) = (None::<Candidate>, coarsest, 0);
        loop {
            if self.reaches_target(compiler, &now)? {
                return Ok((now.axes, Bound::Error));
            }
            let next = self.best_step(compiler, &now)?;
            let kept = match best {
                Some(best) if now.gain_over(&best) <= LEAST_GAIN => {
                    idle += 1;
                    best
                }
                _ => {
                    idle = 0;
                    now
                }
            };
            match next {
                None => return Ok((kept.axes, Bound::Bytes)),
                Some(_) if idle >= PATIENCE => return Ok((kept.axes, Bound::Resolved)),
                Some(next) => now = next,
            }
            best = Some(kept);
        }
    }

    /// The refinement that gains most for its bytes, of those that fit.
    fn best_step(&self, compiler: &mut Compiler<'_>, now: &Candidate) -> Result<Option<Candidate>> {
        // Where the error is: its sum finds what is wrong everywhere, its square what is wrong in places.
        let weights: [fn(f64) -> f64; 2] = [|error| error, |error| error * error];
        let mut chosen: Option<Candidate> = None;
        for (&direction, weight) in self.free.iter().flat_map(|d| weights.map(|weight| (d, weight))) {
            let Some(axes) = self.step(now, direction, weight) else { continue };
            let candidate = self.candidate(compiler, axes)?;
            if chosen.as_ref().is_none_or(|chosen| candidate.gain_over(now) > chosen.gain_over(now)) {
                chosen = Some(candidate);
            }
        }
        Ok(chosen)
    }

    /// Sum of the weights of the trials in each interval of an axis.
    fn blame(&self, nodes: &[f64], direction: Direction, weights: &[f64]) -> Vec<f64> {
        let mut blame = vec![0.0; nodes.len() - 1];
        for (trial, weight) in self.trials.iter().zip(weights) {
            let x = trial.coordinates[direction as usize];
            let above = nodes.partition_point(|&node| node <= x);
            blame[above.clamp(1, nodes.len() - 1) - 1] += weight;
        }
        blame
    }

    /// The axes after one refinement in a direction, where it fits the budget.
    fn step(&self, now: &Candidate, direction: Direction, weight: fn(f64) -> f64) -> Option<Axes> {
        let axes = &now.axes;
        let nodes = match direction {
            Direction::Lateral => &axes.lateral,
            Direction::Yaw => &axes.yaw,
            Direction::Roll => &axes.roll,
            Direction::Vertical => &axes.vertical,
        };
        let weights: Vec<f64> = now.errors.iter().map(|&error| weight(error)).collect();
        let blame = self.blame(nodes, direction, &weights);
        // Halves too narrow for the kernel's bins are left alone.
        let narrowest = (nodes[nodes.len() - 1] - nodes[0]) / (BINS_A_NODE * nodes.len()) as f64;
        let mut order: Vec<usize> = (0..blame.len()).filter(|&i| 0.5 * (nodes[i + 1] - nodes[i]) > narrowest).collect();
        order.sort_by(|&a, &b| blame[b].total_cmp(&blame[a]).then(a.cmp(&b)));
        let share = (nodes.len() as f64 * STEP) as usize;
        let mut count = match direction {
            Direction::Lateral => (share + 1).max(LEAST_LATERAL_STEP),
            _ => share.max(1),
        };
        count = count.min(order.len());
        while count > 0 {
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
            // The last bytes go to as many nodes as they hold.
            count -= 1;
        }
        None
    }
}

/// The nodes with the middles of these intervals.
fn with_midpoints(nodes: &[f64], intervals: &[usize]) -> Vec<f64> {
    let middle = |&i: &usize| (nodes[i] + nodes[i + 1]) / 2.0;
    let mut refined: Vec<f64> = nodes.iter().copied().chain(intervals.iter().map(middle)).collect();
    refined.sort_by(f64::total_cmp);
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
