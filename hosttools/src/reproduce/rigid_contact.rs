//! Figure 7: height and roll of the rigid contact over the lateral position.

use rayon::prelude::*;

use super::runs::Grounds;
use super::{Check, Plate};
use crate::error::Result;
use crate::report::plot::{Curve, Panel, csv, draw};
use crate::report::style::{GREY, INK, Mark};
use crate::rigid::two_wheels;

const RANGE: f64 = 5e-3;
const STEPS: usize = 400;
const YAW: f64 = 15e-3;
/// Half width (m) of the middle, and the lateral position (m) from which on the flange leads.
const MIDDLE: f64 = 1e-3;
const FLANGING: f64 = 1.9e-3;

type Rest = (f64, f64, f64);

fn rests(grounds: &Grounds, yaw: f64) -> Vec<Rest> {
    let at = |i: usize| {
        let y = RANGE * (2.0 * i as f64 / STEPS as f64 - 1.0);
        two_wheels(&grounds.simplified.pair, y, yaw).map(|rest| (y, rest.vertical, rest.roll))
    };
    (0..=STEPS).into_par_iter().filter_map(at).collect()
}

/// Largest slope of a value over the lateral position between two distances from the centre.
fn steepest(rests: &[Rest], value: impl Fn(&Rest) -> f64, from: f64, to: f64) -> f64 {
    let inside = |w: &&[Rest]| w.iter().all(|r| (from..=to).contains(&r.0.abs()));
    let slope = |w: &[Rest]| ((value(&w[1]) - value(&w[0])) / (w[1].0 - w[0].0)).abs();
    rests.windows(2).filter(inside).map(slope).fold(0.0, f64::max)
}

pub(super) fn plate(grounds: &Grounds) -> Result<Plate> {
    let (straight, yawed) = (rests(grounds, 0.0), rests(grounds, YAW));
    let panel = |title: &str, label: &'static str, value: fn(&Rest) -> f64| {
        let points = |rests: &[Rest]| rests.iter().map(|r| (1e3 * r.0, 1e3 * value(r))).collect::<Vec<_>>();
        let curves =
            vec![Curve::new(Mark::Line, INK, points(&straight)), Curve::new(Mark::Dashes, GREY, points(&yawed))];
        Panel::new(title, ["lateral position y (mm)", label], curves)
    };
    let height: fn(&Rest) -> f64 = |r| r.1;
    let roll: fn(&Rest) -> f64 = |r| r.2;
    let rows = [vec![panel("height", "z, down (mm)", height), panel("roll", "roll (mrad)", roll)]];
    let entries =
        [(Mark::Line, INK, "yaw 0".to_string()), (Mark::Dashes, GREY, format!("dashed: yaw {} mrad", 1e3 * YAW))];
    let ratio =
        |value: fn(&Rest) -> f64| steepest(&straight, value, FLANGING, RANGE) / steepest(&straight, value, 0.0, MIDDLE);
    let (by_height, by_roll) = (ratio(height), ratio(roll));
    let both = straight.iter().zip(&yawed).map(|(a, b)| vec![a.0, a.1, a.2, b.1, b.2]);
    let flat = |figure_of: &'static str, measured: f64| Check {
        figure: 7,
        claim: figure_of,
        measured,
        unit: "times the steepest slope within 1 mm of the centre, from 1.9 mm on",
        holds: measured > 5.0,
    };
    Ok(Plate {
        number: 7,
        stem: "fig07".into(),
        title: "Rigid contact of the simplified pair",
        svg: draw("height and roll of the rigid contact", &entries, &rows)?,
        csv: csv(&["y_m", "z_yaw0_m", "roll_yaw0_rad", "z_yaw15_m", "roll_yaw15_rad"], both)?,
        theirs: "Height and roll of the wheelset in rigid contact hardly change near the track's centre and rise steeply \
                 once a flange climbs.",
        ours: format!(
            "The same shape: from 1.9 mm on the height is {by_height:.0} times as steep as within 1 mm of the centre, the \
             roll {by_roll:.0} times."
        ),
        difference: "Agrees in shape. The dimensions of the simplified profiles are ours, so the numbers are too.",
        checks: vec![
            flat("height of the rigid contact: flat near the centre, steep at the flange", by_height),
            flat("roll of the rigid contact: flat near the centre, steep at the flange", by_roll),
        ],
    })
}
