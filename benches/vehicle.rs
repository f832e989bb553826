//! A bogie in real time: how much faster than the clock a simulation with a step of 0.1 ms is, and what a step is made of.
//!
//! `cargo bench --bench vehicle`. The paired ratios (table against direct solver) hold on any machine; real time is that
//! of this one, median of the rounds.

mod common;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use flangeway::creep::{self, Patch};
use flangeway::wheelset::{Motion, contact_wrench, creepages};
use flangeway::{Contacts, Pose, Side};
use flangeway_host::dynamics::body::{LATERAL, ROLL, VERTICAL, YAW};
use flangeway_host::dynamics::run::Ground;
use flangeway_host::dynamics::scenario::Scenario;
use flangeway_host::dynamics::source::Source;
use flangeway_host::dynamics::vehicle::{Line, Vehicle};
use flangeway_host::dynamics::wheel_rail::{Law, WheelRail};

const STEP: f64 = 1e-4;
const ROUNDS: usize = 9;

fn main() {
    let scenario = Scenario::parse(flangeway_tables::BOGIE_R60, Path::new("bogie_r60.toml")).expect("a scenario");
    let mut ground = Ground::of(&scenario).expect("wheels and rails");
    let image = common::aligned(&ground.image.take().expect("a table"));
    ground.image = Some(image.to_vec());
    let table = flangeway::ContactTable::new(image).expect("a table");
    let contact = |source, law| WheelRail {
        source,
        law,
        friction: scenario.contact.friction(),
        elasticity: ground.elasticity(),
        damping: scenario.contact.damping_s_per_m,
    };
    let (track, irregularity) = (scenario.track(), Default::default());
    let speed = scenario.run.speed_m_per_s;
    let polach = contact(Source::Table(&table), Law::Polach);
    let fastsim = contact(Source::Table(&table), Law::Fastsim);
    let direct = contact(Source::Direct(&ground.pair), Law::Polach);
    let line = |contact| Line { track: &track, irregularity: &irregularity, contact, speed };
    // In the curve, where wheels touch twice.
    let mut start = Vehicle::at_rest(scenario.parameters(), &line(&polach)).expect("a vehicle");
    while start.distance < 55.0 {
        start.step(STEP, &line(&polach));
    }
    let run = |contact, steps: usize| {
        let (mut vehicle, line) = (start.clone(), line(contact));
        let begin = Instant::now();
        for _ in 0..steps {
            vehicle.step(STEP, black_box(&line));
        }
        black_box(&vehicle);
        begin.elapsed().as_secs_f64() / steps as f64
    };
    let rounds: Vec<[f64; 3]> =
        (0..ROUNDS).map(|_| [run(&polach, 5000), run(&fastsim, 2000), run(&direct, 60)]).collect();
    let of = |f: &dyn Fn(&[f64; 3]) -> f64| common::quartiles(rounds.iter().map(f).collect());
    println!("bogie in the curve of 60 m, steps of 0.1 ms, one core, {ROUNDS} rounds (quartiles)");
    for (name, way) in [("table, Polach", 0), ("table, FASTSIM 10 x 10", 1), ("direct solver, Polach", 2)] {
        let [low, median, high] = of(&|round| STEP / round[way]);
        println!("  {name:24} {median:8.1} times real time ({low:.1} to {high:.1})");
    }
    let [low, median, high] = of(&|round| round[2] / round[0]);
    println!("  direct over table        {median:8.1} times a step ({low:.1} to {high:.1})");
    parts(&start, &polach, speed);
}

/// What a step's parts cost, for all four wheels.
fn parts(vehicle: &Vehicle, contact: &WheelRail<'_>, speed: f64) {
    let motions: Vec<Motion> = vehicle
        .wheelsets
        .iter()
        .map(|wheelset| {
            let q = wheelset.body.position;
            let pose = Pose { lateral: q[LATERAL], yaw: q[YAW], vertical: q[VERTICAL], roll: q[ROLL] };
            let spin = wheelset.body.velocity[4];
            Motion { pose, speed, spin, track_curvature: -1.0 / 60.0, ..Motion::default() }
        })
        .collect();
    let wheels: Vec<(Side, Motion)> = motions.iter().flat_map(|m| Side::ALL.map(|side| (side, *m))).collect();
    let mut contacts = Contacts::NONE;
    let mut touching = Vec::new();
    for (side, motion) in &wheels {
        contact.source.contacts_into(*side, &motion.pose, &mut contacts);
        touching.extend(contacts.iter().map(|c| (*side, *motion, *c)));
    }
    let slips: Vec<_> = touching.iter().map(|(side, m, c)| creepages(contact.source.geometry(*side), m, c)).collect();
    let patches: Vec<_> = touching.iter().map(|(_, _, c)| Patch::from(c)).collect();
    let time = |repeats: usize, work: &mut dyn FnMut()| {
        let rounds = (0..ROUNDS).map(|_| {
            let begin = Instant::now();
            (0..repeats).for_each(|_| work());
            1e9 * begin.elapsed().as_secs_f64() / repeats as f64
        });
        common::quartiles(rounds.collect())[1]
    };
    let elasticity = &contact.elasticity;
    println!("  parts of a step, ns: {} wheels, {} contacts", wheels.len(), touching.len());
    let row = |name: &str, repeats: usize, work: &mut dyn FnMut()| {
        println!("    {name:24} {:8.0}", time(repeats, work));
    };
    row("contacts by the table", 5000, &mut || {
        for (side, motion) in &wheels {
            contact.source.contacts_into(*side, black_box(&motion.pose), &mut contacts);
            black_box(&contacts);
        }
    });
    row("creepages", 5000, &mut || {
        for (side, motion, c) in &touching {
            black_box(creepages(contact.source.geometry(*side), black_box(motion), c));
        }
    });
    row("creep forces, Polach", 5000, &mut || {
        for (slip, patch) in slips.iter().zip(&patches) {
            black_box(creep::polach(black_box(patch), elasticity, slip, 0.3));
        }
    });
    row("creep forces, FASTSIM", 1000, &mut || {
        for (slip, patch) in slips.iter().zip(&patches) {
            black_box(creep::fastsim::<10, 10>(black_box(patch), elasticity, slip, 0.3));
        }
    });
    row("wrench", 5000, &mut || {
        for (side, motion, c) in &touching {
            let forces = flangeway::creep::CreepForces::NONE;
            black_box(contact_wrench(contact.source.geometry(*side), black_box(&motion.pose), c, &forces));
        }
    });
    let mut all = [Default::default(); 2];
    row("all forces, Polach", 5000, &mut || {
        for motion in &motions {
            black_box(contact.forces(black_box(motion), &mut all));
        }
    });
}
