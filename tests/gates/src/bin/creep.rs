//! Creep forces and creepages of cases of every kind, each by one call of [`counted`], so that callgrind can count each.
//! Prints a line a case: the law, the case's name, and the answer's bits, the same for every build of the kernel.

use std::hint::black_box;

use flangeway::creep::{
    CreepForces, Creepages, Elasticity, Friction, Patch, fastsim, kalker_linear, polach, polach_four,
    shen_hedrick_elkins,
};
use flangeway::wheelset::{Motion, contact_wrench, creepages};
use flangeway::{Contact, Pose, Slot, WheelGeometry};

const GEOMETRY: WheelGeometry = WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 };

/// What is counted.
#[derive(Clone, Copy, PartialEq)]
enum Law {
    /// The call alone.
    Floor,
    Kalker,
    ShenHedrickElkins,
    Polach,
    /// Of four contacts at once, of which the last counts.
    PolachFour,
    Fastsim10,
    Fastsim20,
    /// Creepages of a contact, falling friction, and the wrench.
    Wheelset,
}

const LAWS: [(&str, Law); 8] = [
    ("floor", Law::Floor),
    ("kalker", Law::Kalker),
    ("shen-hedrick-elkins", Law::ShenHedrickElkins),
    ("polach", Law::Polach),
    ("polach four", Law::PolachFour),
    ("fastsim 10x10", Law::Fastsim10),
    ("fastsim 20x20", Law::Fastsim20),
    ("creepages and wrench", Law::Wheelset),
];

struct Case {
    label: &'static str,
    patch: Patch,
    creepages: Creepages,
    friction: f32,
}

/// The function that is counted.
#[inline(never)]
fn counted(law: Law, case: &Case, answer: &mut [f64; 3]) {
    let Case { patch, creepages, friction, .. } = case;
    let steel = Elasticity::STEEL;
    let forces = match law {
        Law::Floor => CreepForces::NONE,
        Law::Kalker => kalker_linear(patch, &steel, creepages),
        Law::ShenHedrickElkins => shen_hedrick_elkins(patch, &steel, creepages, *friction),
        Law::Polach => polach(patch, &steel, creepages, *friction),
        Law::PolachFour => four(case),
        Law::Fastsim10 => fastsim::<10, 10>(patch, &steel, creepages, *friction),
        Law::Fastsim20 => fastsim::<20, 20>(patch, &steel, creepages, *friction),
        Law::Wheelset => wheelset(case),
    };
    if cfg!(feature = "broken") && forces.longitudinal > 0.0 {
        black_box(forces.longitudinal * 2.0);
    }
    *answer = [forces.longitudinal, forces.lateral, forces.spin_moment].map(f64::from);
    black_box(answer);
}

/// The case beside three others.
fn four(case: &Case) -> CreepForces {
    let Case { patch, creepages, friction, .. } = case;
    let other = Patch { semi_axes: [4e-3, 5e-3], normal_force: 6e4 };
    let [.., last] =
        polach_four(&[other, *patch, other, *patch], &Elasticity::STEEL, &[*creepages; 4], &[0.3, 0.4, 0.2, *friction]);
    last
}

/// The case's numbers taken for a motion: yaw, a slip of the axle, a contact angle.
fn wheelset(case: &Case) -> CreepForces {
    let Case { patch, creepages: numbers, friction, .. } = case;
    let pose = Pose { yaw: f64::from(numbers.lateral), ..Pose::default() };
    let spin = 20.0 / 0.46 * (1.0 + f64::from(numbers.longitudinal));
    let motion = Motion { pose, speed: 20.0, spin, track_curvature: 0.002, ..Motion::default() };
    let contact = Contact {
        normal_force: patch.normal_force,
        indentation: 5e-5,
        position: [0.001, 0.75, 0.002].into(),
        angle: 0.3 * numbers.spin,
        rolling_radius: 0.46,
        wheel_coordinate: 0.0,
        semi_axes: patch.semi_axes,
        wheel_curvature: 0.0,
        rail_curvature: 3.0,
        slot: Slot::Tread,
    };
    let creep = creepages(&GEOMETRY, &motion, &contact);
    let falling = Friction { coefficient: *friction, limit_ratio: 0.4, decay: 0.6 };
    let forces = CreepForces { longitudinal: creep.longitudinal, lateral: creep.lateral, spin_moment: creep.spin };
    let wrench = contact_wrench(&GEOMETRY, &pose, &contact, &forces);
    let [x, y, z] = wrench.moment.into();
    CreepForces { longitudinal: x as f32, lateral: (y + z) as f32, spin_moment: falling.at(20.0 * creep.longitudinal) }
}

/// Cases of every kind: at rest, slight, sliding, with spin, and what is no number.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |label, [a, b, n]: [f32; 3], [longitudinal, lateral, spin]: [f32; 3], friction| {
        let patch = Patch { semi_axes: [a, b], normal_force: n };
        cases.push(Case { label, patch, creepages: Creepages { longitudinal, lateral, spin }, friction });
    };
    let round = [5e-3, 5e-3, 8e4];
    for patch in [round, [2e-3, 9e-3, 5e4], [9e-3, 2e-3, 5e4], [1e-5, 2e-2, 1.0], [1e-3, 1e-3, 1e9]] {
        add("none", patch, [0.0; 3], 0.3);
        add("slight", patch, [1e-6, -1e-6, 1e-4], 0.3);
        add("half", patch, [1e-3, 5e-4, 0.0], 0.3);
        add("sliding", patch, [0.1, 0.2, 0.0], 0.3);
        add("spin", patch, [0.0, 0.0, 0.5], 0.3);
        add("great spin", patch, [0.0, -1e-3, -4.0], 0.3);
        add("against spin", patch, [0.0, -2.5e-3, 0.5], 0.3);
        add("huge", patch, [1e30, -1e30, 1e30], 0.3);
        add("tiny", patch, [1e-38, 1e-40, 0.0], 0.3);
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e-45] {
        add("bad semi-axis", [bad, 5e-3, 8e4], [1e-3, 0.0, 0.1], 0.3);
        add("bad semi-axis", [5e-3, bad, 8e4], [1e-3, 0.0, 0.1], 0.3);
        add("bad force", [5e-3, 5e-3, bad], [1e-3, 0.0, 0.1], 0.3);
        add("bad creepage", round, [bad, 1e-3, 0.1], 0.3);
        add("bad creepage", round, [1e-3, bad, 0.1], 0.3);
        add("bad spin", round, [1e-3, 1e-3, bad], 0.3);
        add("bad friction", round, [1e-3, 1e-3, 0.1], bad);
    }
    cases
}

fn main() {
    let cases = cases();
    let mut answers = Vec::new();
    for (_, law) in LAWS {
        for _ in 0..cases.len() {
            answers.push((law, [0.0; 3]));
        }
    }
    // Whatever happens once, happens here.
    counted(Law::Floor, &cases[0], &mut [0.0; 3]);
    for (i, (law, answer)) in answers.iter_mut().enumerate() {
        counted(black_box(*law), black_box(&cases[i % cases.len()]), black_box(answer));
    }
    for (i, (law, answer)) in answers.iter().enumerate() {
        let name = LAWS.iter().find(|(_, of)| of == law).map_or("", |(name, _)| name);
        let [x, y, z] = answer.map(f64::to_bits);
        println!("{name}\t{}\t{x:016x} {y:016x} {z:016x}", cases[i % cases.len()].label);
    }
}
