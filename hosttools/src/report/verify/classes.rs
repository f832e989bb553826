//! Every pose's error over the lateral displacement, by what its cell holds.

use flangeway::{AxisName, ContactTable};
use plotters::prelude::*;

use crate::error::Result;
use crate::report::errors::{DISPLACEMENT, POINTS, SCATTER, SHOWN, range};
use crate::report::heat::decade;
use crate::report::style::{Axis, LEGEND, Mark, figure, legend, panel, panel_height, px};
use crate::verify::{Class, Sample, Surroundings};

/// Colour of a class: of P. Tol's vibrant scheme.
pub(super) fn colour(class: Class) -> RGBColor {
    match class {
        Class::Joint => RGBColor(0, 119, 187),
        Class::Contacts => RGBColor(238, 119, 51),
        Class::Both => RGBColor(204, 51, 17),
        Class::Rest => RGBColor(170, 170, 170),
    }
}

/// The scatter.
pub(super) fn scatter(table: &ContactTable<'_>, samples: &[Sample], around: &[Surroundings]) -> Result<String> {
    figure("force error by what the cell holds", LEGEND + panel_height(SCATTER), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        let entries = Class::ALL.map(|class| (Mark::Dot, colour(class), class.words().into()));
        legend(&above, &entries)?;
        let x = Axis::new(DISPLACEMENT, range(table, AxisName::Lateral), 11);
        let y = Axis::log("force error (%)", SHOWN);
        let mut chart = panel(&below, "", &x, &y)?;
        let every = samples.len().div_ceil(POINTS).max(1);
        for class in [Class::Rest, Class::Joint, Class::Contacts, Class::Both] {
            let of_class = samples.iter().zip(around).step_by(every).filter(|(_, around)| around.class == class);
            chart.draw_series(of_class.map(|(sample, _)| {
                let error = decade(sample.force_error()).clamp(SHOWN.start, SHOWN.end);
                Circle::new((1e3 * sample.coordinates.lateral, error), px(2), colour(class).mix(0.6).filled())
            }))?;
        }
        Ok(())
    })
}
