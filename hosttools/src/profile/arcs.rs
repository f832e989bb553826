//! A wheel of lines and arcs for small vehicles in sharp curves, with three places to bear.

use super::pieces::{Piece, profile};
use super::{Profile, ProfileKind};

/// Cone of the tread.
const CONICITY: f64 = 1.0 / 20.0;
/// Where the tread ends in the throat, and where it ends on the field side (m).
const TREAD: [f64; 2] = [-0.016, 0.060];
/// Radius of the throat (m), hollow, and the angle at which it ends (26.7°).
const THROAT: (f64, f64) = (0.040, 26.7 / 180.0 * std::f64::consts::PI);
/// Radius of the flange root (m), hollow.
const ROOT: f64 = 0.010;
/// Angle of the flange (70°).
const FLANGE: f64 = 70.0 / 180.0 * std::f64::consts::PI;
/// Radius of the flange's tip (m), and how deep it lies.
const TIP: (f64, f64) = (0.018, 0.028);
/// The flange's back (m).
const BACK: f64 = -0.070;

/// Cone 1:20, throat R40, root R10, flange 70°, each tangent to the next; flange 28 mm high, tip R18.
///
/// Where a hollow arc is rounder than the rail it cannot touch, so on a rail of R300, R80 and R13 the throat bears
/// where the R80 passes into the R13, the root does not bear at all, and there are three contacts far apart: tread,
/// throat and flange. 26.7° puts the flange where at 20 mrad of yaw it meets the gauge corner while tread and throat
/// share the load.
pub(super) fn urban_arcs() -> Profile {
    let direction = |angle: f64| [libm::sin(angle), libm::cos(angle)];
    let along = |from: [f64; 2], d: [f64; 2], by: f64| [from[0] + by * d[0], from[1] + by * d[1]];
    // A hollow arc's centre lies below the contour, its point of slope dz/d(-y) = tan a at centre - R [sin a, cos a].
    let start = [TREAD[0], -CONICITY * TREAD[0]];
    let throat = along(start, direction(libm::atan(CONICITY)), THROAT.0);
    let throat_end = along(throat, direction(THROAT.1), -THROAT.0);
    let root = along(throat_end, direction(THROAT.1), ROOT);
    let root_end = along(root, direction(FLANGE), -ROOT);
    // The tip's arc is full: the flange ends where its centre stands above the tip.
    let [sin, cos] = direction(FLANGE);
    let tip_depth = TIP.1 - TIP.0;
    let flange_end_z = tip_depth + TIP.0 * cos;
    let flange_end = [root_end[0] - (flange_end_z - root_end[1]) * cos / sin, flange_end_z];
    let tip = [flange_end[0] - TIP.0 * sin, tip_depth];
    let back_radius = tip[0] - BACK;
    let pieces = [
        Piece::arc([tip[0], TIP.1 - back_radius], back_radius, BACK, tip[0], false),
        Piece::arc(tip, TIP.0, tip[0], flange_end[0], false),
        Piece::Line { from: flange_end, to: root_end },
        Piece::arc(root, ROOT, root_end[0], throat_end[0], true),
        Piece::arc(throat, THROAT.0, throat_end[0], start[0], true),
        Piece::Line { from: start, to: [TREAD[1], -CONICITY * TREAD[1]] },
    ];
    let about = "built-in: wheel of lines and arcs, tread 1:20, throat R40, root R10, flange 70°, 28 mm high";
    profile(ProfileKind::Wheel, "urban_arcs", about, &pieces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_join_with_one_tangent_and_the_tip_is_the_lowest_point() {
        let wheel = urban_arcs();
        for joint in &wheel.joints {
            let (Some(before), Some(after)) = (joint.tangent_before, joint.tangent_after) else { unreachable!() };
            let turn = before[0] * after[1] - before[1] * after[0];
            assert!(turn.abs() < 1e-9, "{} at {:?}", turn, wheel.points[joint.index]);
        }
        let lowest = wheel.points.iter().map(|p| p[1]).fold(0.0, f64::max);
        assert!((lowest - 0.028).abs() < 1e-12);
        // 10 mm below the tape circle the flange is as thick as others: between 28 and 33.5 mm.
        let face = wheel.points.iter().rev().find(|p| p[1] >= 0.010).unwrap();
        assert!((0.028..0.0335).contains(&(face[0] - BACK)), "{face:?}");
    }
}
