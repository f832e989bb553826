//! What the FMU is held against: runs a scenario of a single wheelset as `flangeway simulate` does and writes, for the
//! start and every step, the FMU's inputs and what came out, as bits: `curve SCENARIO STEP_S OUT.bin`.
//!
//! A row is time, the inputs of the unit in their order, then lateral, yaw, vertical, roll, spin and, for right and left
//! wheel, Y, Q, wear index and the normal force of each slot.

use std::path::Path;

use flangeway_host::dynamics::body::{LATERAL, PITCH, ROLL, VERTICAL, YAW};
use flangeway_host::dynamics::irregularity::Irregularity;
use flangeway_host::dynamics::record::slot_forces;
use flangeway_host::dynamics::run::Ground;
use flangeway_host::dynamics::scenario::Scenario;
use flangeway_host::dynamics::source::Source;
use flangeway_host::dynamics::track::Track;
use flangeway_host::dynamics::vehicle::{Line, Vehicle};
use flangeway_host::dynamics::wheel_rail::WheelRail;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, scenario, step, output] = arguments.as_slice() else { return Err("curve SCENARIO STEP_S OUT.bin".into()) };
    let (scenario, step) = (Scenario::load(Path::new(scenario))?, step.parse::<f64>()?);
    let ground = Ground::of(&scenario)?;
    let table = ground.table()?.ok_or("the scenario has no table")?;
    let contact = WheelRail {
        source: Source::Table(&table),
        law: scenario.contact.creep,
        friction: scenario.contact.friction(),
        elasticity: ground.elasticity(),
        damping: scenario.contact.damping_s_per_m,
    };
    let (track, irregularity) = (scenario.track(), scenario.irregularity(ground.half_base())?);
    let speed = scenario.run.speed_m_per_s;
    let line = Line { track: &track, irregularity: &irregularity, contact: &contact, speed };
    let mut vehicle = Vehicle::at_rest(scenario.parameters(), &line)?;
    let mut bytes = Vec::new();
    loop {
        for number in row(&vehicle, &track, &irregularity, speed) {
            bytes.extend(number.to_le_bytes());
        }
        if vehicle.distance >= track.length() {
            break;
        }
        vehicle.step(step, &line);
    }
    std::fs::write(output, bytes)?;
    Ok(())
}

fn row(vehicle: &Vehicle, track: &Track, irregularity: &Irregularity, speed: f64) -> Vec<f64> {
    let at = vehicle.distance;
    let place = track.at(at);
    let (rails, slopes) = irregularity.at(at);
    let mut row = vec![vehicle.time, speed, place.curvature, place.cant, track.heading(at), place.cant_slope];
    for offsets in [rails, slopes] {
        row.extend([offsets.lateral, offsets.vertical, offsets.cross_level]);
    }
    // The far end of the suspension, led along the track at its height of rest; then no forces of the importer's.
    let (q, v) = (&vehicle.frame.position, &vehicle.frame.velocity);
    row.extend([q[LATERAL], 0.0, q[ROLL], q[YAW], v[LATERAL], v[VERTICAL], v[ROLL], v[YAW]]);
    row.extend([0.0; 5]);
    let wheelset = &vehicle.wheelsets[0];
    let (q, v) = (&wheelset.body.position, &wheelset.body.velocity);
    row.extend([q[LATERAL], q[YAW], q[VERTICAL], q[ROLL], v[PITCH]]);
    for wheel in &wheelset.wheels {
        row.extend([wheel.loads.guiding_force, wheel.loads.wheel_load, wheel.wear()]);
        row.extend(slot_forces(wheel));
    }
    row
}
