//! The drawing of a profile: shape, slope angle and curvature over one lateral axis.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::curve::{Curve, CurvePoint};
use crate::error::{Error, Result};
use crate::profile::Profile;

/// The library draws on whole pixels: drawn this many times larger and shown smaller, lines are smooth.
const FINENESS: u32 = 4;
/// Width of the drawing as it is shown (pixels); all below is in drawn pixels.
const SHOWN_WIDTH: u32 = 1200;
const WIDTH: u32 = FINENESS * SHOWN_WIDTH;
const MARGIN: u32 = FINENESS * 20;
const LEFT_LABELS: u32 = FINENESS * 80;
const BOTTOM_LABELS: u32 = FINENESS * 50;
const CAPTION: u32 = FINENESS * 20;
/// Above a caption, and between it and its plot.
const GAP: u32 = FINENESS * 10;
const AXIS: u32 = FINENESS * 16;
const TICK: u32 = FINENESS * 15;
/// Height of the slope's and of the curvature's panel.
const GRAPH: u32 = FINENESS * 330;
/// Room above and below a panel's plot.
const AROUND: u32 = MARGIN + BOTTOM_LABELS + 2 * GAP + 3 * CAPTION / 2;
/// Least and greatest height of the shape's plot.
const SHAPE: Range<f64> = 480.0..3600.0;

const LATERAL: &str = "y (mm), flange or gauge side at the left, field side at the right";
const LINE: RGBColor = RGBColor(0, 60, 130);
const POINT: RGBColor = RGBColor(120, 120, 120);
const JOINT: RGBColor = RGBColor(200, 40, 30);

/// Draws a profile and its curve as SVG.
///
/// # Errors
/// When the drawing library fails.
pub(super) fn draw(profile: &Profile, curve: &Curve) -> Result<String> {
    let mut svg = String::new();
    let height =
        render(&mut svg, profile, curve).map_err(|e| Error::file(&profile.name, format!("cannot be drawn: {e}")))?;
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\" viewBox");
    let shown = format!("width=\"{SHOWN_WIDTH}\" height=\"{}\" viewBox", height / FINENESS);
    Ok(svg.replacen(&drawn, &shown, 1))
}

