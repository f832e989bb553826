//! Rail heads of arcs with tangent continuity. They stand upright; the inclination in the track is applied later.

use super::pieces::{Piece, profile};
use super::{Profile, ProfileKind};

/// Depth (m) to which the sides are drawn.
const SIDE_DEPTH: f64 = 0.030;
/// Slope of the sides, 1:20 against the vertical.
const SIDE: f64 = 1.0 / 20.0;

/// A rail head: crown, shoulder and corner arcs, each tangent to the next, and sides inclined 1:20 (all m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailHead {
    /// Radius of the crown.
    pub crown_radius: f64,
    /// Half the width of the crown arc.
    pub crown_half_width: f64,
    /// Radius of the shoulder.
    pub shoulder_radius: f64,
    /// Radius of the corner.
    pub corner_radius: f64,
    /// Half the head's width where the corner meets the side.
    pub half_width: f64,
}

/// UIC60 / 60E1 as in the Manchester contact benchmark: R300 over 21 mm, R80, R13, head 72 mm wide. Tangency puts the
/// end of the R80 at 25.988 mm.
pub fn rail_60e1() -> RailHead {
    RailHead {
        crown_radius: 0.300,
        crown_half_width: 0.0105,
        shoulder_radius: 0.080,
        corner_radius: 0.013,
        half_width: 0.036,
    }
}

/// UIC54 / 54E1 put together from its radii: R300, R80, R13 and a head 70 mm wide by tangent continuity. The width of
/// the R300, 20.024 mm, is ours to choose with the radii alone; it puts the end of the R80 at 24.863 mm.
pub fn rail_54e1() -> RailHead {
    RailHead { crown_half_width: 0.010012, half_width: 0.035, ..rail_60e1() }
}

impl RailHead {
    /// Height z (m, positive down from the crown) at y (m) on the arcs; NaN beyond the head's corner.
    pub fn height(&self, y: f64) -> f64 {
        let y = y.abs();
        let [shoulder, corner] = self.centres();
        let above = |centre: [f64; 2], radius: f64| centre[1] - (radius * radius - (y - centre[0]).powi(2)).sqrt();
        if y <= self.crown_half_width {
            above([0.0, self.crown_radius], self.crown_radius)
        } else if y <= self.shoulder_end(shoulder, corner) {
            above(shoulder, self.shoulder_radius)
        } else if y <= self.half_width {
            above(corner, self.corner_radius)
        } else {
            f64::NAN
        }
    }

    /// Centres of the shoulder and corner arcs on the field side: each on the normal at the end of the arc before.
    fn centres(&self) -> [[f64; 2]; 2] {
        // the side's outward normal is [20, -1] / sqrt(401)
        let outward = 1.0 / (1.0 + SIDE * SIDE).sqrt();
        let sin = self.crown_half_width / self.crown_radius;
        let inward = self.crown_radius - self.shoulder_radius;
        let shoulder = [inward * sin, self.crown_radius - inward * (1.0 - sin * sin).sqrt()];
        let corner_y = self.half_width - self.corner_radius * outward;
        let reach = self.shoulder_radius - self.corner_radius;
        let corner_z = shoulder[1] - (reach * reach - (corner_y - shoulder[0]).powi(2)).sqrt();
        [shoulder, [corner_y, corner_z]]
    }

    /// y (m) where the shoulder meets the corner.
    fn shoulder_end(&self, shoulder: [f64; 2], corner: [f64; 2]) -> f64 {
        shoulder[0] + self.shoulder_radius * (corner[0] - shoulder[0]) / (self.shoulder_radius - self.corner_radius)
    }

    fn profile(&self, name: &str, about: &str) -> Profile {
        let [shoulder, corner] = self.centres();
        let (crown_end, shoulder_end) = (self.crown_half_width, self.shoulder_end(shoulder, corner));
        let side_top = [self.half_width, corner[1] - self.corner_radius * SIDE / (1.0 + SIDE * SIDE).sqrt()];
        let side_end = [side_top[0] + SIDE * (SIDE_DEPTH - side_top[1]), SIDE_DEPTH];
        let mirror = |p: [f64; 2]| [-p[0], p[1]];
        let arc = |centre, radius, from, to| Piece::arc(centre, radius, from, to, true);
        let pieces = [
            Piece::Line { from: mirror(side_end), to: mirror(side_top) },
            arc(mirror(corner), self.corner_radius, -self.half_width, -shoulder_end),
            arc(mirror(shoulder), self.shoulder_radius, -shoulder_end, -crown_end),
            arc([0.0, self.crown_radius], self.crown_radius, -crown_end, crown_end),
            arc(shoulder, self.shoulder_radius, crown_end, shoulder_end),
            arc(corner, self.corner_radius, shoulder_end, self.half_width),
            Piece::Line { from: side_top, to: side_end },
        ];
        profile(ProfileKind::Rail, name, about, &pieces)
    }
}

pub(super) fn uic60() -> Profile {
    rail_60e1().profile("60e1", "built-in: 60E1 (UIC60) rail head, R300 / R80 / R13, sides 1:20, upright")
}

pub(super) fn uic54() -> Profile {
    let about = "built-in: 54E1 (UIC54) rail head from its radii R300 / R80 / R13 and 70 mm width, sides 1:20, upright";
    rail_54e1().profile("54e1", about)
}
