//! Cost of one wheel's contacts: direct solver in 2-D and 3-D (silhouette, and the paper's sweep), and the table.
//!
//! Absolute times depend on the machine; compare the rows of one run with each other (the paper's figure 15).

#![allow(missing_docs, reason = "criterion_group! makes a public function")]

mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use flangeway::{ContactTable, Pose, Side};
use flangeway_host::compile::{Uniform, compile};
use flangeway_host::contact::{Dimension, Method, Settings};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use flangeway_host::rigid;
use std::hint::black_box;
use std::path::Path;

/// Poses over the range of the table, 30 micrometres into the rigid contact.
fn poses(pair: &Pair) -> Vec<Pose> {
    let pose = |i: usize| {
        let (lateral, yaw) = (-0.005 + 0.0117 * i as f64 / 63.0, 0.02 * (i * 29 % 64) as f64 / 63.0);
        let rest = rigid::two_wheels(pair, lateral, yaw)?;
        Some(Pose { lateral, yaw, vertical: rest.vertical + 30e-6, roll: rest.roll })
    };
    (0..64).filter_map(pose).collect()
}

fn contacts(criterion: &mut Criterion) {
    let recipe = Recipe::parse(flangeway_tables::S1002_60E1_40, Path::new("s1002_60e1_40.toml")).expect("a recipe");
    let pair = Pair::build(&recipe).expect("a pair");
    let poses = poses(&pair);
    let mut group = criterion.benchmark_group("one wheel, 64 poses");
    let default = *pair.body(Side::Right).settings();
    let methods = [
        ("direct 2-D", Settings { dimension: Dimension::Two, ..default }),
        ("direct 3-D, silhouette", default),
        ("direct 3-D, sweep", Settings { method: Method::Sweep, ..default }),
    ];
    for (name, settings) in methods {
        let pair = pair.with_settings(settings);
        group.sample_size(10).bench_function(name, |b| {
            b.iter(|| poses.iter().map(|pose| pair.solve(Side::Right, black_box(pose))[0].indentation).sum::<f64>());
        });
    }
    let image = compile(&recipe, &pair, Some(Uniform { counts: [121, 9, 5, 3] })).expect("a table").image;
    let table = ContactTable::new(&image).expect("a table");
    group.sample_size(50).bench_function("table", |b| {
        let force = |pose: &Pose| table.contacts(Side::Right, black_box(pose)).total_normal_force();
        b.iter(|| poses.iter().map(force).sum::<f32>());
    });
    group.finish();
}

/// Median time of each way over that of the rigid table, as the paper's figure 15 has it.
fn ratios(_: &mut Criterion) {
    let (_, pair) = common::pair();
    let poses = poses(&pair);
    let table = common::table();
    let default = *pair.body(Side::Right).settings();
    let (two, sweep) = (
        pair.with_settings(Settings { dimension: Dimension::Two, ..default }),
        pair.with_settings(Settings { method: Method::Sweep, ..default }),
    );
    let at: Vec<_> = poses.iter().map(|pose| table.coordinates(Side::Right, pose)).collect();
    let mut by_rigid = || {
        for at in (0..20_000).flat_map(|_| &at) {
            black_box(table.rigid(Side::Right).vertical(black_box(at.lateral), at.yaw, at.roll_offset));
        }
    };
    let solved = |pair: &Pair, poses: &[Pose]| {
        poses.iter().for_each(|pose| {
            black_box(pair.solve(Side::Right, black_box(pose)));
        });
    };
    let (mut by_two, mut by_locus) = (|| solved(&two, &poses), || solved(&pair, &poses));
    // The sweep takes a hundred times as long: fewer poses.
    let mut by_sweep = || solved(&sweep, &poses[..4]);
    let mut by_table = || {
        for pose in (0..10_000).flat_map(|_| &poses) {
            black_box(table.contacts(Side::Right, black_box(pose)));
        }
    };
    let done = [20_000 * poses.len(), poses.len(), 4, poses.len(), 10_000 * poses.len()];
    let mut ways: [&mut dyn FnMut(); 5] = [&mut by_rigid, &mut by_two, &mut by_sweep, &mut by_locus, &mut by_table];
    let times = common::rounds(9, 1, &mut ways);
    println!("\none wheel, time over the rigid table's (9 paired rounds, lower and upper quartile)");
    for (way, name) in
        ["rigid table", "2-D direct", "3-D direct, sweep", "3-D direct, locus", "3-D table"].iter().enumerate()
    {
        let each = |round: &[f64; 5], way: usize| round[way] / done[way] as f64;
        let [low, median, high] =
            common::quartiles(times.iter().map(|round| each(round, way) / each(round, 0)).collect());
        println!("  {name:18} {median:10.2} ({low:.2} to {high:.2})");
    }
}

criterion_group!(benches, contacts, ratios);
criterion_main!(benches);
