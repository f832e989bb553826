//! A few poses of a wheelset at rest, looked up in the table and solved directly.

use flangeway::{ContactTable, Pose, Side, Slot};

use crate::commands::print as say;
use crate::contacts::{self, ContactRow};
use crate::error::Result;
use crate::pair::Pair;
use crate::rigid::two_wheels;
use crate::verify::height_for_load;

/// Total normal force (N) of each wheel.
const LOAD: f64 = 60e3;
/// Lateral position (m) and yaw (rad): on the tread, twice, on tread and flange root, on flange root, on the flange.
/// Farther out the wheel climbs, and its tape-circle point leaves the table.
const PLACES: [[f64; 2]; 5] = [[0.0, 0.0], [3e-3, 2e-3], [4.8e-3, 5e-3], [6e-3, 5e-3], [6.5e-3, 5e-3]];
/// Rolls (rad) about the rigid one within which both wheels come to carry the load.
const ROLL: f64 = 1e-3;

/// Prints the contacts of the places, by the table and by the direct solver.
pub(super) fn print(pair: &Pair, table: &ContactTable<'_>) -> Result<()> {
    let mut lines = vec![format!("Wheelset at rest, {:.0} kN of normal force on each wheel:", 1e-3 * LOAD)];
    lines.push(format!(
        "{:>7} {:>6}  {:<5}  {:<11} {:>7} {:>8} {:>7} {:>9} {:>9} {:>7} {:>6} {:>6}",
        "lateral", "yaw", "side", "slot", "at x", "at y", "angle", "N table", "N direct", "differ", "a", "b"
    ));
    lines.push(format!(
        "{:>7} {:>6}  {:<5}  {:<11} {:>7} {:>8} {:>7} {:>9} {:>9} {:>7} {:>6} {:>6}",
        "mm", "mrad", "", "", "mm", "mm", "mrad", "kN", "kN", "%", "mm", "mm"
    ));
    for [lateral, yaw] in PLACES {
        let Some(pose) = at_rest(pair, lateral, yaw) else { continue };
        for side in Side::ALL {
            let found = contacts::looked_up(0, side, &table.contacts(side, &pose));
            let solved = contacts::solved(pair, 0, side, &pose);
            for slot in Slot::ALL {
                let of = |rows: &[ContactRow]| rows.iter().find(|row| row.slot == slot).cloned();
                if let Some(line) = line(&pose, of(&found), of(&solved)) {
                    lines.push(line);
                }
            }
        }
    }
    say(&lines.join("\n"))
}

/// One contact; `None` where neither knows it.
fn line(pose: &Pose, table: Option<ContactRow>, direct: Option<ContactRow>) -> Option<String> {
    let force = |row: &Option<ContactRow>| row.as_ref().map_or(0.0, |row| 1e-3 * row.normal_force);
    let (by_table, by_solver) = (force(&table), force(&direct));
    let difference = if by_solver > 0.0 { format!("{:.3}", 1e2 * (by_table / by_solver - 1.0)) } else { "-".into() };
    let row = table.or(direct)?;
    let [x, y, _] = row.position.map(|p| 1e3 * p);
    let [a, b] = row.semi_axes.map(|a| 1e3 * a);
    Some(format!(
        "{:>7.2} {:>6.2}  {:<5}  {:<11} {x:>7.2} {y:>8.2} {:>7.1} {by_table:>9.3} {by_solver:>9.3} {difference:>7} \
         {a:>6.2} {b:>6.2}",
        1e3 * pose.lateral,
        1e3 * pose.yaw,
        row.side,
        row.slot,
        1e3 * row.angle,
    ))
}

/// The pose at which both wheels carry the load by the direct solver: the roll ρ with
///
/// ```text
/// f(ρ) = z_right(ρ) - z_left(ρ) = 0
/// ```
/// for the heights z at which each wheel carries it. f falls with the roll.
fn at_rest(pair: &Pair, lateral: f64, yaw: f64) -> Option<Pose> {
    let rigid = two_wheels(pair, lateral, yaw)?.roll;
    let height = |side: Side, roll: f64| {
        let pose = Pose { lateral, yaw, vertical: 0.0, roll }.canonical(side).pose;
        height_for_load(&mut pair.column(side, &pose), LOAD)
    };
    let (mut low, mut high) = (rigid - ROLL, rigid + ROLL);
    for _ in 0..40 {
        let roll = 0.5 * (low + high);
        if height(Side::Right, roll)? > height(Side::Left, roll)? { low = roll } else { high = roll }
    }
    let roll = 0.5 * (low + high);
    Some(Pose { lateral, yaw, vertical: height(Side::Right, roll)?, roll })
}
