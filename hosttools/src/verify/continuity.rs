//! Does the force jump? The largest relative change of total force over a tiny step, looked for along random lines.

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use rayon::prelude::*;

use super::load::height_for_load;
use super::{LOADS, forces, stream};
use crate::pair::Pair;

/// Step (m or rad) over which the change is taken.
pub(super) const STEP: f64 = 1e-8;
/// Length (m or rad) of a line, of a vertical one, and points on it before the bisection.
const LENGTH: f64 = 1e-3;
const VERTICAL_LENGTH: f64 = 0.2e-3;
const POINTS: usize = 64;
/// Lines drawn in search of one that crosses a change of contacts.
const ATTEMPTS: usize = 12;
/// Changes kept of the table and of the solver.
const KEPT: usize = 20;

/// What varies along a line and over a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Lateral position.
    #[default]
    Lateral,
    /// Yaw.
    Yaw,
    /// Roll.
    Roll,
    /// Height.
    Vertical,
}

impl Direction {
    const ALL: [Self; 4] = [Self::Lateral, Self::Yaw, Self::Roll, Self::Vertical];

    fn length(self) -> f64 {
        if self == Self::Vertical { VERTICAL_LENGTH } else { LENGTH }
    }

    /// Coordinates moved by `s` (m or rad): at a constant height above the rigid contact, but for the vertical.
    fn along(self, from: &Coordinates, s: f64) -> Coordinates {
        let mut moved = *from;
        match self {
            Self::Lateral => moved.lateral += s,
            Self::Yaw => moved.yaw += s,
            Self::Roll => moved.roll_offset += s,
            Self::Vertical => moved.vertical += s,
        }
        moved
    }

    /// A pose moved by `s` (m or rad), everything else kept.
    fn moved(self, from: &Pose, s: f64) -> Pose {
        let mut moved = *from;
        match self {
            Self::Lateral => moved.lateral += s,
            Self::Yaw => moved.yaw += s,
            Self::Roll => moved.roll += s,
            Self::Vertical => moved.vertical += s,
        }
        moved
    }
}

/// A relative change of total force over 10 nm or 10 nrad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Change {
    /// |ΔN| / N.
    pub relative: f64,
    /// What was stepped.
    pub direction: Direction,
    /// The canonical poses before and after the step.
    pub poses: [Pose; 2],
    /// Table coordinates of the line's point at which the step begins.
    pub coordinates: Coordinates,
    /// Total force (N) before and after.
    pub force: [f64; 2],
    /// The wheel.
    pub side: Option<Side>,
}

/// Largest changes found, by decreasing size, one a line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Continuity {
    /// Of the table.
    pub table: Vec<Change>,
    /// Of the direct solver.
    pub direct: Vec<Change>,
    /// Lines drawn.
    pub lines: usize,
    /// Lines between whose ends another slot comes to carry, or ceases to.
    pub crossing: usize,
}

impl Continuity {
    /// The largest relative change of the table's force, 0 without a line.
    pub fn worst_of_table(&self) -> f64 {
        self.table.first().map_or(0.0, |change| change.relative)
    }

    /// The largest relative change of the direct solver's force, 0 without a line.
    pub fn worst_of_direct(&self) -> f64 {
        self.direct.first().map_or(0.0, |change| change.relative)
    }

    pub(super) fn join(&mut self, other: Self) {
        self.lines += other.lines;
        self.crossing += other.crossing;
        for (own, others) in [(&mut self.table, other.table), (&mut self.direct, other.direct)] {
            own.extend(others);
            own.sort_by(|a, b| b.relative.total_cmp(&a.relative));
            own.truncate(KEPT);
        }
    }
}

/// Draws lines along lateral, yaw, roll and height, at a load of 5 to 150 kN in their middle and (but for the height)
/// kept at its height above the rigid contact, by preference such that cross a change of contacts; on each, bisects
/// towards the largest change of force. A jump shows as a change that does not shrink with the step.
pub fn continuity(table: &ContactTable<'_>, pair: &Pair, side: Side, lines: usize, seed: u64) -> Continuity {
    let found: Vec<_> = (0..lines).into_par_iter().filter_map(|index| line(table, pair, side, seed, index)).collect();
    let mut all = Continuity::default();
    for (crossing, changes) in found {
        let [table, direct] = changes.map(|change| vec![change]);
        all.join(Continuity { table, direct, lines: 1, crossing: usize::from(crossing) });
    }
    all
}

