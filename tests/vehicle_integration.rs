//! The integration of vehicles: its order by halving the step, the energy of a frictionless wheelset, the mirror.

use std::path::Path;

use flangeway::creep::{Elasticity, Friction};
use flangeway_host::dynamics::body::{FrameTurn, LATERAL, ROLL, VERTICAL, Vector5, YAW};
use flangeway_host::dynamics::run::Ground;
use flangeway_host::dynamics::scenario::Scenario;
use flangeway_host::dynamics::source::Source;
use flangeway_host::dynamics::track::{GRAVITY, Section, Track};
use flangeway_host::dynamics::vehicle::{Line, Vehicle};
use flangeway_host::dynamics::wheel_rail::{Law, WheelRail};
use flangeway_host::dynamics::wheelset::{Inputs, Parameters, Wheelset};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;

/// Cones on round rails: Hertz's coefficients hardly depend on the pose, so normal forces are those of a potential.
const CONES: &str = r#"
[wheel]
profile = "cone:1/20"
nominal_radius_m = 0.46
flange_back_spacing_m = 1.36
flange_back_position_m = -0.07
[rail]
profile = "circular_rail:0.3"
gauge_m = 1.435
gauge_height_m = 0.003
[material]
youngs_modulus_pa = 2.1e11
poisson_ratio = 0.28
[grid]
lateral_m = { range = [-0.01, 0.01], nodes = 3 }
yaw_rad = { range = [0.0, 0.02], nodes = 3 }
vertical_m = { range = [-5.0e-5, 1.5e-4], nodes = 3 }
roll_rad = { range = [-1.0e-3, 1.0e-3], nodes = 3 }
"#;

const WHEELSET: Parameters = Parameters { mass_kg: 1500.0, roll_yaw_inertia_kgm2: 1050.0, spin_inertia_kgm2: 110.0 };
const SPEED: f64 = 20.0;

fn cones() -> Pair {
    Pair::build(&Recipe::parse(CONES, Path::new("cones.toml")).unwrap()).unwrap()
}

fn frictionless(pair: &Pair) -> WheelRail<'_> {
    WheelRail {
        source: Source::Direct(pair),
        law: Law::Polach,
        friction: Friction::constant(0.0),
        elasticity: Elasticity::STEEL,
        damping: 0.0,
    }
}

/// Load on the axle beside its own weight, N.
const LOAD: f64 = 60e3;

/// Kinetic, gravitational and elastic energy, J: N = C δ^1.5 stores 2/5 N δ.
fn energy(wheelset: &Wheelset) -> f64 {
    let (q, v) = (&wheelset.body.position, &wheelset.body.velocity);
    let [about, across] = [WHEELSET.spin_inertia_kgm2, WHEELSET.roll_yaw_inertia_kgm2];
    let kinetic = WHEELSET.mass_kg * (v[LATERAL].powi(2) + v[VERTICAL].powi(2))
        + across * (v[ROLL].powi(2) + (v[YAW] * q[ROLL].cos()).powi(2))
        + about * v[4].powi(2);
    let touches = wheelset.wheels.iter().flat_map(|w| w.touches).flatten();
    let elastic: f64 =
        touches.map(|t| 0.4 * f64::from(t.contact.normal_force) * f64::from(t.contact.indentation)).sum();
    0.5 * kinetic - (WHEELSET.mass_kg * GRAVITY + LOAD) * q[VERTICAL] + elastic
}

