//! Wheel on rail, to scale: at rest in chosen places, and the pairs of points that touch as the wheelset moves.

use std::ops::Range;

use flangeway::{Side, Slot};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{
    Area, Axis, Chart, Drawn, GREY, INK, LEGEND, MARGIN, Mark, RAIL, WHEEL, WIDTH, colour, figure, label_style, legend,
    panel, panel_height, plot_width, px, slot_entries, words,
};
use super::sweep::{Step, jumps};
use crate::contact::{Orientation, RidgePoint};
use crate::error::Result;
use crate::pair::Pair;

/// What is shown around the tape circle (mm): y, and z below and above the rail's crown for the figures of places.
const ACROSS: Range<f64> = -72.0..44.0;
const DEPTH: Range<f64> = -16.0..29.0;
/// The same for the pairs, where the wheel is drawn raised (mm) over the rail.
const PAIRS_ACROSS: Range<f64> = -62.0..40.0;
const PAIRS_DEPTH: Range<f64> = -30.0..21.0;
const RAISED: f64 = 20.0;
/// Lateral positions (half millimetres) whose pairs are drawn.
const PAIRS: std::ops::RangeInclusive<i32> = -14..=14;
const LATERAL: &str = "y from the tape circle (mm)";
const DOWN: &str = "z (mm), down";

/// The right wheel on its rail at rest in the centre, and where its contact changes from one slot to the next.
pub(super) fn places(pair: &Pair, steps: &[Step]) -> Result<String> {
    let centre = Step::at(pair, 0.0, 0.0);
    let jumps = jumps(pair, steps).into_iter().filter(|[before, _]| before.lateral > 0.0);
    let shown: Vec<Vec<Step>> = centre.into_iter().map(|step| vec![step]).chain(jumps.map(Vec::from)).collect();
    let shown: Vec<_> = shown.into_iter().take(3).collect();
    let columns = shown.len().max(1) as u32;
    let height = LEGEND + panel_height(to_scale(WIDTH / columns, &ACROSS, &DEPTH));
    figure("wheel on rail in three places", height, |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &slot_entries(Mark::Dot))?;
        for (area, steps) in below.split_evenly((1, columns as usize)).iter().zip(&shown) {
            place(area, pair, steps)?;
        }
        Ok(())
    })
}

/// Height of a plot (shown pixels) that is to scale with its width.
fn to_scale(panel: u32, across: &Range<f64>, depth: &Range<f64>) -> u32 {
    let pixels = f64::from(plot_width(panel)) / (across.end - across.start);
    (pixels * (depth.end - depth.start)).round() as u32
}

fn place(area: &Area<'_>, pair: &Pair, steps: &[Step]) -> Drawn<()> {
    let Some(step) = steps.first() else { return Ok(()) };
    let title = format!("y = {:.2} mm, roll {:.2} mrad", 1e3 * step.lateral, 1e3 * step.rigid.roll);
    let x = Axis::new(LATERAL, ACROSS, 7);
    let mut chart = panel(area, &title, &x, &Axis::new(DOWN, DEPTH.end..DEPTH.start, 6))?;
    rail(&mut chart, pair, &ACROSS, DEPTH.end)?;
    wheel(&mut chart, pair, step, 0.0, &ACROSS, DEPTH.start)?;
    for step in steps {
        let (at, slot) = (rail_point(pair, step.point(Side::Right)), step.slot(pair, Side::Right));
        chart.draw_series([
            Circle::new(at, px(6), WHITE.filled()),
            Circle::new(at, px(5), colour(slot).filled()),
            Circle::new(at, px(6), INK.stroke_width(px(1))),
        ])?;
    }
    Ok(())
}

/// Pairs of points that touch, yaw 0: the wheel in the centre and raised over the rail, a line from each point of the
/// wheel to the point of the rail that it touches.
pub(super) fn pairs(pair: &Pair) -> Result<String> {
    let height = LEGEND + panel_height(to_scale(WIDTH, &PAIRS_ACROSS, &PAIRS_DEPTH));
    figure("pairs of contact points", height, |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &slot_entries(Mark::Line))?;
        let x = Axis::new(LATERAL, PAIRS_ACROSS, 12);
        let title = "Points of the right wheel and rail that touch, by the lateral position of the wheelset (mm)";
        let mut chart = panel(&below, title, &x, &Axis::new(DOWN, PAIRS_DEPTH.end..PAIRS_DEPTH.start, 8))?;
        rail(&mut chart, pair, &PAIRS_ACROSS, PAIRS_DEPTH.end)?;
        let Some(rest) = Step::at(pair, 0.0, 0.0) else { return Ok(()) };
        wheel(&mut chart, pair, &rest, RAISED, &PAIRS_ACROSS, PAIRS_DEPTH.start)?;
        let mut labelled = Labels::default();
        for half in PAIRS {
            let Some(step) = Step::at(pair, 0.5e-3 * f64::from(half), 0.0) else { continue };
            let point = step.point(Side::Right);
            let (from, to) = (wheel_point(pair, &rest, point.wheel.t, RAISED), rail_point(pair, point));
            pair_line(&mut chart, half, [from, to], step.slot(pair, Side::Right), &mut labelled)?;
        }
        let [x, y] = [px(WIDTH - 2 * MARGIN), px(26 + super::style::TITLE)];
        words(&below, &format!("wheel, raised by {RAISED} mm"), [x, y], 14, HPos::Right, GREY)
    })
}

