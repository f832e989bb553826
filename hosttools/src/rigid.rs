//! Rigid contact of the wheelset: the height and roll at which both wheels touch without indentation (paper 2.1).

use flangeway::{Pose, Side, displacement, pose_with};

use crate::contact::RidgePoint;
use crate::pair::Pair;

/// A wheelset that rests on both rails without indentation.
#[derive(Debug, Clone, Copy)]
pub struct Rigid {
    /// Height (m, down).
    pub vertical: f64,
    /// Roll (rad).
    pub roll: f64,
    /// Contact of the right wheel, in its canonical frame.
    pub right: RidgePoint,
    /// Contact of the left wheel, in its canonical frame.
    pub left: RidgePoint,
}

/// Widest roll (rad) to which the search goes.
const WIDEST_ROLL: f64 = 0.08;
/// Heights of the two wheels that count as equal (m).
const LEVEL: f64 = 2e-13;

/// Rigid contact of the wheelset at a lateral position (m) and yaw (rad); `None` where a wheel misses its rail.
pub fn two_wheels(pair: &Pair, lateral: f64, yaw: f64) -> Option<Rigid> {
    rest(pair, yaw, |_| lateral)
}

/// Rigid contact where the given wheel's tape-circle point is displaced by `u` (m), instead of the wheelset's centre.
/// `yaw` is that wheel's own, canonical one, and so is the answer's roll.
pub fn at_displacement(pair: &Pair, side: Side, u: f64, yaw: f64) -> Option<Rigid> {
    let geometry = pair.body(side).wheel().geometry();
    let sign = side.sign();
    let lateral = |roll: f64| {
        let turned = displacement(geometry, &Pose { yaw, roll: sign * roll, ..Pose::default() });
        sign * (u - turned.lateral)
    };
    let found = rest(pair, sign * yaw, lateral)?;
    Some(Rigid { roll: sign * found.roll, ..found })
}

/// Finds the roll ρ at which both wheels touch at the same height: Newton's method, kept inside a bracket, on
///
/// ```text
/// f(ρ) = z_right(ρ) - z_left(ρ),   f' ≈ -2 b
/// ```
fn rest(pair: &Pair, yaw: f64, lateral: impl Fn(f64) -> f64) -> Option<Rigid> {
    let touch = |side: Side, roll: f64, near: Option<f64>| {
        let canonical = Pose { lateral: lateral(roll), yaw, vertical: 0.0, roll }.canonical(side).pose;
        let (vertical, point) = pair.column(side, &canonical).touching(near)?;
        // How fast the lateral position follows the roll; the mirror turns the signs of both. By a central difference,
        // so that the mirrored search takes the mirrored steps to the last bit.
        let follows = (lateral(roll + 1e-6) - lateral(roll - 1e-6)) / 2e-6;
        Some((vertical, point, side.sign() * touching_slope(&point, canonical.yaw, follows)))
    };
    let (mut low, mut high) = (-WIDEST_ROLL, WIDEST_ROLL);
    let (mut roll, mut near) = (0.0, None);
    let mut found = None;
    for _ in 0..80 {
        let (z_right, right, right_slope) = touch(Side::Right, roll, near)?;
        let (z_left, left, left_slope) = touch(Side::Left, roll, near)?;
        let f = z_right - z_left;
        found = Some(Rigid { vertical: 0.5 * (z_right + z_left), roll, right, left });
        if f.abs() < LEVEL || high - low < LEVEL {
            return found;
        }
        // The right wheel hangs too high where f < 0: less roll lifts its contact. f falls with the roll.
        if f > 0.0 {
            low = roll
        } else {
            high = roll
        }
        let newton = roll - f / (right_slope - left_slope).min(-1e-3);
        roll = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        near = Some(0.5 * (z_right + z_left));
    }
    found.filter(|_| high - low < 1e-9)
}

/// dz/dρ of the height at which a wheel touches: its contact point keeps to the rail's tangent plane.
///
/// With p from the axle's centre and ω = (cos ψ, sin ψ, 0) the axis of roll, the point moves by v = ω × p, and
///
/// ```text
/// n · (v + (0, dy/dρ, dz/dρ)) = 0
/// ```
fn touching_slope(point: &RidgePoint, yaw: f64, follows: f64) -> f64 {
    let [x, y, z] = point.surface.position;
    let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
    let [tangent_y, tangent_z] = point.foot.tangent;
    let across = -cos * z + follows;
    let down = cos * y - sin * x;
    across * tangent_z / tangent_y.max(1e-3) - down
}

/// Height of one wheel's tape-circle point (m, down) at which that wheel alone touches, for a displacement `u`, yaw
/// and roll in its canonical frame, and where it touches: the zero of the table's vertical axis.
pub fn touching_displacement(pair: &Pair, side: Side, u: f64, yaw: f64, roll: f64) -> Option<(f64, RidgePoint)> {
    let geometry = pair.body(side).wheel().geometry();
    let pose = pose_with(geometry, &flangeway::Displacement { lateral: u, vertical: 0.0 }, yaw, roll);
    let (vertical, point) = pair.column(side, &pose).touching(None)?;
    Some((displacement(geometry, &Pose { vertical, ..pose }).vertical, point))
}

/// Least width (m) of a gap in the contact's path on the wheel that counts as a jump between regions.
const LEAST_GAP: f64 = 2e-3;

/// Boundaries of the slots on the wheel-profile coordinate (m): the middles of the two gaps in the rigid contact's
/// path on the wheel over which the contact angle changes most, for all lateral positions of the range and yaw from 0
/// to its end. Where it jumps over fewer, the remaining regions hold nothing: their boundaries lie beyond the flange.
pub fn slot_boundaries(pair: &Pair, side: Side, lateral: [f64; 2], yaw: f64) -> [f64; 2] {
    const STEPS: usize = 150;
    const YAWS: usize = 4;
    let mut visited: Vec<[f64; 2]> = Vec::new();
    for j in 0..=YAWS {
        for i in 0..=STEPS {
            let u = lateral[0] + (lateral[1] - lateral[0]) * i as f64 / STEPS as f64;
            if let Some(found) = at_displacement(pair, side, u, yaw * j as f64 / YAWS as f64) {
                let point = if side == Side::Left { found.left } else { found.right };
                let [across, down] = point.foot.tangent;
                visited.push([point.wheel.s, libm::atan2(down, across)]);
            }
        }
    }
    visited.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let gap = |w: &[[f64; 2]]| [w[1][0] - w[0][0], 0.5 * (w[0][0] + w[1][0]), (w[1][1] - w[0][1]).abs()];
    let mut gaps: Vec<[f64; 3]> = visited.windows(2).map(gap).filter(|gap| gap[0] > LEAST_GAP).collect();
    gaps.sort_by(|a, b| b[2].total_cmp(&a[2]));
    let nowhere = pair.body(side).wheel().curve().at(0.0).y - 1e-3;
    let mut boundaries = [0, 1].map(|i| gaps.get(i).map_or(nowhere, |gap| gap[1]));
    boundaries.sort_by(|a, b| b.total_cmp(a));
    boundaries
}