/// Runs a bouncing, swaying, frictionless wheelset; the largest deviation of its energy and where it ends.
fn bounce(pair: &Pair, step: f64, time: f64) -> (f64, Vector5) {
    let contact = frictionless(pair);
    let mut loads = Vector5::zeros();
    loads[VERTICAL] = LOAD;
    let inputs = Inputs { speed: SPEED, loads, ..Inputs::default() };
    let mut wheelset = Wheelset::default();
    wheelset.body.position = Vector5::new(1e-3, 40e-6, 30e-6, 2e-3, 0.0);
    wheelset.body.velocity = Vector5::new(5e-3, 20e-3, 30e-3, 5e-3, SPEED / 0.46);
    wheelset.step(0.0, FrameTurn::default(), &inputs, &WHEELSET, &contact);
    let acceleration = wheelset.body.acceleration;
    wheelset.body.start(acceleration);
    let start = energy(&wheelset);
    let mut worst = 0.0_f64;
    for _ in 0..(time / step).round() as usize {
        wheelset.step(step, FrameTurn::default(), &inputs, &WHEELSET, &contact);
        worst = worst.max((energy(&wheelset) - start).abs());
    }
    (worst, wheelset.body.position)
}

#[test]
fn a_frictionless_wheelset_keeps_its_energy_to_the_second_order() {
    let pair = cones();
    let [coarse, middle, fine] = [2e-4, 1e-4, 5e-5].map(|step| bounce(&pair, step, 0.2).0);
    println!("energy off by {coarse:.2e}, {middle:.2e}, {fine:.2e} J at 0.2, 0.1, 0.05 ms");
    // Second order: sixteen times less for a quarter of the step.
    assert!(middle < coarse && fine < middle && (12.0..22.0).contains(&(coarse / fine)));
    // Of the energy that goes to and fro, some joules, next to nothing.
    assert!(fine < 0.01, "{fine}");
}

#[test]
fn a_frictionless_wheelset_spins_on() {
    let pair = cones();
    let contact = frictionless(&pair);
    let inputs = Inputs { speed: SPEED, loads: Vector5::new(0.0, LOAD, 0.0, 0.0, 0.0), ..Inputs::default() };
    let mut wheelset = Wheelset::default();
    wheelset.body.position = Vector5::new(1e-3, 40e-6, 0.0, 5e-3, 0.0);
    wheelset.body.velocity[4] = 40.0;
    for _ in 0..1000 {
        wheelset.step(1e-4, FrameTurn::default(), &inputs, &WHEELSET, &contact);
    }
    // Normal forces pass through the axle; what is left is the rounding of contact points to f32.
    assert!((wheelset.body.velocity[4] - 40.0).abs() < 1e-4, "{}", wheelset.body.velocity[4]);
}

/// Runs the committed bogie into its curve, on straight track first; where its bodies stand then.
fn bogie(step: f64, contact: &WheelRail<'_>, scenario: &Scenario) -> Vec<f64> {
    let section = |length, curvature: [f64; 2]| Section { length, curvature, cant: [0.0; 2] };
    // The begin of a transition: smooth, before anything jumps.
    let track = Track::new(&[section(2.0, [0.0; 2]), section(60.0, [0.0, -1.0 / 300.0])]);
    let irregularity = Default::default();
    let line = Line { track: &track, irregularity: &irregularity, contact, speed: 15.0 };
    let mut vehicle = Vehicle::at_rest(scenario.parameters(), &line).unwrap();
    for _ in 0..(0.6 / step).round() as usize {
        vehicle.step(step, &line);
    }
    let bodies = vehicle.wheelsets.iter().map(|w| w.body).chain([vehicle.frame]);
    bodies.flat_map(|body| body.position.iter().take(4).copied().collect::<Vec<_>>()).collect()
}

#[test]
fn halving_the_step_quarters_the_error() {
    let scenario = Scenario::parse(flangeway_tables::BOGIE_R60, Path::new("bogie_r60.toml")).unwrap();
    let ground = Ground::of(&scenario).unwrap();
    let contact = WheelRail {
        source: Source::Direct(&ground.pair),
        law: Law::Polach,
        friction: scenario.contact.friction(),
        elasticity: ground.elasticity(),
        damping: scenario.contact.damping_s_per_m,
    };
    let [a, b, c] = [2e-4, 1e-4, 5e-5].map(|step| bogie(step, &contact, &scenario));
    let distance = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    let (first, second) = (distance(&a, &b), distance(&b, &c));
    println!("differences {first:.2e} and {second:.2e}: order {:.2}", (first / second).log2());
    assert!((1.6..2.6).contains(&(first / second).log2()));
}

