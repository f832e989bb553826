//! What a report of `verify` says beyond the figures: errors by class of cell, the worst poses, the largest changes.

use flangeway::{ContactTable, SLOTS, Slot};
use serde::Serialize;

use super::classify::{Class, Surroundings, surroundings};
use super::continuity::{Change, Direction};
use super::explain::{Cause, explain_direct, explain_table};
use super::joints::Joint;
use super::{Measured, Quantiles, Sample, forces};
use crate::pair::Pair;

/// Worst poses that are told.
const WORST: usize = 20;

/// Errors of the samples of one class.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ClassFigures {
    /// The class.
    pub class: Class,
    /// Samples in it.
    pub samples: usize,
    /// Its share of the sum of all squared errors.
    pub share_of_squares: f64,
    /// Relative force error.
    pub normal_force: Quantiles,
}

/// The joint nearest to a contact.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NearJoint {
    /// Lateral coordinate (m): of a wheel its profile coordinate, of a rail in the track frame.
    pub lateral_m: f64,
    /// Distance from the contact along the profile (m), positive towards the field side.
    pub distance_m: f64,
    /// Mean curvature (1/m) on the flange or gauge side and on the field side.
    pub curvature_per_m: [f64; 2],
}

/// One of the worst poses and what happens there.
#[derive(Debug, Clone, Serialize)]
pub struct WorstPose {
    /// Wheel.
    pub side: String,
    /// Relative force error.
    pub error: f64,
    /// Lateral displacement of the tape-circle point (m).
    pub lateral_m: f64,
    /// Yaw (rad).
    pub yaw_rad: f64,
    /// Roll about the rigid one (rad).
    pub roll_offset_rad: f64,
    /// Height about the rigid one (m).
    pub vertical_m: f64,
    /// The canonical pose: y (m), yaw (rad), z (m), roll (rad).
    pub pose: [f64; 4],
    /// Forces of the slots by the direct solver (N).
    pub direct_n: [f64; SLOTS],
    /// Forces of the slots by the table (N).
    pub table_n: [f64; SLOTS],
    /// Class of the cell.
    pub class: Class,
    /// Loaded peaks of the overlap.
    pub peaks: usize,
    /// Least share of its force that a peak keeps beside another of its zone.
    pub least_share: f64,
    /// Slots that come into contact inside the cell.
    pub onset: Vec<String>,
    /// Slots that lean on their edge at some corners of the cell.
    pub leaning: Vec<String>,
    /// Lateral width of the cell (m).
    pub lateral_width_m: f64,
    /// Nearest joint of the wheel.
    pub wheel_joint: Option<NearJoint>,
    /// Nearest joint of the rail.
    pub rail_joint: Option<NearJoint>,
    /// Whether the height is above the table's vertical axis, so that the indentation is extrapolated.
    pub beyond_vertical_axis: bool,
}

/// One of the largest changes of force over a tiny step.
#[derive(Debug, Clone, Serialize)]
pub struct LargeChange {
    /// |ΔN| / N.
    pub relative: f64,
    /// Force (N) before the step.
    pub force_n: f64,
    /// What was stepped.
    pub direction: Direction,
    /// Lateral displacement of the tape-circle point (m).
    pub lateral_m: f64,
    /// Yaw (rad).
    pub yaw_rad: f64,
    /// Roll about the rigid one (rad).
    pub roll_offset_rad: f64,
    /// The canonical pose before the step: y (m), yaw (rad), z (m), roll (rad).
    pub pose: [f64; 4],
    /// Whether the change stays when the step is made smaller.
    pub jump: bool,
    /// The cause that the direct solver shows.
    pub cause: Cause,
    /// Loaded peaks before and after.
    pub peaks: [usize; 2],
    /// How many times faster than the step the contact point moves along the wheel.
    pub speed: f64,
    /// Largest change of a peak's share.
    pub share: f64,
    /// Wheel-profile coordinate of the contact (m).
    pub profile_m: f64,
}

/// The largest changes of force.
#[derive(Debug, Clone, Serialize)]
pub struct Changes {
    /// Lines drawn.
    pub lines: usize,
    /// Lines with different carrying slots at their ends.
    pub crossing: usize,
    /// Of the table.
    pub table: Vec<LargeChange>,
    /// Of the direct solver.
    pub direct: Vec<LargeChange>,
}