/// A line: its direction, its middle, and whether the carrying slots differ between its ends.
fn draw(
    table: &ContactTable<'_>,
    pair: &Pair,
    side: Side,
    direction: Direction,
    uniform: &mut impl FnMut([f64; 2]) -> f64,
) -> Option<(Coordinates, bool)> {
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
    let geometry = pair.body(side).wheel().geometry();
    let pose = table.rigid(side).pose(geometry, &middle);
    middle.vertical = height_for_load(&mut pair.column(side, &pose), load)? - pose.vertical;
    let carrying = |s: f64| {
        let pose = table.rigid(side).pose(geometry, &direction.along(&middle, s));
        pair.column(side, &pose).slots(pose.vertical).map(|slot| slot.normal_force() > 0.0)
    };
    let half = 0.5 * direction.length();
    Some((middle, carrying(-half) != carrying(half)))
}

fn line(table: &ContactTable<'_>, pair: &Pair, side: Side, seed: u64, index: usize) -> Option<(bool, [Change; 2])> {
    let direction = Direction::ALL[index % Direction::ALL.len()];
    let mut uniform = stream(seed ^ 0x6c69_6e65, index);
    let mut drawn = None;
    for _ in 0..ATTEMPTS {
        drawn = draw(table, pair, side, direction, &mut uniform).or(drawn);
        if drawn.is_some_and(|(_, crossing)| crossing) {
            break;
        }
    }
    let (middle, crossing) = drawn?;
    let geometry = pair.body(side).wheel().geometry();
    let at = |s: f64| table.rigid(side).pose(geometry, &direction.along(&middle, s));
    let change = |force: &dyn Fn(&Pose) -> f64| {
        let s = towards_largest_change(direction.length(), |s| force(&at(s)));
        // Steps along the line, and of the pose's own coordinate, all else kept.
        let steps = [s, s + STEP].into_iter().flat_map(|s| {
            let pose = at(s);
            [(s, [pose, at(s + STEP)]), (s, [pose, direction.moved(&pose, STEP)])]
        });
        let of = |(s, poses): (f64, [Pose; 2])| {
            let force = poses.each_ref().map(force);
            let coordinates = direction.along(&middle, s);
            Change { relative: relative(force), direction, poses, coordinates, force, side: Some(side) }
        };
        steps.map(of).max_by(|a, b| a.relative.total_cmp(&b.relative)).unwrap_or_default()
    };
    let by_table = change(&|pose| forces::table(table, side, pose));
    let by_solver = change(&|pose| forces::direct(pair, side, pose));
    Some((crossing, [by_table, by_solver]))
}

/// Relative change between two forces (N), 0 where both are lighter than the lightest load.
fn relative([a, b]: [f64; 2]) -> f64 {
    let greater = a.max(b);
    if greater < LOADS[0] { 0.0 } else { (b - a).abs() / greater }
}

/// Bisects towards the largest relative change of `force` along a line until the interval is about [`STEP`]: where it
/// begins.
fn towards_largest_change(length: f64, force: impl Fn(f64) -> f64) -> f64 {
    let s = |i: usize| length * (i as f64 / POINTS as f64 - 0.5);
    let values: Vec<f64> = (0..=POINTS).map(|i| force(s(i))).collect();
    let change = |i: usize| relative([values[i], values[i + 1]]);
    let start = (0..POINTS).max_by(|&i, &j| change(i).total_cmp(&change(j))).unwrap_or(0);
    let (mut low, mut high) = (s(start), s(start + 1));
    let (mut f_low, mut f_high) = (values[start], values[start + 1]);
    while high - low > 2.0 * STEP {
        let middle = 0.5 * (low + high);
        let f = force(middle);
        if relative([f_low, f]) > relative([f, f_high]) {
            (high, f_high) = (middle, f)
        } else {
            (low, f_low) = (middle, f)
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_found_and_a_slope_is_not_one() {
        let largest = |force: &dyn Fn(f64) -> f64| {
            let s = towards_largest_change(LENGTH, force);
            [s, s + STEP].map(|s| relative([force(s), force(s + STEP)])).into_iter().fold(0.0, f64::max)
        };
        assert!((largest(&|s| if s > 1.234e-4 { 1.1e4 } else { 1e4 }) - 1.0 / 11.0).abs() < 1e-9);
        assert!(largest(&|s| 1e4 * (1.0 + 1e3 * s)) < 3e-5);
    }

    #[test]
    fn the_largest_changes_are_kept_in_order() {
        let change = |relative| Change { relative, ..Change::default() };
        let mut all = Continuity::default();
        for i in 0..50 {
            let changes = vec![change(f64::from(i * 7 % 50))];
            all.join(Continuity { table: changes.clone(), direct: changes, lines: 1, crossing: 0 });
        }
        assert_eq!((all.lines, all.table.len(), all.worst_of_table()), (50, KEPT, 49.0));
        assert!(all.direct.is_sorted_by(|a, b| a.relative >= b.relative));
    }
}
