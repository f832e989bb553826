//! Looks up poses of every kind, one by one and eight together, each by one call of [`counted`], so that callgrind can
//! count each. Prints a line a case: its table, name, wheel, contacts, flags and a digest of the answer, the same for
//! every build of the kernel; to standard error which instructions the lookups are made of. With the argument `baseline`
//! these are those of every processor.

use std::hint::black_box;

use flangeway::{AxisName, ContactTable, Contacts, Coordinates, InstructionSet, Pose, Side};

/// A made-up table in which all three slots can carry force; `tests/kernel_gates.rs` writes it.
static THREE: &[u8] = include_bytes!("../../three_contacts.fwt");

/// Wheels that are looked up together.
const WHEELS: usize = 8;
/// Label of the calls that look nothing up.
const FLOOR: &str = "floor";

/// What is looked up.
#[derive(Clone, Copy)]
enum Wheels {
    One(Side, Pose),
    Eight([(Side, Pose); WHEELS]),
}

struct Case<'a> {
    table: &'a ContactTable<'static>,
    label: &'static str,
    wheels: Wheels,
    /// False for the floor: the call alone.
    lookup: bool,
    contacts: [Contacts; WHEELS],
}

impl<'a> Case<'a> {
    fn new(table: &'a ContactTable<'static>, label: &'static str, wheels: Wheels) -> Self {
        Self { table, label, wheels, lookup: label != FLOOR, contacts: [Contacts::NONE; WHEELS] }
    }

    /// What was looked up, and the answers.
    fn answers(&self) -> Vec<(Side, Pose, &Contacts)> {
        let wheels = match &self.wheels {
            Wheels::One(side, pose) => &[(*side, *pose)][..],
            Wheels::Eight(wheels) => wheels,
        };
        let answers = wheels.iter().zip(&self.contacts).filter(|_| self.lookup);
        answers.map(|((side, pose), contacts)| (*side, *pose, contacts)).collect()
    }
}

/// A branch on data, for the gate to notice: only in a build that is broken on purpose.
#[inline(always)]
fn spoil(contacts: &mut Contacts) {
    if cfg!(feature = "broken") && contacts.total_normal_force() > 0.0 {
        contacts.list.iter_mut().for_each(|contact| contact.angle = black_box(contact.angle) * 2.0);
    }
}

/// The function that is counted.
#[inline(never)]
fn counted(case: &mut Case<'_>) {
    match &case.wheels {
        Wheels::One(side, pose) => {
            let [contacts, ..] = &mut case.contacts;
            if case.lookup {
                case.table.contacts_into(*side, pose, contacts);
                spoil(contacts);
            }
        }
        Wheels::Eight(wheels) => {
            if case.lookup {
                case.table.contacts_many(wheels, &mut case.contacts);
                case.contacts.iter_mut().for_each(spoil);
            }
        }
    }
    black_box(case);
}

/// Poses of every kind, by fractions of the table's axes.
fn poses(table: &ContactTable<'_>) -> Vec<(&'static str, Pose)> {
    let at = |fractions: [f64; 4]| {
        let on = |name: AxisName, t: f64| {
            let (first, last) = table.axis(name).range();
            first + t * (last - first)
        };
        let [u, psi, phi, zeta] = fractions;
        let coordinates = Coordinates {
            lateral: on(AxisName::Lateral, u),
            yaw: on(AxisName::Yaw, psi),
            roll_offset: on(AxisName::RollOffset, phi),
            vertical: on(AxisName::Vertical, zeta),
        };
        table.rigid(Side::Right).pose(&table.header().right.geometry, &coordinates)
    };
    let inner = at([0.4, 0.3, 0.6, 0.7]);
    let mut poses = vec![("zero", Pose::default()), ("backward", Pose { yaw: -inner.yaw, ..inner })];
    for (label, fractions) in [
        ("interior", [0.1, 0.2, 0.3, 0.6]),
        ("interior", [0.5, 0.5, 0.5, 0.5]),
        ("interior", [0.77, 0.9, 0.2, 0.8]),
        ("first nodes", [0.0; 4]),
        ("last nodes", [1.0; 4]),
        ("edge", [0.0, 0.5, 0.5, 0.5]),
        ("edge", [1.0, 0.5, 0.5, 0.5]),
        ("edge", [0.5, 1.0, 0.5, 1.0]),
        ("clamped lateral", [-0.5, 0.5, 0.5, 0.6]),
        ("clamped lateral", [1.5, 0.5, 0.5, 0.6]),
        ("clamped yaw", [0.5, 2.0, 0.5, 0.6]),
        ("clamped roll", [0.5, 0.5, -3.0, 0.6]),
        ("clamped all", [-1.0, 2.0, 3.0, 1.2]),
        ("far below", [0.5, 0.5, 0.5, -50.0]),
        ("far above", [0.5, 0.5, 0.5, 50.0]),
        ("no contact", [0.5, 0.5, 0.5, -5.0]),
        ("many contacts", [0.5, 0.1, 0.5, 2.0]),
        ("many contacts", [0.95, 0.1, 0.5, 3.0]),
    ] {
        poses.push((label, at(fractions)));
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 5e-324] {
        poses.push(("not a number", Pose { lateral: bad, ..inner }));
        poses.push(("not a number", Pose { yaw: bad, ..inner }));
        poses.push(("not a number", Pose { vertical: bad, ..inner }));
        poses.push(("not a number", Pose { roll: bad, ..inner }));
    }
    poses.push(("large angles", Pose { yaw: 1.0, roll: -1.0, ..inner }));
    poses
}

