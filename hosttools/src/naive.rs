//! A naive table, for comparison only: the paper's coordinates and storage at the bytes of a table of ours. Nothing
//! but the report of `verify` uses it.
//!
//! What it takes from the paper (section 4): nodes are uniform over raw (y, yaw, z, roll) of the wheelset; windows of
//! z and roll are centred on the rigid contact of the wheelset at (y, yaw); the indentation is unsigned, zero without
//! contact; contacts are the first, second and third as they are found along the profile; everything is interpolated
//! linearly but N, a, b, which are rebuilt from C, K, K'; a node takes 60 bytes.
//!
//! Where the paper leaves a choice it is given the better of the two: a pose is looked up by its distance from the
//! *interpolated* rigid contact, numbers are single precision though 60 bytes would hold half of them, and windows,
//! proportions of the node counts and the coefficients beside a missing contact are tried and the best are taken.

use flangeway::{Pose, Side};
use rayon::prelude::*;

use crate::contact::SLOTS;
use crate::pair::Pair;
use crate::rigid;
use crate::verify::{LOADS, Quantiles, Sample};
use crate::{progress, verify};

/// Bytes of a node, as in the paper.
pub const NODE: usize = 60;
/// Nodes of the paper's table: y, yaw, z, roll.
pub const PAPER: [usize; 4] = [121, 9, 25, 21];
/// Shares of the poses that the tried windows of z and roll hold.
const COVERED: [f64; 3] = [1.0, 0.995, 0.98];
/// Factor by which an axis grows or shrinks against the others from one trial to the next, and most rounds of that.
const GROWTH: f64 = 1.35;
const ROUNDS: usize = 6;
/// Share of the roll window that counts as close to the rigid roll.
const CLOSE: f64 = 0.1;
/// Bytes from which on the proportions are searched with these many only, and then scaled up.
const SEARCHED: usize = 1 << 20;

/// What a node stores of a contact for the force: indentation δ (m) and C (N m^-1.5). Position, angle, ellipse and
/// curvatures would fill the rest of its bytes.
type Stored = [[f32; 2]; SLOTS];

/// The design of a naive table.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Design {
    /// Nodes along y, yaw, z, roll.
    pub nodes: [usize; 4],
    /// Ranges of y (m), of yaw (rad), and of z (m) and roll (rad) about the rigid contact.
    pub ranges: [[f64; 2]; 4],
    /// Share of the poses that the windows of z and roll were made for.
    pub covered: f64,
    /// Whether a node without a contact takes C from the next node above that has one, instead of zero.
    pub borrowed: bool,
}

/// The errors of the best naive table that was found.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Naive {
    /// Its design.
    pub design: Design,
    /// Bytes at 60 a node.
    pub bytes: usize,
    /// Tables tried.
    pub trials: usize,
    /// Share of the poses outside its windows.
    pub outside: f64,
    /// Relative force error over the same poses.
    pub normal_force: Quantiles,
}

/// How many times smaller the errors of a table of ours are.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Factor {
    /// Root mean square.
    pub rms: f64,
    /// Median.
    pub median: f64,
    /// 95 % quantile.
    pub p95: f64,
    /// 99 % quantile.
    pub p99: f64,
}

impl Factor {
    /// Errors of the naive table over ours.
    pub fn of(naive: &Quantiles, ours: &Quantiles) -> Self {
        let ratio = |a: f64, b: f64| a / b.max(f64::MIN_POSITIVE);
        Self {
            rms: ratio(naive.rms, ours.rms),
            median: ratio(naive.median, ours.median),
            p95: ratio(naive.p95, ours.p95),
            p99: ratio(naive.p99, ours.p99),
        }
    }
}

/// Uniform nodes over a range.
#[derive(Debug, Clone, Copy)]
struct Even {
    range: [f64; 2],
    nodes: usize,
}

impl Even {
    fn at(&self, i: usize) -> f64 {
        self.range[0] + (self.range[1] - self.range[0]) * i as f64 / (self.nodes - 1) as f64
    }

    /// Cell, and position in it, clamped.
    fn locate(&self, x: f64) -> (usize, f64) {
        let place = (x - self.range[0]) / (self.range[1] - self.range[0]) * (self.nodes - 1) as f64;
        let cell = (place.max(0.0) as usize).min(self.nodes - 2);
        (cell, (place - cell as f64).clamp(0.0, 1.0))
    }
}

/// A naive table of one wheel.
struct Table {
    axes: [Even; 4],
    /// Rigid z and roll by y and yaw.
    rigid: Vec<[f64; 2]>,
    /// By y, yaw, roll, z.
    nodes: Vec<Stored>,
}

