//! Where the contacts of a wheel come from: the table, the direct solver on line, or rigid contact. One switch.

use flangeway::{Contact, ContactTable, Contacts, Flags, Pose, Side, Slot, WheelGeometry};
use nalgebra::Vector3;

use crate::contact::SlotState;
use crate::contacts::track_position;
use crate::pair::Pair;

/// A way to the contacts of a wheel.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// The kernel's lookup.
    Table(&'a ContactTable<'a>),
    /// The direct elastic solver, 2-D or 3-D by the pair's settings.
    Direct(&'a Pair),
    /// Rigid contact, its constraints kept by a penalty: wherever the table's signed overlap δ of a slot is positive, a
    /// linear spring of this stiffness k (N/m), `N = k δ`, stiffer than steel. Two slots can bear at once, as rigid bodies
    /// can. Hertz's ellipse belongs to the penalty's force.
    Rigid(&'a ContactTable<'a>, f64),
}

impl Source<'_> {
    /// Size and place of a wheel.
    #[must_use]
    pub fn geometry(&self, side: Side) -> &WheelGeometry {
        match self {
            Self::Table(table) | Self::Rigid(table, _) => &table.header().side(side).geometry,
            Self::Direct(pair) => pair.body(side).wheel().geometry(),
        }
    }

    /// The contacts of a wheel at a pose in the frame of its rails.
    pub fn contacts_into(&self, side: Side, pose: &Pose, contacts: &mut Contacts) {
        match self {
            Self::Table(table) => table.contacts_into(side, pose, contacts),
            Self::Direct(pair) => direct(pair, side, pose, contacts),
            Self::Rigid(table, stiffness) => rigid(table, *stiffness, side, pose, contacts),
        }
    }
}

fn direct(pair: &Pair, side: Side, pose: &Pose, contacts: &mut Contacts) {
    contacts.list.clear();
    contacts.flags = Flags::NONE;
    for (state, slot) in pair.solve(side, pose).iter().zip(Slot::ALL) {
        if state.normal_force() > 0.0 {
            // As many places as slots.
            let _ = contacts.list.push(solved(pair, side, pose, slot, state));
            contacts.flags |= if state.conformal { Flags::CONFORMAL } else { Flags::NONE };
        }
    }
}

/// A slot of the direct solver as the kernel's contact.
fn solved(pair: &Pair, side: Side, pose: &Pose, slot: Slot, state: &SlotState) -> Contact {
    let canonical = pose.canonical(side);
    let [x, y, z] = track_position(pair, side, &canonical.pose, state);
    let (along, across) = (canonical.longitudinal_sign, canonical.lateral_sign);
    let root = state.indentation.max(0.0).sqrt();
    let nominal = pair.body(side).wheel().geometry().nominal_radius;
    Contact {
        normal_force: state.normal_force() as f32,
        indentation: state.indentation as f32,
        position: Vector3::new(along * x, across * y, z).cast(),
        angle: (across * state.angle) as f32,
        rolling_radius: (nominal + state.radius_offset) as f32,
        wheel_coordinate: state.profile as f32,
        semi_axes: [state.semi_axis_x, state.semi_axis_y].map(|k| (k * root) as f32),
        wheel_curvature: state.wheel_curvature as f32,
        rail_curvature: state.rail_curvature as f32,
        slot,
    }
}

fn rigid(table: &ContactTable<'_>, stiffness: f64, side: Side, pose: &Pose, contacts: &mut Contacts) {
    table.contacts_into(side, pose, contacts);
    for contact in &mut contacts.list {
        // N = k δ
        let normal_force = stiffness as f32 * contact.indentation;
        // The same ellipse coefficients: the semi-axes grow as N^(1/3).
        let ratio = libm::cbrtf(normal_force / contact.normal_force);
        contact.normal_force = normal_force;
        contact.semi_axes = contact.semi_axes.map(|axis| axis * ratio);
    }
}
