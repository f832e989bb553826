//! The rigid maps of a side, as they are stored.
//!
//! They are finer than the records, so that the zero of the vertical axis follows the curvature of the rigid contact
//! and what is left to the records is nearly linear. But where the contact jumps from one region of the wheel to
//! another they must not: the kink belongs to one slot and would bend the indentation of all others inside the cell.
//! There the map is linear between the records' nodes. Any reference does, as long as compiler and kernel agree.

use super::axes::{Axes, REFINEMENT};
use super::sampler::{Sampler, Touch};

/// Farthest (m) that the rigid contact moves on the wheel inside a cell without having jumped.
const JUMP: f64 = 5e-3;

/// `roll[lateral][yaw]` (rad) and `vertical[lateral][yaw][roll offset]` (m) on the rigid axes.
pub(super) fn maps(sampler: &Sampler<'_>, axes: &Axes) -> (Vec<f32>, Vec<f32>) {
    let [lateral, yaw, roll] = axes.rigid();
    let mut rest = Vec::with_capacity(lateral.len() * yaw.len());
    let mut touches = Vec::with_capacity(lateral.len() * yaw.len() * roll.len());
    for &u in lateral {
        for &psi in yaw {
            rest.push(sampler.rest(u, psi));
            touches.extend(roll.iter().map(|&offset| sampler.touch(u, psi, offset)));
        }
    }
    let counts = [lateral.len(), yaw.len(), roll.len()];
    let vertical = (0..touches.len()).map(|k| without_kink(&touches, counts, k)).collect();
    (rest, vertical)
}

/// The height at a node of the rigid axes: as solved, or linear between the surrounding nodes of the records where
/// the contact jumps between them.
fn without_kink(touches: &[Touch], [_, yaws, rolls]: [usize; 3], k: usize) -> f32 {
    let place = [k / (yaws * rolls), k / rolls % yaws, k % rolls];
    let (mut height, mut jumped) = (0.0, false);
    // The corners of the smallest element of the records' grid (node, edge, face or cell) that holds this node.
    for corner in 0..8 {
        let mut weight = 1.0;
        let mut at = [0; 3];
        for axis in 0..3 {
            let parts = usize::from(REFINEMENT[axis]);
            let inside = place[axis] % parts;
            let share = inside as f64 / parts as f64;
            let upper = corner >> axis & 1 == 1;
            weight *= if upper { share } else { 1.0 - share };
            at[axis] = place[axis] - inside + if upper && inside > 0 { parts } else { 0 };
        }
        if weight > 0.0 {
            let corner = &touches[(at[0] * yaws + at[1]) * rolls + at[2]];
            jumped |= (corner.profile - touches[k].profile).abs() > JUMP;
            height += weight * f64::from(corner.vertical);
        }
    }
    if jumped { height as f32 } else { touches[k].vertical }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(heights: [f32; 3], profiles: [f64; 3]) -> Vec<Touch> {
        (0..3).map(|i| Touch { vertical: heights[i], profile: profiles[i] }).collect()
    }

    #[test]
    fn a_smooth_cell_keeps_its_middle_and_a_kinked_one_does_not() {
        let smooth = column([0.0, 3.0, 2.0], [0.0, 1e-3, 2e-3]);
        assert_eq!(without_kink(&smooth, [1, 1, 3], 1), 3.0);
        let kinked = column([0.0, 3.0, 2.0], [0.0, 1e-3, 9e-3]);
        assert_eq!(without_kink(&kinked, [1, 1, 3], 1), 1.0);
        assert_eq!(without_kink(&kinked, [1, 1, 3], 2), 2.0);
    }
}
