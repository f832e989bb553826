//! What the benches share: a table, poses, paired rounds.
#![allow(dead_code, unreachable_pub, reason = "each bench takes a part of this")]

use std::path::Path;
use std::sync::LazyLock;
use std::time::Instant;

use flangeway::{AxisName, ContactTable, Coordinates, Pose, Side};
use flangeway_host::compile::{Uniform, compile};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Counts of the table's nodes: a mebibyte of records.
pub const COUNTS: [usize; 4] = [121, 9, 5, 3];

/// S1002 on 60E1 1:40.
pub fn pair() -> (Recipe, Pair) {
    let recipe = Recipe::parse(flangeway_tables::S1002_60E1_40, Path::new("s1002_60e1_40.toml")).expect("a recipe");
    let pair = Pair::build(&recipe).expect("a pair");
    (recipe, pair)
}

/// A table with evenly spaced nodes, its records on a multiple of 64 bytes.
pub fn table() -> ContactTable<'static> {
    let (recipe, pair) = pair();
    let image = compile(&recipe, &pair, Some(Uniform { counts: COUNTS })).expect("a table").image;
    ContactTable::new(aligned(&image)).expect("a table")
}

/// The image on a multiple of 64 bytes, for good.
pub fn aligned(image: &[u8]) -> &'static [u8] {
    let mut bytes = vec![0; image.len() + 64];
    let start = bytes.as_ptr().align_offset(64);
    bytes[start..start + image.len()].copy_from_slice(image);
    let bytes: &'static [u8] = bytes.leak();
    &bytes[start..start + image.len()]
}

/// Random poses of the right wheel over the whole table.
pub fn random_poses(table: &ContactTable<'_>, count: usize, seed: u64) -> Vec<Pose> {
    let mut stream = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| pose_at(table, std::array::from_fn(|_| stream.random_range(0.0..1.0)))).collect()
}

/// Poses along a smooth run over the table.
pub fn trajectory(table: &ContactTable<'_>, count: usize) -> Vec<Pose> {
    let wave = |i: usize, periods: f64| 0.5 + 0.45 * (std::f64::consts::TAU * periods * i as f64 / count as f64).sin();
    (0..count).map(|i| pose_at(table, [wave(i, 3.0), wave(i, 5.0), wave(i, 7.0), wave(i, 11.0)])).collect()
}

/// The pose at fractions of the records' axes, lateral, yaw, roll offset, vertical.
pub fn pose_at(table: &ContactTable<'_>, fractions: [f64; 4]) -> Pose {
    let [lateral, yaw, roll_offset, vertical] = std::array::from_fn(|i| {
        let (first, last) = table.axis(AxisName::ALL[i]).range();
        first + fractions[i] * (last - first)
    });
    let at = Coordinates { lateral, yaw, roll_offset, vertical };
    table.rigid(Side::Right).pose(&table.header().right.geometry, &at)
}

/// Processor time of this thread (s), so that what the scheduler gives others does not count; else the time of day.
pub fn seconds() -> f64 {
    static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
    flangeway_host::campaign::cpu_seconds().unwrap_or_else(|| BEGIN.elapsed().as_secs_f64())
}

/// Nanoseconds an item takes in each of several ways, round by round: the ways take turns, so that whatever else the
/// machine does falls on all of them. `ways` are called with nothing and do `items` items.
pub fn rounds<const N: usize>(count: usize, items: usize, ways: &mut [&mut dyn FnMut(); N]) -> Vec<[f64; N]> {
    ways.iter_mut().for_each(|way| way());
    (0..count)
        .map(|_| {
            std::array::from_fn(|i| {
                let start = seconds();
                ways[i]();
                (seconds() - start) * 1e9 / items as f64
            })
        })
        .collect()
}

/// Lower quartile, median and upper quartile.
pub fn quartiles(mut numbers: Vec<f64>) -> [f64; 3] {
    numbers.sort_by(f64::total_cmp);
    [1, 2, 3].map(|i| numbers[(numbers.len() - 1) * i / 4])
}

/// Value of an option `--name VALUE`.
pub fn option(name: &str) -> Option<String> {
    std::env::args().skip_while(|argument| argument != name).nth(1)
}
