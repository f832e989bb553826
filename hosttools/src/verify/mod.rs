//! How good a table is: random poses against the direct solver (ARCHITECTURE.md, "How accuracy is measured").
//!
//! Lateral position, yaw and roll are uniform over the table, the load is log-uniform from 5 to 150 kN and the height
//! is what the direct solver needs to carry it as total normal force. The relative force error is
//!
//! ```text
//! |N_table - N_direct| / max(N_direct, 5 kN)
//! ```
//! on the wheel's total.

mod classify;
mod continuity;
mod explain;
mod findings;
mod forces;
mod joints;
mod load;
mod statistics;

use flangeway::{ContactTable, Coordinates, ErrorFigures, Pose, Side};
use indicatif::ParallelProgressIterator;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

pub use classify::{Class, Surroundings, surroundings};
pub use continuity::{Change, Continuity, Direction, continuity};
pub use explain::{Cause, Explanation, explain_direct, explain_table};
pub use findings::{Changes, ClassFigures, Findings, LargeChange, NearJoint, WorstPose, findings};
pub use joints::{Joint, joints};
pub use load::height_for_load;
pub use statistics::{Quantiles, quantile};

use crate::contact::{SLOTS, SlotState};
use crate::contacts::track_position;
use crate::pair::Pair;
use crate::progress;

/// Loads (N) that are drawn.
pub const LOADS: [f64; 2] = [5e3, 150e3];
/// Share of the total force from which on a contact counts as carrying.
pub(crate) const CARRYING: f64 = 0.02;

/// One sampled pose, by the direct solver and by the table.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// The wheel.
    pub side: Side,
    /// The canonical pose.
    pub pose: Pose,
    /// Its table coordinates.
    pub coordinates: Coordinates,
    /// Total normal force by the direct solver (N).
    pub direct: f64,
    /// Total normal force by the table (N).
    pub table: f64,
    /// Direct slots.
    pub slots: [SlotState; SLOTS],
    /// Largest position error over contacts that carry force in both (m).
    pub position: f64,
    /// Largest angle error of those (rad).
    pub angle: f64,
    /// Largest relative error of their semi-axes.
    pub semi_axes: f64,
    /// Whether table and solver have a different number of carrying contacts.
    pub other_count: bool,
}

impl Sample {
    /// |N_table - N_direct| / max(N_direct, 5 kN)
    pub fn force_error(&self) -> f64 {
        (self.table - self.direct).abs() / self.direct.max(LOADS[0])
    }
}

/// Error figures over a set of samples.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Report {
    /// Poses drawn.
    pub samples: usize,
    /// Seed of the drawing.
    pub seed: u64,
    /// Bytes of the table.
    pub table_bytes: usize,
    /// Relative force error of the wheel's total.
    pub normal_force: Quantiles,
    /// Position error over carrying contacts (m).
    pub position_m: Quantiles,
    /// Contact angle error over carrying contacts (rad).
    pub angle_rad: Quantiles,
    /// Relative error of the semi-axes over carrying contacts.
    pub semi_axes: Quantiles,
    /// Share of poses with a different number of carrying contacts.
    pub other_count: f64,
    /// Largest relative change of the table's total force over a step of 10 nm or 10 nrad.
    pub continuity: f64,
    /// The same of the direct solver.
    pub continuity_direct: f64,
}

impl Report {
    /// The figures that a compiler writes into the header.
    pub fn figures(&self) -> ErrorFigures {
        let force = &self.normal_force;
        ErrorFigures {
            samples: u32::try_from(self.samples).unwrap_or(u32::MAX),
            seed: self.seed,
            force_rms: force.rms as f32,
            force_median: force.median as f32,
            force_p95: force.p95 as f32,
            force_p99: force.p99 as f32,
            force_max: force.max as f32,
            continuity: self.continuity as f32,
        }
    }
}

/// Draws poses and compares the table with the direct solver on one side.
pub fn sample(table: &ContactTable<'_>, pair: &Pair, side: Side, count: usize, seed: u64) -> Vec<Sample> {
    let bar = progress::bar(count as u64, "verifying");
    let draw = |index: usize| draw(table, pair, side, seed, index);
    (0..count).into_par_iter().progress_with(bar).filter_map(draw).collect()
}

/// Uniform draws of one sample: a stream of its own for each, so that the order of work does not matter.
pub(crate) fn stream(seed: u64, index: usize) -> impl FnMut([f64; 2]) -> f64 {
    let mut seed_bytes = [0; 32];
    seed_bytes[..8].copy_from_slice(&seed.to_le_bytes());
    seed_bytes[8..16].copy_from_slice(&(index as u64).to_le_bytes());
    let mut generator = Pcg64::from_seed(seed_bytes);
    for _ in 0..4 {
        let _: u64 = generator.random();
    }
    move |[low, high]: [f64; 2]| low + (high - low) * generator.random::<f64>()
}

