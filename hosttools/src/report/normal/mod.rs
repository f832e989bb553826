//! What the three models of normal contact make of the same pair.

mod curves;
mod manchester;
mod patches;

use flangeway::{Coordinates, Pose, Side};

use super::Figure;
use super::style::{ACCENT, GREY, INK, Mark};
use crate::contact::{Normal, Settings};
use crate::error::Result;
use crate::pair::Pair;
use crate::rigid;
use crate::verify::height_for_load;
use plotters::style::RGBColor;

/// The models, their names, and how their lines are drawn.
const MODELS: [(Normal, &str, Mark, RGBColor); 3] = [
    (Normal::Hertz, "Hertz", Mark::Dashes, GREY),
    (Normal::SemiHertzian, "semi-Hertzian", Mark::Line, ACCENT),
    (Normal::HalfSpace, "half-space", Mark::Line, INK),
];

/// The pair solved by each of the models.
fn models(pair: &Pair) -> [Pair; 3] {
    let settings = *pair.body(Side::Right).settings();
    MODELS.map(|(normal, ..)| pair.with_settings(Settings { normal, ..settings }))
}

/// The right wheel at a displacement of its tape-circle point and a yaw, with the rigid contact's roll, at the height
/// at which it carries a load (N) by the pair's model (for the half-space by the semi-Hertzian one).
fn pose(pair: &Pair, at: &Coordinates, load: f64) -> Option<Pose> {
    let rest = rigid::at_displacement(pair, Side::Right, at.lateral, at.yaw)?;
    let place = flangeway::Displacement { lateral: at.lateral, vertical: 0.0 };
    let geometry = pair.body(Side::Right).wheel().geometry();
    let pose = flangeway::pose_with(geometry, &place, at.yaw, rest.roll);
    let vertical = height_for_load(&mut pair.column(Side::Right, &pose), load)?;
    Some(Pose { vertical, ..pose })
}

/// The figures.
pub(super) fn figures(pair: &Pair) -> Result<Vec<Figure>> {
    let models = models(pair);
    let (against_contact, words) = manchester::manchester()?;
    Ok(vec![
        Figure {
            title: "Pressure in the patch",
            svg: patches::patches(&models)?,
            caption: "Pressure by the half-space solver, element by element (darker is higher; the scale is each \
                      panel's own, its largest pressure in the title), over the track's x and the arc length of the \
                      rail's profile, which falls from the field side to the gauge side. Lines: the ellipses that \
                      Hertz gives for the same pose."
                .into(),
        },
        Figure {
            title: "Force over the height, by three models",
            svg: curves::over_height(&models)?,
            caption: "Total normal force of the right wheel as it comes down, over the height above the rigid contact."
                .into(),
        },
        Figure {
            title: "From tread to flange, by three models",
            svg: curves::transfer(&models)?,
            caption: format!(
                "Total normal force of the right wheel moved sideways at yaw {} mrad, {} µm below the height at which it \
                 first touches. What is a step with Hertz is where peaks of one patch merge or change places.",
                1e3 * curves::YAW,
                1e6 * curves::DEPTH
            ),
        },
        Figure { title: "Three models against CONTACT", svg: against_contact, caption: words },
    ])
}
