//! What happens where the force changes fast: a jump or a slope, and the cause as far as the direct solver shows it.

use flangeway::{ContactTable, Pose, Side};

use super::continuity::{Change, STEP};
use super::forces;
use crate::contact::Peak;
use crate::pair::Pair;

/// Halvings of the step, and the share of its change that has to be left for a jump.
const HALVINGS: usize = 6;
const LEFT: f64 = 0.5;
/// Shares of a peak that differ by more than this are told.
const SHARE: f64 = 1e-3;
/// From this many steps on, a contact point that moves over one is told.
const FAST: f64 = 20.0;

/// What makes the force change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The number of loaded peaks changes.
    Peaks,
    /// The share of a peak in its zone of interpenetration changes.
    Share,
    /// The contact point runs along the profile many times faster than the wheel moves: nearly conformal.
    Conformal,
    /// The stiffness changes while the peaks stay where they are.
    Stiffness,
    /// None of these: the force follows the indentation.
    Indentation,
}

impl Cause {
    /// The cause in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Peaks => "a peak of the overlap appears or vanishes under load",
            Self::Share => "the share of a peak beside another changes",
            Self::Conformal => "the contact point runs along nearly conformal profiles",
            Self::Stiffness => "the stiffness changes, the contact points do not move",
            Self::Indentation => "the force follows the indentation",
        }
    }
}

/// An explanation of one change, by the direct solver's peaks before and after the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explanation {
    /// Whether the change stays when the step is made smaller.
    pub jump: bool,
    /// What the direct solver shows.
    pub cause: Cause,
    /// Loaded peaks before and after.
    pub peaks: [usize; 2],
    /// The way of the contact point along the wheel over the step, in steps: how many times faster it runs.
    pub speed: f64,
    /// Largest change of a peak's share.
    pub share: f64,
    /// Wheel-profile coordinate (m) of the contact that changes most.
    pub profile: f64,
}

/// Explains a change of the table's force.
pub fn explain_table(table: &ContactTable<'_>, pair: &Pair, change: &Change) -> Explanation {
    explain(pair, change, |side, pose| forces::table(table, side, pose))
}

/// Explains a change of the direct solver's force.
pub fn explain_direct(pair: &Pair, change: &Change) -> Explanation {
    explain(pair, change, |side, pose| forces::direct(pair, side, pose))
}

fn explain(pair: &Pair, change: &Change, force: impl Fn(Side, &Pose) -> f64) -> Explanation {
    let side = change.side.unwrap_or(Side::Right);
    let jump = remains(change, |pose| force(side, pose));
    let loaded = |pose: &Pose| -> Vec<Peak> {
        let peaks = pair.column(side, pose).peaks(pose.vertical);
        peaks.into_iter().filter(|peak| peak.state.indentation > 0.0).collect()
    };
    let [before, after] = change.poses.each_ref().map(loaded);
    let peaks = [before.len(), after.len()];
    let carried = |peak: &Peak| peak.share * peak.state.normal_force();
    let strongest = before.iter().chain(&after).max_by(|a, b| carried(a).total_cmp(&carried(b)));
    let mut found = Explanation {
        jump,
        cause: Cause::Peaks,
        peaks,
        speed: 0.0,
        share: 0.0,
        profile: strongest.map_or(0.0, |peak| peak.point.wheel.s),
    };
    if peaks[0] != peaks[1] {
        return found;
    }
    let (mut most, mut stiffness) = (0.0, 0.0);
    for (a, b) in before.iter().zip(&after) {
        found.speed = found.speed.max((b.point.wheel.t - a.point.wheel.t).abs() / STEP);
        found.share = found.share.max((b.share - a.share).abs());
        let by = (carried(b) - carried(a)).abs();
        if by > most {
            (most, found.profile) = (by, a.point.wheel.s);
            stiffness = (b.state.stiffness / a.state.stiffness - 1.0).abs();
        }
    }
    found.cause = if found.speed > FAST {
        Cause::Conformal
    } else if found.share > SHARE {
        Cause::Share
    } else if stiffness > 0.5 * change.relative {
        Cause::Stiffness
    } else {
        Cause::Indentation
    };
    found
}

/// Whether most of the change is left in the smallest part of its step.
fn remains(change: &Change, force: impl Fn(&Pose) -> f64) -> bool {
    let [mut low, mut high] = change.poses;
    let (mut f_low, mut f_high) = (force(&low), force(&high));
    let whole = (f_high - f_low).abs();
    for _ in 0..HALVINGS {
        let middle = Pose {
            lateral: 0.5 * (low.lateral + high.lateral),
            yaw: 0.5 * (low.yaw + high.yaw),
            vertical: 0.5 * (low.vertical + high.vertical),
            roll: 0.5 * (low.roll + high.roll),
        };
        let f = force(&middle);
        if (f - f_low).abs() > (f_high - f).abs() { (high, f_high) = (middle, f) } else { (low, f_low) = (middle, f) }
    }
    whole > 0.0 && (f_high - f_low).abs() > LEFT * whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jumps_remain_and_slopes_do_not() {
        let change =
            Change { poses: [Pose::default(), Pose { lateral: STEP, ..Pose::default() }], ..Change::default() };
        assert!(remains(&change, |pose| if pose.lateral > 0.3 * STEP { 1.1e4 } else { 1e4 }));
        assert!(!remains(&change, |pose| 1e4 * (1.0 + 1e5 * pose.lateral)));
        assert!(!remains(&change, |_| 1e4));
    }
}