/// Two rows of labels above the wheel's contour, the upper one for labels too close to the last in the lower.
#[derive(Default)]
struct Labels {
    lower: Option<f64>,
}

impl Labels {
    /// Room (mm) that a label takes, and the rows' heights above the contour.
    const ROOM: f64 = 1.9;
    const ROWS: [f64; 2] = [1.5, 3.1];

    fn height(&mut self, y: f64) -> f64 {
        if self.lower.is_some_and(|last| (y - last).abs() < Self::ROOM) {
            return Self::ROWS[1];
        }
        self.lower = Some(y);
        Self::ROWS[0]
    }
}

/// One pair; whole millimetres are labelled.
fn pair_line(
    chart: &mut Chart<'_, '_>,
    half: i32,
    ends: [(f64, f64); 2],
    slot: Slot,
    labels: &mut Labels,
) -> Drawn<()> {
    let whole = half % 2 == 0;
    let ink = colour(slot);
    let width = if whole { px(2) } else { px(1) };
    chart.draw_series([PathElement::new(ends.to_vec(), ink.stroke_width(width))])?;
    chart.draw_series(ends.map(|end| Circle::new(end, px(3), ink.filled())))?;
    if whole {
        let (y, z) = ends[0];
        let place = (y, z - labels.height(y));
        chart.draw_series([Text::new((half / 2).to_string(), place, label_style(INK))])?;
    }
    Ok(())
}

/// y (mm) from the tape circle's nominal place and z (mm) of a point in the track frame (m).
fn shown(pair: &Pair, [y, z]: [f64; 2]) -> (f64, f64) {
    (1e3 * (y - pair.body(Side::Right).wheel().geometry().lateral_position), 1e3 * z)
}

/// A point of the right wheel's section through the axle, raised by some millimetres.
fn wheel_point(pair: &Pair, step: &Step, t: f64, raised: f64) -> (f64, f64) {
    let wheel = pair.body(Side::Right).wheel();
    let centre = step.rigid.vertical - wheel.geometry().nominal_radius;
    let section = Orientation::new(0.0, step.rigid.roll).section(&wheel.at(t), 0.0);
    let [_, y, z] = section.map_or([f64::NAN; 3], |surface| surface.position);
    let (y, z) = shown(pair, [y + step.lateral, z + centre]);
    (y, z - raised)
}

/// The rail's point of a contact.
fn rail_point(pair: &Pair, point: &RidgePoint) -> (f64, f64) {
    let foot = pair.body(Side::Right).rail().curve().at(point.foot.t);
    shown(pair, [foot.y, foot.z])
}

fn rail(chart: &mut Chart<'_, '_>, pair: &Pair, across: &Range<f64>, bottom: f64) -> Drawn<()> {
    let curve = pair.body(Side::Right).rail().curve();
    let points = parameters(curve.length()).map(|t| curve.at(t)).map(|p| shown(pair, [p.y, p.z]));
    outline(chart, points.filter(|(y, z)| across.contains(y) && *z < bottom).collect(), bottom, RAIL)
}

fn wheel(chart: &mut Chart<'_, '_>, pair: &Pair, step: &Step, raised: f64, across: &Range<f64>, top: f64) -> Drawn<()> {
    let length = pair.body(Side::Right).wheel().curve().length();
    let points = parameters(length).map(|t| wheel_point(pair, step, t, raised));
    outline(chart, points.filter(|(y, z)| across.contains(y) && *z > top).collect(), top, WHEEL)
}

/// A body between its contour and a level (mm).
fn outline(chart: &mut Chart<'_, '_>, contour: Vec<(f64, f64)>, level: f64, fill: RGBColor) -> Drawn<()> {
    let (Some(first), Some(last)) = (contour.first(), contour.last()) else { return Ok(()) };
    let closed: Vec<_> = contour.iter().copied().chain([(last.0, level), (first.0, level)]).collect();
    chart.draw_series([Polygon::new(closed, fill.filled())])?;
    chart.draw_series(LineSeries::new(contour, INK.stroke_width(px(1))))?;
    Ok(())
}

/// Parameters (m) every tenth of a millimetre along a contour.
fn parameters(length: f64) -> impl Iterator<Item = f64> {
    let steps = (length / 1e-4).ceil() as usize;
    (0..=steps).map(move |i| length * i as f64 / steps as f64)
}