#[test]
fn a_left_hand_curve_is_the_mirror_image_of_a_right_hand_one() {
    let mut scenario = Scenario::parse(flangeway_tables::BOGIE_R60, Path::new("bogie_r60.toml")).unwrap();
    let ground = Ground::of(&scenario).unwrap();
    scenario.sections.truncate(3);
    scenario.sections[2].length_m = 5.0;
    let hidden = indicatif::ProgressBar::hidden();
    let left = flangeway_host::dynamics::run::run(&scenario, &ground, &hidden).unwrap();
    let curve = &mut scenario.sections[2];
    (curve.radius_m, curve.cant_rad) = (curve.radius_m.map(|r| -r), curve.cant_rad.map(|c| -c));
    let right = flangeway_host::dynamics::run::run(&scenario, &ground, &hidden).unwrap();
    let (l, r) = (left.last().unwrap(), right.last().unwrap());
    for (a, b) in l.wheelsets.iter().zip(&r.wheelsets) {
        let (p, q) = (a.body.position, b.body.position);
        for (i, sign) in [(LATERAL, -1.0), (VERTICAL, 1.0), (ROLL, -1.0), (YAW, -1.0)] {
            assert!((p[i] - sign * q[i]).abs() < 1e-9, "{i}: {} {}", p[i], q[i]);
        }
        let outer = [a.wheels[0].loads.wheel_load, b.wheels[1].loads.wheel_load];
        assert!((outer[0] - outer[1]).abs() < 1.0, "{outer:?}");
    }
    assert!(l.wheelsets[0].body.position[LATERAL] > 4e-3, "the outer flange leads");
}

/// Where and how a led wheelset with these dampers (N s/m) ends in a curve: lateral position and yaw.
fn ends_in_a_curve(damping: f64) -> [f64; 2] {
    let text = flangeway_tables::WHEELSET_R1000
        .replace("damping_ns_per_m = [1.0e4, 1.0e4, 2.0e4]", &format!("damping_ns_per_m = [{damping:e}, 1.0e4, 2.0e4]"))
        .replace("stiffness_n_per_m = [2.0e7", "stiffness_n_per_m = [2.0e6");
    let scenario = Scenario::parse(&text, Path::new("wheelset.toml")).unwrap();
    let ground = Ground::of(&scenario).unwrap();
    let table = ground.table().unwrap().unwrap();
    let contact = WheelRail {
        source: Source::Table(&table),
        law: Law::Polach,
        friction: scenario.contact.friction(),
        elasticity: ground.elasticity(),
        damping: scenario.contact.damping_s_per_m,
    };
    let (track, irregularity) = (scenario.track(), Default::default());
    let line = Line { track: &track, irregularity: &irregularity, contact: &contact, speed: 15.0 };
    let mut vehicle = Vehicle::at_rest(scenario.parameters(), &line).unwrap();
    while vehicle.distance < track.length() {
        vehicle.step(1e-4, &line);
    }
    [LATERAL, YAW].map(|i| vehicle.wheelsets[0].body.position[i])
}

#[test]
fn dampers_do_nothing_in_a_steady_curve() {
    let ([y, yaw], [damped_y, damped_yaw]) = (ends_in_a_curve(1e4), ends_in_a_curve(3e5));
    // What leads the wheelset turns with the curve as it does. A frame at rest would turn it by 2 d² c V κ / (2 d² k).
    let at_rest = (3e5 - 1e4) * 15.0 / 1000.0 / 2e6;
    println!("yaw {yaw:e}, damped {damped_yaw:e}; by a frame at rest {at_rest:e} more");
    assert!((damped_yaw - yaw).abs() < 1e-3 * at_rest, "{yaw:e} {damped_yaw:e}");
    assert!((damped_y - y).abs() < 1e-7, "{y:e} {damped_y:e}");
}