/// Rigid z and roll of the wheelset at a canonical y and yaw of a side.
fn at_rest(pair: &Pair, side: Side, lateral: f64, yaw: f64) -> Option<[f64; 2]> {
    let sign = side.sign();
    let found = rigid::two_wheels(pair, sign * lateral, sign * yaw)?;
    Some([found.vertical, sign * found.roll])
}

impl Table {
    fn compile(pair: &Pair, side: Side, design: &Design) -> Self {
        let axes = [0, 1, 2, 3].map(|k| Even { range: design.ranges[k], nodes: design.nodes[k] });
        let [y, yaw, z, roll] = &axes;
        let plane: Vec<(f64, f64)> =
            (0..y.nodes * yaw.nodes).map(|i| (y.at(i / yaw.nodes), yaw.at(i % yaw.nodes))).collect();
        let rigid: Vec<Option<[f64; 2]>> = plane.par_iter().map(|&(y, yaw)| at_rest(pair, side, y, yaw)).collect();
        let columns = |(&(lateral, yaw), rest): (&(f64, f64), &Option<[f64; 2]>)| {
            let mut nodes = Vec::with_capacity(roll.nodes * z.nodes);
            for l in 0..roll.nodes {
                let [vertical, turn] = rest.unwrap_or_default();
                let pose = Pose { lateral, yaw, vertical, roll: turn + roll.at(l) };
                let mut column = pair.column(side, &pose);
                let stored = |k: usize| rest.map_or([[0.0; 2]; SLOTS], |_| store(column.slots(vertical + z.at(k))));
                let mut column: Vec<Stored> = (0..z.nodes).map(stored).collect();
                if design.borrowed {
                    borrow(&mut column);
                }
                nodes.extend(column);
            }
            nodes
        };
        let nodes = plane.par_iter().zip(&rigid).flat_map_iter(columns).collect();
        let rigid = rigid.into_iter().map(Option::unwrap_or_default).collect();
        Self { axes, rigid, nodes }
    }

    /// Total normal force (N) of a canonical pose, and whether it lies in the windows.
    fn force(&self, pose: &Pose) -> (f64, bool) {
        let [y, yaw, z, roll] = &self.axes;
        let ((i, u), (j, v)) = (y.locate(pose.lateral), yaw.locate(pose.yaw));
        let plane = [
            (i, j, (1.0 - u) * (1.0 - v)),
            (i, j + 1, (1.0 - u) * v),
            (i + 1, j, u * (1.0 - v)),
            (i + 1, j + 1, u * v),
        ];
        let mut rest = [0.0; 2];
        for (i, j, weight) in plane {
            let node = self.rigid[i * yaw.nodes + j];
            rest = [rest[0] + weight * node[0], rest[1] + weight * node[1]];
        }
        let offsets = [pose.vertical - rest[0], pose.roll - rest[1]];
        let ((k, s), (l, t)) = (z.locate(offsets[0]), roll.locate(offsets[1]));
        let mut sum = [[0.0; 2]; SLOTS];
        for (i, j, weight) in plane {
            for (l, weight) in [(l, weight * (1.0 - t)), (l + 1, weight * t)] {
                for (k, weight) in [(k, weight * (1.0 - s)), (k + 1, weight * s)] {
                    let node = &self.nodes[((i * yaw.nodes + j) * roll.nodes + l) * z.nodes + k];
                    for (sum, stored) in sum.as_flattened_mut().iter_mut().zip(node.as_flattened()) {
                        *sum += weight * f64::from(*stored);
                    }
                }
            }
        }
        // N = C δ^1.5, rebuilt
        let force = sum.iter().map(|[delta, c]| c * delta * delta.sqrt()).sum();
        let inside = |x: f64, axis: &Even| axis.range[0] <= x && x <= axis.range[1];
        (force, inside(offsets[0], z) && inside(offsets[1], roll))
    }
}

/// Contacts in the order in which they are found along the profile.
fn store(slots: [crate::contact::SlotState; SLOTS]) -> Stored {
    let mut stored = [[0.0; 2]; SLOTS];
    let loaded = slots.iter().filter(|slot| slot.normal_force() > 0.0);
    for (place, slot) in stored.iter_mut().zip(loaded) {
        *place = [slot.indentation as f32, slot.stiffness as f32];
    }
    stored
}

