//! Figure 1: the angle of attack in a curve, and where the contact lies because of it.

use rayon::prelude::*;

use super::runs::{Grounds, STAND_IN, bogie};
use super::{Check, Plate};
use crate::dynamics::body::YAW;
use crate::dynamics::run::run;
use crate::dynamics::scenario::{Method, SectionKind};
use crate::error::Result;
use crate::report::plot::{Curve, Panel, csv, draw};
use crate::report::style::{INK, Mark, colour, slot_at};
use crate::rigid::two_wheels;

/// Radii of the curves, m.
const RADII: [f64; 8] = [60.0, 80.0, 120.0, 180.0, 270.0, 400.0, 600.0, 1000.0];
/// Lateral acceleration left uncompensated in each of them, m/s².
const ACCELERATION: f64 = 0.65;
/// Lateral position (m) at which the outer wheel rests on its flange at every angle of attack, and the largest angle.
const FLANGING: f64 = 5.0e-3;
const LARGEST: f64 = 40e-3;
const STEPS: usize = 160;

/// Angle of attack (rad) of the leading wheelset in a steady curve.
fn angle(grounds: &Grounds, radius: f64) -> Result<f64> {
    let mut scenario = bogie()?;
    scenario.contact.method = Method::Table;
    // A step short enough for the creep's damping at this speed.
    scenario.run.speed_m_per_s = (ACCELERATION * radius).sqrt();
    scenario.run.step_s = 4e-5;
    scenario.run.output_interval_s = 2e-2;
    for section in &mut scenario.sections {
        if section.kind == SectionKind::Curve {
            (section.radius_m, section.cant_rad, section.length_m) = (Some(-radius), Some(0.0), 40.0);
        }
    }
    let samples = run(&scenario, &grounds.urban, &indicatif::ProgressBar::hidden())?;
    Ok(samples.last().map_or(f64::NAN, |sample| sample.wheelsets[0].body.position[YAW]))
}

/// How far ahead of the axle (m) the right wheel touches in rigid contact on its flange, and the contact's region.
fn ahead(grounds: &Grounds, yaw: f64) -> Option<(f64, f64, f64)> {
    let rest = two_wheels(&grounds.urban.pair, FLANGING, yaw)?;
    Some((yaw, rest.right.wheel.radius * rest.right.surface.around[0], rest.right.wheel.s))
}

pub(super) fn plate(grounds: &Grounds) -> Result<Plate> {
    let angles: Vec<f64> = RADII.par_iter().map(|r| angle(grounds, *r)).collect::<Result<_>>()?;
    let contacts: Vec<_> =
        (0..=STEPS).into_par_iter().filter_map(|i| ahead(grounds, LARGEST * i as f64 / STEPS as f64)).collect();
    let boundaries = grounds.urban.pair.body(flangeway::Side::Right).boundaries();
    let flange = contacts.last().map_or(INK, |c| colour(slot_at(boundaries, c.2)));
    let by_radius: Vec<_> = RADII.iter().zip(&angles).map(|(r, a)| (*r, 1e3 * a)).collect();
    let by_angle: Vec<_> = contacts.iter().map(|(yaw, x, _)| (1e3 * yaw, 1e3 * x)).collect();
    let rows = [vec![
        Panel::new(
            "leading wheelset of the bogie",
            ["radius of the curve (m)", "angle of attack (mrad)"],
            vec![Curve::new(Mark::Line, INK, by_radius.clone()), Curve::new(Mark::Dot, INK, by_radius)],
        ),
        Panel::new(
            "contact of the outer wheel's flange, rigid",
            ["angle of attack (mrad)", "ahead of the axle (mm)"],
            vec![Curve::new(Mark::Line, flange, by_angle.clone())],
        ),
    ]];
    let entries = [(Mark::Line, INK, STAND_IN.to_string()), (Mark::Line, flange, "flange".to_string())];
    let falls = angles.windows(2).all(|w| w[1] < w[0]);
    let grows = contacts.windows(2).all(|w| w[1].1 > w[0].1);
    let (sharp, wide) = (1e3 * angles[0], 1e3 * angles[RADII.len() - 1]);
    let farthest = 1e3 * contacts.last().map_or(0.0, |c| c.1);
    let longest = RADII.len().max(contacts.len());
    let table = (0..longest).map(|i| {
        let radius = RADII.get(i).copied().unwrap_or(f64::NAN);
        let contact = contacts.get(i).copied().unwrap_or((f64::NAN, f64::NAN, f64::NAN));
        vec![radius, angles.get(i).copied().unwrap_or(f64::NAN), contact.0, contact.1]
    });
    Ok(Plate {
        number: 1,
        stem: "fig01".into(),
        title: "Angle of attack and place of the contact",
        svg: draw("angle of attack and place of the contact", &entries, &rows)?,
        csv: csv(&["radius_m", "angle_of_attack_rad", "flange_angle_of_attack_rad", "flange_contact_ahead_m"], table)?,
        theirs: "In a curve the leading wheelset meets the outer rail at an angle of attack that grows as the radius \
                 falls; because of it the flange touches ahead of the axle, farther with every milliradian.",
        ours: format!(
            "The bogie's leading wheelset settles at {sharp:.1} mrad on R = 60 m and at {wide:.2} mrad on R = 1000 m, each \
             curve at the speed that leaves {ACCELERATION} m/s² uncompensated. At 40 mrad the flange touches {farthest:.1} \
             mm ahead of the axle."
        ),
        difference: "Agrees in both. The paper draws the geometry; the angles here are those of our bogie.",
        checks: vec![
            Check {
                figure: 1,
                claim: "angle of attack grows as the radius falls",
                measured: sharp - wide,
                unit: "mrad between R = 60 m and R = 1000 m, falling over all radii between",
                holds: falls,
            },
            Check {
                figure: 1,
                claim: "the contact's longitudinal distance grows with the angle of attack",
                measured: farthest,
                unit: "mm ahead of the axle at 40 mrad, rising all the way from 0",
                holds: grows,
            },
        ],
    })
}
