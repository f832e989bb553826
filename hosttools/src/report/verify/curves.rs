//! Quantiles of the error over each coordinate and over the load.

use std::ops::Range;

use flangeway::{AxisName, ContactTable};

use crate::error::Result;
use crate::report::errors::range;
use crate::report::heat::decade;
use crate::report::style::{
    Axis, Drawn, GREY, INK, LEGEND, Mark, dashes, figure, legend, line, panel, panel_height, plain,
};
use crate::verify::{LOADS, Sample, quantile};

/// Height of a plot (shown pixels), steps along an axis, decades of the error in percent.
const PLOT: u32 = 260;
const STEPS: usize = 40;
const SHOWN: Range<f64> = -3.0..2.0;
/// Fewest poses of a step that is drawn.
const FEWEST: usize = 20;

/// A panel's axis and the value of a sample on it.
struct Over<'a> {
    axis: Axis<'a>,
    value: fn(&Sample) -> f64,
}

/// Four panels: error over lateral displacement, yaw, roll offset and load.
pub(super) fn curves(table: &ContactTable<'_>, samples: &[Sample]) -> Result<String> {
    let kilonewtons = LOADS.map(|load| libm::log10(1e-3 * load));
    let mut load = Axis::new("load (kN)", kilonewtons[0]..kilonewtons[1], 8);
    load.format = |x| plain(&libm::round(libm::pow(10.0, *x)));
    let along = |label, name| Axis::new(label, range(table, name), 8);
    let panels = [
        Over { axis: along("lateral displacement u (mm)", AxisName::Lateral), value: |s| 1e3 * s.coordinates.lateral },
        Over { axis: along("yaw (mrad)", AxisName::Yaw), value: |s| 1e3 * s.coordinates.yaw },
        Over {
            axis: along("roll about the rigid one (mrad)", AxisName::RollOffset),
            value: |s| 1e3 * s.coordinates.roll_offset,
        },
        Over { axis: load, value: |s| libm::log10((1e-3 * s.direct).max(1e-9)) },
    ];
    let height = LEGEND + 2 * panel_height(PLOT);
    figure("force error over each coordinate", height, |area| {
        let (above, below) = area.split_vertically(crate::report::style::px(LEGEND));
        let entries = [
            (Mark::Line, INK, "median".into()),
            (Mark::Dashes, INK, "95 % quantile".into()),
            (Mark::Dashes, GREY, "99 % quantile".into()),
        ];
        legend(&above, &entries)?;
        for (place, over) in below.split_evenly((2, 2)).iter().zip(&panels) {
            let mut chart = panel(place, "", &over.axis, &Axis::log("force error (%)", SHOWN))?;
            let of = |q| quantiles(samples, over, q);
            dashes(&mut chart, of(0.99), GREY)?;
            dashes(&mut chart, of(0.95), INK)?;
            line(&mut chart, of(0.5), INK)?;
        }
        Drawn::Ok(())
    })
}

/// Quantile of the error's decade in each step of an axis.
fn quantiles(samples: &[Sample], over: &Over<'_>, q: f64) -> Vec<(f64, f64)> {
    let Range { start, end } = over.axis.range;
    let mut steps = vec![Vec::new(); STEPS];
    for sample in samples {
        let place = ((over.value)(sample) - start) / (end - start) * STEPS as f64;
        steps[(place.max(0.0) as usize).min(STEPS - 1)].push(sample.force_error());
    }
    let middle = |i: usize| start + (end - start) * (i as f64 + 0.5) / STEPS as f64;
    let full = steps.iter_mut().enumerate().filter(|(_, errors)| errors.len() >= FEWEST);
    full.map(|(i, errors)| {
        errors.sort_by(f64::total_cmp);
        (middle(i), decade(quantile(errors, q)).clamp(SHOWN.start, SHOWN.end))
    })
    .collect()
}
