//! The table against the direct solver at random poses: the error of the force, pose by pose and as a map.

use flangeway::{AxisName, ContactTable, Side, Slot};
use plotters::prelude::*;
use rayon::prelude::*;

use super::heat::{CELLS, bar, cells, decade};
use super::style::{
    Axis, INK, LEGEND, Mark, WIDTH, colour, figure, legend, panel, panel_height, px, slot_at, slot_entries,
};
use crate::error::Result;
use crate::pair::Pair;
use crate::rigid::at_displacement;
use crate::verify::Sample;

/// Decades of the error in percent that the scatter shows.
pub(super) const SHOWN: std::ops::Range<f64> = -3.0..3.0;
/// Most points of the scatter.
pub(super) const POINTS: usize = 4000;
/// Heights of the plots, width of the colour bar's panel (shown pixels).
pub(super) const SCATTER: u32 = 360;
const MAP: u32 = 330;
pub(super) const BAR: u32 = 150;
pub(super) const DISPLACEMENT: &str = "lateral displacement u of the tape-circle point (mm)";

/// The slot that carries most by the direct solver.
pub(super) fn dominant(sample: &Sample) -> Slot {
    let force = |slot: &Slot| sample.slots[slot.index()].normal_force();
    Slot::ALL.into_iter().max_by(|a, b| force(a).total_cmp(&force(b))).unwrap_or(Slot::Tread)
}

/// Ends of a table's axis (mm or mrad).
pub(super) fn range(table: &ContactTable<'_>, name: AxisName) -> std::ops::Range<f64> {
    let (first, last) = table.axis(name).range();
    // Axes are single precision: their ends are shown as they were written.
    let round = |x: f64| (1e7 * x).round() / 1e4;
    round(first)..round(last)
}

/// Every sample's error over the lateral displacement, in the colour of the slot that carries most.
pub(super) fn scatter(table: &ContactTable<'_>, samples: &[Sample]) -> Result<String> {
    figure("force error over lateral displacement", LEGEND + panel_height(SCATTER), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &slot_entries(Mark::Dot))?;
        let x = Axis::new(DISPLACEMENT, range(table, AxisName::Lateral), 11);
        let y = Axis::log("force error (%)", SHOWN);
        let mut chart = panel(&below, "force of the table against the direct solver's, random poses", &x, &y)?;
        let every = samples.len().div_ceil(POINTS).max(1);
        // The rarer slots on top.
        for slot in Slot::ALL {
            let of_slot = samples.iter().step_by(every).filter(|sample| dominant(sample) == slot);
            chart.draw_series(of_slot.map(|sample| {
                let error = decade(sample.force_error()).clamp(SHOWN.start, SHOWN.end);
                Circle::new((1e3 * sample.coordinates.lateral, error), px(2), colour(slot).mix(0.6).filled())
            }))?;
        }
        Ok(())
    })
}

/// The 95 % quantile of the error in cells of lateral displacement and yaw.
pub(super) fn map(pair: &Pair, table: &ContactTable<'_>, samples: &[Sample]) -> Result<String> {
    let (across, up) = (range(table, AxisName::Lateral), range(table, AxisName::Yaw));
    let jumps = jumps(pair, [&across, &up]);
    figure("map of the force error over lateral displacement and yaw", LEGEND + panel_height(MAP), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &[(Mark::Ring, INK, "rigid contact changes from slot to slot".into())])?;
        let (left, right) = below.split_horizontally(px(WIDTH - BAR));
        let x = Axis::new(DISPLACEMENT, across.clone(), 11);
        let y = Axis::new("yaw (mrad)", up.clone(), 7);
        let mut chart = panel(&left, "force error, 95 % quantile in each cell", &x, &y)?;
        cells(&mut chart, [&across, &up], samples.iter())?;
        chart.draw_series(jumps.iter().flat_map(|&at| {
            [Circle::new(at, px(4), RIGID.filled()), Circle::new(at, px(4), INK.stroke_width(px(1)))]
        }))?;
        bar(&right)
    })
}

/// Colour of the dots where the rigid contact changes its slot.
pub(super) const RIGID: RGBColor = RGBColor(255, 255, 255);

/// Displacement (mm) and yaw (mrad) where the right wheel's rigid contact changes from slot to slot.
pub(super) fn jumps(pair: &Pair, [across, up]: [&std::ops::Range<f64>; 2]) -> Vec<(f64, f64)> {
    const STEPS: usize = 80;
    let row = |j: usize| {
        let yaw = up.start + (up.end - up.start) * j as f64 / CELLS[1] as f64;
        let slot = |u: f64| {
            let found = at_displacement(pair, Side::Right, 1e-3 * u, 1e-3 * yaw)?;
            Some(slot_at(pair.body(Side::Right).boundaries(), found.right.wheel.s))
        };
        let u = |i: usize| across.start + (across.end - across.start) * i as f64 / STEPS as f64;
        let slots: Vec<_> = (0..=STEPS).map(|i| slot(u(i))).collect();
        let change = |i: &usize| slots[*i].is_some() && slots[i + 1].is_some() && slots[*i] != slots[i + 1];
        let narrowed = |i: usize| {
            let (mut low, mut high) = (u(i), u(i + 1));
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if slot(middle) == slots[i] { low = middle } else { high = middle }
            }
            (0.5 * (low + high), yaw)
        };
        (0..STEPS).filter(change).map(narrowed).collect::<Vec<_>>()
    };
    (0..=CELLS[1]).into_par_iter().flat_map_iter(row).collect()
}
