//! What all figures share: colours, fonts, panels with axes, legends, and the SVG around them.

use std::ops::Range;

use flangeway::Slot;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::{Error, Result};

/// The library draws on whole pixels: drawn this many times larger and shown smaller, lines are smooth.
pub(crate) const FINENESS: u32 = 4;
/// Width of every figure as it is shown (pixels).
pub(crate) const WIDTH: u32 = 1200;

/// Room around a panel's plot, in shown pixels.
pub(crate) const TITLE: u32 = 30;
pub(crate) const LEFT_LABELS: u32 = 66;
pub(crate) const BOTTOM_LABELS: u32 = 50;
pub(crate) const MARGIN: u32 = 14;
/// Height of a legend's row (shown pixels).
pub(crate) const LEGEND: u32 = 34;
const FONT: &str = "sans-serif";
const TITLE_FONT: u32 = 18;
const AXIS_FONT: u32 = 15;
const TICK_FONT: u32 = 14;

/// Ink of totals, outlines and words.
pub(crate) const INK: RGBColor = RGBColor(34, 34, 34);
/// A second ink, for what is only for comparison.
pub(crate) const GREY: RGBColor = RGBColor(120, 120, 120);
/// A third ink, for one more curve.
pub(crate) const ACCENT: RGBColor = RGBColor(204, 102, 0);
/// Filling of the wheel and of the rail.
pub(crate) const WHEEL: RGBColor = RGBColor(228, 233, 240);
pub(crate) const RAIL: RGBColor = RGBColor(226, 226, 222);

/// Colour of a slot, the same in every figure: P. Tol's high-contrast scheme, which keeps its three colours apart for
/// colour-blind readers and in grey.
pub(crate) fn colour(slot: Slot) -> RGBColor {
    match slot {
        Slot::Tread => RGBColor(0, 68, 136),
        Slot::FlangeRoot => RGBColor(221, 170, 51),
        Slot::Flange => RGBColor(187, 85, 102),
    }
}

/// The slot of a wheel-profile coordinate (m), by the boundaries of its wheel (m).
pub(crate) fn slot_at([upper, lower]: [f64; 2], s: f64) -> Slot {
    if s > upper {
        Slot::Tread
    } else if s > lower {
        Slot::FlangeRoot
    } else {
        Slot::Flange
    }
}

/// What the drawing library may fail with.
pub(crate) type Drawn<T> = std::result::Result<T, Box<dyn std::error::Error>>;
/// An area to draw on, in drawn pixels.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// A plot with two linear axes.
pub(crate) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Shown pixels in drawn ones.
pub(crate) const fn px(shown: u32) -> u32 {
    FINENESS * shown
}

/// Draws a figure of the usual width and a height in shown pixels, as SVG. `name` says what it shows.
pub(crate) fn figure(name: &str, height: u32, draw: impl FnOnce(&Area<'_>) -> Drawn<()>) -> Result<String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (px(WIDTH), px(height))).into_drawing_area();
        let drawn = area.fill(&WHITE).map_err(Into::into).and_then(|()| draw(&area));
        let drawn = drawn.and_then(|()| area.present().map_err(Into::into));
        drawn.map_err(|e| Error::field("", name, format!("cannot be drawn: {e}")))?;
    }
    let drawn = format!("width=\"{}\" height=\"{}\" viewBox", px(WIDTH), px(height));
    let shown = format!("role=\"img\" aria-label=\"{name}\" width=\"{WIDTH}\" height=\"{height}\" viewBox");
    Ok(svg.replacen(&drawn, &shown, 1))
}

/// An axis: label with unit, range (of which the end may be the lesser), rough number of ticks.
pub(crate) struct Axis<'s> {
    pub(crate) label: &'s str,
    pub(crate) range: Range<f64>,
    pub(crate) ticks: usize,
    pub(crate) format: fn(&f64) -> String,
}

impl<'s> Axis<'s> {
    /// A linear axis.
    pub(crate) fn new(label: &'s str, range: Range<f64>, ticks: usize) -> Self {
        Self { label, range, ticks, format: plain }
    }

    /// A logarithmic axis: the chart is given log10 of the values.
    pub(crate) fn log(label: &'s str, decades: Range<f64>) -> Self {
        let ticks = (decades.end - decades.start).abs() as usize + 1;
        Self { label, range: decades, ticks, format: power }
    }
}

/// Height (shown pixels) of a panel whose plot is `plot` high.
pub(crate) const fn panel_height(plot: u32) -> u32 {
    TITLE + plot + BOTTOM_LABELS + MARGIN
}

/// Width (shown pixels) of the plot in a panel.
pub(crate) const fn plot_width(panel: u32) -> u32 {
    panel - LEFT_LABELS - 2 * MARGIN
}

/// A panel with a title and axes.
pub(crate) fn panel<'a, 'b>(area: &Area<'b>, title: &str, x: &Axis<'_>, y: &Axis<'_>) -> Drawn<Chart<'a, 'b>>
where
    'b: 'a,
{
    let (above, below) = area.split_vertically(px(TITLE));
    let middle = px(LEFT_LABELS + MARGIN) + px(plot_width(area.dim_in_pixel().0 / FINENESS)) / 2;
    words(&above, title, [middle, px(TITLE) / 2], TITLE_FONT, HPos::Center, INK)?;
    let mut chart = ChartBuilder::on(&below)
        .margin(px(MARGIN))
        .margin_top(0)
        .margin_bottom(px(MARGIN))
        .x_label_area_size(px(BOTTOM_LABELS))
        .y_label_area_size(px(LEFT_LABELS))
        .build_cartesian_2d(x.range.clone(), y.range.clone())?;
    chart
        .configure_mesh()
        .x_desc(x.label)
        .y_desc(y.label)
        .axis_desc_style((FONT, px(AXIS_FONT)))
        .label_style((FONT, px(TICK_FONT)))
        .x_labels(x.ticks)
        .y_labels(y.ticks)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12).stroke_width(FINENESS))
        .axis_style(BLACK.stroke_width(FINENESS))
        .set_all_tick_mark_size(px(5))
        .x_label_formatter(&x.format)
        .y_label_formatter(&y.format)
        .draw()?;
    Ok(chart)
}

