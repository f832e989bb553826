//! Built-in profiles by name: standard wheels and rails, and simple shapes with closed-form contact.

use super::pieces::{Piece, profile};
use super::reading::parse;
use super::{Profile, ProfileKind, arcs, rails, s1002};
use crate::error::{Error, Result};

/// The built-in profiles, as they are written in a recipe.
pub const BUILT_INS: [&str; 9] = [
    "s1002",
    "cone:1/20",
    "circular_wheel:0.1",
    "two_line",
    "urban_arcs",
    "60e1",
    "54e1",
    "flat_rail",
    "circular_rail:0.3",
];

/// Ends (m) of the conical and circular wheels, those of the S1002.
const WHEEL_ENDS: [f64; 2] = [-0.070, 0.060];
/// Half the width (m) of the flat and circular rails.
const RAIL_HALF_WIDTH: f64 = 0.050;
/// A circular profile ends where it is this steep (sine of 80°): a flange of 70° finds its point on it.
const STEEPEST: f64 = 0.984_807_753_012_208;

/// Whether a profile's specification names a built-in one.
pub fn is_built_in(spec: &str) -> bool {
    let name = |s: &str| s.split_once(':').map_or(s.to_ascii_lowercase(), |(name, _)| name.to_ascii_lowercase());
    BUILT_INS.iter().any(|built_in| name(built_in) == name(spec))
}

pub(super) fn build(spec: &str) -> Result<Profile> {
    let spec = &*spec.to_ascii_lowercase();
    let (name, parameter) = spec.split_once(':').map_or((spec, None), |(name, parameter)| (name, Some(parameter)));
    let value = |what: &str, least: f64, most: f64| {
        let text = parameter.ok_or_else(|| Error::field("", spec, format!("needs its {what}, as in {name}:0.1")))?;
        match quotient(text) {
            Some(value) if (least..=most).contains(&value) => Ok(value),
            _ => Err(Error::field("", spec, format!("{text:?} is not a {what} from {least} to {most}"))),
        }
    };
    let plain = |profile: fn() -> Profile| match parameter {
        None => Ok(profile()),
        Some(text) => Err(Error::field("", spec, format!("takes no parameter, given {text:?}"))),
    };
    match name {
        "s1002" => plain(s1002::s1002),
        "two_line" => plain(two_line),
        "urban_arcs" => plain(arcs::urban_arcs),
        "60e1" => plain(rails::uic60),
        "54e1" => plain(rails::uic54),
        "flat_rail" => plain(flat_rail),
        "cone" => Ok(cone(spec, value("conicity", 0.0, 1.0)?)),
        "circular_wheel" => Ok(circular_wheel(spec, value("radius in metres", 0.005, 100.0)?)),
        "circular_rail" => Ok(circular_rail(spec, value("radius in metres", 0.005, 100.0)?)),
        _ => Err(Error::field("", spec, format!("is no built-in profile; those are {}", BUILT_INS.join(", ")))),
    }
}

/// "0.05" or "1/20".
fn quotient(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((dividend, divisor)) => Some(parse(dividend)? / parse(divisor)?),
        None => parse(text),
    }
}

/// A cone without flange: z = -γ y, so the rolling radius falls towards the field side.
fn cone(name: &str, conicity: f64) -> Profile {
    let [from, to] = WHEEL_ENDS.map(|y| [y, -conicity * y]);
    let about = format!("built-in: conical wheel, conicity {conicity}");
    profile(ProfileKind::Wheel, name, &about, &[Piece::Line { from, to }])
}

/// A wheel profile of one arc, convex downwards, lowest at y = 0.
fn circular_wheel(name: &str, radius: f64) -> Profile {
    let half = WHEEL_ENDS[1].min(STEEPEST * radius);
    let about = format!("built-in: circular wheel profile of {radius} m radius");
    profile(ProfileKind::Wheel, name, &about, &[Piece::arc([0.0, -radius], radius, -half, half, false)])
}

/// The paper's simplified wheel of two straight lines.
///
/// The paper gives the idea; the figures are ours: tread cone 1:20 through the tape circle, and a flange of 70° that
/// lies on the S1002's flange line (z = -93.5767 mm - 2.7475 y), so that both have the same play in the track. They
/// meet at y = -34.691 mm. The flange goes down to 40 mm, the tread out to 60 mm.
fn two_line() -> Profile {
    const CONICITY: f64 = 1.0 / 20.0;
    const FLANGE_OFFSET: f64 = -93.576667419e-3;
    const FLANGE_SLOPE: f64 = -2.747477419;
    const FLANGE_DEPTH: f64 = 0.040;
    // -y / 20 = offset + slope y
    let corner = -FLANGE_OFFSET / (FLANGE_SLOPE + CONICITY);
    let corner = [corner, -CONICITY * corner];
    let tip = [(FLANGE_DEPTH - FLANGE_OFFSET) / FLANGE_SLOPE, FLANGE_DEPTH];
    let field = [WHEEL_ENDS[1], -CONICITY * WHEEL_ENDS[1]];
    let pieces = [Piece::Line { from: tip, to: corner }, Piece::Line { from: corner, to: field }];
    let about = "built-in: wheel of two straight lines, tread 1:20 and flange 70°";
    profile(ProfileKind::Wheel, "two_line", about, &pieces)
}

fn flat_rail() -> Profile {
    let piece = Piece::Line { from: [-RAIL_HALF_WIDTH, 0.0], to: [RAIL_HALF_WIDTH, 0.0] };
    profile(ProfileKind::Rail, "flat_rail", "built-in: flat rail, 100 mm wide", &[piece])
}

/// A rail head of one arc, crown at the origin.
fn circular_rail(name: &str, radius: f64) -> Profile {
    let half = RAIL_HALF_WIDTH.min(STEEPEST * radius);
    let about = format!("built-in: circular rail head of {radius} m radius");
    profile(ProfileKind::Rail, name, &about, &[Piece::arc([0.0, radius], radius, -half, half, true)])
}
