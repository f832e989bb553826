//! Figure 15: what one wheel's contact costs by each method, over the rigid one.

use std::hint::black_box;
use std::time::Instant;

use flangeway::{Pose, Side};

use super::runs::Grounds;
use super::{Check, Plate};
use crate::contact::{Method, Settings};
use crate::error::Result;
use crate::pair::Pair;
use crate::report::plot::{bars, csv};
use crate::report::style::{GREY, INK};
use crate::rigid::two_wheels;

/// Poses, rounds, and lookups of each pose in a round.
const POSES: usize = 48;
const ROUNDS: usize = 7;
const REPEATS: usize = 400;

fn poses(pair: &Pair) -> Vec<Pose> {
    let pose = |i: usize| {
        let share = i as f64 / (POSES - 1) as f64;
        let (lateral, yaw) = (-0.004 + 0.009 * share, 0.03 * (i * 29 % POSES) as f64 / POSES as f64);
        let rest = two_wheels(pair, lateral, yaw)?;
        Some(Pose { lateral, yaw, vertical: rest.vertical + 40e-6, roll: rest.roll })
    };
    (0..POSES).filter_map(pose).collect()
}

/// Seconds for one item.
fn time(items: usize, mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() / items as f64
}

pub(super) fn plate(grounds: &Grounds) -> Result<Plate> {
    let ground = &grounds.urban;
    let poses = poses(&ground.pair);
    let settings = *ground.pair.body(Side::Right).settings();
    let sweep = ground.pair.with_settings(Settings { method: Method::Sweep, ..settings });
    let table = ground.table()?.ok_or_else(|| crate::error::Error::field("", "figure 15", "there is no table"))?;
    let solve = |pair: &Pair, poses: &[Pose]| {
        time(poses.len(), || {
            for pose in poses {
                black_box(pair.solve(Side::Right, black_box(pose)));
            }
        })
    };
    let round = || {
        // The rigid contact from its own table, as in the paper.
        let rigid = time(REPEATS * poses.len(), || {
            for pose in (0..REPEATS).flat_map(|_| &poses) {
                let at = table.coordinates(Side::Right, black_box(pose));
                black_box(table.rigid(Side::Right).vertical(at.lateral, at.yaw, at.roll_offset));
            }
        });
        let lookup = time(REPEATS * poses.len(), || {
            for pose in (0..REPEATS).flat_map(|_| &poses) {
                black_box(table.contacts(Side::Right, black_box(pose)));
            }
        });
        let flat = solve(&ground.flat, &poses);
        let locus = solve(&ground.pair, &poses);
        let by_sweep = solve(&sweep, &poses[..2]);
        [lookup, flat, locus, by_sweep].map(|seconds| seconds / rigid)
    };
    round();
    let rounds: Vec<[f64; 4]> = (0..ROUNDS).map(|_| round()).collect();
    let median = |way: usize| {
        let mut ratios: Vec<f64> = rounds.iter().map(|round| round[way]).collect();
        ratios.sort_by(f64::total_cmp);
        ratios[ROUNDS / 2]
    };
    let [lookup, flat, locus, by_sweep] = [0, 1, 2, 3].map(median);
    let all = [
        ("rigid table", 1.0, GREY),
        ("3-D table", lookup, INK),
        ("2-D on line", flat, GREY),
        ("3-D on line, silhouette", locus, GREY),
        ("3-D on line, sweep", by_sweep, GREY),
    ];
    Ok(Plate {
        number: 15,
        stem: "fig15".into(),
        title: "Cost of each method",
        svg: bars(
            "cost of each method",
            "one wheel's contact, median of paired rounds",
            "time over the rigid table's",
            &all,
        )?,
        csv: csv(
            &["rigid_table", "table_3d", "direct_2d", "direct_3d_silhouette", "direct_3d_sweep"],
            [vec![1.0, lookup, flat, locus, by_sweep]],
        )?,
        theirs: "The lookup costs about as much as the 2-D solution, a little more than the rigid one, and far less than \
                 the 3-D solution on line.",
        ours: format!(
            "Over the rigid table's lookup: the 3-D table {lookup:.1}, 2-D on line {flat:.0}, 3-D on line {locus:.0} by the \
             silhouette and {by_sweep:.0} by the paper's sweep."
        ),
        difference: "The lookup is cheaper than the 2-D solution by far, since both on-line solutions here search along the \
                     whole profile. With the silhouette 3-D costs hardly more than 2-D; the paper's sweep costs much more.",
        checks: vec![
            Check {
                figure: 15,
                claim: "the table lookup costs about as much as 2-D, or less",
                measured: lookup / flat,
                unit: "times the 2-D solution; about is up to 2",
                holds: lookup < 2.0 * flat,
            },
            Check {
                figure: 15,
                claim: "the table lookup costs far less than 3-D on line",
                measured: by_sweep / lookup,
                unit: "times the lookup, for the paper's sweep; far is from 10 on",
                holds: by_sweep > 10.0 * lookup && locus > 10.0 * lookup,
            },
        ],
    })
}
