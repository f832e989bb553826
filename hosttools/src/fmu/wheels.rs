//! What both modes tell of the two wheels.

use flangeway::creep::Friction;
use flangeway::{Side, Slot};

use super::variables::{Real, SHARED, output};
use crate::dynamics::wheel_rail::{Law, Wheel};

/// Real outputs of a slot.
const OF_SLOT: usize = 12;

/// The wear of both, then each wheel and its slots.
pub(super) fn outputs() -> Vec<Real> {
    let mut all = vec![output("wear_index", "N", "Wear index T gamma of both wheels: work a metre of track")];
    for side in Side::ALL {
        for (name, unit, description) in [
            ("guiding_force", "N", "Guiding force Y on the rail, positive outwards"),
            ("wheel_load", "N", "Wheel load Q on the rail"),
            ("derailment_quotient", "", "Y / Q"),
            ("wear_index", "N", "Wear index T gamma of the wheel"),
            ("normal_force", "N", "Sum of the contacts' normal forces"),
        ] {
            all.push(output(&format!("{side}.{name}"), unit, description));
        }
        for slot in Slot::ALL {
            let slot = slot.to_string().replace(' ', "_");
            for (name, unit, description) in [
                ("normal_force", "N", "Normal force; zero without contact, as are the others of this slot"),
                ("x", "m", "Contact point, forward"),
                ("y", "m", "Contact point, to the right"),
                ("z", "m", "Contact point, down"),
                ("angle", "rad", "Contact angle, slope dz/dy"),
                ("longitudinal_creepage", "", "Longitudinal creepage"),
                ("lateral_creepage", "", "Lateral creepage"),
                ("spin_creepage", "1/m", "Spin creepage"),
                ("longitudinal_force", "N", "Longitudinal creep force on the wheel"),
                ("lateral_force", "N", "Lateral creep force on the wheel, in the contact plane"),
                ("spin_moment", "N.m", "Spin moment on the wheel"),
                ("wear_index", "N", "Wear index T gamma of the contact"),
            ] {
                all.push(output(&format!("{side}.{slot}.{name}"), unit, description));
            }
        }
    }
    all
}

/// The values of [`outputs`].
pub(super) fn write(wheels: &[Wheel; 2], values: &mut [f64]) {
    let mut next = values.iter_mut();
    let mut put = |value: f64| {
        if let Some(place) = next.next() {
            *place = value;
        }
    };
    put(wheels.iter().map(Wheel::wear).sum());
    for wheel in wheels {
        let loads = &wheel.loads;
        [loads.guiding_force, loads.wheel_load, loads.ratio(), wheel.wear(), wheel.normal_force()]
            .into_iter()
            .for_each(&mut put);
        for touch in &wheel.touches {
            let Some(touch) = touch else {
                [0.0; OF_SLOT].into_iter().for_each(&mut put);
                continue;
            };
            let (contact, slip, force) = (&touch.contact, &touch.creepages, &touch.forces);
            let [x, y, z] = contact.position.into();
            [contact.normal_force, x, y, z, contact.angle, slip.longitudinal, slip.lateral, slip.spin]
                .map(f64::from)
                .into_iter()
                .for_each(&mut put);
            [force.longitudinal, force.lateral, force.spin_moment].map(f64::from).into_iter().for_each(&mut put);
            put(touch.wear);
        }
    }
}

/// Flags and number of contacts of each wheel, in the order of the integer outputs.
pub(super) fn integers(wheels: &[Wheel; 2]) -> [i32; 4] {
    let [right, left] = wheels.each_ref().map(|w| [i32::from(w.flags), w.touches.iter().flatten().count() as i32]);
    [right[0], right[1], left[0], left[1]]
}

/// Friction and damping from the last real parameters.
pub(super) fn friction(parameters: &[f64]) -> (Friction, f64) {
    let [coefficient, limit_ratio, decay, damping] = *parameters.last_chunk::<SHARED>().unwrap_or(&[0.0; SHARED]);
    let [coefficient, limit_ratio, decay] = [coefficient, limit_ratio, decay].map(|x| x as f32);
    (Friction { coefficient, limit_ratio, decay }, damping)
}

/// A creep law by its number.
pub(super) fn law(number: i32) -> Law {
    match number {
        0 => Law::Kalker,
        1 => Law::ShenHedrickElkins,
        3 => Law::Fastsim,
        _ => Law::Polach,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_values_as_variables() {
        let mut values = vec![f64::NAN; outputs().len() + 1];
        write(&[Wheel::default(); 2], &mut values);
        let past = values.pop();
        assert!(values.iter().all(|value| *value == 0.0) && past.is_some_and(f64::is_nan));
    }
}
