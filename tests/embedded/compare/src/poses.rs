//! A thousand poses of every kind, over a committed table and one in which three contacts occur.

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::creep::CreepCase;

/// A made-up table in which all three slots can carry force; `tests/kernel_gates.rs` writes it.
static THREE: &[u8] = include_bytes!("../../../gates/three_contacts.fwt");

/// Poses of each kind, over each table.
const OF_A_KIND: usize = 100;
/// What is no coordinate, or hardly one.
const STRANGE: [f64; 8] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 1000.1, 5e-324, -0.0, f64::from_bits(0x7ff0_0000_0000_0001)];

/// A pose to look up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case {
    /// Which of [`tables`].
    pub(crate) table: usize,
    /// The wheel.
    pub(crate) side: Side,
    /// The wheelset's pose.
    pub(crate) pose: Pose,
    /// What its contacts' creep forces depend on.
    pub(crate) creep: CreepCase,
}

/// Kinds of poses.
#[derive(Clone, Copy)]
enum Kind {
    /// Anywhere inside the table.
    Interior,
    /// On nodes and edges of the table's axes.
    Edges,
    /// Outside it, up to an axis' length on either side.
    Clamped,
    /// With one coordinate that is no number, or hardly one.
    Strange,
    /// Pressed in deeper than the table goes: contacts of as many slots as there are.
    Deep,
}

/// The tables, in the firmware's order.
pub(crate) fn tables() -> [ContactTable<'static>; 2] {
    [flangeway_tables::S1002_60E1_40_TABLE, THREE].map(|image| ContactTable::new(image).expect("a table"))
}

/// The poses, always the same.
pub(crate) fn poses() -> Vec<Case> {
    let (mut random, mut motions) = (Pcg64::seed_from_u64(1), Pcg64::seed_from_u64(2));
    let mut cases = Vec::new();
    for (index, table) in tables().iter().enumerate() {
        for kind in [Kind::Interior, Kind::Edges, Kind::Clamped, Kind::Strange, Kind::Deep] {
            for i in 0..OF_A_KIND {
                let (side, pose) = (Side::ALL[i % 2], pose(table, kind, i, &mut random));
                let geometry = &table.header().side(side).geometry;
                // Another motion than the pose's for both sides and both signs of yaw.
                let creep = CreepCase::new(pose, geometry, cases.len() / 4 + i, &mut motions);
                cases.push(Case { table: index, side, pose, creep });
            }
        }
    }
    cases
}

fn pose(table: &ContactTable<'_>, kind: Kind, index: usize, random: &mut Pcg64) -> Pose {
    let mut on = |name: AxisName| {
        let t = random.random::<f64>();
        let axis = table.axis(name);
        let (first, last) = axis.range();
        match (kind, name) {
            (Kind::Edges, _) => axis.node((t * axis.len() as f64) as usize),
            (Kind::Clamped, _) => first + (3.0 * t - 1.0) * (last - first),
            (Kind::Deep, AxisName::Vertical) => last + 3.0 * t * (last - first),
            _ => first + t * (last - first),
        }
    };
    let at = Coordinates {
        lateral: on(AxisName::Lateral),
        yaw: on(AxisName::Yaw),
        roll_offset: on(AxisName::RollOffset),
        vertical: on(AxisName::Vertical),
    };
    let mut pose = table.rigid(Side::Right).pose(&table.header().right.geometry, &at);
    // Left and right, forward and backward.
    if index % 4 > 1 {
        pose.yaw = -pose.yaw;
    }
    if index % 2 == 1 {
        (pose.lateral, pose.yaw, pose.roll) = (-pose.lateral, -pose.yaw, -pose.roll);
    }
    if let Kind::Strange = kind {
        let strange = STRANGE[index / 4 % STRANGE.len()];
        *[&mut pose.lateral, &mut pose.yaw, &mut pose.vertical, &mut pose.roll][index % 4] = strange;
    }
    pose
}

/// The poses as the firmware reads them: table, side, four `f64`, what their creep forces depend on.
pub(crate) fn bytes() -> Vec<u8> {
    let case = |case: &Case| {
        let Pose { lateral, yaw, vertical, roll } = case.pose;
        let side = Side::ALL.iter().position(|side| *side == case.side).expect("one of two");
        let numbers = [lateral, yaw, vertical, roll].map(f64::to_le_bytes);
        [[case.table as u8, side as u8].as_slice(), numbers.as_flattened(), &case.creep.bytes()].concat()
    };
    poses().iter().flat_map(case).collect()
}