/// A line of words; `at` in drawn pixels, `size` in shown ones, in the middle of the line's height.
pub(crate) fn words(area: &Area<'_>, text: &str, at: [u32; 2], size: u32, anchor: HPos, colour: RGBColor) -> Drawn<()> {
    let style = (FONT, px(size)).into_text_style(area).color(&colour).pos(Pos::new(anchor, VPos::Center));
    area.draw_text(text, &style, (at[0] as i32, at[1] as i32))?;
    Ok(())
}

/// Style of a small label inside a plot, centred on its point.
pub(crate) fn label_style<'a>(colour: RGBColor) -> TextStyle<'a> {
    TextStyle {
        font: (FONT, px(13)).into_font(),
        color: colour.to_backend_color(),
        pos: Pos::new(HPos::Center, VPos::Center),
    }
}

/// How an entry of a legend is marked.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mark {
    Line,
    Dashes,
    Dot,
    Ring,
}

/// Entries for the three slots.
pub(crate) fn slot_entries(mark: Mark) -> Vec<(Mark, RGBColor, String)> {
    Slot::ALL.into_iter().map(|slot| (mark, colour(slot), slot.to_string())).collect()
}

/// A row of entries at the top of an area, above everything else.
pub(crate) fn legend(area: &Area<'_>, entries: &[(Mark, RGBColor, String)]) -> Drawn<()> {
    let (mut x, y) = (px(LEFT_LABELS + MARGIN) as i32, px(LEGEND) as i32 / 2);
    let sample = px(34) as i32;
    for (mark, colour, text) in entries {
        match mark {
            Mark::Line => {
                area.draw(&PathElement::new(vec![(x, y), (x + sample, y)], colour.stroke_width(px(3))))?;
            }
            Mark::Dashes => {
                for part in 0..3 {
                    let from = x + part * sample * 3 / 8;
                    let dash = vec![(from, y), (from + sample / 4, y)];
                    area.draw(&PathElement::new(dash, colour.stroke_width(px(2))))?;
                }
            }
            Mark::Dot => area.draw(&Circle::new((x + sample / 2, y), px(4), colour.filled()))?,
            Mark::Ring => area.draw(&Circle::new((x + sample / 2, y), px(4), colour.stroke_width(px(1))))?,
        }
        let start = x + sample + px(8) as i32;
        words(area, text, [start as u32, y as u32], AXIS_FONT, HPos::Left, INK)?;
        // Words are measured by the reader's fonts; this is room enough for the usual ones.
        x = start + (text.chars().count() as f64 * 0.56 * f64::from(px(AXIS_FONT))) as i32 + px(26) as i32;
    }
    Ok(())
}

/// Runs of a curve that lie in the same slot, each to be drawn in one colour.
pub(crate) fn runs(points: impl IntoIterator<Item = (Slot, (f64, f64))>) -> Vec<(Slot, Vec<(f64, f64)>)> {
    let mut runs: Vec<(Slot, Vec<(f64, f64)>)> = Vec::new();
    for (slot, point) in points {
        match runs.last_mut() {
            Some((last, run)) if *last == slot => run.push(point),
            _ => runs.push((slot, vec![point])),
        }
    }
    runs
}

/// Draws a full line.
pub(crate) fn line(chart: &mut Chart<'_, '_>, points: Vec<(f64, f64)>, ink: RGBColor) -> Drawn<()> {
    chart.draw_series(LineSeries::new(points, ink.stroke_width(px(3))))?;
    Ok(())
}

/// Draws a dashed line.
pub(crate) fn dashes(chart: &mut Chart<'_, '_>, points: Vec<(f64, f64)>, ink: RGBColor) -> Drawn<()> {
    chart.draw_series(DashedLineSeries::new(points, px(7), px(4), ink.stroke_width(px(2))))?;
    Ok(())
}

/// A number without trailing zeros and without a negative zero.
pub(crate) fn plain(x: &f64) -> String {
    let text = format!("{:.3}", x + 0.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// The number of which this is the decadic logarithm.
fn power(exponent: &f64) -> String {
    let value = libm::pow(10.0, *exponent);
    if value < 1e-3 { format!("1e{exponent:.0}") } else { plain(&value) }
}

/// The least range around the values, with a share of air, of which both ends are multiples of `step`.
pub(crate) fn around(values: impl Iterator<Item = f64>, share: f64, step: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    let air = share * (high - low);
    ((low - air) / step).floor() * step..((high + air) / step).ceil() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_by_their_boundaries() {
        let at = |s| slot_at([-0.023, -0.036], s);
        assert_eq!([at(0.0), at(-0.03), at(-0.036)], Slot::ALL);
    }

    #[test]
    fn numbers_on_axes() {
        assert_eq!([plain(&-1e-9), plain(&0.25), plain(&-3.0)], ["0", "0.25", "-3"]);
        assert_eq!([power(&-4.0), power(&-3.0), power(&2.0)], ["1e-4", "0.001", "100"]);
    }

    #[test]
    fn curves_fall_into_runs() {
        let points = [Slot::Tread, Slot::Tread, Slot::Flange, Slot::Tread].map(|slot| (slot, (0.0, 1.0)));
        assert_eq!(runs(points).iter().map(|(_, run)| run.len()).collect::<Vec<_>>(), [2, 1, 1]);
    }
}
