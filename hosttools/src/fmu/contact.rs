//! Contact and creep forces only: the wheelset's motion in, the wrench of its contacts out, at the same time.

use flangeway::Pose;
use flangeway::wheelset::{Motion, Rates};

use super::variables::{Real, input, output};
use crate::dynamics::wheel_rail::{Wheel, WheelRail};

const INPUTS: usize = 11;
const OUTPUTS: usize = 6;

pub(super) fn inputs() -> Vec<Real> {
    let all = [
        ("lateral", "m", "Lateral displacement of the wheelset, to the right", 1e3),
        ("yaw", "rad", "Yaw, positive turns x towards y", 1e3),
        ("vertical", "m", "Vertical displacement, down; 0 has the axle at nominal radius above the rails", 1e3),
        ("roll", "rad", "Roll, positive moves the right wheel down; before yaw", 1e3),
        ("lateral_rate", "m/s", "Rate of lateral", 1e6),
        ("yaw_rate", "rad/s", "Rate of yaw, against the track", 1e6),
        ("vertical_rate", "m/s", "Rate of vertical", 1e6),
        ("roll_rate", "rad/s", "Rate of roll", 1e6),
        ("speed", "m/s", "Speed along the track", 1e6),
        ("spin", "rad/s", "Angular speed about the axle, speed / radius when rolling freely", 1e6),
        ("track_curvature", "1/m", "Curvature of the track, positive to the right", 1e6),
    ];
    debug_assert_eq!(all.len(), INPUTS);
    all.into_iter().map(|(name, unit, description, limit)| input(name, unit, description, limit)).collect()
}

pub(super) fn outputs() -> Vec<Real> {
    let all = [
        ("force_x", "N", "Force on the wheelset, forward"),
        ("force_y", "N", "Force on the wheelset, to the right"),
        ("force_z", "N", "Force on the wheelset, down"),
        ("moment_x", "N.m", "Moment about the wheelset's centre, about x"),
        ("moment_y", "N.m", "Moment about the wheelset's centre, about y"),
        ("moment_z", "N.m", "Moment about the wheelset's centre, about z"),
    ];
    debug_assert_eq!(all.len(), OUTPUTS);
    all.into_iter().map(|(name, unit, description)| output(name, unit, description)).collect()
}

/// The wrench of an input, written to the outputs; the wheels.
pub(super) fn evaluate(inputs: &[f64], contact: &WheelRail<'_>, outputs: &mut [f64]) -> [Wheel; 2] {
    let mut numbers = [0.0; INPUTS];
    numbers.copy_from_slice(inputs);
    let [lateral, yaw, vertical, roll, y_rate, yaw_rate, z_rate, roll_rate, speed, spin, track_curvature] = numbers;
    let motion = Motion {
        pose: Pose { lateral, yaw, vertical, roll },
        rates: Rates { lateral: y_rate, yaw: yaw_rate, vertical: z_rate, roll: roll_rate },
        speed,
        spin,
        track_curvature,
    };
    let mut wheels = [Wheel::default(); 2];
    let wrench = contact.forces(&motion, &mut wheels);
    for (place, value) in outputs.iter_mut().zip(wrench.force.iter().chain(&wrench.moment)) {
        *place = *value;
    }
    super::wheels::write(&wheels, &mut outputs[OUTPUTS..]);
    wheels
}
