//! Histograms of a rig's run: how long the steps took, and how late the wake-ups came.

use std::ops::Range;

use hdrhistogram::Histogram;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{
    Area, Axis, Drawn, INK, LEFT_LABELS, LEGEND, MARGIN, Mark, WIDTH, figure, legend, panel, panel_height, px, words,
};
use crate::error::Result;
use crate::rig::{Figures, NOTE, Quantiles};

/// Height of a plot, room for the last label of the axis of time (shown pixels), and bars in a decade of time.
const PLOT: u32 = 260;
const LAST_LABEL: u32 = 20;
const BARS: f64 = 25.0;
/// Bottom of the counts' decades: a bar for a single step has to have a height.
const FLOOR: f64 = -0.3;
const BAR: RGBColor = RGBColor(170, 184, 204);

/// Both histograms, on the same axis of time, with the period in it.
///
/// # Errors
/// When the drawing library fails.
pub fn histograms(figures: &Figures<'_>) -> Result<String> {
    let log = figures.log;
    let period = 1e9 / f64::from(figures.settings.rate);
    let decades = decades([&log.step, &log.lateness], period as u64);
    let height = LEGEND + panel_height(PLOT);
    figure("step times and wake-up lateness of a fixed-step loop", LEGEND + 2 * height, |area| {
        let (area, _) = area.split_horizontally(px(WIDTH - LAST_LABEL));
        let (above, below) = area.split_vertically(px(LEGEND));
        let at = [px(LEFT_LABELS + MARGIN), px(LEGEND) / 2];
        words(&above, &heading(figures), at, 15, HPos::Left, INK)?;
        let (top, bottom) = below.split_vertically(px(height));
        let lines = |histogram| lines(&Quantiles::of(histogram), period);
        one(&top, "step time: from a step's begin to its end", &log.step, &decades, &lines(&log.step))?;
        let title = "wake-up lateness: from a period's release to its step's begin";
        one(&bottom, title, &log.lateness, &decades, &lines(&log.lateness))
    })
}

fn heading(figures: &Figures<'_>) -> String {
    let (settings, counts) = (figures.settings, &figures.log.counts);
    format!(
        "{} steps at {} Hz, wheels: {}; {} of {} deadlines missed; {NOTE}",
        counts.steps(),
        settings.rate,
        settings.wheels,
        counts.missed(),
        settings.periods()
    )
}

/// What is marked on the axis of time: kind of line, colour, name and time (µs). Colours of P. Tol's high-contrast
/// scheme, and a green beside them.
fn lines(quantiles: &Quantiles, period: f64) -> [(Mark, RGBColor, &'static str, f64); 5] {
    [
        (Mark::Dashes, RGBColor(0, 68, 136), "p50", 1e6 * quantiles.p50),
        (Mark::Dashes, RGBColor(221, 170, 51), "p99", 1e6 * quantiles.p99),
        (Mark::Dashes, RGBColor(187, 85, 102), "p99.9", 1e6 * quantiles.p99_9),
        (Mark::Dashes, INK, "observed max", 1e6 * quantiles.max),
        (Mark::Line, RGBColor(17, 119, 51), "period", 1e-3 * period),
    ]
}

/// Whole decades (log10 of µs) around everything recorded and the period (ns).
fn decades(histograms: [&Histogram<u64>; 2], period: u64) -> Range<f64> {
    let low = histograms.iter().map(|h| decade(h.min_nz())).fold(decade(period), f64::min).floor();
    let high = histograms.iter().map(|h| decade(h.max())).fold(decade(period), f64::max).ceil();
    low.min(high - 1.0)..high
}

/// log10 of nanoseconds in µs.
fn decade(nanoseconds: u64) -> f64 {
    libm::log10(1e-3 * (nanoseconds.max(1) as f64))
}

fn one(
    area: &Area<'_>,
    title: &str,
    histogram: &Histogram<u64>,
    decades: &Range<f64>,
    lines: &[(Mark, RGBColor, &str, f64)],
) -> Drawn<()> {
    let (above, below) = area.split_vertically(px(LEGEND));
    let entry = |&(mark, ink, name, time): &_| (mark, ink, format!("{name} {} µs", short(time)));
    legend(&above, &lines.iter().map(entry).collect::<Vec<_>>())?;

    let bars = bars(histogram, decades);
    let most = bars.iter().copied().max().unwrap_or(1).max(1);
    let counts = FLOOR..libm::log10(most as f64).ceil().max(1.0);
    let x = Axis::log("time (µs, log scale)", decades.clone());
    let mut chart = panel(&below, title, &x, &Axis::log("steps (log scale)", counts.clone()))?;
    let upright = |x: f64| vec![(x, counts.start), (x, counts.end)];
    // The lines of 2 to 9 within each decade show that the axis is logarithmic.
    for whole in decades.start as i32..decades.end as i32 {
        let within = (2..10).map(|digit| f64::from(whole) + libm::log10(f64::from(digit)));
        let style = BLACK.mix(0.05).stroke_width(px(1));
        chart.draw_series(within.map(|x| PathElement::new(upright(x), style)))?;
    }
    let filled = bars.iter().enumerate().filter(|(_, count)| **count > 0);
    chart.draw_series(filled.map(|(i, count)| {
        let x = |i: usize| decades.start + i as f64 / BARS;
        Rectangle::new([(x(i), counts.start), (x(i + 1), libm::log10(*count as f64))], BAR.filled())
    }))?;
    // The last first: a quantile that falls on the period is seen through it.
    for &(mark, ink, _, time) in lines.iter().rev() {
        let points = upright(libm::log10(time.max(1e-9)).clamp(decades.start, decades.end));
        let style = ink.stroke_width(px(2));
        match mark {
            Mark::Dashes => chart.draw_series(DashedLineSeries::new(points, px(7), px(4), style))?,
            _ => chart.draw_series(LineSeries::new(points, style))?,
        };
    }
    Ok(())
}

/// Three digits or all whole ones.
fn short(value: f64) -> String {
    let decimals = if value < 10.0 {
        2
    } else if value < 100.0 {
        1
    } else {
        0
    };
    format!("{value:.decimals$}")
}

/// Counts of a histogram in bars of equal width on the logarithmic axis.
fn bars(histogram: &Histogram<u64>, decades: &Range<f64>) -> Vec<u64> {
    let count = ((decades.end - decades.start) * BARS).round() as usize;
    let mut bars = vec![0; count];
    for value in histogram.iter_recorded() {
        let place = (decade(value.value_iterated_to()) - decades.start) * BARS;
        let place = (place.max(0.0) as usize).min(count - 1);
        bars[place] += value.count_at_value();
    }
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_hold_every_step() {
        let mut histogram = Histogram::new_with_bounds(1, 100_000_000_000, 3).unwrap();
        for value in [0, 1, 900, 1_000, 1_001, 30_000, 20_000_000_000] {
            histogram.record(value).unwrap();
        }
        let decades = decades([&histogram, &histogram], 1_000_000);
        assert_eq!(decades, -3.0..8.0);
        let bars = bars(&histogram, &decades);
        assert_eq!(bars.len(), 275);
        assert_eq!(bars.iter().sum::<u64>(), 7);
        assert_eq!((bars[0], bars[75]), (2, 2));
    }

    #[test]
    fn three_digits() {
        assert_eq!([0.1234, 9.99, 12.34, 123.4, 12_345.0].map(short), ["0.12", "9.99", "12.3", "123", "12345"]);
    }
}
