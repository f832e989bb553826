//! Figures 13 and 14: the bogie on R = 60 m; and the same by the table.

use flangeway::Slot;

use super::runs::{Runs, STAND_IN, THROAT};
use super::wheelset::{both, points, steady, ways};
use super::{Check, Plate};
use crate::dynamics::record::{Sample, slot_forces};
use crate::dynamics::wheel_rail::Wheel;
use crate::error::Result;
use crate::report::plot::{Curve, Panel, csv, draw};
use crate::report::style::{GREY, INK, Mark, colour, slot_entries};

/// Share of the wheel's normal force from which on a region takes part, and over how much track (m) it is asked for.
const SHARE: f64 = 0.05;
const STRETCH: f64 = 10.0;

/// Legend of the regions, by this wheel's names.
fn regions_entries() -> Vec<(Mark, plotters::style::RGBColor, String)> {
    let mut entries = slot_entries(Mark::Line);
    entries[Slot::FlangeRoot.index()].2 = THROAT.into();
    entries
}

/// A number taken from a sample.
type Quantity = fn(&Sample) -> f64;

/// The outer leading wheel: the right one in the scenario's left-hand curve.
fn outer(sample: &Sample) -> &Wheel {
    &sample.wheelsets[0].wheels[0]
}

/// Figure 13.
pub(super) fn regions(runs: &Runs) -> Result<Plate> {
    let force = |slot: Slot| move |sample: &Sample| slot_forces(outer(sample))[slot.index()];
    let total: fn(&Sample) -> f64 = |sample| outer(sample).normal_force();
    let mut curves = vec![Curve::new(Mark::Line, INK, points(&runs.bogie, 1e-3, total))];
    curves.extend(Slot::ALL.map(|slot| Curve::new(Mark::Line, colour(slot), points(&runs.bogie, 1e-3, force(slot)))));
    let title = format!("outer leading wheel, 3-D on line; {STAND_IN}");
    let rows = [vec![Panel::new(&title, ["distance (m)", "normal force (kN)"], curves)]];
    let mut entries = regions_entries();
    entries.push((Mark::Line, INK, "total".into()));
    let most = |slot: Slot| runs.bogie.iter().map(|s| force(slot)(s) / total(s).max(1.0)).fold(0.0, f64::max);
    let least = Slot::ALL.map(most).into_iter().fold(1.0, f64::min);
    // Metres of track over which the least of the three shares is large enough.
    let third = |s: &Sample| slot_forces(outer(s)).into_iter().fold(f64::INFINITY, f64::min) / total(s).max(1.0);
    let shared = |w: &[Sample]| if third(&w[0]) >= SHARE { w[1].distance - w[0].distance } else { 0.0 };
    let together: f64 = runs.bogie.windows(2).map(shared).sum();
    let at_the_end = 1e2 * steady(&runs.bogie, third);
    let [tread, root, flange] = Slot::ALL.map(|slot| 1e-3 * steady(&runs.bogie, force(slot)));
    let row = |s: &Sample| [&[s.distance][..], &slot_forces(outer(s)), &[total(s)]].concat();
    Ok(Plate {
        number: 13,
        stem: "fig13".into(),
        title: "Three regions of the outer leading wheel",
        svg: draw("normal forces of the outer leading wheel on R = 60 m", &entries, &rows)?,
        csv: csv(&["distance_m", "tread_n", "flange_root_n", "flange_n", "total_n"], runs.bogie.iter().map(row))?,
        theirs: "On R = 60 m three regions of the outer leading wheel share the load.",
        ours: format!(
            "In the steady curve tread, throat and flange bear {tread:.1}, {root:.1} and {flange:.1} kN: the least of them \
             {at_the_end:.1} % of the three. Each bears at least {:.0} % of their sum over {together:.0} m of track.",
            1e2 * SHARE
        ),
        difference: "Agrees, on a wheel that was chosen for it: the flange reaches its rail, at this yaw, where tread and \
                     throat share the load. The same bogie on S1002 wheels has two regions share at a time. The peaks at \
                     14 and 39 m are the kinks at both ends of the linear cant ramp, which track and vehicle take without \
                     elasticity of their own.",
        checks: vec![
            Check {
                figure: 13,
                claim: "three regions share the load on the way through the curve",
                measured: 1e2 * least,
                unit: "% of the wheel's load at the most, on the region that bears least; a part is from 5 % on",
                holds: least > SHARE,
            },
            Check {
                figure: 13,
                claim: "three regions share the load at the same time",
                measured: together,
                unit: "m of track on which each of the three bears at least 5 % of the wheel's load; asked for are 10 m",
                holds: together >= STRETCH,
            },
        ],
    })
}