/// Gives nodes without a contact the C of the next one below the wheel that has it.
fn borrow(column: &mut [Stored]) {
    for contact in 0..SLOTS {
        let mut next = 0.0;
        for node in column.iter_mut().rev() {
            if node[contact][1] > 0.0 {
                next = node[contact][1];
            } else {
                node[contact][1] = next;
            }
        }
    }
}

/// Node counts in these proportions that fit the bytes, at least 3 an axis.
fn counts(weights: [f64; 4], bytes: usize) -> [usize; 4] {
    let most = bytes / NODE;
    let of = |scale: f64| weights.map(|w| ((scale * w).floor() as usize).max(3));
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle).iter().map(|&n| n as f64).product::<f64>() <= most as f64 { low = middle } else { high = middle }
    }
    let mut nodes = of(low);
    // What is left goes to y.
    nodes[0] = (most / (nodes[1] * nodes[2] * nodes[3])).max(3);
    nodes
}

/// What the search compares: all four figures count alike.
fn score(q: &Quantiles) -> f64 {
    [q.rms, q.median, q.p95, q.p99].map(|x| libm::log(x.max(1e-12))).iter().sum()
}

/// Ranges that hold the samples: y and yaw all, z and roll about the rigid contact a share of them.
fn ranges(samples: &[Sample], offsets: &[[f64; 2]], covered: f64) -> [[f64; 2]; 4] {
    let quantiles = |mut values: Vec<f64>, covered: f64| {
        values.sort_by(f64::total_cmp);
        let tail = 0.5 * (1.0 - covered);
        [verify::quantile(&values, tail), verify::quantile(&values, 1.0 - tail)]
    };
    [
        quantiles(samples.iter().map(|s| s.pose.lateral).collect(), 1.0),
        quantiles(samples.iter().map(|s| s.pose.yaw).collect(), 1.0),
        quantiles(offsets.iter().map(|o| o[0]).collect(), covered),
        quantiles(offsets.iter().map(|o| o[1]).collect(), covered),
    ]
}

/// What naive tables are measured with.
struct Search<'a> {
    pair: &'a Pair,
    samples: &'a [Sample],
    /// Heights (m) and rolls (rad) of the samples about the rigid contact.
    offsets: Vec<[f64; 2]>,
    sides: Vec<Side>,
    bar: indicatif::ProgressBar,
    trials: usize,
}

/// Proportions and windows of a naive table, whatever its bytes.
#[derive(Debug, Clone, Copy)]
struct Shape {
    weights: [f64; 4],
    covered: f64,
    borrowed: bool,
}

impl Search<'_> {
    fn measure(&mut self, shape: Shape, bytes: usize) -> Naive {
        self.trials += 1;
        self.bar.inc(1);
        let Shape { weights, covered, borrowed } = shape;
        let nodes = counts(weights, bytes / self.sides.len());
        let design = Design { nodes, ranges: ranges(self.samples, &self.offsets, covered), covered, borrowed };
        let tables: Vec<Table> = self.sides.iter().map(|&side| Table::compile(self.pair, side, &design)).collect();
        let error = |s: &Sample| {
            let table = tables.get(s.side as usize).unwrap_or(&tables[0]);
            let (force, inside) = table.force(&s.pose);
            ((force - s.direct).abs() / s.direct.max(LOADS[0]), inside)
        };
        let errors: Vec<(f64, bool)> = self.samples.par_iter().map(error).collect();
        let outside = errors.iter().filter(|(_, inside)| !inside).count() as f64 / errors.len() as f64;
        let normal_force = Quantiles::of(errors.into_iter().map(|(error, _)| error).collect());
        let bytes = NODE * nodes.iter().product::<usize>() * self.sides.len();
        Naive { design, bytes, trials: self.trials, outside, normal_force }
    }

    /// The best of some shapes.
    fn best(&mut self, shapes: impl Iterator<Item = Shape>, bytes: usize) -> Option<(Shape, Naive)> {
        let measured = shapes.map(|shape| (shape, self.measure(shape, bytes)));
        measured.reduce(|a, b| if score(&b.1.normal_force) < score(&a.1.normal_force) { b } else { a })
    }
}

/// A naive table beside ours.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Beside {
    /// Which poses.
    pub poses: &'static str,
    /// How many.
    pub samples: usize,
    /// The naive table, made for these poses alone.
    pub naive: Naive,
    /// Relative force error of our table, made for all.
    pub ours: Quantiles,
    /// How many times smaller ours is.
    pub factor: Factor,
}

