//! Does the force jump? The largest relative change of total force over a tiny step, looked for along random lines.

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use rayon::prelude::*;

use super::load::height_for_load;
use super::{LOADS, stream};
use crate::pair::Pair;

/// Step (m or rad) over which the change is taken.
const STEP: f64 = 1e-8;
/// Length (m or rad) of a line, and points on it before the bisection.
const LENGTH: f64 = 1e-3;
const POINTS: usize = 64;

/// A relative change of total force over [`STEP`], and the canonical pose at which it begins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Change {
    /// |ΔN| / N.
    pub relative: f64,
    /// The pose.
    pub pose: Pose,
}

impl Change {
    fn max(self, other: Self) -> Self {
        if other.relative > self.relative { other } else { self }
    }
}

/// Largest changes found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Continuity {
    /// Of the table.
    pub table: Change,
    /// Of the direct solver.
    pub direct: Change,
}

impl Continuity {
    pub(super) fn max(self, other: Self) -> Self {
        Self { table: self.table.max(other.table), direct: self.direct.max(other.direct) }
    }
}

/// Draws lines along lateral, yaw and roll, at a load of 5 to 150 kN in their middle and kept at the height above the
/// rigid contact; on each, bisects towards the largest change of force. A jump shows as a change that does not shrink
/// with the step.
pub fn continuity(table: &ContactTable<'_>, pair: &Pair, side: Side, lines: usize, seed: u64) -> Continuity {
    (0..lines)
        .into_par_iter()
        .filter_map(|index| line(table, pair, side, seed, index))
        .reduce(Continuity::default, Continuity::max)
}

fn line(table: &ContactTable<'_>, pair: &Pair, side: Side, seed: u64, index: usize) -> Option<Continuity> {
    let mut uniform = stream(seed ^ 0x6c69_6e65, index);
    let mut inside = |name: AxisName, length: f64| {
        let (first, last) = table.axis(name).range();
        let margin = length.min(0.4 * (last - first));
        uniform([first + margin, last - margin])
    };
    let mut middle = Coordinates {
        lateral: inside(AxisName::Lateral, LENGTH),
        yaw: inside(AxisName::Yaw, LENGTH),
        roll_offset: inside(AxisName::RollOffset, 0.5 * LENGTH),
        vertical: 0.0,
    };
    let load = libm::exp(uniform(LOADS.map(libm::log)));
    let geometry = *pair.body(side).wheel().geometry();
    let maps = table.rigid(side);
    let pose = maps.pose(&geometry, &middle);
    middle.vertical = height_for_load(&mut pair.column(side, &pose), load)? - pose.vertical;
    let at = |s: f64| {
        let mut c = middle;
        match index % 3 {
            0 => c.lateral += s,
            1 => c.yaw += s,
            _ => c.roll_offset += s,
        }
        maps.pose(&geometry, &c)
    };
    let sign = side.sign();
    let by_table = |p: Pose| {
        let p = Pose { lateral: sign * p.lateral, yaw: sign * p.yaw, roll: sign * p.roll, ..p };
        f64::from(table.contacts(side, &p).total_normal_force())
    };
    let by_solver = |p: Pose| pair.column(side, &p).total_force(p.vertical);
    let change = |force: &dyn Fn(Pose) -> f64| {
        let (relative, s) = largest_change(|s| force(at(s)));
        Change { relative, pose: at(s) }
    };
    Some(Continuity { table: change(&by_table), direct: change(&by_solver) })
}

/// Bisects towards the largest relative change of `force` until the interval is about [`STEP`]: the change and where.
fn largest_change(force: impl Fn(f64) -> f64) -> (f64, f64) {
    let relative = |a: f64, b: f64| if a.max(b) < LOADS[0] { 0.0 } else { (b - a).abs() / a.max(b) };
    let s = |i: usize| LENGTH * (i as f64 / POINTS as f64 - 0.5);
    let values: Vec<f64> = (0..=POINTS).map(|i| force(s(i))).collect();
    let Some(start) =
        (0..POINTS).max_by(|&i, &j| relative(values[i], values[i + 1]).total_cmp(&relative(values[j], values[j + 1])))
    else {
        return (0.0, 0.0);
    };
    let (mut low, mut high) = (s(start), s(start + 1));
    let (mut f_low, mut f_high) = (values[start], values[start + 1]);
    while high - low > 2.0 * STEP {
        let middle = 0.5 * (low + high);
        let f = force(middle);
        if relative(f_low, f) > relative(f, f_high) { (high, f_high) = (middle, f) } else { (low, f_low) = (middle, f) }
    }
    let step = |s: f64| (relative(force(s), force(s + STEP)), s);
    let (first, second) = (step(low), step(low + STEP));
    if first.0 > second.0 { first } else { second }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_found_and_a_slope_is_not_one() {
        let jump = |s: f64| if s > 1.234e-4 { 1.1e4 } else { 1e4 };
        assert!((largest_change(jump).0 - 1.0 / 11.0).abs() < 1e-9);
        let slope = |s: f64| 1e4 * (1.0 + 1e3 * s);
        assert!(largest_change(slope).0 < 3e-5);
    }
}
