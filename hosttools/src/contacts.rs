//! Contacts as rows of a table that people and programs read: the CSV of `solve` and `lookup`.

use std::path::Path;

use flangeway::{Attitude, Contacts, Flags, Pose, Side, Slot};

use crate::contact::SlotState;
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::pair::Pair;

/// One contact of one pose, in the track frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRow {
    /// Zero-based row of the pose file.
    pub pose: usize,
    /// Wheel.
    pub side: Side,
    /// Region of the wheel profile.
    pub slot: Slot,
    /// Position (m).
    pub position: [f64; 3],
    /// Contact angle (rad).
    pub angle: f64,
    /// Indentation (m).
    pub indentation: f64,
    /// Normal force (N).
    pub normal_force: f64,
    /// Semi-axes along x and across (m).
    pub semi_axes: [f64; 2],
    /// Rolling radius (m).
    pub rolling_radius: f64,
    /// Curvatures of wheel and rail profile (1/m).
    pub curvatures: [f64; 2],
    /// Remarks of the solver or the lookup on the wheel.
    pub remarks: String,
}

/// Contacts of one wheel by the direct solver; none without force.
pub fn solved(pair: &Pair, pose_index: usize, side: Side, pose: &Pose) -> Vec<ContactRow> {
    let states = pair.solve(side, pose);
    let carries = states.into_iter().zip(Slot::ALL).filter(|(state, _)| state.normal_force() > 0.0);
    carries.map(|(state, slot)| row(pair, pose_index, side, pose, slot, &state)).collect()
}

fn row(pair: &Pair, index: usize, side: Side, pose: &Pose, slot: Slot, state: &SlotState) -> ContactRow {
    let canonical = pose.canonical(side);
    let position = track_position(pair, side, &canonical.pose, state);
    let root = state.indentation.sqrt();
    ContactRow {
        pose: index,
        side,
        slot,
        position: [canonical.longitudinal_sign * position[0], canonical.lateral_sign * position[1], position[2]],
        angle: canonical.lateral_sign * state.angle,
        indentation: state.indentation,
        normal_force: state.normal_force(),
        semi_axes: [state.semi_axis_x * root, state.semi_axis_y * root],
        rolling_radius: pair.body(side).wheel().geometry().nominal_radius + state.radius_offset,
        curvatures: [state.wheel_curvature, state.rail_curvature],
        remarks: if state.conformal { Flags::CONFORMAL.to_string() } else { Flags::NONE.to_string() },
    }
}

/// Place of a slot's contact in the track frame of the canonical case (m): the wheel's point
/// `(e, b + s, √(R² - e²))` turned by roll, then yaw, from the axle's centre.
pub fn track_position(pair: &Pair, side: Side, canonical: &Pose, state: &SlotState) -> [f64; 3] {
    let geometry = pair.body(side).wheel().geometry();
    let Attitude { yaw, roll } = Attitude::new(canonical.yaw, canonical.roll);
    let radius = geometry.nominal_radius + state.radius_offset;
    let (e, axial) = (state.longitudinal, geometry.lateral_position + state.profile);
    let down = (radius * radius - e * e).sqrt();
    let across = axial * roll.cos - down * roll.sin;
    [
        yaw.cos * e - yaw.sin * across,
        canonical.lateral + yaw.sin * e + yaw.cos * across,
        canonical.vertical - geometry.nominal_radius + axial * roll.sin + down * roll.cos,
    ]
}

/// Contacts of one wheel from a table's lookup.
pub fn looked_up(pose_index: usize, side: Side, found: &Contacts) -> Vec<ContactRow> {
    let contact = |c: &flangeway::Contact| ContactRow {
        pose: pose_index,
        side,
        slot: c.slot,
        position: [c.position.x, c.position.y, c.position.z].map(f64::from),
        angle: f64::from(c.angle),
        indentation: f64::from(c.indentation),
        normal_force: f64::from(c.normal_force),
        semi_axes: c.semi_axes.map(f64::from),
        rolling_radius: f64::from(c.rolling_radius),
        curvatures: [f64::from(c.wheel_curvature), f64::from(c.rail_curvature)],
        remarks: found.flags.to_string(),
    };
    found.iter().map(contact).collect()
}

const COLUMNS: [&str; 15] = [
    "pose",
    "side",
    "slot",
    "x_m",
    "y_m",
    "z_m",
    "angle_rad",
    "indentation_m",
    "normal_force_n",
    "semi_axis_x_m",
    "semi_axis_y_m",
    "rolling_radius_m",
    "wheel_curvature_per_m",
    "rail_curvature_per_m",
    "remarks",
];

/// Writes contacts as CSV, all or nothing.
///
/// # Errors
/// When the file cannot be written.
pub fn write_csv(path: &Path, rows: &[ContactRow]) -> Result<()> {
    let failed = |e: csv::Error| Error::file(path, e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS).map_err(failed)?;
    for r in rows {
        let numbers = [
            r.position[0],
            r.position[1],
            r.position[2],
            r.angle,
            r.indentation,
            r.normal_force,
            r.semi_axes[0],
            r.semi_axes[1],
            r.rolling_radius,
            r.curvatures[0],
            r.curvatures[1],
        ];
        let words = [r.pose.to_string(), r.side.to_string(), r.slot.to_string().replace(' ', "_")];
        let fields = words.into_iter().chain(numbers.map(|v| format!("{v:.9e}"))).chain([r.remarks.clone()]);
        writer.write_record(fields).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::file(path, e.to_string()))?;
    write_atomically(path, &bytes)
}