/// FNV-1a over the bits of every number of a case's answers.
fn digest(case: &Case<'_>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |word: u32| hash = (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    for (_, _, contacts) in case.answers() {
        add(u32::from(contacts.flags.bits()));
        for c in contacts {
            let [x, y, z] = c.position.into();
            let [a, b] = c.semi_axes;
            let numbers = [c.normal_force, c.indentation, x, y, z, c.angle, c.rolling_radius, c.wheel_coordinate, a, b];
            numbers.iter().chain(&[c.wheel_curvature, c.rail_curvature]).for_each(|number| add(number.to_bits()));
            add(c.slot.index() as u32);
        }
    }
    hash
}

fn main() {
    let images = [("s1002_60e1_40", flangeway_tables::S1002_60E1_40_TABLE), ("three", THREE)];
    let baseline = std::env::args().any(|argument| argument == "baseline");
    let tables = images.map(|(name, image)| {
        let mut table = ContactTable::new(image).expect("a table");
        if baseline {
            table.set_instruction_set(InstructionSet::Baseline);
        }
        (name, table)
    });
    eprintln!("{}", tables[0].1.instruction_set());
    let mut cases = Vec::new();
    for (_, table) in &tables {
        let poses = poses(table);
        let one = |(_, pose): (&str, Pose), side| Wheels::One(side, pose);
        // Every pose once in every place.
        let eight = |first: usize| {
            let wheel = |i: usize| (Side::ALL[i % 2], poses[(first + i) % poses.len()].1);
            Wheels::Eight(std::array::from_fn(wheel))
        };
        let first = one(poses[0], Side::Right);
        // Twice: what happens before the loop belongs to the first.
        cases.extend([first, first, eight(0)].map(|wheels| Case::new(table, FLOOR, wheels)));
        for pose in &poses {
            cases.extend(Side::ALL.map(|side| Case::new(table, pose.0, one(*pose, side))));
        }
        cases.extend((0..poses.len()).map(|first| Case::new(table, "eight wheels", eight(first))));
    }
    // Whatever happens once, happens here.
    for wheels in [cases[2].wheels, cases[cases.len() - 1].wheels] {
        counted(black_box(&mut Case::new(cases[2].table, "", wheels)));
    }
    for case in &mut cases {
        counted(black_box(case));
    }
    for case in &cases {
        let name = tables.iter().find(|(_, table)| std::ptr::eq(table, case.table)).map_or("", |(name, _)| name);
        let (mut count, mut flags) = (0, 0);
        for (side, pose, contacts) in case.answers() {
            // Together as one by one.
            assert!(
                cfg!(feature = "broken") || case.table.contacts(side, &pose) == *contacts,
                "{}: {pose:?}",
                case.label
            );
            count += contacts.list.len();
            flags |= contacts.flags.bits();
        }
        let wheel = match &case.wheels {
            Wheels::One(side, _) => side.to_string(),
            Wheels::Eight(_) => "each".to_string(),
        };
        println!("{name}\t{}\t{wheel}\t{count}\t{flags:02x}\t{:016x}", case.label, digest(case));
    }
}
