//! Time of one pose by the three models of normal contact, on the Manchester pair, one core: processor time.
//!
//! `cargo bench --bench normal_contact`: median and 95 % quantile over 300 random poses, 5 to 150 kN. The half-space with
//! its own elements (0.4 mm x 0.2 mm at the most) and with 0.2 mm x 0.2 mm, CONTACT's usual ones.

use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Instant;

use flangeway::{Pose, Side};
use flangeway_host::campaign;
use flangeway_host::contact::{Normal, Settings, SlotState};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use flangeway_host::rigid;
use flangeway_host::verify::{LOADS, height_for_load, quantile};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const POSES: usize = 300;

fn main() {
    let text = flangeway_tables::S1002_60E1_40;
    let pair = Pair::build(&Recipe::parse(text, "recipe.toml".as_ref()).unwrap()).unwrap();
    let poses = poses(&pair);
    let default = *pair.body(Side::Right).settings();
    let models = [
        ("Hertz", default),
        ("semi-Hertzian", Settings { normal: Normal::SemiHertzian, ..default }),
        ("half-space", Settings { normal: Normal::HalfSpace, ..default }),
        ("half-space, 0.2 mm", Settings { normal: Normal::HalfSpace, elements: [2e-4; 2], ..default }),
        ("half-space, 0.1 mm", Settings { normal: Normal::HalfSpace, elements: [1e-4; 2], ..default }),
    ];
    let mut finest = Vec::new();
    println!(
        "time a pose (ms): median, 95 %, longest; total force less that of 0.1 mm elements (%): median, 95 %, largest"
    );
    for (name, settings) in models.into_iter().rev() {
        let pair = pair.with_settings(settings);
        let (mut times, mut forces) = (Vec::new(), Vec::new());
        // What a program makes once, at the first use, is not a pose's: tables of integrals, plans of transforms.
        pair.solve(Side::Right, &poses[0]);
        for pose in &poses {
            let start = seconds();
            let slots = black_box(pair.solve(Side::Right, black_box(pose)));
            times.push(1e3 * (seconds() - start));
            forces.push(slots.iter().map(SlotState::normal_force).sum::<f64>());
        }
        if finest.is_empty() {
            finest.clone_from(&forces);
        }
        let mut apart: Vec<f64> = forces.iter().zip(&finest).map(|(a, b)| 1e2 * (a / b - 1.0).abs()).collect();
        times.sort_by(f64::total_cmp);
        apart.sort_by(f64::total_cmp);
        let figures = |sorted: &[f64]| [0.5, 0.95, 1.0].map(|share| quantile(sorted, share));
        println!("{name:>20}: {:7.3?}  {:7.3?}", figures(&times), figures(&apart));
    }
}

/// Processor time of this thread (s), where the system tells; else the clock's.
fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    campaign::cpu_seconds().unwrap_or_else(|| START.elapsed().as_secs_f64())
}

/// Random poses of the right wheel.
fn poses(pair: &Pair) -> Vec<Pose> {
    let mut generator = Pcg64::seed_from_u64(1);
    let mut within = |[low, high]: [f64; 2]| low + (high - low) * generator.random::<f64>();
    let mut poses = Vec::new();
    while poses.len() < POSES {
        let (u, yaw, offset) = (within([-6e-3, 9e-3]), within([0.0, 0.024]), within([-1e-3, 1e-3]));
        let load = LOADS[0] * (LOADS[1] / LOADS[0]).powf(within([0.0, 1.0]));
        let Some(rest) = rigid::at_displacement(pair, Side::Right, u, yaw) else { continue };
        let at = flangeway::Displacement { lateral: u, vertical: 0.0 };
        let geometry = pair.body(Side::Right).wheel().geometry();
        let pose = flangeway::pose_with(geometry, &at, yaw, rest.roll + offset);
        let mut column = pair.column(Side::Right, &pose);
        poses.extend(height_for_load(&mut column, load).map(|vertical| Pose { vertical, ..pose }));
    }
    poses
}
