//! Patches of chosen poses: pressures of the half-space, and Hertz's ellipses over them.

use std::f64::consts::TAU;

use flangeway::{Coordinates, Side};
use plotters::prelude::*;

use super::pose;
use crate::contact::Peak;
use crate::error::Result;
use crate::halfspace::Patch;
use crate::pair::Pair;
use crate::report::style::{Axis, INK, figure, line, panel, panel_height, plain};

/// Height of a plot (shown pixels).
const PLOT: u32 = 300;
/// Lateral displacement (m), yaw (rad) and load (N) of each panel.
const POSES: [[f64; 3]; 4] = [[0.0, 0.0, 60e3], [0.5e-3, 0.0, 60e3], [5.5e-3, 5e-3, 60e3], [6.6e-3, 20e-3, 60e3]];

/// Four panels; poses that the pair cannot take are left empty.
pub(super) fn patches([hertz, semi, half]: &[Pair; 3]) -> Result<String> {
    figure("pressure in the patch", 2 * panel_height(PLOT), |area| {
        for (place, [lateral, yaw, load]) in area.split_evenly((2, 2)).iter().zip(POSES) {
            let at = Coordinates { lateral, yaw, ..Coordinates::default() };
            let Some(pose) = pose(semi, &at, load) else { continue };
            let patches = half.column(Side::Right, &pose).patches(pose.vertical);
            let peaks = hertz.column(Side::Right, &pose).peaks(pose.vertical);
            let outlines: Vec<Vec<(f64, f64)>> =
                peaks.iter().filter(|peak| peak.share > 0.02 && peak.point.depth() > 0.0).map(ellipse).collect();
            let elements: Vec<Element> = patches.iter().flat_map(elements).collect();
            let most = elements.iter().map(|e| e.pressure).fold(0.0, f64::max);
            let corners = elements.iter().flat_map(|e| [e.from, e.to]);
            let points = || corners.clone().chain(outlines.iter().flatten().copied());
            let x = Axis::new("x along the track (mm)", around(points().map(|p| p.0)), 6);
            let s = Axis::new("arc length on the rail (mm)", around(points().map(|p| p.1)), 6);
            let title = format!(
                "u {} mm, yaw {} mrad, {} kN: up to {:.0} MPa",
                plain(&(1e3 * lateral)),
                plain(&(1e3 * yaw)),
                plain(&(1e-3 * load)),
                1e-6 * most
            );
            let mut chart = panel(place, &title, &x, &s)?;
            let shade = |p: f64| {
                let channel = |from: f64, to: f64| (from + (to - from) * p / most) as u8;
                RGBColor(channel(222.0, 0.0), channel(235.0, 68.0), channel(247.0, 136.0))
            };
            let boxes = elements.iter().map(|e| Rectangle::new([e.from, e.to], shade(e.pressure).filled()));
            chart.draw_series(boxes)?;
            for outline in outlines {
                line(&mut chart, outline, INK)?;
            }
        }
        Ok(())
    })
}

/// An element under pressure, corners in mm.
#[derive(Clone, Copy)]
struct Element {
    from: (f64, f64),
    to: (f64, f64),
    pressure: f64,
}

fn elements(patch: &Patch) -> Vec<Element> {
    let [along, across] = patch.edges;
    let corner = |column: f64, row: f64| (1e3 * along * column, 1e3 * across * row);
    let loaded = patch.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0);
    loaded
        .map(|(n, &pressure)| {
            let column = (patch.first_column + (n % patch.columns) as i64) as f64;
            let row = patch.rows[n / patch.columns].number as f64;
            Element { from: corner(column - 0.5, row - 0.5), to: corner(column + 0.5, row + 0.5), pressure }
        })
        .collect()
}

/// Hertz's ellipse of a peak, in mm.
fn ellipse(peak: &Peak) -> Vec<(f64, f64)> {
    let root = peak.point.depth().sqrt();
    let (x, s) = (peak.point.surface.position[0], peak.point.foot.t);
    let at = |i: u32| TAU * f64::from(i) / 90.0;
    let point = |i: u32| {
        let (a, b) = (peak.state.semi_axis_x * root, peak.state.semi_axis_y * root);
        (1e3 * (x + a * libm::cos(at(i))), 1e3 * (s + b * libm::sin(at(i))))
    };
    (0..=90).map(point).collect()
}

/// The range of values and a tenth to each side.
fn around(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low < high { low - 0.1 * (high - low)..high + 0.1 * (high - low) } else { -1.0..1.0 }
}
