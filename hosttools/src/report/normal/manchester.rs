//! The three models against CONTACT on the Manchester contact benchmark.

use std::f64::consts::PI;

use flangeway::{Pose, Side};
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;
use rayon::prelude::*;

use super::{MODELS, models};
use crate::contact::SlotState;
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::report::style::{
    Area, Axis, Drawn, GREY, INK, LEGEND, Mark, dashes, figure, legend, line, panel, panel_height, px, words,
};

const PLOT: u32 = 240;
/// Shown pixels of a row of the table.
const ROW: u32 = 22;
const FONT: u32 = 14;
/// Places of the table's columns (shown pixels from its left edge) and their heads.
const COLUMNS: [(u32, &str); 8] = [
    (60, "y (mm)"),
    (130, "(kN)"),
    (215, "Hertz"),
    (295, "semi-Hertz."),
    (380, "half-space"),
    (450, "(mm²)"),
    (520, "semi-Hertz."),
    (600, "half-space"),
];
/// Ranges (%) of the plots of force and area.
const FORCE: f64 = 8.0;
const AREA: f64 = 40.0;

/// One wheel at one pose: what CONTACT prints, and how far each model is off (%).
struct Row {
    side: Side,
    lateral: f64,
    force: f64,
    area: f64,
    forces_off: [f64; 3],
    areas_off: [f64; 3],
}

/// The benchmark's rows, in the pose's printed coordinates.
fn rows() -> Result<Vec<Row>> {
    let text = flangeway_tables::S1002_60E1_40.replace("youngs_modulus_pa = 2.1e11", "youngs_modulus_pa = 2.0992e11");
    let pair = Pair::build(&Recipe::parse(&text, "manchester.toml".as_ref())?)?;
    let models = models(&pair);
    let lines: Vec<&str> = include_str!("manchester.csv").lines().filter(|l| !l.starts_with('#')).skip(1).collect();
    lines.par_iter().map(|text| row(&models, text)).collect()
}

fn row(models: &[Pair; 3], text: &str) -> Result<Row> {
    let side = if text.starts_with("left") { Side::Left } else { Side::Right };
    let numbers: Vec<f64> = text.split(',').skip(2).filter_map(|field| field.parse().ok()).collect();
    let &[y, yaw, roll, z, force, approach, area] = numbers.as_slice() else {
        return Err(Error::field("manchester.csv", text, "seven numbers are expected"));
    };
    let pose = Pose { lateral: 1e-3 * y, yaw, vertical: 1e-3 * z, roll }.canonical(side).pose;
    let mut column = models[0].column(side, &pose);
    // The height at which the greatest overlap is the printed approach: z is printed too coarsely.
    let mut vertical = pose.vertical;
    for _ in 0..8 {
        if let Some(deepest) = column.deepest(vertical) {
            vertical += (1e-3 * approach - deepest.depth()) / deepest.foot.tangent[0];
        }
    }
    let found = models.each_ref().map(|pair| {
        let slots = pair.column(side, &pose).slots(vertical);
        let carrying = || slots.iter().filter(|slot| slot.normal_force() > 0.0);
        let ellipse = |slot: &SlotState| PI * slot.semi_axis_x * slot.semi_axis_y * slot.indentation;
        [carrying().map(SlotState::normal_force).sum::<f64>(), 1e6 * carrying().map(ellipse).sum::<f64>()]
    });
    let off = |part: usize, truth: f64| found.map(|found| 1e2 * (found[part] / truth - 1.0));
    let (forces_off, areas_off) = (off(0, force), off(1, area));
    Ok(Row { side, lateral: y, force, area, forces_off, areas_off })
}

