//! Difference of the rolling radii over the lateral position, rigid.

use plotters::prelude::*;

use super::style::{
    Area, Axis, Drawn, GREY, INK, LEGEND, Mark, around, dashes, figure, label_style, legend, line, panel, panel_height,
    px,
};
use super::sweep::Step;
use crate::error::Result;
use crate::pair::Pair;

/// Height of a plot (shown pixels), and the half width (mm) of the tread's own panel.
const PLOT: u32 = 300;
const TREAD: f64 = 5.0;
/// Amplitude (m) at which the secant is drawn.
pub(super) const AMPLITUDE: f64 = 3e-3;

/// Ink of the secant: none of the slots'.
const SECANT: RGBColor = RGBColor(17, 119, 51);

/// r_right - r_left (mm).
fn difference(step: &Step) -> f64 {
    1e3 * (step.rigid.right.wheel.radius - step.rigid.left.wheel.radius)
}

/// The secant (r_right - r_left) / 2y at an amplitude: the conicity of a coned wheelset with this difference there.
pub(super) fn secant(pair: &Pair) -> Option<f64> {
    Step::at(pair, AMPLITUDE, 0.0).map(|step| difference(&step) / (2e3 * AMPLITUDE))
}

/// The whole range, and the tread alone with the secant; yaw 0 in full, another yaw (rad) dashed.
pub(super) fn rolling(straight: &[Step], yawed: &[Step], yaw: f64, secant: Option<f64>) -> Result<String> {
    figure("rolling radius difference over the lateral position", LEGEND + panel_height(PLOT), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        let entries =
            [(Mark::Line, INK, "yaw 0".to_string()), (Mark::Dashes, GREY, format!("dashed: yaw {} mrad", 1e3 * yaw))];
        legend(&above, &entries)?;
        let areas = below.split_evenly((1, 2));
        let [whole, tread] = areas.as_slice() else { return Ok(()) };
        half(whole, "whole range", [straight, yawed], None)?;
        let near = |steps: &[Step]| -> Vec<Step> {
            steps.iter().filter(|step| step.lateral.abs() <= 1e-3 * TREAD + 1e-9).copied().collect()
        };
        half(tread, "around the centre", [&near(straight), &near(yawed)], secant)
    })
}

fn half(area: &Area<'_>, title: &str, [straight, yawed]: [&[Step]; 2], secant: Option<f64>) -> Drawn<()> {
    let (Some(first), Some(last)) = (straight.first(), straight.last()) else { return Ok(()) };
    let values = around(straight.iter().chain(yawed).map(difference), 0.03, 0.5);
    let x = Axis::new("lateral position of the wheelset y (mm)", 1e3 * first.lateral..1e3 * last.lateral, 9);
    let title = format!("rolling radius, right minus left: {title}");
    let mut chart = panel(area, &title, &x, &Axis::new("difference (mm)", values, 8))?;
    let points = |steps: &[Step]| steps.iter().map(|step| (1e3 * step.lateral, difference(step))).collect::<Vec<_>>();
    line(&mut chart, points(straight), INK)?;
    dashes(&mut chart, points(yawed), GREY)?;
    if let Some(secant) = secant {
        let y = 1e3 * AMPLITUDE;
        let end = (y, 2.0 * secant * y);
        let (from, to) = ((-end.0, -end.1), end);
        chart.draw_series([PathElement::new(vec![from, to], SECANT.stroke_width(px(1)))])?;
        chart.draw_series([from, to].map(|p| Circle::new(p, px(4), SECANT.filled())))?;
        let text = format!("secant at {y} mm: {secant:.3}");
        chart.draw_series([Text::new(text, (0.5 * y - 2.9, 0.62 * end.1), label_style(SECANT))])?;
    }
    Ok(())
}
