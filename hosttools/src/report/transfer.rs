//! The load of one wheel on its way from tread to flange: each slot's force by the table and by the direct solver.

use flangeway::{ContactTable, Coordinates, Side, Slot};
use plotters::prelude::*;
use rayon::prelude::*;

use super::style::{
    Axis, Chart, Drawn, GREY, INK, LEGEND, Mark, colour, dashes, figure, legend, line, panel, panel_height, plain, px,
    slot_entries,
};
use crate::contact::SLOTS;
use crate::error::Result;
use crate::pair::Pair;
use crate::verify::height_for_load;

/// Height of the plot (shown pixels).
const PLOT: u32 = 380;
/// Lateral displacements (m) of the wheel's tape-circle point, steps between them for the lines, and lines a dot.
const LATERAL: [f64; 2] = [4e-3, 7.5e-3];
const STEPS: usize = 700;
const DOT: usize = 5;
/// Yaw (rad) and load (N).
pub(super) const YAW: f64 = 5e-3;
pub(super) const LOAD: f64 = 60e3;

/// Forces (N) of the right wheel's slots at one place.
struct Place {
    /// Displacement of the tape-circle point (m).
    displacement: f64,
    direct: [f64; SLOTS],
    table: [f64; SLOTS],
}

/// At the rigid roll, and at the height at which the direct solver carries the load.
fn place(pair: &Pair, table: &ContactTable<'_>, displacement: f64) -> Option<Place> {
    let coordinates = Coordinates { lateral: displacement, yaw: YAW, ..Coordinates::default() };
    let geometry = pair.body(Side::Right).wheel().geometry();
    let mut pose = table.rigid(Side::Right).pose(geometry, &coordinates);
    let mut column = pair.column(Side::Right, &pose);
    pose.vertical = height_for_load(&mut column, LOAD)?;
    let direct = column.slots(pose.vertical).map(|state| state.normal_force());
    let mut by_table = [0.0; SLOTS];
    for contact in &table.contacts(Side::Right, &pose) {
        by_table[contact.slot.index()] = f64::from(contact.normal_force);
    }
    Some(Place { displacement, direct, table: by_table })
}

/// Forces of the slots over the displacement of the tape-circle point.
pub(super) fn transfer(pair: &Pair, table: &ContactTable<'_>) -> Result<String> {
    let at = |i: usize| LATERAL[0] + (LATERAL[1] - LATERAL[0]) * i as f64 / STEPS as f64;
    let places: Vec<Place> = (0..=STEPS).into_par_iter().filter_map(|i| place(pair, table, at(i))).collect();
    figure("forces from tread to flange", LEGEND + panel_height(PLOT), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        let mut entries = slot_entries(Mark::Line);
        entries.push((Mark::Line, INK, "total (lines: table)".into()));
        entries.push((Mark::Dot, GREY, "dots: direct solver".into()));
        entries.push((Mark::Dashes, GREY, "its total".into()));
        legend(&above, &entries)?;
        let title = format!("{} kN on the right wheel, yaw {} mrad", plain(&(1e-3 * LOAD)), plain(&(1e3 * YAW)));
        let x = Axis::new("lateral displacement u of the tape-circle point (mm)", mm(LATERAL), 15);
        let most = places.iter().map(|p| p.table.iter().sum::<f64>()).fold(LOAD, f64::max);
        let y = Axis::new("normal force (kN)", 0.0..1e-3 * 1.08 * most, 8);
        let mut chart = panel(&below, &title, &x, &y)?;
        let level = 1e-3 * LOAD;
        dashes(&mut chart, vec![(1e3 * LATERAL[0], level), (1e3 * LATERAL[1], level)], GREY)?;
        let total = places.iter().map(|p| (1e3 * p.displacement, 1e-3 * p.table.iter().sum::<f64>()));
        line(&mut chart, total.collect(), INK)?;
        for slot in Slot::ALL {
            let force = |forces: &[f64; SLOTS]| forces[slot.index()];
            curve(&mut chart, &places, colour(slot), force)?;
        }
        Ok(())
    })
}

fn mm([from, to]: [f64; 2]) -> std::ops::Range<f64> {
    1e3 * from..1e3 * to
}

/// A force by the table as a line, by the direct solver as dots.
fn curve(
    chart: &mut Chart<'_, '_>,
    places: &[Place],
    ink: RGBColor,
    force: impl Fn(&[f64; SLOTS]) -> f64,
) -> Drawn<()> {
    let point = |p: &Place, forces: &[f64; SLOTS]| (1e3 * p.displacement, 1e-3 * force(forces));
    line(chart, places.iter().map(|p| point(p, &p.table)).collect(), ink)?;
    let loaded = |p: &&Place| force(&p.direct) + force(&p.table) > 0.0;
    let dots = places.iter().step_by(DOT).filter(loaded);
    let dots = dots.map(|p| Circle::new(point(p, &p.direct), px(3), ink.filled()));
    chart.draw_series(dots)?;
    Ok(())
}
