//! A bogie in real time: how much faster than the clock a simulation with a step of 0.1 ms is, and what a step is made of.
//!
//! `cargo bench --bench vehicle`. The paired ratios (table against direct solver) hold on any machine; real time is that
//! of this one, median of the rounds, beside it that of the fastest 50 steps in a row: what else the machine does slows
//! the first by any factor and hardly the second.

mod common;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use flangeway::creep::{self, Patch};
use flangeway::wheelset::{Footing, Motion, Rolling, creepages};
use flangeway::{Contacts, Pose, Side};
use flangeway_host::dynamics::body::{LATERAL, ROLL, VERTICAL, YAW};
use flangeway_host::dynamics::run::Ground;
use flangeway_host::dynamics::scenario::Scenario;
use flangeway_host::dynamics::source::Source;
use flangeway_host::dynamics::vehicle::{Line, Vehicle};
use flangeway_host::dynamics::wheel_rail::{Law, WheelRail};

const STEP: f64 = 1e-4;
const ROUNDS: usize = 9;
/// Steps timed together, and the parts' repeats.
const BURST: usize = 50;

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
    // Seconds a step, of all and of the fastest burst.
    let run = |contact, steps: usize| {
        let (mut vehicle, line) = (start.clone(), line(contact));
        let bursts = bursts(steps, &mut || vehicle.step(STEP, black_box(&line)));
        black_box(&vehicle);
        bursts
    };
    let rounds: Vec<[[f64; 2]; 3]> =
        (0..ROUNDS).map(|_| [run(&polach, 5000), run(&fastsim, 2000), run(&direct, 60)]).collect();
    let of = |f: &dyn Fn(&[[f64; 2]; 3]) -> f64| common::quartiles(rounds.iter().map(f).collect());
    println!("bogie in the curve of 60 m, steps of 0.1 ms, one core, {ROUNDS} rounds (quartiles)");
    for (name, way) in [("table, Polach", 0), ("table, FASTSIM 10 x 10", 1), ("direct solver, Polach", 2)] {
        let [low, median, high] = of(&|round| STEP / round[way][0]);
        let fastest = rounds.iter().map(|round| round[way][1]).fold(f64::INFINITY, f64::min);
        let (undisturbed, microseconds) = (STEP / fastest, 1e6 * fastest);
        println!(
            "  {name:24} {median:8.1} times real time ({low:.1} to {high:.1}); at best {undisturbed:.1}, {microseconds:.2} µs a step"
        );
    }
    let [low, median, high] = of(&|round| round[2][1] / round[0][1]);
    println!("  direct over table        {median:8.1} times a step ({low:.1} to {high:.1})");
    parts(&start, &polach, speed);
}

/// Seconds that some work takes each time, of all and in the fastest burst.
fn bursts(repeats: usize, work: &mut dyn FnMut()) -> [f64; 2] {
    let (mut sum, mut fastest) = (0.0, f64::INFINITY);
    let bursts = repeats.div_ceil(BURST);
    for _ in 0..bursts {
        let begin = Instant::now();
        (0..BURST).for_each(|_| work());
        let seconds = begin.elapsed().as_secs_f64() / BURST as f64;
        (sum, fastest) = (sum + seconds, f64::min(fastest, seconds));
    }
    [sum / bursts as f64, fastest]
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
    let rollings: Vec<_> = touching.iter().map(|(_, m, _)| Rolling::new(m)).collect();
    let footings: Vec<_> =
        touching.iter().map(|(side, m, c)| Footing::new(contact.source.geometry(*side), &m.pose, c)).collect();
    let patches: Vec<_> = touching.iter().map(|(_, _, c)| Patch::from(c)).collect();
    let time = |repeats: usize, work: &mut dyn FnMut()| {
        let rounds: Vec<_> = (0..ROUNDS).map(|_| bursts(repeats, work).map(|seconds| 1e9 * seconds)).collect();
        [
            common::quartiles(rounds.iter().map(|round| round[0]).collect())[1],
            rounds.iter().map(|round| round[1]).fold(f64::INFINITY, f64::min),
        ]
    };
    let elasticity = &contact.elasticity;
    println!("  parts of a step, ns (median; at best): {} wheels, {} contacts", wheels.len(), touching.len());
    let row = |name: &str, repeats: usize, work: &mut dyn FnMut()| {
        let [median, fastest] = time(repeats, work);
        println!("    {name:24} {median:8.0} {fastest:8.0}");
    };
    row("contacts by the table", 5000, &mut || {
        for (side, motion) in &wheels {
            contact.source.contacts_into(*side, black_box(&motion.pose), &mut contacts);
            black_box(&contacts);
        }
    });
    row("arms, creepages", 5000, &mut || {
        for motion in &motions {
            black_box(Rolling::new(black_box(motion)));
        }
        for ((side, motion, c), rolling) in touching.iter().zip(&rollings) {
            let footing = Footing::new(contact.source.geometry(*side), black_box(&motion.pose), c);
            black_box(footing.creepages(black_box(rolling)));
        }
    });
    row("creep forces, Polach", 5000, &mut || {
        for (slip, patch) in slips.iter().zip(&patches) {
            black_box(creep::polach(black_box(patch), elasticity, slip, 0.3));
        }
    });
    // As the wheelsets do: four contacts at once.
    let four = |from: usize| {
        let at = |i: usize| from + i;
        let patches = [0, 1, 2, 3].map(|i| patches.get(at(i)).copied().unwrap_or_default());
        (patches, [0, 1, 2, 3].map(|i| slips.get(at(i)).copied().unwrap_or_default()))
    };
    let fours = [four(0), four(4)];
    row("the same, four at once", 5000, &mut || {
        for (patches, slips) in &fours {
            black_box(creep::polach_four(black_box(patches), elasticity, slips, &[0.3; 4]));
        }
    });
    row("creep forces, FASTSIM", 1000, &mut || {
        for (slip, patch) in slips.iter().zip(&patches) {
            black_box(creep::fastsim::<10, 10>(black_box(patch), elasticity, slip, 0.3));
        }
    });
    row("wrench", 5000, &mut || {
        for ((_, _, c), footing) in touching.iter().zip(&footings) {
            black_box(black_box(footing).wrench(c.normal_force, &creep::CreepForces::NONE));
        }
    });
    let mut all = [Default::default(); 2];
    row("all forces, Polach", 5000, &mut || {
        for motion in &motions {
            black_box(contact.forces(black_box(motion), &mut all));
        }
    });
}
