//! Curves in panels, bars, and the CSV beside them: for figures whose axes follow from their data.

use std::ops::Range;

use plotters::prelude::*;

use super::style::{Axis, INK, LEGEND, Mark, dashes, figure, legend, line, panel, panel_height, px};
use crate::error::{Error, Result};

/// Height of a plot (shown pixels).
const PLOT: u32 = 320;

/// A curve of a panel.
pub(crate) struct Curve {
    pub(crate) mark: Mark,
    pub(crate) ink: RGBColor,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Curve {
    pub(crate) fn new(mark: Mark, ink: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self { mark, ink, points }
    }
}

/// A panel: title, labels of its axes with units, curves.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) labels: [&'static str; 2],
    pub(crate) curves: Vec<Curve>,
    /// Cells `[x, y, width, height]` filled with an ink, below the curves.
    pub(crate) cells: Vec<([f64; 4], RGBColor)>,
    /// Ranges of x and y where they are not to follow from the data.
    pub(crate) ranges: Option<[Range<f64>; 2]>,
}

impl Panel {
    pub(crate) fn new(title: &str, labels: [&'static str; 2], curves: Vec<Curve>) -> Self {
        Self { title: title.into(), labels, curves, cells: Vec::new(), ranges: None }
    }

    fn range(&self, axis: usize) -> Range<f64> {
        if let Some(ranges) = &self.ranges {
            return ranges[axis].clone();
        }
        let of = |&(x, y): &(f64, f64)| if axis == 0 { x } else { y };
        let curves = self.curves.iter().flat_map(|curve| curve.points.iter().map(of));
        let cells = self.cells.iter().flat_map(|(cell, _)| [cell[axis], cell[axis] + cell[axis + 2]]);
        let (low, high) = curves
            .chain(cells)
            .filter(|v| v.is_finite())
            .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        if low >= high {
            return low - 1.0..low + 1.0;
        }
        // Along x to the ends of the data, along y with air.
        let air = if axis == 0 { 0.0 } else { 0.05 * (high - low) };
        low - air..high + air
    }
}

/// Rows of panels, as many side by side as are given, under one legend; a note goes into the legend's row.
pub(crate) fn draw(name: &str, entries: &[(Mark, RGBColor, String)], rows: &[Vec<Panel>]) -> Result<String> {
    let height = LEGEND + rows.len() as u32 * panel_height(PLOT);
    figure(name, height, |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, entries)?;
        for (panels, area) in rows.iter().zip(below.split_evenly((rows.len(), 1))) {
            for (content, area) in panels.iter().zip(area.split_evenly((1, panels.len()))) {
                let ticks = 14 / panels.len();
                let (x, y) = (content.range(0), content.range(1));
                let x = Axis { format: number, ..Axis::new(content.labels[0], x, ticks) };
                let y = Axis { format: number, ..Axis::new(content.labels[1], y, 7) };
                let mut chart = panel(&area, &content.title, &x, &y)?;
                for ([x, y, width, height], ink) in &content.cells {
                    let corners = [(*x, *y), (x + width, y + height)];
                    chart.draw_series([Rectangle::new(corners, ink.filled())])?;
                }
                for Curve { mark, ink, points } in &content.curves {
                    match mark {
                        Mark::Line => line(&mut chart, points.clone(), *ink)?,
                        Mark::Dashes => dashes(&mut chart, points.clone(), *ink)?,
                        Mark::Dot | Mark::Ring => {
                            let dots = points.iter().map(|&p| Circle::new(p, px(4), ink.filled()));
                            chart.draw_series(dots)?;
                        }
                    }
                }
            }
        }
        Ok(())
    })
}

/// Bars with a name and a value each, on a logarithmic scale.
pub(crate) fn bars(name: &str, title: &str, label: &str, bars: &[(&str, f64, RGBColor)]) -> Result<String> {
    let decades = |value: f64| libm::log10(value);
    let most = bars.iter().map(|(_, value, _)| decades(*value)).fold(0.0, f64::max).ceil() + 0.4;
    let least = bars.iter().map(|(_, value, _)| decades(*value)).fold(0.0, f64::min).floor();
    figure(name, panel_height(PLOT), |area| {
        let x = Axis { format: nothing, ..Axis::new("", 0.0..bars.len() as f64, 1) };
        let mut chart = panel(area, title, &x, &Axis::log(label, least..most))?;
        for (index, (name, value, ink)) in bars.iter().enumerate() {
            let (left, middle) = (index as f64 + 0.2, index as f64 + 0.5);
            let corners = [(left, least), (left + 0.6, decades(*value))];
            chart.draw_series([Rectangle::new(corners, ink.filled())])?;
            let style = super::style::label_style(INK);
            let text = format!("{name}: {}", significant(*value));
            chart.draw_series([Text::new(text, (middle, decades(*value) + 0.06 * (most - least)), style)])?;
        }
        Ok(())
    })
}

fn nothing(_: &f64) -> String {
    String::new()
}

/// Three significant digits.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (2 - libm::floor(libm::log10(value.abs())) as i32).clamp(0, 9) as usize;
    format!("{value:.digits$}")
}

/// A number on an axis of any size.
fn number(value: &f64) -> String {
    let text = format!("{:.4}", value + 0.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// A CSV file of numbers.
pub(crate) fn csv(columns: &[&str], rows: impl IntoIterator<Item = Vec<f64>>) -> Result<Vec<u8>> {
    let failed = |e: csv::Error| Error::field("", "csv", e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns).map_err(failed)?;
    for row in rows {
        writer.write_record(row.iter().map(|value| format!("{value:.7e}"))).map_err(failed)?;
    }
    writer.into_inner().map_err(|e| Error::field("", "csv", e.to_string()))
}
