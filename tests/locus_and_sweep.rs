//! The closed-form silhouette against the paper's sweep of sections, over random poses.

use std::time::Instant;

use crate::common::{self, Draws, MM};
use flangeway::{Pose, Side};
use flangeway_host::contact::{Body, Method, Peak};
use flangeway_host::contacts::track_position;
use flangeway_host::pair::Pair;
use flangeway_host::rigid::two_wheels;
use flangeway_host::verify::height_for_load;
use rayon::prelude::*;

const POSES: usize = 2000;
const UM: f64 = 1e-6;
/// Two peaks of a slot nearer to each other in depth than this (m) compete: either may be the slot's contact.
const COMPETING: f64 = 0.5 * UM;
/// Allowed differences of x and of the indentation (m).
const X: f64 = 0.05 * MM;
const INDENTATION: f64 = 0.2 * UM;

/// One slot that carries force, by both methods.
struct Compared {
    slot: usize,
    pose: Pose,
    x: [f64; 2],
    indentation: [f64; 2],
    force: [f64; 2],
    competing: bool,
}

impl Compared {
    fn apart(&self) -> [f64; 2] {
        [(self.x[1] - self.x[0]).abs(), (self.indentation[1] - self.indentation[0]).abs()]
    }

    fn agree(&self) -> bool {
        let [x, indentation] = self.apart();
        x <= X && indentation <= INDENTATION
    }
}

/// Poses of the right wheel: lateral -6 to 9 mm, yaw 0 to 40 mrad, roll within 1 mrad of the rigid one, load log-uniform
/// from 5 to 150 kN.
fn pose(pair: &Pair, index: usize) -> Option<Pose> {
    let mut draws = Draws::new(0x10c5 + index as u64);
    let (lateral, yaw) = (draws.within(-6.0 * MM, 9.0 * MM), draws.within(0.0, 0.04));
    let roll = two_wheels(pair, lateral, yaw)?.roll + draws.within(-1e-3, 1e-3);
    let load = draws.within(5e3_f64.ln(), 150e3_f64.ln()).exp();
    let pose = Pose { lateral, yaw, vertical: 0.0, roll };
    let vertical = height_for_load(&mut pair.column(Side::Right, &pose), load)?;
    Some(Pose { vertical, ..pose })
}

fn slot_of(body: &Body, peak: &Peak) -> usize {
    let [upper, lower] = body.boundaries();
    usize::from(peak.point.wheel.s <= upper) + usize::from(peak.point.wheel.s <= lower)
}

fn compare(locus: &Pair, sweep: &Pair, pose: &Pose) -> Vec<Compared> {
    let side = Side::Right;
    let body = locus.body(side);
    let peaks = locus.column(side, pose).peaks(pose.vertical);
    let by_locus = locus.solve(side, pose);
    let by_sweep = sweep.solve(side, pose);
    (0..by_locus.len())
        .filter(|&slot| by_locus[slot].normal_force() > 0.0)
        .map(|slot| {
            let depths: Vec<f64> = peaks.iter().filter(|p| slot_of(body, p) == slot).map(|p| p.point.depth()).collect();
            let top = depths.iter().copied().fold(f64::MIN, f64::max);
            let states = [&by_locus[slot], &by_sweep[slot]];
            Compared {
                slot,
                pose: *pose,
                x: states.map(|s| track_position(locus, side, pose, s)[0]),
                indentation: states.map(|s| s.indentation),
                force: states.map(|s| s.normal_force()),
                competing: depths.iter().filter(|d| **d > top - COMPETING).count() > 1,
            }
        })
        .collect()
}

fn check(name: &str, locus: &Pair) {
    let start = Instant::now();
    let sweep = locus.with_method(Method::Sweep);
    let poses: Vec<Pose> = (0..POSES).into_par_iter().filter_map(|i| pose(locus, i)).collect();
    assert_eq!(poses.len(), POSES, "every pose drawn reaches its load");
    let compared: Vec<Compared> = poses.par_iter().flat_map_iter(|p| compare(locus, &sweep, p)).collect();
    let (competing, clear): (Vec<&Compared>, Vec<&Compared>) = compared.iter().partition(|c| c.competing);
    let worst = |set: &[&Compared], k: usize| set.iter().map(|c| c.apart()[k]).fold(0.0, f64::max);
    let force = clear.iter().map(|c| (c.force[1] - c.force[0]).abs() / c.force[0].max(5e3)).fold(0.0, f64::max);
    let in_slot = |slot| compared.iter().filter(|c| c.slot == slot).count();
    println!(
        "{name}: {POSES} poses, slots in contact: tread {}, flange root {}, flange {}; worst x {:.4} mm, indentation \
         {:.5} um, force {:.4} %; {:.1} s",
        in_slot(0),
        in_slot(1),
        in_slot(2),
        worst(&clear, 0) / MM,
        worst(&clear, 1) / UM,
        1e2 * force,
        start.elapsed().as_secs_f64()
    );
    println!(
        "  {} with two peaks within 0.5 um, of which {} differ (worst x {:.3} mm, indentation {:.4} um)",
        competing.len(),
        competing.iter().filter(|c| !c.agree()).count(),
        worst(&competing, 0) / MM,
        worst(&competing, 1) / UM
    );
    let failed: Vec<&&Compared> = clear.iter().filter(|c| !c.agree()).collect();
    for c in failed.iter().take(20) {
        println!(
            "  slot {} at {:?}: x {:.4} / {:.4} mm, indentation {:.4} / {:.4} um, force {:.1} / {:.1} N",
            c.slot,
            c.pose,
            c.x[0] / MM,
            c.x[1] / MM,
            c.indentation[0] / UM,
            c.indentation[1] / UM,
            c.force[0],
            c.force[1]
        );
    }
    assert!(failed.is_empty(), "{} of {} slots differ", failed.len(), clear.len());
}

#[test]
fn built_in_pair() {
    check("s1002 on 60e1", &Pair::build(&common::built_in()).unwrap());
}

#[test]
fn manchester_files() {
    if let Some(recipe) = common::manchester_files() {
        check("Manchester files", &Pair::build(&recipe).unwrap());
    }
}
