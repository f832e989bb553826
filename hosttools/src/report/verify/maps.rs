//! Maps of the error over lateral displacement and yaw, one for each slot.

use flangeway::{ContactTable, Slot};
use plotters::prelude::*;

use crate::error::Result;
use crate::pair::Pair;
use crate::report::errors::{BAR, DISPLACEMENT, RIGID, dominant, jumps, range};
use crate::report::heat::{bar, cells};
use crate::report::style::{Axis, INK, LEGEND, Mark, WIDTH, figure, legend, panel, panel_height, px};
use crate::verify::Sample;

/// Height of each plot (shown pixels).
const MAP: u32 = 200;

/// Maps of the samples in which a slot carries most, for those slots that ever do.
pub(super) fn by_slot(pair: &Pair, table: &ContactTable<'_>, samples: &[Sample]) -> Result<String> {
    use flangeway::AxisName;
    let (across, up) = (range(table, AxisName::Lateral), range(table, AxisName::Yaw));
    let of = |slot: Slot| samples.iter().filter(move |sample| dominant(sample) == slot);
    let slots: Vec<Slot> = Slot::ALL.into_iter().filter(|&slot| of(slot).next().is_some()).collect();
    let jumps = jumps(pair, [&across, &up]);
    let height = LEGEND + panel_height(MAP) * slots.len().max(1) as u32;
    figure("maps of the force error by slot", height, |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &[(Mark::Ring, INK, "rigid contact changes from slot to slot".into())])?;
        let (left, right) = below.split_horizontally(px(WIDTH - BAR));
        for (place, &slot) in left.split_evenly((slots.len().max(1), 1)).iter().zip(&slots) {
            let x = Axis::new(DISPLACEMENT, across.clone(), 11);
            let y = Axis::new("yaw (mrad)", up.clone(), 7);
            let title = format!("{slot} carries most, {} poses", of(slot).count());
            let mut chart = panel(place, &title, &x, &y)?;
            cells(&mut chart, [&across, &up], of(slot))?;
            chart.draw_series(jumps.iter().flat_map(|&at| {
                [Circle::new(at, px(3), RIGID.filled()), Circle::new(at, px(3), INK.stroke_width(px(1)))]
            }))?;
        }
        bar(&right)
    })
}