fn draw(table: &ContactTable<'_>, pair: &Pair, side: Side, seed: u64, index: usize) -> Option<Sample> {
    let mut uniform = stream(seed, index);
    let range = |name| <[f64; 2]>::from(table.axis(name).range());
    let (lateral, yaw, roll_offset) = (
        uniform(range(flangeway::AxisName::Lateral)),
        uniform(range(flangeway::AxisName::Yaw)),
        uniform(range(flangeway::AxisName::RollOffset)),
    );
    let load = libm::exp(uniform(LOADS.map(libm::log)));
    let mut coordinates = Coordinates { lateral, yaw, roll_offset, vertical: 0.0 };
    let geometry = pair.body(side).wheel().geometry();
    let mut pose = table.rigid(side).pose(geometry, &coordinates);
    let mut column = pair.column(side, &pose);
    let vertical = height_for_load(&mut column, load)?;
    coordinates.vertical += vertical - pose.vertical;
    pose.vertical = vertical;
    let slots = column.slots(vertical);
    Some(compare(table, pair, side, pose, coordinates, slots))
}

/// Compares one pose; `slots` are the direct solver's.
fn compare(
    table: &ContactTable<'_>,
    pair: &Pair,
    side: Side,
    pose: Pose,
    coordinates: Coordinates,
    slots: [SlotState; SLOTS],
) -> Sample {
    // The canonical pose is a pose of the right wheel; the left wheel's is its mirror.
    let sign = side.sign();
    let found = forces::looked_up(table, side, &pose);
    let direct: f64 = slots.iter().map(SlotState::normal_force).sum();
    let total = f64::from(found.total_normal_force());
    let mut sample = Sample {
        side,
        pose,
        coordinates,
        direct,
        table: total,
        slots,
        position: 0.0,
        angle: 0.0,
        semi_axes: 0.0,
        other_count: false,
    };
    let carrying = slots.iter().filter(|s| s.normal_force() > CARRYING * direct).count();
    sample.other_count = carrying != found.iter().filter(|c| f64::from(c.normal_force) > CARRYING * total).count();
    for contact in found.iter().filter(|c| f64::from(c.normal_force) > CARRYING * total) {
        let state = &slots[contact.slot.index()];
        if state.normal_force() <= CARRYING * direct {
            continue;
        }
        let p = track_position(pair, side, &pose, state);
        let q = [contact.position.x, contact.position.y, contact.position.z].map(f64::from);
        let distance = (p[0] - q[0]).powi(2) + (p[1] - sign * q[1]).powi(2) + (p[2] - q[2]).powi(2);
        sample.position = sample.position.max(distance.sqrt());
        sample.angle = sample.angle.max((sign * f64::from(contact.angle) - state.angle).abs());
        let root = state.indentation.sqrt();
        for (got, truth) in contact.semi_axes.iter().zip([state.semi_axis_x, state.semi_axis_y]) {
            sample.semi_axes = sample.semi_axes.max((f64::from(*got) / (truth * root) - 1.0).abs());
        }
    }
    sample
}

/// Everything measured of a table.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The figures.
    pub report: Report,
    /// The samples behind the errors.
    pub samples: Vec<Sample>,
    /// The largest changes behind the continuity figures.
    pub continuity: Continuity,
}

/// The whole comparison of a table, on every side that has data of its own: `count` poses and `lines` lines.
pub fn measure(table: &ContactTable<'_>, bytes: usize, pair: &Pair, count: usize, lines: usize, seed: u64) -> Measured {
    let mut samples = Vec::new();
    let mut changes = Continuity::default();
    let sides = table.header().sides();
    for side in Side::ALL.into_iter().take(sides) {
        samples.extend(sample(table, pair, side, count / sides, seed));
        changes.join(continuity(table, pair, side, lines / sides, seed));
    }
    let of = |value: fn(&Sample) -> f64| Quantiles::of(samples.iter().map(value).collect());
    let report = Report {
        samples: samples.len(),
        seed,
        table_bytes: bytes,
        normal_force: of(Sample::force_error),
        position_m: of(|s| s.position),
        angle_rad: of(|s| s.angle),
        semi_axes: of(|s| s.semi_axes),
        other_count: samples.iter().filter(|s| s.other_count).count() as f64 / samples.len().max(1) as f64,
        continuity: changes.worst_of_table(),
        continuity_direct: changes.worst_of_direct(),
    };
    Measured { report, samples, continuity: changes }
}

/// As [`measure`], without the changes behind the continuity figures.
pub fn report(
    table: &ContactTable<'_>,
    bytes: usize,
    pair: &Pair,
    count: usize,
    lines: usize,
    seed: u64,
) -> (Report, Vec<Sample>) {
    let Measured { report, samples, .. } = measure(table, bytes, pair, count, lines, seed);
    (report, samples)
}
