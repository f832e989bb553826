//! What a run leaves: a sample of the vehicle at every row, and the CSV of them.

use std::path::Path;

use flangeway::{Flags, SLOTS, Side, Slot};

use super::track::TrackPoint;
use super::vehicle::Vehicle;
use super::wheelset::Wheelset;
use crate::error::{Error, Result};
use crate::image::write_atomically;

/// The vehicle at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Time since the start, s.
    pub time: f64,
    /// Distance of the vehicle's centre from the track's begin, m.
    pub distance: f64,
    /// The track there.
    pub track: TrackPoint,
    /// The wheelsets, the leading one first.
    pub wheelsets: Vec<Wheelset>,
}

impl Sample {
    /// The vehicle as it is, its centre at this place of the track.
    #[must_use]
    pub fn of(vehicle: &Vehicle, track: TrackPoint) -> Self {
        Self { time: vehicle.time, distance: vehicle.distance, track, wheelsets: vehicle.wheelsets.clone() }
    }

    /// Wear index of all wheels, N.
    #[must_use]
    pub fn wear(&self) -> f64 {
        self.wheelsets.iter().flat_map(|w| &w.wheels).map(super::wheel_rail::Wheel::wear).sum()
    }
}

/// Writes samples as CSV, all or nothing.
///
/// # Errors
/// When the file cannot be written.
pub fn write_csv(path: &Path, samples: &[Sample]) -> Result<()> {
    let failed = |e: csv::Error| Error::file(path, e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let wheelsets = samples.first().map_or(0, |sample| sample.wheelsets.len());
    writer.write_record(columns(wheelsets)).map_err(failed)?;
    for sample in samples {
        let numbers = [sample.time, sample.distance, sample.track.curvature, sample.track.cant];
        let mut row: Vec<String> = numbers.map(number).to_vec();
        sample.wheelsets.iter().for_each(|wheelset| fields(wheelset, &mut row));
        row.push(number(sample.wear()));
        writer.write_record(row).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::file(path, e.to_string()))?;
    write_atomically(path, &bytes)
}

const POSE: [&str; 5] = ["lateral_m", "yaw_rad", "vertical_m", "roll_rad", "spin_rad_per_s"];
const CONTACT: [&str; 5] = ["normal_force_n", "x_m", "y_m", "angle_rad", "wear_index_n"];
const WHEEL: [&str; 5] = ["guiding_force_n", "wheel_load_n", "guiding_force_over_wheel_load", "wear_index_n", "flags"];

fn columns(wheelsets: usize) -> Vec<String> {
    let mut columns: Vec<String> = ["time_s", "distance_m", "curvature_per_m", "cant_rad"].map(String::from).to_vec();
    let names: &[&str] = if wheelsets == 1 { &["wheelset"] } else { &["leading", "trailing"] };
    for name in names.iter().take(wheelsets) {
        columns.extend(POSE.map(|column| format!("{name}_{column}")));
        for side in Side::ALL {
            for slot in Slot::ALL {
                let slot = slot.to_string().replace(' ', "_");
                columns.extend(CONTACT.map(|column| format!("{name}_{side}_{slot}_{column}")));
            }
            columns.extend(WHEEL.map(|column| format!("{name}_{side}_{column}")));
        }
    }
    columns.push("wear_index_n".into());
    columns
}

fn fields(wheelset: &Wheelset, row: &mut Vec<String>) {
    let [lateral, vertical, roll, yaw, _] = wheelset.body.position.into();
    row.extend([lateral, yaw, vertical, roll, wheelset.body.velocity[super::body::PITCH]].map(number));
    for wheel in &wheelset.wheels {
        for touch in &wheel.touches {
            // A slot without contact leaves its fields empty, and its force zero.
            let Some(touch) = touch else {
                row.push("0".into());
                row.extend(std::iter::repeat_n(String::new(), CONTACT.len() - 1));
                continue;
            };
            let contact = &touch.contact;
            let floats = [contact.normal_force, contact.position.x, contact.position.y, contact.angle];
            row.extend(floats.map(|v| number(f64::from(v))));
            row.push(number(touch.wear));
        }
        let loads = &wheel.loads;
        row.extend([loads.guiding_force, loads.wheel_load, loads.ratio(), wheel.wear()].map(number));
        row.push(Flags::from_bits(wheel.flags).to_string());
    }
}

fn number(value: f64) -> String {
    format!("{value:.7e}")
}

/// Force of each slot of a wheel, N.
#[must_use]
pub fn slot_forces(wheel: &super::wheel_rail::Wheel) -> [f64; SLOTS] {
    wheel.touches.map(|touch| touch.map_or(0.0, |touch| f64::from(touch.contact.normal_force)))
}
