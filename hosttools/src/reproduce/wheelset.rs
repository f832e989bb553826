//! Figures 9 to 11: the single wheelset on R = 1000 m, in 2-D and in 3-D.

use flangeway::wheelset::nadal_limit;
use flangeway::{SLOTS, Slot};

use super::runs::Runs;
use super::{Check, Plate};
use crate::dynamics::body::{LATERAL, YAW};
use crate::dynamics::record::{Sample, slot_forces};
use crate::dynamics::wheel_rail::{Touch, Wheel};
use crate::error::Result;
use crate::report::plot::{Curve, Panel, csv, draw};
use crate::report::style::{GREY, INK, Mark, colour};

/// The outer wheel: the right one in the scenario's left-hand curve.
fn outer(sample: &Sample) -> &Wheel {
    &sample.wheelsets[0].wheels[0]
}

/// Every fourth sample's value, where it has one.
pub(super) fn points(samples: &[Sample], scale: f64, value: impl Fn(&Sample) -> f64) -> Vec<(f64, f64)> {
    let point = |sample: &Sample| (sample.distance, scale * value(sample));
    samples.iter().step_by(4).map(point).filter(|point| point.1.is_finite()).collect()
}

/// Mean over the last tenth of a run, when all is steady.
pub(super) fn steady(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> f64 {
    let last = &samples[samples.len() - samples.len() / 10..];
    last.iter().map(value).sum::<f64>() / last.len() as f64
}

pub(super) fn ways() -> Vec<(Mark, plotters::style::RGBColor, String)> {
    vec![(Mark::Line, INK, "3-D".into()), (Mark::Dashes, GREY, "dashed: 2-D".into())]
}

pub(super) fn both(
    title: &str,
    label: &'static str,
    [flat, full]: [&[Sample]; 2],
    scale: f64,
    value: impl Fn(&Sample) -> f64,
) -> Panel {
    let curves = vec![
        Curve::new(Mark::Line, INK, points(full, scale, &value)),
        Curve::new(Mark::Dashes, GREY, points(flat, scale, &value)),
    ];
    Panel::new(title, ["distance (m)", label], curves)
}

/// Figure 9.
pub(super) fn lateral(runs: &Runs) -> Result<Plate> {
    let samples = [runs.wheelset_flat.as_slice(), &runs.wheelset];
    let y: fn(&Sample) -> f64 = |sample| sample.wheelsets[0].body.position[LATERAL];
    let yaw: fn(&Sample) -> f64 = |sample| sample.wheelsets[0].body.position[YAW];
    let pairs = samples[0].iter().zip(samples[1]).step_by(4);
    let less = Curve::new(Mark::Line, INK, pairs.map(|(a, b)| (b.distance, 1e6 * (y(a) - y(b)))).collect());
    let rows = [vec![
        both("lateral displacement", "y (mm)", samples, 1e3, y),
        Panel::new("2-D less 3-D", ["distance (m)", "difference of y (µm)"], vec![less]),
    ]];
    let [flat, full] = samples.map(|s| 1e3 * steady(s, y));
    let pairs = samples[0].iter().zip(samples[1]);
    Ok(Plate {
        number: 9,
        stem: "fig09".into(),
        title: "Lateral displacement on R = 1000 m",
        svg: draw("lateral displacement on R = 1000 m", &ways(), &rows)?,
        csv: csv(
            &["distance_m", "y_2d_m", "y_3d_m", "yaw_2d_rad", "yaw_3d_rad"],
            pairs.map(|(a, b)| vec![b.distance, y(a), y(b), yaw(a), yaw(b)]),
        )?,
        theirs: "Entering the curve the wheelset moves outwards until its flange touches; in 3-D it moves less far than in \
                 2-D.",
        ours: format!("In the curve y is {full:.4} mm in 3-D and {flat:.4} mm in 2-D."),
        difference: "Agrees in sign. The difference is small here, since the angle of attack, which our suspension gives \
                     the wheelset, is below 5 mrad.",
        checks: vec![Check {
            figure: 9,
            claim: "3-D lateral displacement is smaller than 2-D",
            measured: 1e3 * (flat - full),
            unit: "micrometres less in the steady curve",
            holds: full < flat,
        }],
    })
}

/// Figure 10.
pub(super) fn loads(runs: &Runs) -> Result<Plate> {
    let force = |slot: usize| move |sample: &Sample| slot_forces(outer(sample))[slot];
    let total: fn(&Sample) -> f64 = |sample| outer(sample).normal_force();
    let mut curves = vec![Curve::new(Mark::Line, INK, points(&runs.wheelset, 1e-3, total))];
    for slot in [Slot::Tread, Slot::FlangeRoot] {
        let of = force(slot.index());
        curves.push(Curve::new(Mark::Line, colour(slot), points(&runs.wheelset, 1e-3, of)));
        curves.push(Curve::new(Mark::Dashes, colour(slot), points(&runs.wheelset_flat, 1e-3, of)));
    }
    let rows = [vec![Panel::new("outer wheel", ["distance (m)", "normal force (kN)"], curves)]];
    let entries = [
        (Mark::Line, INK, "total".to_string()),
        (Mark::Line, colour(Slot::Tread), "tread".into()),
        (Mark::Line, colour(Slot::FlangeRoot), "flange line (second slot of this pair)".into()),
        (Mark::Dashes, GREY, "dashed: 2-D".into()),
    ];
    let [tread, flange] = [0, 1].map(|slot| 1e-3 * steady(&runs.wheelset, force(slot)));
    let start = 1e-3 * total(&runs.wheelset[0]);
    let row = |s: &Sample| {
        let forces: [f64; SLOTS] = slot_forces(outer(s));
        vec![s.distance, forces[0], forces[1], total(s)]
    };
    Ok(Plate {
        number: 10,
        stem: "fig10".into(),
        title: "Load of the outer wheel",
        svg: draw("normal forces of the outer wheel on R = 1000 m", &entries, &rows)?,
        csv: csv(&["distance_m", "tread_n", "flange_n", "total_n"], runs.wheelset.iter().map(row))?,
        theirs: "Through the transition the load passes from tread to flange; in the curve both share it, the greater part \
                 on the flange, and the sum of the normal forces is larger than on straight track.",
        ours: format!(
            "In the curve the tread bears {tread:.1} kN and the flange {flange:.1} kN; their sum rises from {start:.1} to \
             {:.1} kN.",
            tread + flange
        ),
        difference: "Load passes over and the sum rises as in the paper. Which of the two bears more depends on the \
                     guiding force, so on friction, suspension and speed, which are ours.",
        checks: vec![
            Check {
                figure: 10,
                claim: "load passes from tread to flange",
                measured: start - tread,
                unit: "kN that leave the tread",
                holds: tread < start && flange > 1.0,
            },
            Check {
                figure: 10,
                claim: "shared at the end, with the greater part on the flange",
                measured: flange / (tread + flange),
                unit: "share of the flange",
                holds: flange > tread && tread > 0.0,
            },
            Check {
                figure: 10,
                claim: "total normal force rises",
                measured: tread + flange - start,
                unit: "kN",
                holds: tread + flange > start,
            },
        ],
    })
}

/// The flange contact of the outer wheel: this pair's second slot.
fn flange(sample: &Sample) -> Option<&Touch> {
    outer(sample).touches[1].as_ref()
}

/// Figure 11. Nadal considers the forces at the flange contact alone, as it stands before a climb (Locomotives à vapeur,
/// 1908; Wu and Wilson in Iwnicki, Handbook of Railway Vehicle Dynamics, 2006, chapter 8; Marquis and Greif, JRC2011-56064):
///
/// ```text
/// Y/Q of the flange = (N sin γ - T cos γ) / (N cos γ + T sin γ),   limit (tan γ - μ) / (1 + μ tan γ) where T = μ N
/// ```
/// T is the creep force across the rail that holds the flange up. For a wheel that touches once this is Y/Q of the wheel.
pub(super) fn wear(runs: &Runs) -> Result<Plate> {
    let samples = [runs.wheelset_flat.as_slice(), &runs.wheelset];
    let wear: fn(&Sample) -> f64 = |sample| outer(sample).wear();
    let of_wheel: fn(&Sample) -> f64 = |sample| outer(sample).loads.ratio();
    let of_flange: fn(&Sample) -> f64 = |sample| flange(sample).map_or(f64::NAN, |touch| touch.loads.ratio());
    let holding = |sample: &Sample| {
        let share = |t: &Touch| f64::from(t.forces.lateral.abs()) / (runs.friction * f64::from(t.contact.normal_force));
        flange(sample).map_or(f64::NAN, share)
    };
    let angle = steady(&runs.wheelset, |s| flange(s).map_or(f64::NAN, |t| f64::from(t.contact.angle)));
    let limit = nadal_limit(angle, runs.friction);
    let end = runs.wheelset.last().map_or(0.0, |sample| sample.distance);
    let mut nadal = both("Nadal's coefficient: its flange contact", "Y/Q (-)", samples, 1.0, of_flange);
    nadal.curves.push(Curve::new(Mark::Line, GREY, vec![(0.0, limit), (end, limit)]));
    let rows = [
        vec![both("wear index of the outer wheel", "wear index (N)", samples, 1.0, wear), nadal],
        vec![
            both("the whole wheel", "Y/Q (-)", samples, 1.0, of_wheel),
            both("creep force up the flange", "share of friction times N (-)", samples, 1.0, holding),
        ],
    ];
    let mut entries = ways();
    entries.push((Mark::Line, GREY, format!("Nadal's limit, {limit:.2}")));
    let change = |value: fn(&Sample) -> f64| {
        let [flat, full] = samples.map(|s| steady(s, value));
        1e2 * (full - flat) / flat
    };
    let (by_wear, by_flange, by_wheel) = (change(wear), change(of_flange), change(of_wheel));
    let [flat, full] = samples.map(|s| steady(s, of_flange));
    let pairs = samples[0].iter().zip(samples[1]);
    let values = [wear, of_flange, of_wheel];
    let row = |(a, b): (&Sample, &Sample)| {
        [vec![b.distance], values.iter().flat_map(|value| [value(a), value(b)]).collect()].concat()
    };
    let columns =
        ["distance_m", "wear_2d_n", "wear_3d_n", "nadal_flange_2d", "nadal_flange_3d", "y_over_q_2d", "y_over_q_3d"];
    let differs = |claim: &'static str, measured: f64| Check {
        figure: 11,
        claim,
        measured,
        unit: "% by which 3-D differs from 2-D in the steady curve; clearly is from 5 % on",
        holds: measured.abs() >= 5.0,
    };
    Ok(Plate {
        number: 11,
        stem: "fig11".into(),
        title: "Wear index and Nadal's coefficient",
        svg: draw("wear index and Nadal's coefficient on R = 1000 m", &entries, &rows)?,
        csv: csv(&columns, pairs.map(row))?,
        theirs: "Wear index and Nadal's coefficient of the outer wheel differ clearly between 2-D and 3-D.",
        ours: format!(
            "In the curve the wear index is {by_wear:+.1} % in 3-D against 2-D. Nadal's coefficient is drawn as Y/Q of the \
             flange contact alone, the forces that his criterion is about: {full:.2} in 3-D, {flat:.2} in 2-D, \
             {by_flange:+.0} %, above the limit of {limit:.2} as long as the flange slides down the rail. Y/Q of the whole \
             wheel, tread and flange together, changes by {by_wheel:+.2} %."
        ),
        difference: "Agrees for the flange contact: in 3-D it lies ahead of the axle and slides down the rail, so friction \
                     holds it up; in 2-D it slides along the rail. Y/Q of the whole wheel hardly differs, since the \
                     equilibrium of the wheelset fixes it. Which of the two the paper draws we do not know.",
        checks: vec![
            differs("wear index differs clearly between 2-D and 3-D", by_wear),
            differs("Nadal's coefficient (Y/Q of the flange contact) differs clearly between 2-D and 3-D", by_flange),
        ],
    })
}