/// Compares naive tables of at most these bytes with the table that these samples measured: over all samples; over
/// those that the tread carries alone; and over those of them that are close to the rigid roll, where raw coordinates
/// are at their best. Every time the naive table is made for just these poses.
pub fn compare(pair: &Pair, samples: &[Sample], bytes: usize) -> Vec<Beside> {
    let widest = samples.iter().map(|s| s.coordinates.roll_offset.abs()).fold(0.0, f64::max);
    let tread = |s: &Sample| s.slots[0].normal_force() >= s.direct;
    let close = |s: &Sample| tread(s) && s.coordinates.roll_offset.abs() < CLOSE * widest;
    let beside = |poses: &'static str, chosen: &dyn Fn(&Sample) -> bool| {
        let samples: Vec<Sample> = samples.iter().filter(|s| chosen(s)).copied().collect();
        let naive = best(pair, &samples, bytes)?;
        let ours = Quantiles::of(samples.iter().map(Sample::force_error).collect());
        let factor = Factor::of(&naive.normal_force, &ours);
        Some(Beside { poses, samples: samples.len(), naive, ours, factor })
    };
    let all = beside("all poses", &|_| true);
    let on_tread = beside("poses on the tread", &tread);
    let near = beside("poses on the tread, close to the rigid roll", &close);
    [all, on_tread, near].into_iter().flatten().collect()
}

/// Compiles naive tables of at most these bytes and measures them on these samples: the best of them. `None` without
/// samples whose wheelset rests on the rails.
fn best(pair: &Pair, samples: &[Sample], bytes: usize) -> Option<Naive> {
    let offset = |s: &Sample| {
        let [vertical, roll] = at_rest(pair, s.side, s.pose.lateral, s.pose.yaw)?;
        Some([s.pose.vertical - vertical, s.pose.roll - roll])
    };
    let offsets: Vec<[f64; 2]> = samples.par_iter().filter_map(offset).collect();
    if offsets.is_empty() {
        return None;
    }
    let most = COVERED.len() * 2 + ROUNDS * PAPER.len() * 2;
    let sides = Side::ALL.into_iter().take(pair.sides()).collect();
    let bar = progress::bar(most as u64, "naive tables");
    let mut search = Search { pair, samples, offsets, sides, bar, trials: 0 };
    let few = bytes.min(SEARCHED);
    let weights = PAPER.map(|n| n as f64);
    let windows = COVERED.into_iter().flat_map(|covered| [false, true].map(|borrowed| (covered, borrowed)));
    let shapes = windows.map(|(covered, borrowed)| Shape { weights, covered, borrowed });
    let (mut shape, mut best) = search.best(shapes, few)?;
    for _ in 0..ROUNDS {
        // The axis whose growth at the cost of the others, or the reverse, helps most.
        let steps = (0..PAPER.len()).flat_map(|axis| [GROWTH, 1.0 / GROWTH].map(|by| (axis, by)));
        let shapes = steps.map(|(axis, by)| {
            let mut grown = shape;
            grown.weights[axis] *= by;
            grown
        });
        let (grown, found) = search.best(shapes, few)?;
        if score(&found.normal_force) >= score(&best.normal_force) {
            break;
        }
        (shape, best) = (grown, found);
    }
    if bytes > few {
        (_, best) = search.best([shape, Shape { weights, ..shape }].into_iter(), bytes)?;
    }
    search.bar.finish_and_clear();
    Some(Naive { trials: search.trials, ..best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn node_counts_fit_the_bytes_in_the_papers_proportions() {
        assert_eq!(counts(PAPER.map(|n| n as f64), NODE * PAPER.iter().product::<usize>()), PAPER);
        for bytes in [20_000, 1 << 20, 1 << 25] {
            let nodes = counts(PAPER.map(|n| n as f64), bytes);
            let used = NODE * nodes.iter().product::<usize>();
            assert!(used <= bytes && 10 * used > 6 * bytes, "{bytes}: {nodes:?}");
        }
    }

    #[test]
    fn a_place_on_an_axis() {
        let axis = Even { range: [-1.0, 1.0], nodes: 5 };
        assert_eq!([axis.locate(-2.0), axis.locate(0.25), axis.locate(1.0)], [(0, 0.0), (2, 0.5), (3, 1.0)]);
        assert_eq!([axis.at(0), axis.at(4)], [-1.0, 1.0]);
    }

    #[test]
    fn missing_contacts_borrow_from_below() {
        let mut column = [0.0, 0.0, 3.0, 0.0].map(|c| [[0.0, c], [0.0; 2], [0.0; 2]]);
        borrow(&mut column);
        assert_eq!(column.map(|node| node[0][1]), [3.0, 3.0, 3.0, 0.0]);
    }
}
