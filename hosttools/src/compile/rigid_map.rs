//! The rigid map of a side, as it is stored: at each node the roll at which both wheels touch, and the height at which this
//! one does as a parabola in the roll offset.
//!
//! It is finer than the records, so that the zero of the vertical axis follows the curvature of the rigid contact and what
//! is left to the records is nearly linear. But where the contact jumps from one region of the wheel to another it must not
//! follow: the kink belongs to one slot and would bend the indentation of all others inside the cell. There the height is
//! linear in the roll offset, and between the records' nodes linear in lateral displacement and yaw. Any reference does, as
//! long as compiler and kernel agree.

use super::axes::{Axes, REFINEMENT};
use super::sampler::Sampler;

/// Farthest (m) that the rigid contact moves on the wheel, between two roll offsets or inside a cell, without having jumped.
const JUMP: f64 = 5e-3;

/// Roll offsets at which a node's height is solved, evenly over the roll axis.
pub(super) const OFFSETS: usize = 5;

/// Where the wheel touches at one roll offset.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Touch {
    /// Displacement w of the tape-circle point (m).
    pub(super) vertical: f64,
    /// Wheel-profile coordinate of the contact (m).
    pub(super) profile: f64,
}

/// The roll offsets for a roll axis (rad).
pub(super) fn offsets(roll: &[f64]) -> [f64; OFFSETS] {
    let [first, last] = [roll[0], roll[roll.len() - 1]];
    std::array::from_fn(|i| first + (last - first) * i as f64 / (OFFSETS - 1) as f64)
}

/// A node of the map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RigidNode {
    /// As in the image: roll (rad), h0 (m), h1 (m/rad), h2 (m/rad²).
    values: [f32; 4],
    /// Wheel-profile coordinates of the contact at the roll offsets (m).
    profiles: [f64; OFFSETS],
}

impl RigidNode {
    /// The parabola nearest to the heights in the sense of least squares; a straight line where the contact jumps. There
    /// zeta = 0 is touching on the average of the roll offsets; a line through the height at the middle one serves as well
    /// (0.840 % instead of 0.842 % rms on the same axes, the Manchester pair on 97 x 9 x 6 x 4 nodes).
    pub(super) fn new(roll: f32, offsets: &[f64; OFFSETS], touches: &[Touch; OFFSETS]) -> Self {
        let jumped = touches.windows(2).any(|pair| (pair[1].profile - pair[0].profile).abs() > JUMP);
        // By polynomials that are orthogonal over the five offsets: 1, x and x² - 2 with x = -2 to 2.
        let sum = |weights: [f64; OFFSETS]| weights.iter().zip(touches).map(|(w, t)| w * t.vertical).sum::<f64>();
        let (mean, slope) = (sum([0.2; OFFSETS]), sum([-0.2, -0.1, 0.0, 0.1, 0.2]));
        let bend = if jumped { 0.0 } else { sum([2.0, -1.0, -2.0, -1.0, 2.0]) / 14.0 };
        // In powers of the roll offset: x = (offset - middle) / step.
        let (middle, step) = (offsets[2], offsets[1] - offsets[0]);
        let (h1, h2) = (slope / step, bend / (step * step));
        let h0 = mean - 2.0 * bend - h1 * middle + h2 * middle * middle;
        let values = [f64::from(roll), h0, h1 - 2.0 * h2 * middle, h2].map(|x| x as f32);
        Self { values, profiles: touches.map(|touch| touch.profile) }
    }

    /// Roll at which both wheels touch (rad).
    pub(super) fn roll(&self) -> f64 {
        f64::from(self.values[0])
    }

    /// Height (m) at a roll offset (rad), as the kernel computes it.
    pub(super) fn height(&self, offset: f64) -> f64 {
        let [_, h0, h1, h2] = self.values.map(f64::from);
        h0 + offset * (h1 + offset * h2)
    }

