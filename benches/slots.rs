//! How many slots a record needs: what is lost when several peaks of a wheel share one.
//!
//! A slot that holds several peaks keeps their summed force and gives their force-weighted mean as position. For each
//! number of slots this prints the share of poses in which a slot holds two peaks that carry more than 2 % of the
//! wheel's force each, and how far (rms, force-weighted, over all poses) a peak then lies from its slot's mean along
//! the wheel's profile. Poses are drawn as `verify` draws them. The boundaries of one to three slots are the
//! compiler's, those of "3, other" the pair of 40 places that keeps most peaks apart; four slots have the compiler's and
//! one more, the best of 40 places.

use std::path::Path;

use flangeway::{Displacement, Side, pose_with};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use flangeway_host::rigid;
use flangeway_host::verify::{LOADS, height_for_load};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

const POSES: usize = 8000;
const CARRYING: f64 = 0.02;

/// The peaks of one pose that carry force: wheel-profile coordinate (m) and share of the force.
type Peaks = Vec<[f64; 2]>;

fn draw(recipe: &Recipe, pair: &Pair, seed: u64) -> Option<Peaks> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut uniform = |[low, high]: [f64; 2]| low + (high - low) * random.random::<f64>();
    let grid = &recipe.grid;
    let (u, yaw) = (uniform(grid.lateral_m.range), uniform(grid.yaw_rad.range));
    let roll = rigid::at_displacement(pair, Side::Right, u, yaw)?.roll + uniform(grid.roll_rad.range);
    let load = uniform(LOADS.map(f64::ln)).exp();
    let geometry = pair.body(Side::Right).wheel().geometry();
    let pose = pose_with(geometry, &Displacement { lateral: u, vertical: 0.0 }, yaw, roll);
    let mut column = pair.column(Side::Right, &pose);
    let height = height_for_load(&mut column, load)?;
    let peaks = column.peaks(height);
    let force = |peak: &flangeway_host::contact::Peak| peak.share * peak.state.normal_force();
    let total: f64 = peaks.iter().map(force).sum();
    let shares = peaks.iter().map(|peak| [peak.point.wheel.s, force(peak) / total]);
    Some(shares.filter(|[_, share]| *share > CARRYING).collect())
}

/// Share of poses with a slot of several peaks, and rms distance of the force from its slot's mean (m).
fn loss(poses: &[Peaks], boundaries: &[f64]) -> [f64; 2] {
    let (mut crowded, mut square) = (0, 0.0);
    for peaks in poses {
        let slot = |s: f64| boundaries.iter().filter(|boundary| s <= **boundary).count();
        let mut any = false;
        for k in 0..=boundaries.len() {
            let own: Vec<&[f64; 2]> = peaks.iter().filter(|[s, _]| slot(*s) == k).collect();
            let weight: f64 = own.iter().map(|[_, share]| share).sum();
            let mean = own.iter().map(|[s, share]| s * share).sum::<f64>() / weight.max(1e-12);
            square += own.iter().map(|[s, share]| share * (s - mean).powi(2)).sum::<f64>();
            any |= own.len() > 1;
        }
        crowded += usize::from(any);
    }
    let count = poses.len() as f64;
    [crowded as f64 / count, (square / count).sqrt()]
}

fn main() {
    println!("{:<20} {:<9} {:>18}   {:>16}   boundaries, mm", "pair", "slots", "two peaks in one", "rms distance");
    for table in &flangeway_tables::ALL {
        let recipe = Recipe::parse(table.recipe, Path::new(table.name)).expect("a recipe");
        let pair = Pair::build(&recipe).expect("a pair");
        let seeds: Vec<u64> = (0..POSES as u64).collect();
        let poses: Vec<Peaks> = seeds.par_iter().filter_map(|&seed| draw(&recipe, &pair, seed)).collect();
        let [upper, lower] = pair.body(Side::Right).boundaries();
        let curve = pair.body(Side::Right).wheel().curve();
        let (first, last) = (curve.at(0.0).y, curve.at(curve.length()).y);
        let places: Vec<f64> = (1..40).map(|i| first + (last - first) * f64::from(i) / 40.0).collect();
        let by_loss = |a: &Vec<f64>, b: &Vec<f64>| loss(&poses, a)[1].total_cmp(&loss(&poses, b)[1]);
        let pairs = places.iter().flat_map(|&a| places.iter().filter(move |b| **b < a).map(move |&b| vec![a, b]));
        let third = pairs.min_by(by_loss).expect("places");
        let fourth = places.iter().map(|&extra| vec![upper, lower, extra]).min_by(by_loss).expect("places");
        let rows = [("1", vec![]), ("2", vec![upper]), ("3", vec![upper, lower]), ("3, other", third), ("4", fourth)];
        for (slots, boundaries) in rows {
            let [crowded, distance] = loss(&poses, &boundaries);
            let at: Vec<String> = boundaries.iter().map(|s| format!("{:.1}", 1e3 * s)).collect();
            println!(
                "{:<20} {slots:<9} {:>16.2} %   {:>13.3} mm   {}",
                table.name,
                100.0 * crowded,
                1e3 * distance,
                at.join(", ")
            );
        }
        let most = poses.iter().map(Vec::len).max().unwrap_or(0);
        let three = poses.iter().filter(|peaks| peaks.len() > 2).count();
        println!("{:<20} at most {most} peaks at once, three or more in {three} of {} poses", "", poses.len());
    }
}
