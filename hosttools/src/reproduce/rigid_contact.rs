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
/// The right half's middle and its flange: a millimetre each (m).
const MIDDLE: [f64; 2] = [0.0, 1e-3];
const FLANGE: [f64; 2] = [1.9e-3, 2.9e-3];

type Rest = (f64, f64, f64);

fn rests(grounds: &Grounds, yaw: f64) -> Vec<Rest> {
    let at = |i: usize| {
        let y = RANGE * (2.0 * i as f64 / STEPS as f64 - 1.0);
        two_wheels(&grounds.simplified.pair, y, yaw).map(|rest| (y, rest.vertical, rest.roll))
    };
    (0..=STEPS).into_par_iter().filter_map(at).collect()
}

/// By how much a value changes between two lateral positions.
fn change(rests: &[Rest], value: impl Fn(&Rest) -> f64, [from, to]: [f64; 2]) -> f64 {
    let inside = rests.iter().filter(|r| (from - 1e-9..=to + 1e-9).contains(&r.0)).map(value);
    let (low, high) = inside.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    high - low
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
    let changes = |value: fn(&Rest) -> f64| [MIDDLE, FLANGE].map(|range| 1e3 * change(&straight, value, range));
    let (by_height, by_roll) = (changes(height), changes(roll));
    let both = straight.iter().zip(&yawed).map(|(a, b)| vec![a.0, a.1, a.2, b.1, b.2]);
    let flat = |claim: &'static str, unit: &'static str, [middle, flange]: [f64; 2]| Check {
        figure: 7,
        claim,
        measured: flange,
        unit,
        holds: flange > 10.0 * middle,
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
            "The same shape: from y = 0 to 1 mm the height changes by {:.4} mm and the roll by {:.2} mrad, from 1.9 to 2.9 \
             mm by {:.1} mm and {:.1} mrad.",
            by_height[0], by_roll[0], by_height[1], by_roll[1]
        ),
        difference: "Agrees in shape. The dimensions of the simplified profiles are ours, so the numbers are too.",
        checks: vec![
            flat(
                "height of the rigid contact: flat near the centre, steep at the flange",
                "mm of height from y = 1.9 to 2.9 mm; steep is ten times as much as from 0 to 1 mm",
                by_height,
            ),
            flat(
                "roll of the rigid contact: flat near the centre, steep at the flange",
                "mrad of roll from y = 1.9 to 2.9 mm; steep is ten times as much as from 0 to 1 mm",
                by_roll,
            ),
        ],
    })
}
