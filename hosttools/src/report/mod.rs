//! The report of a table: what it was made of, how good it is, and what the contact looks like. One page, one file.

pub mod campaign;
mod errors;
mod heat;
mod normal;
pub(crate) mod page;
pub(crate) mod plot;
mod positions;
mod profiles;
pub mod rig;
mod rolling;
pub(crate) mod style;
mod sweep;
mod transfer;
pub(crate) mod vehicle;
pub mod verify;

use flangeway::ContactTable;

use crate::error::Result;
use crate::pair::Pair;
use crate::progress;
use crate::recipe::Recipe;
use crate::verify::{Report, Sample};

/// Lateral positions (m) of the rigid figures, and steps over them.
const LATERAL: [f64; 2] = [-8e-3, 8e-3];
const STEPS: usize = 641;
/// The other yaw (rad) that the rigid figures show.
const YAW: f64 = 20e-3;

/// What a report is made from.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The recipe.
    pub recipe: &'a Recipe,
    /// Its wheels on its rails.
    pub pair: &'a Pair,
    /// The table compiled from it.
    pub table: &'a ContactTable<'a>,
    /// Name of the table's file.
    pub table_name: &'a str,
    /// Size of the table (bytes).
    pub bytes: usize,
    /// Time that compiling took (s).
    pub seconds: f64,
    /// The table's error figures.
    pub report: &'a Report,
    /// The samples behind them.
    pub samples: &'a [Sample],
}

/// A figure and the words below it.
struct Figure {
    title: &'static str,
    svg: String,
    caption: String,
}

/// Draws all figures and puts them on a page of HTML that needs nothing but itself.
///
/// # Errors
/// When the drawing library fails.
pub fn html(content: &Content<'_>) -> Result<String> {
    Ok(page::page(content, &figures(content)?))
}

fn figures(content: &Content<'_>) -> Result<Vec<Figure>> {
    let Content { pair, table, samples, report, .. } = *content;
    let bar = progress::bar(7, "drawing");
    let done = |figure: Figure| {
        bar.inc(1);
        figure
    };
    let straight = sweep::sweep(pair, LATERAL, 0.0, STEPS);
    let yawed = sweep::sweep(pair, LATERAL, YAW, STEPS);
    let secant = rolling::secant(pair);
    let figures = vec![
        done(Figure {
            title: "Wheel on rail",
            svg: profiles::places(pair, &straight)?,
            caption: "The right wheel on its rail in rigid contact at yaw 0, to scale: in the centre, and where the \
                      contact moves from one slot to the next, so that the wheel touches in two places. A slot is a \
                      region of the wheel's profile; the table keeps one contact for each."
                .into(),
        }),
        done(Figure {
            title: "Pairs of contact points",
            svg: profiles::pairs(pair)?,
            caption: "Lines join the points of wheel and rail that touch in rigid contact, every half millimetre of \
                      the wheelset's lateral position (numbers at whole millimetres), at yaw 0. Where neighbouring \
                      lines are far apart, the contact jumps."
                .into(),
        }),
        done(Figure {
            title: "Contact over the lateral position",
            svg: positions::positions(pair, &straight, &yawed, YAW)?,
            caption: format!(
                "Rigid contact of both wheels. On the wheel, s is measured from the tape circle outwards; on the rail, \
                 from the place over which the tape circle stands when the wheelset is in the centre, outwards too. \
                 The angle is the slope dz/dy of the common tangent in the track frame. Full lines: yaw 0; dashed \
                 lines: yaw {} mrad.",
                1e3 * YAW
            ),
        }),
        done(Figure {
            title: "Rolling radius difference",
            svg: rolling::rolling(&straight, &yawed, YAW, secant)?,
            caption: match secant {
                Some(secant) => format!(
                    "What steers the wheelset: the difference of the rolling radii in rigid contact. At an amplitude \
                     of {} mm its secant, (right minus left) / 2y, is {secant:.3}: the conicity of a coned wheelset \
                     with the same difference there, which is not the equivalent conicity of EN 15302.",
                    1e3 * rolling::AMPLITUDE
                ),
                None => "What steers the wheelset: the difference of the rolling radii in rigid contact.".into(),
            },
        }),
        done(Figure {
            title: "From tread to flange",
            svg: transfer::transfer(pair, table)?,
            caption: format!(
                "The right wheel under a constant total normal force of {} kN at yaw {} mrad, moved sideways with the \
                 roll of the rigid contact: each slot's share by the table (lines) and by the direct solver (dots). \
                 The height is the one at which the direct solver carries the load, so its total is level; what the \
                 table's total leaves it by is the table's error.",
                1e-3 * transfer::LOAD,
                1e3 * transfer::YAW
            ),
        }),
        done(Figure {
            title: "Force error, pose by pose",
            svg: errors::scatter(table, samples)?,
            caption: format!(
                "Random poses: lateral displacement, yaw and roll uniform over the table, load log-uniform from 5 to \
                 150 kN. Error of the total normal force, |table - direct| / max(direct, 5 kN), in the colour of the \
                 slot that carries most. Half of the poses are below {:.2} %, 95 % below {:.2} %.",
                1e2 * report.normal_force.median,
                1e2 * report.normal_force.p95
            ),
        }),
        done(Figure {
            title: "Force error, as a map",
            svg: errors::map(pair, table, samples)?,
            caption: "The same error over lateral displacement and yaw: the 95 % quantile of the poses in each cell. \
                      Dots mark where the rigid contact changes from one slot to the next."
                .into(),
        }),
    ];
    bar.finish_and_clear();
    Ok(figures)
}