/// The figure and the words below it.
pub(super) fn manchester() -> Result<(String, String)> {
    let rows = rows()?;
    let entries: Vec<(Mark, RGBColor, String)> =
        MODELS.iter().map(|&(_, name, mark, ink)| (mark, ink, name.into())).collect();
    let sides = [Side::Left, Side::Right].map(|side| rows.iter().filter(|row| row.side == side).collect::<Vec<_>>());
    let table = ROW * (sides[0].len() as u32 + 3);
    let svg = figure("force and area against CONTACT", LEGEND + 2 * panel_height(PLOT) + table, |area| {
        let (above, rest) = area.split_vertically(px(LEGEND));
        legend(&above, &entries)?;
        let (plots, below) = rest.split_vertically(px(2 * panel_height(PLOT)));
        let places = plots.split_evenly((2, 2));
        for (n, (place, rows)) in places.iter().zip(sides.iter().cycle()).enumerate() {
            draw(place, ["left wheel", "right wheel"][n % 2], n < 2, rows)?;
        }
        for (n, (place, rows)) in below.split_evenly((1, 2)).iter().zip(&sides).enumerate() {
            list(place, ["Left wheel", "Right wheel"][n], rows)?;
        }
        Ok(())
    })?;
    let largest = |model: usize| rows.iter().map(|row| row.forces_off[model].abs()).fold(0.0, f64::max);
    let caption = format!(
        "S1002 on 60E1 1:40 (this table's pair or not), case A-2.2 of the Manchester contact benchmark: 20 kN an axle, \
         lateral displacement y of the wheelset and yaw growing together to 10 mm and 24 mrad. CONTACT's full solution, as \
         printed with it, against the models at its printed approach; area of the ellipses (sum of π a b). Largest \
         difference of the force: Hertz {:.1} %, semi-Hertzian {:.1} %, half-space {:.1} %.",
        largest(0),
        largest(1),
        largest(2)
    );
    Ok((svg, caption))
}

/// One wheel's force or area against CONTACT's.
fn draw(place: &Area<'_>, wheel: &str, forces: bool, rows: &[&Row]) -> Drawn<()> {
    let (what, reach) = if forces { ("normal force", FORCE) } else { ("area", AREA) };
    let x = Axis::new("lateral displacement y of the wheelset (mm)", 0.0..10.0, 10);
    let label = format!("{what} / CONTACT - 1 (%)");
    let mut chart = panel(place, &format!("{what}, {wheel}"), &x, &Axis::new(&label, -reach..reach, 8))?;
    line(&mut chart, vec![(0.0, 0.0), (10.0, 0.0)], RGBColor(210, 210, 210))?;
    for (model, (_, _, mark, ink)) in MODELS.into_iter().enumerate() {
        let off = |row: &&Row| (row.lateral, if forces { row.forces_off[model] } else { row.areas_off[model] });
        let points = rows.iter().map(off).map(|(y, off)| (y, off.clamp(-reach, reach))).collect();
        match mark {
            Mark::Dashes => dashes(&mut chart, points, ink)?,
            _ => line(&mut chart, points, ink)?,
        }
    }
    Ok(())
}

/// The numbers behind one wheel's plots.
fn list(place: &Area<'_>, wheel: &str, rows: &[&Row]) -> Drawn<()> {
    let write = |row: usize, x: u32, text: &str, ink| {
        words(place, text, [px(x), px(ROW) * row as u32 + px(ROW) / 2], FONT, HPos::Right, ink)
    };
    write(0, 130, wheel, INK)?;
    write(0, 380, "force by CONTACT, others less it (%)", INK)?;
    write(0, 600, "area, others less it (%)", INK)?;
    for (x, head) in COLUMNS {
        write(1, x, head, GREY)?;
    }
    for (n, row) in rows.iter().enumerate() {
        let [hertz, semi, half] = row.forces_off;
        let [_, area_semi, area_half] = row.areas_off;
        let numbers = [row.lateral, 1e-3 * row.force, hertz, semi, half, row.area, area_semi, area_half];
        for (column, ((x, _), number)) in COLUMNS.into_iter().zip(numbers).enumerate() {
            let text = match column {
                0 => format!("{number:.0}"),
                1 | 5 => format!("{number:.2}"),
                // No negative zero.
                _ => format!("{:+.1}", (10.0 * number).round() / 10.0 + 0.0),
            };
            write(n + 2, x, &text, INK)?;
        }
    }
    Ok(())
}