/// The run of figure 13 by the table, beside the direct solver.
pub(super) fn table(runs: &Runs) -> Result<Plate> {
    let quantities: [(&'static str, Quantity); 3] = [
        ("normal force (kN)", |s| outer(s).normal_force()),
        ("guiding force Y (kN)", |s| outer(s).loads.guiding_force),
        ("wheel load Q (kN)", |s| outer(s).loads.wheel_load),
    ];
    let panel = |&(label, value): &(&'static str, Quantity)| {
        let curves = vec![
            Curve::new(Mark::Line, INK, points(&runs.bogie_by_table, 1e-3, value)),
            Curve::new(Mark::Dashes, GREY, points(&runs.bogie, 1e-3, value)),
        ];
        Panel::new(label, ["distance (m)", label], curves)
    };
    let regions = {
        let force = |slot: Slot| move |sample: &Sample| slot_forces(outer(sample))[slot.index()];
        let curves = Slot::ALL.into_iter().flat_map(|slot| {
            [
                Curve::new(Mark::Line, colour(slot), points(&runs.bogie_by_table, 1e-3, force(slot))),
                Curve::new(Mark::Dashes, GREY, points(&runs.bogie, 1e-3, force(slot))),
            ]
        });
        Panel::new("normal force by region", ["distance (m)", "normal force (kN)"], curves.collect())
    };
    let rows = [vec![panel(&quantities[0]), regions], vec![panel(&quantities[1]), panel(&quantities[2])]];
    let mut entries = regions_entries();
    entries.push((Mark::Line, INK, "table (lines)".into()));
    entries.push((Mark::Dashes, GREY, "dashed: direct solver".into()));
    let rms = |samples: &[Sample], value: Quantity| {
        let squares = |f: &dyn Fn((&Sample, &Sample)) -> f64| samples.iter().zip(&runs.bogie).map(f).sum::<f64>();
        let errors = squares(&|(a, b)| (value(a) - value(b)).powi(2));
        1e2 * (errors / squares(&|(_, b)| value(b).powi(2))).sqrt()
    };
    let errors = quantities.map(|(_, value)| rms(&runs.bogie_by_table, value));
    let [small_n, small_y, small_q] = quantities.map(|(_, value)| rms(&runs.bogie_by_small_table, value));
    let worst = errors.into_iter().fold(0.0, f64::max);
    // What the last, steady tenth still moves.
    let swing = |samples: &[Sample]| {
        let (last, value) = (&samples[samples.len() - samples.len() / 10..], quantities[0].1);
        let (low, high) = last.iter().map(value).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let spurious = swing(&runs.bogie_by_table) - swing(&runs.bogie);
    let pairs = runs.bogie_by_table.iter().zip(&runs.bogie);
    let row = |(a, b): (&Sample, &Sample)| {
        [vec![b.distance], quantities.iter().flat_map(|(_, value)| [value(a), value(b)]).collect()].concat()
    };
    Ok(Plate {
        number: 13,
        stem: "fig13_table".into(),
        title: "The same by the table",
        svg: draw("the bogie by the table and by the direct solver", &entries, &rows)?,
        csv: csv(
            &["distance_m", "n_table_n", "n_direct_n", "y_table_n", "y_direct_n", "q_table_n", "q_direct_n"],
            pairs.map(row),
        )?,
        theirs: "The paper runs its dynamics from a table of 10 to 34 MB in place of the on-line solution.",
        ours: format!(
            "With a table of 1 MiB the outer leading wheel's normal force, Y and Q differ by {:.2}, {:.2} and {:.2} % rms \
             from the same run with the direct solver; with one of 256 KiB (not drawn) by {small_n:.2}, {small_y:.2} and \
             {small_q:.2} %.",
            errors[0], errors[1], errors[2]
        ),
        difference: "No figure of the paper: it shows that nothing above is the table's doing.",
        checks: vec![
            Check {
                figure: 13,
                claim: "table against direct solver: forces of the outer leading wheel within 3 % rms",
                measured: worst,
                unit: "% rms, the worst of normal force, Y and Q",
                holds: worst < 3.0,
            },
            Check {
                figure: 13,
                claim: "no spurious oscillation from the table",
                measured: spurious,
                unit: "N of swing in the steady curve beyond the direct solver's",
                holds: spurious < 100.0,
            },
        ],
    })
}

/// Figure 14.
pub(super) fn wear(runs: &Runs) -> Result<Plate> {
    let samples = [runs.bogie_flat.as_slice(), &runs.bogie];
    let wear: fn(&Sample) -> f64 = Sample::wear;
    let leading: fn(&Sample) -> f64 = |sample| outer(sample).wear();
    let rows = [vec![
        both(&format!("all four wheels; {STAND_IN}"), "wear index (N)", samples, 1.0, wear),
        both("outer leading wheel", "wear index (N)", samples, 1.0, leading),
    ]];
    let [flat, full] = samples.map(|s| steady(s, wear));
    let pairs = samples[0].iter().zip(samples[1]);
    Ok(Plate {
        number: 14,
        stem: "fig14".into(),
        title: "Total wear index of the bogie",
        svg: draw("total wear index of the bogie on R = 60 m", &ways(), &rows)?,
        csv: csv(
            &["distance_m", "wear_2d_n", "wear_3d_n", "outer_leading_2d_n", "outer_leading_3d_n"],
            pairs.map(|(a, b)| vec![b.distance, wear(a), wear(b), leading(a), leading(b)]),
        )?,
        theirs: "The total wear index in the curve is larger in 3-D than in 2-D.",
        ours: format!(
            "In the steady curve it is {full:.0} N in 3-D and {flat:.0} N in 2-D, {:+.0} %.",
            1e2 * (full / flat - 1.0)
        ),
        difference: "Agrees in sign. The 2-D wheel touches in the section through the axle, where its flange does not slide \
                     down the rail, and farther out, so that its tread does not bear: what two contacts share slips less \
                     than what three do.",
        checks: vec![Check {
            figure: 14,
            claim: "total wear index is larger in 3-D",
            measured: full / flat,
            unit: "times the 2-D one in the steady curve",
            holds: full > flat,
        }],
    })
}
