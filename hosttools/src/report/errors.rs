//! The table against the direct solver at random poses: the error of the force, pose by pose and as a map.

use flangeway::{AxisName, ContactTable, Side, Slot};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use rayon::prelude::*;

use super::style::{
    Area, Axis, BOTTOM_LABELS, Drawn, INK, LEGEND, MARGIN, Mark, TITLE, WIDTH, colour, figure, legend, panel,
    panel_height, px, slot_at, slot_entries, words,
};
use crate::error::Result;
use crate::pair::Pair;
use crate::rigid::at_displacement;
use crate::verify::{Sample, quantile};

/// Decades of the error in percent: shown in the scatter, coloured in the map.
const SHOWN: std::ops::Range<f64> = -3.0..3.0;
const COLOURED: [f64; 2] = [-2.0, 2.0];
/// Most points of the scatter.
const POINTS: usize = 4000;
/// Cells of the map over lateral displacement and yaw.
const CELLS: [usize; 2] = [40, 12];
/// Heights of the plots, width of the colour bar's panel (shown pixels).
const SCATTER: u32 = 360;
const MAP: u32 = 330;
const BAR: u32 = 150;
const DISPLACEMENT: &str = "lateral displacement u of the tape-circle point (mm)";

/// log10 of the force error in percent.
fn decade(error: f64) -> f64 {
    libm::log10((1e2 * error).max(1e-9))
}

/// The slot that carries most by the direct solver.
fn dominant(sample: &Sample) -> Slot {
    let force = |slot: &Slot| sample.slots[slot.index()].normal_force();
    Slot::ALL.into_iter().max_by(|a, b| force(a).total_cmp(&force(b))).unwrap_or(Slot::Tread)
}

fn range(table: &ContactTable<'_>, name: AxisName) -> std::ops::Range<f64> {
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
    let mut cells = vec![Vec::new(); CELLS[0] * CELLS[1]];
    let width = (across.end - across.start) / CELLS[0] as f64;
    let height = (up.end - up.start) / CELLS[1] as f64;
    for sample in samples {
        let cell = |value: f64, start: f64, size: f64, count: usize| (((value - start) / size) as usize).min(count - 1);
        let i = cell(1e3 * sample.coordinates.lateral, across.start, width, CELLS[0]);
        let j = cell(1e3 * sample.coordinates.yaw, up.start, height, CELLS[1]);
        cells[i * CELLS[1] + j].push(sample.force_error());
    }
    let jumps = jumps(pair, [&across, &up]);
    figure("map of the force error over lateral displacement and yaw", LEGEND + panel_height(MAP), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &[(Mark::Ring, INK, "rigid contact changes from slot to slot".into())])?;
        let (left, right) = below.split_horizontally(px(WIDTH - BAR));
        let x = Axis::new(DISPLACEMENT, across.clone(), 11);
        let y = Axis::new("yaw (mrad)", up.clone(), 7);
        let mut chart = panel(&left, "force error, 95 % quantile in each cell", &x, &y)?;
        for (index, cell) in cells.iter_mut().enumerate().filter(|(_, cell)| !cell.is_empty()) {
            cell.sort_by(f64::total_cmp);
            let (i, j) = ((index / CELLS[1]) as f64, (index % CELLS[1]) as f64);
            let corner = |i: f64, j: f64| (across.start + width * i, up.start + height * j);
            let ink = heat(decade(quantile(cell, 0.95)));
            // A little larger: the next cells cover that, and no seam shows.
            let far = corner((i + 1.04).min(CELLS[0] as f64), (j + 1.04).min(CELLS[1] as f64));
            chart.draw_series([Rectangle::new([corner(i, j), far], ink.filled())])?;
        }
        chart.draw_series(jumps.iter().flat_map(|&at| {
            [Circle::new(at, px(4), RIGID.filled()), Circle::new(at, px(4), INK.stroke_width(px(1)))]
        }))?;
        bar(&right)
    })
}

/// Colour of the dots where the rigid contact changes its slot.
const RIGID: RGBColor = RGBColor(255, 255, 255);

/// Displacement (mm) and yaw (mrad) where the right wheel's rigid contact changes from slot to slot.
fn jumps(pair: &Pair, [across, up]: [&std::ops::Range<f64>; 2]) -> Vec<(f64, f64)> {
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

/// The colour bar.
fn bar(area: &Area<'_>) -> Drawn<()> {
    let [low, high] = COLOURED;
    let (top, bottom) = (px(TITLE), area.dim_in_pixel().1 - px(BOTTOM_LABELS + MARGIN));
    let (left, right) = (px(MARGIN), px(MARGIN + 24));
    let level = |decade: f64| bottom - (f64::from(bottom - top) * (decade - low) / (high - low)) as u32;
    const STEPS: usize = 64;
    for i in 0..STEPS {
        let at = |i: usize| low + (high - low) * i as f64 / STEPS as f64;
        let corners = [(left as i32, level(at(i)) as i32), (right as i32, top as i32)];
        area.draw(&Rectangle::new(corners, heat(at(i)).filled()))?;
    }
    let frame = [(left as i32, top as i32), (right as i32, bottom as i32)];
    area.draw(&Rectangle::new(frame, INK.stroke_width(px(1))))?;
    words(area, "force error", [left, px(TITLE) / 2], 14, HPos::Left, INK)?;
    for tick in low as i32..=high as i32 {
        let sign = if f64::from(tick) == low {
            "≤ "
        } else if f64::from(tick) == high {
            "≥ "
        } else {
            ""
        };
        let text = format!("{sign}{} %", 10_f64.powi(tick));
        words(area, &text, [right + px(8), level(f64::from(tick))], 14, HPos::Left, INK)?;
    }
    Ok(())
}

/// Colour of an error's decade: anchors of viridis, whose lightness rises evenly and whose hues stay apart for
/// colour-blind readers.
fn heat(decade: f64) -> RGBColor {
    const ANCHORS: [[f64; 3]; 6] = [
        [68.0, 1.0, 84.0],
        [65.0, 68.0, 135.0],
        [42.0, 120.0, 142.0],
        [34.0, 168.0, 132.0],
        [122.0, 209.0, 81.0],
        [253.0, 231.0, 37.0],
    ];
    let [low, high] = COLOURED;
    let place = ((decade - low) / (high - low)).clamp(0.0, 1.0) * (ANCHORS.len() - 1) as f64;
    let below = (place as usize).min(ANCHORS.len() - 2);
    let share = place - below as f64;
    let channel = |k: usize| (ANCHORS[below][k] + share * (ANCHORS[below + 1][k] - ANCHORS[below][k])).round() as u8;
    RGBColor(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_runs_from_end_to_end() {
        assert_eq!(heat(-9.0), RGBColor(68, 1, 84));
        assert_eq!(heat(COLOURED[1]), RGBColor(253, 231, 37));
    }
}