/// All of it.
#[derive(Debug, Clone, Serialize)]
pub struct Findings {
    /// Errors by class.
    pub classes: Vec<ClassFigures>,
    /// The worst poses, the worst first.
    pub worst: Vec<WorstPose>,
    /// The largest changes.
    pub changes: Changes,
    /// The surroundings of every sample.
    #[serde(skip)]
    pub surroundings: Vec<Surroundings>,
}

/// Looks into what was measured.
pub fn findings(table: &ContactTable<'_>, pair: &Pair, measured: &Measured) -> Findings {
    let samples = &measured.samples;
    let surroundings = surroundings(table, pair, samples);
    let all: f64 = samples.iter().map(|s| s.force_error().powi(2)).sum();
    let figures = |class: Class| {
        let of_class = samples.iter().zip(&surroundings).filter(|(_, around)| around.class == class);
        let errors: Vec<f64> = of_class.map(|(sample, _)| sample.force_error()).collect();
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        ClassFigures {
            class,
            samples: errors.len(),
            share_of_squares: if all > 0.0 { squares / all } else { 0.0 },
            normal_force: Quantiles::of(errors),
        }
    };
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by(|&a, &b| samples[b].force_error().total_cmp(&samples[a].force_error()).then(a.cmp(&b)));
    let worst = order.iter().take(WORST).map(|&i| worst(table, &samples[i], &surroundings[i])).collect();
    let continuity = &measured.continuity;
    let changes = Changes {
        lines: continuity.lines,
        crossing: continuity.crossing,
        table: continuity.table.iter().map(|c| large(c, explain_table(table, pair, c))).collect(),
        direct: continuity.direct.iter().map(|c| large(c, explain_direct(pair, c))).collect(),
    };
    Findings { classes: Class::ALL.map(figures).to_vec(), worst, changes, surroundings }
}

fn worst(table: &ContactTable<'_>, sample: &Sample, around: &Surroundings) -> WorstPose {
    let Sample { coordinates: at, pose, .. } = sample;
    let mut table_n = [0.0; SLOTS];
    for contact in &forces::looked_up(table, sample.side, pose) {
        table_n[contact.slot.index()] = f64::from(contact.normal_force);
    }
    let named = |is: [bool; SLOTS]| {
        Slot::ALL.into_iter().filter(|slot| is[slot.index()]).map(|slot| slot.to_string()).collect::<Vec<_>>()
    };
    let near = |(joint, distance): (Joint, f64)| NearJoint {
        lateral_m: joint.lateral,
        distance_m: distance,
        curvature_per_m: joint.curvature,
    };
    WorstPose {
        side: sample.side.to_string(),
        error: sample.force_error(),
        lateral_m: at.lateral,
        yaw_rad: at.yaw,
        roll_offset_rad: at.roll_offset,
        vertical_m: at.vertical,
        pose: [pose.lateral, pose.yaw, pose.vertical, pose.roll],
        direct_n: sample.slots.map(|slot| slot.normal_force()),
        table_n,
        class: around.class,
        peaks: around.peaks,
        least_share: around.least_share,
        onset: named(around.onset),
        leaning: named(around.leaning),
        lateral_width_m: around.lateral_width,
        wheel_joint: around.wheel_joint.map(near),
        rail_joint: around.rail_joint.map(near),
        beyond_vertical_axis: around.beyond,
    }
}

fn large(change: &Change, why: super::Explanation) -> LargeChange {
    let (at, [pose, _]) = (&change.coordinates, &change.poses);
    LargeChange {
        relative: change.relative,
        force_n: change.force[0],
        direction: change.direction,
        lateral_m: at.lateral,
        yaw_rad: at.yaw,
        roll_offset_rad: at.roll_offset,
        pose: [pose.lateral, pose.yaw, pose.vertical, pose.roll],
        jump: why.jump,
        cause: why.cause,
        peaks: why.peaks,
        speed: why.speed,
        share: why.share,
        profile_m: why.profile,
    }
}
