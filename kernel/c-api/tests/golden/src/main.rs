//! Writes motions of a wheelset (88 bytes each, as `flangeway_motion`) and what the kernel answers in Rust, as bits in
//! hexadecimal: `golden TABLE MOTIONS ANSWERS`. `tests/bits.c` answers the same motions through the C interface.

use std::fmt::Write as _;

use flangeway::creep::{self, CreepForces, Creepages, Elasticity, Friction, Patch};
use flangeway::wheelset::{Motion, Rates, WheelLoads, Wrench, contact_wrench, creepages};
use flangeway::{Contact, ContactTable, Contacts, Pose, Side};

const MOTIONS: usize = 2000;
const FRICTION: Friction = Friction { coefficient: 0.35, limit_ratio: 0.4, decay: 0.6 };

type Law = fn(&Patch, &Elasticity, &Creepages, f32) -> CreepForces;
const LAWS: [Law; 5] = [
    |patch, elasticity, creepages, _| creep::kalker_linear(patch, elasticity, creepages),
    creep::shen_hedrick_elkins,
    creep::polach,
    creep::fastsim::<10, 10>,
    creep::fastsim::<20, 20>,
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, table, motions, answers] = arguments.as_slice() else { return Err("golden TABLE MOTIONS ANSWERS".into()) };
    let image = std::fs::read(table)?;
    let table = ContactTable::new(&image)?;
    let mut random = Random(1);
    let (mut bytes, mut text) = (Vec::new(), String::new());
    for _ in 0..MOTIONS {
        let motion = random.motion();
        let Motion { pose, rates, speed, spin, track_curvature } = motion;
        for number in [
            pose.lateral,
            pose.yaw,
            pose.vertical,
            pose.roll,
            rates.lateral,
            rates.yaw,
            rates.vertical,
            rates.roll,
            speed,
            spin,
            track_curvature,
        ] {
            bytes.extend(number.to_le_bytes());
        }
        answer(&table, &motion, &mut text)?;
    }
    std::fs::write(motions, bytes)?;
    std::fs::write(answers, text)?;
    Ok(())
}

/// All that is answered of a motion.
fn answer(table: &ContactTable<'_>, motion: &Motion, text: &mut String) -> std::fmt::Result {
    for side in Side::ALL {
        let contacts = table.contacts(side, &motion.pose);
        write!(text, "{:x} {:x}", contacts.list.len(), contacts.flags.bits())?;
        contacts.iter().try_for_each(|contact| write_contact(contact, text))?;
        writeln!(text)?;
    }
    for law in LAWS {
        let mut total = Wrench::default();
        for side in Side::ALL {
            total = total + wheel(table, motion, side, law, text)?;
        }
        total.force.iter().chain(&total.moment).try_for_each(|x| write!(text, " {:016x}", x.to_bits()))?;
        writeln!(text)?;
    }
    Ok(())
}

fn wheel(
    table: &ContactTable<'_>,
    motion: &Motion,
    side: Side,
    law: Law,
    text: &mut String,
) -> Result<Wrench, std::fmt::Error> {
    let header = table.header();
    let (geometry, elasticity) = (header.side(side).geometry, Elasticity::from(&header.material));
    let contacts: Contacts = table.contacts(side, &motion.pose);
    let (mut on_wheel, mut wear) = (Wrench::default(), 0.0);
    for contact in &contacts {
        let slip = creepages(&geometry, motion, contact);
        let size = CreepForces { longitudinal: slip.longitudinal, lateral: slip.lateral, spin_moment: 0.0 };
        let friction = FRICTION.at(size.magnitude() * motion.speed.abs() as f32);
        let force = law(&contact.into(), &elasticity, &slip, friction);
        on_wheel = on_wheel + contact_wrench(&geometry, &motion.pose, contact, &force);
        wear += creep::wear_index(&slip, &force);
        let numbers =
            [slip.longitudinal, slip.lateral, slip.spin, force.longitudinal, force.lateral, force.spin_moment];
        numbers.into_iter().try_for_each(|x| write!(text, " {:08x}", x.to_bits()))?;
    }
    let loads = WheelLoads::new(side, &on_wheel);
    let numbers = [loads.guiding_force, loads.wheel_load, loads.ratio(), wear];
    numbers.into_iter().try_for_each(|x| write!(text, " {:016x}", x.to_bits()))?;
    writeln!(text)?;
    Ok(on_wheel)
}

fn write_contact(contact: &Contact, text: &mut String) -> std::fmt::Result {
    let [x, y, z] = contact.position.into();
    let [a, b] = contact.semi_axes;
    let numbers = [
        contact.normal_force,
        contact.indentation,
        x,
        y,
        z,
        contact.angle,
        contact.rolling_radius,
        contact.wheel_coordinate,
        a,
        b,
        contact.wheel_curvature,
        contact.rail_curvature,
    ];
    numbers.into_iter().try_for_each(|x| write!(text, " {:08x}", x.to_bits()))?;
    write!(text, " {:x}", contact.slot as i32)
}

/// Knuth's linear congruential generator.
struct Random(u64);

impl Random {
    /// From -1 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Inside the table, at its edges and beyond; with force on most wheels.
    fn motion(&mut self) -> Motion {
        let speed = 20.0 + 19.0 * self.next();
        Motion {
            pose: Pose {
                lateral: 0.010 * self.next(),
                yaw: 0.02 * self.next(),
                vertical: 2e-4 + 5e-4 * self.next(),
                roll: 1e-3 * self.next(),
            },
            rates: Rates {
                lateral: 0.05 * self.next(),
                yaw: 0.1 * self.next(),
                vertical: 0.02 * self.next(),
                roll: 0.05 * self.next(),
            },
            speed,
            spin: speed / 0.46 * (1.0 + 0.002 * self.next()),
            track_curvature: 2e-3 * self.next(),
        }
    }
}