/// What the drawing library may fail with.
type Drawn<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Draws and returns the height in drawn pixels.
fn render(svg: &mut String, profile: &Profile, curve: &Curve) -> Drawn<u32> {
    let samples = samples(curve);
    let mm = |x: f64| 1e3 * x;
    let y = padded(samples.iter().map(|p| mm(p.y)), 0.03);
    let mut z = padded(samples.iter().map(|p| mm(p.z)), 0.08);
    // to scale: as many pixels a millimetre down as across
    let plot_width = f64::from(WIDTH - LEFT_LABELS - 2 * MARGIN);
    let pixels = plot_width / (y.end - y.start);
    let height = ((z.end - z.start) * pixels).clamp(SHAPE.start, SHAPE.end);
    let spare = 0.5 * (height / pixels - (z.end - z.start));
    z = z.start - spare..z.end + spare;
    let shape_height = height.round() as u32 + AROUND;

    let total_height = shape_height + 2 * GRAPH;
    let root = SVGBackend::with_string(svg, (WIDTH, total_height)).into_drawing_area();
    root.fill(&WHITE)?;
    let (shape, graphs) = root.split_vertically(shape_height);
    let (slope, curvature) = graphs.split_vertically(GRAPH);
    let joints: Vec<CurvePoint> = curve.joints().iter().map(|&t| curve.at(t)).collect();

    let title = format!("{}, {} profile", profile.name, profile.kind);
    let mut chart = panel(&shape, &title, y.clone(), z.end..z.start, "z (mm), down")?;
    chart.draw_series(profile.points.iter().map(|p| Circle::new((mm(p[0]), mm(p[1])), FINENESS, POINT.filled())))?;
    chart.draw_series(LineSeries::new(samples.iter().map(|p| (mm(p.y), mm(p.z))), LINE.stroke_width(2 * FINENESS)))?;
    chart.draw_series(
        joints.iter().map(|p| Circle::new((mm(p.y), mm(p.z)), 5 * FINENESS, JOINT.stroke_width(2 * FINENESS))),
    )?;

    let angle = |p: &CurvePoint| libm::atan2(p.tangent[1], p.tangent[0]).to_degrees();
    let range = padded(samples.iter().map(angle), 0.06);
    let mut chart = panel(&slope, "Slope angle, arctan(dz/dy)", y.clone(), range.clone(), "angle (deg)")?;
    chart.draw_series(joints.iter().map(|p| marker(mm(p.y), &range)))?;
    chart.draw_series(LineSeries::new(samples.iter().map(|p| (mm(p.y), angle(p))), LINE.stroke_width(2 * FINENESS)))?;

    let (range, clipped) = curvature_range(&samples);
    let remark = if clipped { ", the extremes clipped" } else { "" };
    let title = format!("Curvature, positive where convex{remark}");
    let mut chart = panel(&curvature, &title, y, range.clone(), "curvature (1/m)")?;
    chart.draw_series(joints.iter().map(|p| marker(mm(p.y), &range)))?;
    let held = |p: &CurvePoint| p.curvature.clamp(range.start, range.end);
    chart.draw_series(LineSeries::new(samples.iter().map(|p| (mm(p.y), held(p))), LINE.stroke_width(2 * FINENESS)))?;
    root.present()?;
    Ok(total_height)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A panel with axes; every panel has the same room at its left, so that equal y stand below each other.
fn panel<'a, 'b>(area: &'a Area<'b>, title: &str, y: Range<f64>, up: Range<f64>, label: &str) -> Drawn<Chart<'a, 'b>>
where
    'b: 'a,
{
    let below = area.margin(GAP, 0, 0, 0).titled(title, ("sans-serif", CAPTION))?;
    let mut chart = ChartBuilder::on(&below)
        .margin(MARGIN)
        .margin_top(GAP)
        .x_label_area_size(BOTTOM_LABELS)
        .y_label_area_size(LEFT_LABELS)
        .build_cartesian_2d(y, up)?;
    chart
        .configure_mesh()
        .x_desc(LATERAL)
        .y_desc(label)
        .axis_desc_style(("sans-serif", AXIS))
        .label_style(("sans-serif", TICK))
        .x_labels(14)
        .y_labels(8)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12).stroke_width(FINENESS))
        .axis_style(BLACK.stroke_width(FINENESS))
        .set_all_tick_mark_size(FINENESS * 5)
        .x_label_formatter(&plain)
        .y_label_formatter(&plain)
        .draw()?;
    Ok(chart)
}

/// A number without trailing zeros and without a negative zero.
fn plain(x: &f64) -> String {
    let text = format!("{:.3}", x + 0.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// A joint in a graph.
fn marker(y: f64, range: &Range<f64>) -> PathElement<(f64, f64)> {
    PathElement::new(vec![(y, range.start), (y, range.end)], JOINT.mix(0.35).stroke_width(FINENESS))
}

/// The curve every 20 micrometres, but between 2000 and 20000 points, and on both sides of every joint.
fn samples(curve: &Curve) -> Vec<CurvePoint> {
    let count = ((curve.length() / 20e-6).ceil() as usize).clamp(2_000, 20_000);
    let mut parameters: Vec<f64> = (0..=count).map(|i| curve.length() * i as f64 / count as f64).collect();
    let beside = 1e-6 * curve.length() / count as f64;
    parameters.extend(curve.joints().iter().flat_map(|t| [t - beside, *t]));
    parameters.sort_by(f64::total_cmp);
    parameters.into_iter().map(|t| curve.at(t)).collect()
}

/// The values' range with some air around it.
fn padded(values: impl Iterator<Item = f64>, share: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    let air = (share * (high - low)).max(0.5);
    low - air..high + air
}

/// A range that shows the curvature of all but the most extreme parts, and whether those are cut off.
fn curvature_range(samples: &[CurvePoint]) -> (Range<f64>, bool) {
    let mut sorted: Vec<f64> = samples.iter().map(|p| p.curvature).collect();
    sorted.sort_by(f64::total_cmp);
    let all = sorted[0]..sorted[sorted.len() - 1];
    let cut = sorted.len() / 50;
    let most = sorted[cut]..sorted[sorted.len() - 1 - cut];
    let beyond = 0.5 * (most.end - most.start);
    let shown = [all.start.max(most.start - beyond), all.end.min(most.end + beyond)];
    let range = padded(shown.into_iter(), 0.06);
    let clipped = all.start < range.start || all.end > range.end;
    (range, clipped)
}