    /// Whether the contact is elsewhere on the wheel than at another node, at any roll offset.
    fn jumped_from(&self, other: &Self) -> bool {
        self.profiles.iter().zip(&other.profiles).any(|(a, b)| (a - b).abs() > JUMP)
    }
}

/// Roll and height's coefficients at all nodes, `[lateral][yaw]`.
pub(super) fn map(sampler: &Sampler<'_>, axes: &Axes) -> Vec<[f32; 4]> {
    let [lateral, yaw] = axes.rigid();
    let nodes: Vec<RigidNode> = lateral.iter().flat_map(|&u| yaw.iter().map(move |&p| sampler.rigid(u, p))).collect();
    (0..nodes.len()).map(|k| without_kink(&nodes, yaw.len(), k)).collect()
}

/// A node's values: as solved, or the height's linear between the surrounding nodes of the records where the contact jumps
/// between them.
fn without_kink(nodes: &[RigidNode], yaws: usize, k: usize) -> [f32; 4] {
    let place = [k / yaws, k % yaws];
    let (mut blended, mut jumped) = ([0.0; 4], false);
    // The corners of the smallest element of the records' grid (node, edge or face) that holds this node.
    for corner in 0..4 {
        let mut weight = 1.0;
        let mut at = [0; 2];
        for axis in 0..2 {
            let parts = usize::from(REFINEMENT[axis]);
            let inside = place[axis] % parts;
            let share = inside as f64 / parts as f64;
            let upper = corner >> axis & 1 == 1;
            weight *= if upper { share } else { 1.0 - share };
            at[axis] = place[axis] - inside + if upper && inside > 0 { parts } else { 0 };
        }
        if weight > 0.0 {
            let corner = &nodes[at[0] * yaws + at[1]];
            jumped |= corner.jumped_from(&nodes[k]);
            blended.iter_mut().zip(corner.values).for_each(|(sum, value)| *sum += weight * f64::from(value));
        }
    }
    let [_, h0, h1, h2] = blended.map(|x| x as f32);
    let values = nodes[k].values;
    if jumped { [values[0], h0, h1, h2] } else { values }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [f64; OFFSETS] = [-0.001, -0.0005, 0.0, 0.0005, 0.001];

    fn node(height: impl Fn(f64) -> f64, profile: impl Fn(f64) -> f64) -> RigidNode {
        RigidNode::new(0.01, &AT, &AT.map(|x| Touch { vertical: height(x), profile: profile(x) }))
    }

    #[test]
    fn a_parabola_is_kept_and_a_kink_becomes_a_line() {
        let parabola = |x: f64| 0.002 + 0.03 * x + 0.4 * x * x;
        let smooth = node(parabola, |x| x);
        for x in [-0.001, -0.0003, 0.0007] {
            assert!((smooth.height(x) - parabola(x)).abs() < 2e-10, "{x}");
        }
        let kinked = node(|x| 0.04 * x.abs(), |x| if x > 0.0 { -0.04 } else { 0.0 });
        assert_eq!(kinked.values[3], 0.0);
        assert!((kinked.height(0.0) - 0.04 * 0.0006).abs() < 1e-9);
        // The offsets' middle need not be zero.
        let moved = AT.map(|x| x + 0.0004);
        let moved = RigidNode::new(0.0, &moved, &moved.map(|x| Touch { vertical: parabola(x), profile: 0.0 }));
        assert!((moved.height(0.001) - parabola(0.001)).abs() < 2e-10);
    }

    #[test]
    fn a_smooth_cell_keeps_its_middle_and_a_kinked_one_does_not() {
        let row = |middle: f64| {
            let place = |s: f64, h: f64| node(move |_| h, move |_| s);
            [place(0.0, 0.0), place(0.001, 0.003), place(middle, 0.002)]
        };
        assert_eq!(without_kink(&row(0.002), 3, 1)[1], 0.003);
        assert_eq!(without_kink(&row(0.009), 3, 1)[1], 0.001);
        assert_eq!(without_kink(&row(0.009), 3, 2)[1], 0.002);
    }
}
