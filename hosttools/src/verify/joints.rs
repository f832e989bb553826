//! Joints of a profile: the places where its curvature changes abruptly, and with it Hertz's stiffness.

use crate::curve::Curve;

/// Width (m) to each side over which curvatures are compared, and step of the search.
const WIDTH: f64 = 0.75e-3;
const STEP: f64 = 0.05e-3;
/// Least change of curvature (1/m), and least share of the greater curvature, that counts.
const LEAST_CHANGE: f64 = 4.0;
const LEAST_SHARE: f64 = 0.2;

/// A joint of curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Parameter on the curve (m).
    pub t: f64,
    /// Lateral coordinate on the curve (m).
    pub lateral: f64,
    /// Mean curvature (1/m) on the flange or gauge side and on the field side.
    pub curvature: [f64; 2],
}

impl Joint {
    /// The joint nearest to parameter `t` (m), and its signed distance along the profile (m), positive towards the
    /// field side.
    pub fn nearest(joints: &[Self], t: f64) -> Option<(Self, f64)> {
        let nearest = joints.iter().min_by(|a, b| (a.t - t).abs().total_cmp(&(b.t - t).abs()))?;
        Some((*nearest, nearest.t - t))
    }
}

/// Joints along a curve: those it was built with, and those that its curvature shows. A profile from a file knows its
/// kinks only, so the curvatures over 0.75 mm to both sides of a place are compared.
pub fn joints(curve: &Curve) -> Vec<Joint> {
    let mean = |from: f64, to: f64| curve.turn(from, to) / (to - from);
    let steps = ((curve.length() - 2.0 * WIDTH) / STEP).max(0.0) as usize;
    let around = |t: f64| [mean(t - WIDTH, t), mean(t, t + WIDTH)];
    let places: Vec<(f64, [f64; 2])> = (0..=steps)
        .map(|i| {
            let t = WIDTH + STEP * i as f64;
            (t, around(t))
        })
        .collect();
    let change = |i: usize| (places[i].1[1] - places[i].1[0]).abs();
    let reach = (WIDTH / STEP) as usize;
    let mut found = Vec::new();
    for i in 0..places.len() {
        let before = (i.saturating_sub(reach)..i).all(|j| change(j) < change(i));
        let after = (i + 1..(i + reach + 1).min(places.len())).all(|j| change(j) <= change(i));
        let [a, b] = places[i].1;
        if !(before && after) || change(i) < LEAST_CHANGE.max(LEAST_SHARE * a.abs().max(b.abs())) {
            continue;
        }
        let near = |t: &&f64| (**t - places[i].0).abs() < 0.5 * WIDTH;
        let t = curve.joints().iter().find(near).copied().unwrap_or(places[i].0);
        found.push(Joint { t, lateral: curve.at(t).y, curvature: around(t) });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Profile, ProfileKind};

    #[test]
    fn an_arc_that_ends_in_a_line_has_one_joint() {
        // A circle of 50 mm from -0.3 rad to 0, then a straight line along y.
        let arc = (0..60).map(|i| {
            let angle = -0.3 + 0.005 * f64::from(i);
            [0.05 * libm::sin(angle), 0.05 * (1.0 - libm::cos(angle))]
        });
        let line = (0..60).map(|i| [0.25e-3 * f64::from(i), 0.0]);
        let profile = Profile {
            kind: ProfileKind::Rail,
            name: "arc and line".into(),
            points: arc.chain(line).collect(),
            joints: vec![],
            recognised: vec![],
            source_hash: [0; 32],
            smoothing: 0.0,
        };
        let found = joints(&Curve::fit(&profile, 0.0).unwrap());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].lateral.abs() < 0.2e-3);
        assert!((found[0].curvature[0] - 20.0).abs() < 1.5 && found[0].curvature[1].abs() < 1.5, "{found:?}");
        assert_eq!(Joint::nearest(&found, 0.0).map(|(joint, _)| joint), Some(found[0]));
        assert_eq!(Joint::nearest(&[], 0.0), None);
    }
}
