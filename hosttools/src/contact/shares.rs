//! From pressures to slots: the force of each region of the wheel's profile, and where and how large its patch is.

use super::slots::SlotState;
use super::{Body, SLOTS};
use crate::halfspace::RowLoad;

/// Gives each slot the force of the rows on its region of the wheel.
///
/// C is N / δ^1.5 of the slot's own indentation; position, angle and curvatures are means under the pressure. A row
/// on a boundary belongs to both sides by its width. What falls to a slot that has no indentation goes to the deepest.
///
/// The semi-axes are those of an ellipse as long and as wide under pressure, n(s) the force per width of a row:
///
/// ```text
/// a² = 5 ∫ n <(x - x̄)²> ds / N,   x̄ and <> each row's own;   b = 3/5 N² / ∫ n² ds
/// ```
/// Both are exact for Hertz's ellipse, also one askew, whose area is π a b with a its half chord along x. Patches side by
/// side count by their widths, not by how far apart they are: with second moments about the common mean, that distance
/// ruled b, and between the nodes of a table it is anything but linear.
pub(super) fn assign(body: &Body, slots: &mut [SlotState; SLOTS], loads: &[RowLoad]) {
    let deepest = (0..SLOTS).max_by(|&i, &j| slots[i].indentation.total_cmp(&slots[j].indentation)).unwrap_or(0);
    let mut sums = [Sums::default(); SLOTS];
    for load in loads {
        for (slot, state) in slots.iter().enumerate() {
            let (below, above) = body.region(slot);
            let share = |limit: f64| (0.5 + (load.row.wheel.s - limit) / load.width).clamp(0.0, 1.0);
            let part = share(below) - share(above);
            if part > 0.0 {
                let slot = if state.indentation > 0.0 { slot } else { deepest };
                sums[slot].add(load, part * load.force);
            }
        }
    }
    for (slot, sums) in slots.iter_mut().zip(&sums) {
        if slot.indentation > 0.0 {
            sums.put_into(slot, body);
        }
    }
}

/// Sums under the pressure of one slot.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    force: f64,
    /// Σ N <(x - mean of the row)²>
    along: f64,
    /// Σ N² / h
    squares: f64,
    longitudinal: f64,
    profile: f64,
    radius: f64,
    angle: f64,
    curvatures: [f64; 2],
}

impl Sums {
    fn add(&mut self, load: &RowLoad, force: f64) {
        let row = &load.row;
        let [mean, square] = load.moments;
        self.force += force;
        self.along += force * (square - mean * mean);
        self.squares += force * load.force / load.width;
        self.longitudinal += force * (row.longitudinal + mean);
        self.profile += force * row.wheel.s;
        self.radius += force * row.wheel.radius;
        self.angle += force * libm::atan2(row.rail.tangent[1], row.rail.tangent[0]);
        self.curvatures[0] += force * row.wheel.curvature;
        self.curvatures[1] += force * row.rail.curvature;
    }

    fn put_into(&self, slot: &mut SlotState, body: &Body) {
        let delta = slot.indentation;
        if self.force <= 0.0 {
            slot.stiffness = 0.0;
            return;
        }
        *slot = SlotState {
            stiffness: self.force / (delta * delta.sqrt()),
            semi_axis_x: (5.0 * self.along / self.force / delta).sqrt(),
            semi_axis_y: 0.6 * self.force * self.force / self.squares / delta.sqrt(),
            longitudinal: self.longitudinal / self.force,
            profile: self.profile / self.force,
            radius_offset: self.radius / self.force - body.wheel.geometry().nominal_radius,
            angle: self.angle / self.force,
            wheel_curvature: self.curvatures[0] / self.force,
            rail_curvature: self.curvatures[1] / self.force,
            ..*slot
        };
    }
}
