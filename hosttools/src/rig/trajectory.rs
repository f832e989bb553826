//! What the wheels do: a recorded trajectory, or hunting with a curve that takes them from tread to flange.

use std::f64::consts::TAU;

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};

/// Length of the synthetic trajectory (s); it ends as it begins, so that it can be repeated.
const SYNTHETIC: f64 = 10.0;
/// Frequency of the hunting and of the bounce (Hz): whole cycles in the trajectory.
const HUNTING: f64 = 2.0;
const BOUNCE: f64 = 5.0;
/// Begin and end (s) of the curve's transitions, with the full curve between them.
const ENTRY: [f64; 2] = [3.0, 5.0];
const EXIT: [f64; 2] = [8.0, 10.0];

/// Poses of a wheelset at a rate (Hz): three seconds of hunting in straight track, then a right-hand curve of which the
/// entry takes one wheel over tread, flange root and flange, then straight track again.
///
/// It is laid out on the table's own ranges: 15 % of the lateral range as amplitude of the hunting, half of it in
/// the curve, with 80 % as offset; 5 % of the yaw range as amplitude, 30 % as angle of attack. The right wheel is
/// pressed in by half of the vertical range, more or less a tenth; the roll is the rigid one.
#[must_use]
pub fn synthetic(table: &ContactTable<'_>, rate: u32) -> Vec<Pose> {
    let end = |axis: AxisName| table.axis(axis).range().1;
    let (from, to) = table.axis(AxisName::Lateral).range();
    let (lateral, yaw, vertical) = ((-from).min(to), end(AxisName::Yaw), end(AxisName::Vertical));
    let geometry = table.header().side(Side::Right).geometry;
    let steps = (SYNTHETIC * f64::from(rate)) as usize;
    let pose = |step: usize| {
        let time = step as f64 / f64::from(rate);
        let curve = ramp(time, ENTRY) - ramp(time, EXIT);
        let hunting = TAU * HUNTING * time;
        let yaw = yaw * (0.05 * libm::cos(hunting) + 0.3 * curve);
        let at = Coordinates {
            lateral: lateral * (0.15 * (1.0 - 0.5 * curve) * libm::sin(hunting) + 0.8 * curve),
            yaw: yaw.abs(),
            roll_offset: 0.0,
            vertical: vertical * (0.5 + 0.1 * libm::sin(TAU * BOUNCE * time)),
        };
        // Backward yaw is the mirror image of forward yaw: everything else stays.
        Pose { yaw, ..table.rigid(Side::Right).pose(&geometry, &at) }
    };
    (0..steps).map(pose).collect()
}

/// From 0 to 1 between two times, without a kink.
fn ramp(time: f64, [from, to]: [f64; 2]) -> f64 {
    let t = ((time - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use flangeway::Slot;

    use super::*;

    #[test]
    fn on_every_committed_table_both_wheels_touch_all_the_way() {
        for committed in flangeway_tables::ALL {
            let table = ContactTable::new(committed.image).unwrap();
            let poses = synthetic(&table, 1000);
            assert_eq!(poses.len(), 10_000);
            let mut carried = [0; 3];
            let mut in_the_air = 0;
            for pose in &poses {
                let contacts = Side::ALL.map(|side| table.contacts(side, pose));
                contacts.iter().flatten().for_each(|c| carried[c.slot.index()] += 1);
                in_the_air += contacts.iter().filter(|c| c.iter().next().is_none()).count();
            }
            println!("{}: contacts by slot {carried:?}, wheels in the air {in_the_air}", committed.name);
            assert_eq!(in_the_air, 0, "{}", committed.name);
            assert!(carried[Slot::Tread.index()] > 5000, "{}: {carried:?}", committed.name);
        }
    }

    #[test]
    fn s1002_touches_with_all_slots_and_the_loop_closes() {
        let table = ContactTable::new(flangeway_tables::S1002_60E1_40_TABLE).unwrap();
        let poses = synthetic(&table, 1000);
        let mut carried = [0; 3];
        for pose in &poses {
            table.contacts(Side::Right, pose).iter().for_each(|c| carried[c.slot.index()] += 1);
        }
        assert!(carried.iter().all(|count| *count > 100), "{carried:?}");
        let largest = |f: fn(&Pose) -> f64| {
            let turned = poses.iter().skip(1).chain(&poses[..1]);
            poses.iter().zip(turned).map(|(a, b)| (f(b) - f(a)).abs()).fold(0.0, f64::max)
        };
        let steps = [largest(|p| p.lateral), largest(|p| p.yaw), largest(|p| p.vertical), largest(|p| p.roll)];
        println!("largest steps in a millisecond: {steps:?}");
        assert!(steps.iter().all(|step| *step < 5e-5), "{steps:?}");
    }
}
