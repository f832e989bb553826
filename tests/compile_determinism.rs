//! The same recipe gives the same bytes, and a wheelset of two different wheels gives each side its own answer.

use crate::common::{self, Draws, Small};
use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use flangeway_host::compile::{Uniform, compile};
use flangeway_host::pair::Pair;
use flangeway_host::verify;

const NODES: &str = "21x3x3x3";

/// The built-in recipe with another left wheel.
fn with_left_wheel(profile: &str) -> String {
    let (before, after) = flangeway_tables::S1002_60E1_40.split_once("\n[rail]").unwrap();
    format!("{before}\n[wheel.left]\nprofile = \"{profile}\"\n\n[rail]{after}")
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    for text in [flangeway_tables::S1002_60E1_40.to_owned(), with_left_wheel("cone:1/20")] {
        let image = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Small::of(common::recipe(&text), NODES).image)
        };
        let first = image(1);
        for threads in [2, 5, 5] {
            let again = image(threads);
            assert_eq!(first.len(), again.len());
            let differs = first.iter().zip(&again).position(|(a, b)| a != b);
            assert_eq!(differs, None, "{threads} threads: the first byte that differs");
        }
        println!("{} bytes, the same for 1, 2, 5 and again 5 threads", first.len());
    }
}

/// Contacts by table and solver at random loaded poses: the share of force by which they differ, sorted.
fn force_errors(table: &ContactTable<'_>, pair: &Pair, side: Side) -> Vec<f64> {
    let samples = verify::sample(table, pair, side, 1000, 8);
    assert!(samples.len() > 900, "{} of 1000 poses reach their load", samples.len());
    let mut errors: Vec<f64> = samples.iter().map(verify::Sample::force_error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn each_side_answers_by_its_own_profile() {
    let small = Small::of(common::recipe(&with_left_wheel("cone:1/20")), "81x5x3x3");
    let table = ContactTable::new(&small.image).unwrap();
    assert_eq!((table.header().sides(), small.pair.sides()), (2, 2));
    assert_eq!((table.header().side(Side::Right).wheel, table.header().side(Side::Left).wheel), ("s1002", "cone:1/20"));
    for side in Side::ALL {
        let errors = force_errors(&table, &small.pair, side);
        let at = |q| 1e2 * verify::quantile(&errors, q);
        println!("{side}: force error median {:.3} %, p95 {:.2} %, largest {:.1} %", at(0.5), at(0.95), at(1.0));
        assert!(at(0.5) < 1.0 && at(0.95) < 15.0);
    }
    // A cone has the curvature 0 and the slope 1:20 wherever it touches.
    let mut draws = Draws::new(9);
    let geometry = table.header().side(Side::Left).geometry;
    let mut contacts = 0;
    for _ in 0..1000 {
        let [lateral, yaw, roll_offset] = [AxisName::Lateral, AxisName::Yaw, AxisName::RollOffset].map(|name| {
            let (first, last) = table.axis(name).range();
            draws.within(first, last)
        });
        let at = Coordinates { lateral, yaw, roll_offset, vertical: 8e-5 };
        let pose = common::on_side(Side::Left, &table.rigid(Side::Left).pose(&geometry, &at));
        let found = table.contacts(Side::Left, &pose);
        for contact in found.iter() {
            // The left wheel leans by its own conicity and the roll; its angle is positive on the gauge side.
            let expected = 0.05_f64.atan() + pose.roll;
            assert!((f64::from(contact.angle) - expected).abs() < 2e-3, "{pose:?}: {contact:?}");
            assert!(contact.wheel_curvature.abs() < 1e-3, "{contact:?}");
            let radius = geometry.nominal_radius - 0.05 * f64::from(contact.wheel_coordinate);
            assert!((f64::from(contact.rolling_radius) - radius).abs() < 1e-5);
            contacts += 1;
        }
    }
    assert!(contacts >= 1000, "{contacts}");
    // The right wheel is the S1002 of the one-sided table, on another rigid contact.
    let pose = Pose { lateral: 0.002, yaw: 0.003, vertical: 2.5e-4, roll: 0.0 };
    assert_ne!(table.contacts(Side::Right, &pose), table.contacts(Side::Left, &pose));
}

#[test]
fn a_left_wheel_like_the_right_one_changes_nothing() {
    let one = Small::of(common::built_in(), NODES);
    let two = Small::of(common::recipe(&with_left_wheel("s1002")), NODES);
    let (one_sided, two_sided) = (ContactTable::new(&one.image).unwrap(), ContactTable::new(&two.image).unwrap());
    assert_eq!((one_sided.header().sides(), two_sided.header().sides()), (1, 2));
    let geometry = one_sided.header().side(Side::Left).geometry;
    let mut draws = Draws::new(10);
    let mut contacts = 0;
    for _ in 0..20_000 {
        let [lateral, yaw, roll_offset, vertical] = AxisName::ALL.map(|name| {
            let (first, last) = one_sided.axis(name).range();
            draws.within(first, last)
        });
        let at = Coordinates { lateral, yaw, roll_offset, vertical };
        for side in Side::ALL {
            let pose = common::on_side(side, &one_sided.rigid(side).pose(&geometry, &at));
            let (a, b) = (one_sided.contacts(side, &pose), two_sided.contacts(side, &pose));
            assert_eq!(a, b, "{side} at {pose:?}");
            contacts += a.list.len();
        }
    }
    println!("{contacts} contacts, the same to the last bit");
}

#[test]
fn counts_that_do_not_fit_are_refused() {
    let recipe = common::built_in();
    let pair = Pair::build(&recipe).unwrap();
    assert!("1x3x3x3".parse::<Uniform>().is_err());
    let poor = common::recipe(&flangeway_tables::S1002_60E1_40.replace("1_048_576", "10_000"));
    let message = compile(&poor, &pair, None).unwrap_err().to_string();
    println!("{message}");
    assert!(message.starts_with("recipe.toml: grid.max_bytes: 10000 is too little"), "{message}");
}
