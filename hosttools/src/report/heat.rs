//! Colours of errors: a map over lateral displacement and yaw, and the bar that says what they mean.

use std::ops::Range;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{Area, BOTTOM_LABELS, Chart, Drawn, INK, MARGIN, TITLE, px, words};
use crate::verify::{Sample, quantile};

/// Decades of the error in percent that are coloured.
const COLOURED: [f64; 2] = [-2.0, 2.0];
/// Cells of a map over lateral displacement and yaw.
pub(super) const CELLS: [usize; 2] = [40, 12];

/// log10 of a relative error in percent.
pub(super) fn decade(error: f64) -> f64 {
    libm::log10((1e2 * error).max(1e-9))
}

/// Colours the cells of a map (mm, mrad) by the 95 % quantile of the errors of the samples in each.
pub(super) fn cells<'s>(
    chart: &mut Chart<'_, '_>,
    [across, up]: [&Range<f64>; 2],
    samples: impl Iterator<Item = &'s Sample>,
) -> Drawn<()> {
    let mut cells = vec![Vec::new(); CELLS[0] * CELLS[1]];
    let width = (across.end - across.start) / CELLS[0] as f64;
    let height = (up.end - up.start) / CELLS[1] as f64;
    for sample in samples {
        let cell = |value: f64, start: f64, size: f64, count: usize| (((value - start) / size) as usize).min(count - 1);
        let i = cell(1e3 * sample.coordinates.lateral, across.start, width, CELLS[0]);
        let j = cell(1e3 * sample.coordinates.yaw, up.start, height, CELLS[1]);
        cells[i * CELLS[1] + j].push(sample.force_error());
    }
    for (index, cell) in cells.iter_mut().enumerate().filter(|(_, cell)| !cell.is_empty()) {
        cell.sort_by(f64::total_cmp);
        let (i, j) = ((index / CELLS[1]) as f64, (index % CELLS[1]) as f64);
        let corner = |i: f64, j: f64| (across.start + width * i, up.start + height * j);
        let ink = heat(decade(quantile(cell, 0.95)));
        // A little larger: the next cells cover that, and no seam shows.
        let far = corner((i + 1.04).min(CELLS[0] as f64), (j + 1.04).min(CELLS[1] as f64));
        chart.draw_series([Rectangle::new([corner(i, j), far], ink.filled())])?;
    }
    Ok(())
}

/// The colour bar, as high as the plot beside it.
pub(super) fn bar(area: &Area<'_>) -> Drawn<()> {
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
