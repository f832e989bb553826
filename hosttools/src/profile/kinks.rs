//! Kinks of a measured or tabulated contour: corners that a smooth curve must not round.

use super::Joint;
use super::reading::{counted, list};

/// Least turn (rad) of a kink, 8°, beyond what the contour turns around it.
const LEAST_TURN: f64 = 8.0 * std::f64::consts::PI / 180.0;
/// A kink stands out by this many times over each near neighbour: a noisy point's neighbours turn back at least half
/// as much as it turns.
const OVER_NEIGHBOURS: f64 = 4.0;
/// Near neighbours on each side.
const NEIGHBOURS: usize = 3;
/// A kink stands out by this many times over the upper quartile around it, the measure of noise.
const OVER_NOISE: f64 = 8.0;
/// Points on each side whose median turn is that of the contour: a densely sampled small radius is no kink.
const AROUND: usize = 10;

/// The kinks as joints without tangents: those are the neighbouring pieces' own.
pub(super) fn find(points: &[[f64; 2]], lines: &[usize], said: &mut Vec<String>) -> Vec<Joint> {
    // turns[k] is the turn at point k + 1
    let turns: Vec<f64> = points.windows(3).map(|w| turn(w[0], w[1], w[2])).collect();
    let joints: Vec<Joint> = (0..turns.len())
        .filter(|&k| is_kink(&turns, k))
        .map(|k| Joint { index: k + 1, tangent_before: None, tangent_after: None })
        .collect();
    if !joints.is_empty() {
        let mut at: Vec<usize> = joints.iter().filter_map(|j| lines.get(j.index).copied()).collect();
        at.sort_unstable();
        let joints = if at.len() == 1 { "a joint" } else { "joints" };
        said.push(format!("{} kept as {joints}, on {}", counted(at.len(), "kink"), list(&at)));
    }
    joints
}

fn is_kink(turns: &[f64], k: usize) -> bool {
    if turns[k].abs() < LEAST_TURN {
        return false;
    }
    let around = |reach: usize| {
        let range = k.saturating_sub(reach)..(k + reach + 1).min(turns.len());
        range.filter(|&j| j != k).map(|j| turns[j])
    };
    let usual = quantile(around(AROUND).collect(), 0.5);
    let excess = (turns[k] - usual).abs();
    let noise = quantile(around(AROUND).map(|turn| (turn - usual).abs()).collect(), 0.75);
    excess > LEAST_TURN
        && excess > OVER_NOISE * noise
        && around(NEIGHBOURS).all(|turn| excess > OVER_NEIGHBOURS * (turn - usual).abs())
}

/// The value that a share of the values stays below, 0 of nothing.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// Change of direction (rad) from a-b to b-c.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    libm::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
}
