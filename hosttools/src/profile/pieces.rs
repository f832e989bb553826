//! Analytic contours as pieces of lines, arcs and graphs, sampled into points and joints.

use std::f64::consts::FRAC_PI_2;

use super::{Joint, Profile, ProfileKind, hash_points};

/// Greatest distance (m) between points on curved pieces: a cubic spline then follows an arc of 12 mm radius within
/// 1e-7 mm.
const CURVED_STEP: f64 = 0.2e-3;
/// Greatest distance (m) between points on straight pieces.
const STRAIGHT_STEP: f64 = 0.5e-3;

/// A smooth stretch of a contour, towards the field side (m).
#[derive(Debug, Clone, Copy)]
pub(super) enum Piece {
    /// A straight line.
    Line { from: [f64; 2], to: [f64; 2] },
    /// An arc `centre + radius [cos a, sin a]`, the angle a running from `from` to `to` (rad).
    Arc { centre: [f64; 2], radius: f64, from: f64, to: f64 },
    /// The graph of `height(y)` with its `slope` dz/dy, y running from `from` to `to`; sampled evenly in y, so for
    /// slopes of at most one.
    Graph { from: f64, to: f64, height: fn(f64) -> f64, slope: fn(f64) -> f64 },
}

impl Piece {
    /// The arc through `y = from` and `y = to` above (`z` smaller than the centre's) or below its centre.
    pub(super) fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, above: bool) -> Self {
        let sign = if above { -1.0 } else { 1.0 };
        let angle = |y: f64| sign * libm::acos(((y - centre[0]) / radius).clamp(-1.0, 1.0));
        Self::Arc { centre, radius, from: angle(from), to: angle(to) }
    }

    fn step_count(&self) -> usize {
        let (length, step) = match *self {
            Self::Line { from, to } => (libm::hypot(to[0] - from[0], to[1] - from[1]), STRAIGHT_STEP),
            Self::Arc { radius, from, to, .. } => (radius * (to - from).abs(), CURVED_STEP),
            // an arc step of at most CURVED_STEP where the slope is one
            Self::Graph { from, to, .. } => ((to - from) * std::f64::consts::SQRT_2, CURVED_STEP),
        };
        (length / step).ceil().max(1.0) as usize
    }

    /// Point and unit tangent at a share 0 to 1 of the piece.
    fn at(&self, share: f64) -> ([f64; 2], [f64; 2]) {
        match *self {
            Self::Line { from, to } => {
                let d = [to[0] - from[0], to[1] - from[1]];
                let length = libm::hypot(d[0], d[1]);
                ([from[0] + share * d[0], from[1] + share * d[1]], [d[0] / length, d[1] / length])
            }
            Self::Arc { centre, radius, from, to } => {
                let angle = from + share * (to - from);
                let ahead = angle + if to > from { FRAC_PI_2 } else { -FRAC_PI_2 };
                let point = [centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)];
                (point, [libm::cos(ahead), libm::sin(ahead)])
            }
            Self::Graph { from, to, height, slope } => {
                let y = from + share * (to - from);
                let slope = slope(y);
                let length = libm::hypot(1.0, slope);
                ([y, height(y)], [1.0 / length, slope / length])
            }
        }
    }
}

/// Samples pieces that follow each other into a profile, with a joint between any two.
pub(super) fn profile(kind: ProfileKind, name: &str, about: &str, pieces: &[Piece]) -> Profile {
    let mut points: Vec<[f64; 2]> = pieces.first().map(|p| p.at(0.0).0).into_iter().collect();
    let mut joints = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let count = piece.step_count();
        points.extend((1..=count).map(|k| piece.at(k as f64 / count as f64).0));
        if let Some(next) = pieces.get(i + 1) {
            let (tangent_before, tangent_after) = (Some(piece.at(1.0).1), Some(next.at(0.0).1));
            joints.push(Joint { index: points.len() - 1, tangent_before, tangent_after });
        }
    }
    let source_hash = hash_points(&points);
    let recognised = vec![about.to_owned()];
    Profile { kind, name: name.to_owned(), points, joints, recognised, source_hash, smoothing: 0.0 }
}
