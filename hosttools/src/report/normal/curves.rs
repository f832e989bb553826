//! Force over the height and on the way from tread to flange, by the three models.

use flangeway::{Coordinates, Pose, Side};
use rayon::prelude::*;

use super::{MODELS, pose};
use crate::error::Result;
use crate::pair::Pair;
use crate::report::style::{Axis, Drawn, LEGEND, Mark, dashes, figure, legend, line, panel, panel_height, plain, px};

const PLOT: u32 = 320;
/// Yaw (rad) of the transfer and its height (m) above the rigid contact, its lateral displacements (m) and steps.
pub(super) const YAW: f64 = 5e-3;
pub(super) const DEPTH: f64 = 70e-6;
const LATERAL: [f64; 2] = [4e-3, 7.5e-3];
const STEPS: usize = 350;
/// Lateral displacements (m) and yaw (rad) of the curves over the height, which ends (m) above the rigid contact.
const PLACES: [[f64; 2]; 2] = [[0.5e-3, 0.0], [5.5e-3, 5e-3]];
/// Load (N) of a wheel that just touches.
const TOUCHING: f64 = 1.0;
const HIGHEST: f64 = 0.1e-3;
const HEIGHTS: usize = 50;

/// Points of a curve, by each model.
type Curves = [Vec<(f64, f64)>; 3];

fn forces(models: &[Pair; 3], pose: &Pose) -> [f64; 3] {
    models.each_ref().map(|pair| 1e-3 * pair.column(Side::Right, pose).total_force(pose.vertical))
}

fn curves(points: &[(f64, [f64; 3])]) -> Curves {
    std::array::from_fn(|model| points.iter().map(|(x, forces)| (*x, forces[model])).collect())
}

fn entries() -> Vec<(Mark, plotters::style::RGBColor, String)> {
    MODELS.iter().map(|&(_, name, mark, ink)| (mark, ink, name.into())).collect()
}

fn draw(area: &crate::report::style::Area<'_>, title: &str, label: &str, curves: Curves) -> Drawn<()> {
    let all = || curves.iter().flatten();
    let (first, last) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let most = all().map(|p| p.1).fold(0.0, f64::max);
    let x = Axis::new(label, first..last, 8);
    let mut chart = panel(area, title, &x, &Axis::new("normal force (kN)", 0.0..1.08 * most.max(1.0), 8))?;
    for (points, (_, _, mark, ink)) in curves.into_iter().zip(MODELS) {
        match mark {
            Mark::Dashes => dashes(&mut chart, points, ink)?,
            _ => line(&mut chart, points, ink)?,
        }
    }
    Ok(())
}

/// Force over the height above the rigid contact.
pub(super) fn over_height(models: &[Pair; 3]) -> Result<String> {
    let [hertz, ..] = models;
    figure("force over the height", LEGEND + panel_height(PLOT), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &entries())?;
        for (place, [lateral, yaw]) in below.split_evenly((1, 2)).iter().zip(PLACES) {
            let at = Coordinates { lateral, yaw, ..Coordinates::default() };
            let Some(start) = pose(hertz, &at, TOUCHING) else { continue };
            let height = |i: usize| HIGHEST * i as f64 / HEIGHTS as f64;
            let point = |i: usize| {
                let pose = Pose { vertical: start.vertical + height(i), ..start };
                (1e6 * height(i), forces(models, &pose))
            };
            let points: Vec<_> = (0..=HEIGHTS).into_par_iter().map(point).collect();
            let title = format!("u {} mm, yaw {} mrad", plain(&(1e3 * lateral)), plain(&(1e3 * yaw)));
            draw(place, &title, "height below first contact (µm)", curves(&points))?;
        }
        Ok(())
    })
}

/// Total force on the way from tread to flange.
pub(super) fn transfer(models: &[Pair; 3]) -> Result<String> {
    let [hertz, ..] = models;
    let lateral = |i: usize| LATERAL[0] + (LATERAL[1] - LATERAL[0]) * i as f64 / STEPS as f64;
    let point = |i: usize| {
        let at = Coordinates { lateral: lateral(i), yaw: YAW, ..Coordinates::default() };
        let touching = pose(hertz, &at, TOUCHING)?;
        let pose = Pose { vertical: touching.vertical + DEPTH, ..touching };
        Some((1e3 * lateral(i), forces(models, &pose)))
    };
    let points: Vec<_> = (0..=STEPS).into_par_iter().filter_map(point).collect();
    figure("total force from tread to flange", LEGEND + panel_height(PLOT), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        legend(&above, &entries())?;
        let title = format!("{} µm below first contact, yaw {} mrad", plain(&(1e6 * DEPTH)), plain(&(1e3 * YAW)));
        draw(&below, &title, "lateral displacement u of the tape-circle point (mm)", curves(&points))
    })
}
