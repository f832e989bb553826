//! Whether a profile's curvature is noise: Hertz lives on second derivatives, and those of measured points may be
//! anything.
//!
//! A contour's curvature may jump, where one arc ends and the next begins; it does not swing to and fro within a few
//! millimetres. The measure is that swing, on the fitted curve: for every point, how far the curvature (averaged over
//! [`AVERAGED`]) stands out over, or falls below, what lies within [`REACH`] on both of its sides.

use flangeway::Side;

use crate::curve::Curve;
use crate::error::Result;
use crate::pair::Pair;
use crate::profile::{Profile, ProfileKind};
use crate::recipe::{OtherProfile, Recipe};
use crate::rigid;

/// Length (m) of the curve over which the curvature is averaged.
pub const AVERAGED: f64 = 0.5e-3;
/// How far (m) to each side a swing may reach.
pub const REACH: f64 = 1.5e-3;
/// Spacing (m) of the points that are looked at.
const STEP: f64 = 0.1e-3;
/// A swing is noise from this (1/m) upwards, where the contour is nearly straight: as much as wheel and rail have
/// together on the tread.
const LEAST_SWING: f64 = 8.0;
/// Where it is curved, from this share of its curvature more.
const SHARE: f64 = 0.3;
/// Steepest slope (rad) at which a contact may lie, 75°.
const STEEPEST: f64 = 75.0 * std::f64::consts::PI / 180.0;
/// No contact is looked for this near (m) to a contour's ends, and this far from rigid contact.
const END: f64 = 5e-3;
const HALF_CONTACT: f64 = 5e-3;
/// Lateral positions at which rigid contact is looked at.
const LATERAL_STEPS: u32 = 60;
/// A wheel's flange tip is the lowest point of its contour where that lies in this part of its width from the flange
/// side; what is before the tip is the flange's back.
const TIP_WITHIN: f64 = 1.0 / 3.0;

/// The worst swing of a contour's curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// Where it is: lateral coordinate (m) of the profile.
    pub lateral: f64,
    /// By how much the curvature (1/m) stands out on both sides.
    pub size: f64,
    /// The size from which it is noise there (1/m).
    pub allowed: f64,
}

impl Swing {
    /// Whether it is too large for a contour's own shape.
    pub fn is_noise(&self) -> bool {
        self.size > self.allowed
    }
}

/// The worst swing, as a share of what is allowed there, between two parameters (m) of a profile's curve and where it
/// is not too steep for contact; `None` where that part is shorter than a swing.
pub fn worst(curve: &Curve, [first, last]: [f64; 2]) -> Option<Swing> {
    let inner = curve.joints().iter().copied().filter(|&t| t > first && t < last);
    let ends: Vec<f64> = std::iter::once(first).chain(inner).chain([last]).collect();
    let over = |swing: &Swing| swing.size / swing.allowed;
    let pieces = ends.windows(2).filter_map(|piece| worst_of_piece(curve, piece[0], piece[1]));
    pieces.max_by(|a, b| over(a).total_cmp(&over(b)))
}

/// The part of a profile's curve (parameters, m) where contacts may lie, whatever it is paired with: not near its ends,
/// and of a wheel not behind the flange's tip.
pub fn contactable(curve: &Curve, kind: ProfileKind) -> [f64; 2] {
    let first = if kind == ProfileKind::Wheel { flange_tip(curve) } else { 0.0 };
    [first.max(END), curve.length() - END]
}

/// What to tell the user of the profiles of a pair, one sentence each, where contacts lie in the recipe's ranges;
/// nothing where all are smooth enough.
///
/// # Errors
/// When a curve cannot be fitted, which [`Pair::build`] would have said.
pub fn warnings(recipe: &Recipe, pair: &Pair) -> Result<Vec<String>> {
    let (wheel, rail) = (&recipe.wheel, &recipe.rail);
    let mut found = Vec::new();
    for side in Side::ALL.into_iter().take(pair.sides()) {
        let other = |left: &Option<OtherProfile>, own: Option<f64>| match (side, left) {
            (Side::Left, Some(other)) => other.smoothing_m,
            _ => own,
        };
        let source = pair.source(side);
        let bands = touched(recipe, pair, side);
        let smoothings = [other(&wheel.left, wheel.smoothing_m), other(&rail.left, rail.smoothing_m)];
        for ((profile, smoothing), band) in [&source.wheel, &source.rail].into_iter().zip(smoothings).zip(bands) {
            let curve = Curve::fit(profile, smoothing.unwrap_or(0.0))?;
            found.extend(warning(profile, &curve, smoothing.unwrap_or(0.0), band));
        }
    }
    found.dedup();
    Ok(found)
}

/// The parameters (m) of wheel and rail between which rigid contact lies for the recipe's lateral positions and yaws,
/// and half a contact more. They are those of the profiles' own curves too: moving a curve keeps its lengths.
fn touched(recipe: &Recipe, pair: &Pair, side: Side) -> [[f64; 2]; 2] {
    let ([from, to], yaw) = (recipe.grid.lateral_m.range, recipe.grid.yaw_rad.range[1]);
    let mut bands = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for i in 0..=LATERAL_STEPS {
        let u = from + (to - from) * f64::from(i) / f64::from(LATERAL_STEPS);
        for found in [0.0, yaw].into_iter().filter_map(|yaw| rigid::at_displacement(pair, side, u, yaw)) {
            let point = if side == Side::Left { found.left } else { found.right };
            for (band, t) in bands.iter_mut().zip([point.wheel.t, point.foot.t]) {
                *band = [band[0].min(t - HALF_CONTACT), band[1].max(t + HALF_CONTACT)];
            }
        }
    }
    let body = pair.body(side);
    let lengths = [body.wheel().curve().length(), body.rail().curve().length()];
    [0, 1].map(|k| [bands[k][0].max(0.0), bands[k][1].min(lengths[k])])
}

/// What to tell the user of one profile, where its curvature is noise between two parameters (m) of its curve.
pub fn warning(profile: &Profile, curve: &Curve, smoothing: f64, band: [f64; 2]) -> Option<String> {
    let swing = worst(curve, band).filter(Swing::is_noise)?;
    let advice = if smoothing > 0.0 {
        format!("set a larger smoothing_m than {smoothing}")
    } else {
        String::from("set smoothing_m to the scatter of the measurement, such as 5e-5")
    };
    Some(format!(
        "{}: the {} profile's curvature is noise: near y = {:.1} mm it swings by {:.0} 1/m within {:.0} mm, where {:.0} \
         1/m would be plausible; {advice}",
        profile.name,
        profile.kind,
        1e3 * swing.lateral,
        swing.size,
        2e3 * REACH,
        swing.allowed
    ))
}

/// The worst swing between two parameters, with no joint between them.
fn worst_of_piece(curve: &Curve, from: f64, to: f64) -> Option<Swing> {
    let (from, to) = (from + 0.5 * AVERAGED, to - 0.5 * AVERAGED);
    let count = ((to - from) / STEP).floor();
    if count < 2.0 {
        return None;
    }
    let t = |i: usize| from + STEP * i as f64;
    let count = count as usize + 1;
    let mean = |i: usize| curve.turn(t(i) - 0.5 * AVERAGED, t(i) + 0.5 * AVERAGED) / AVERAGED;
    let curvatures: Vec<f64> = (0..count).map(mean).collect();
    let reach = (REACH / STEP).round() as usize;
    let swing = |i: usize| {
        let p = curve.at(t(i));
        if libm::atan2(p.tangent[1], p.tangent[0]).abs() > STEEPEST {
            return None;
        }
        let [before, after] = [&curvatures[i.saturating_sub(reach)..i], &curvatures[i + 1..count.min(i + 1 + reach)]];
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Over what is lowest on the higher of its two sides, or under what is highest on the lower one.
        let peak = curvatures[i] - least(before).max(least(after));
        let dip = most(before).min(most(after)) - curvatures[i];
        let size = peak.max(dip).max(0.0);
        let around = curvatures[i] - if peak > dip { peak } else { -dip };
        Some(Swing { lateral: p.y, size, allowed: LEAST_SWING + SHARE * around.abs() })
    };
    (1..count - 1).filter_map(swing).max_by(|a, b| (a.size / a.allowed).total_cmp(&(b.size / b.allowed)))
}

/// Parameter of the flange tip, 0 for a wheel without flange.
fn flange_tip(curve: &Curve) -> f64 {
    let steps = (curve.length() / STEP).ceil() as usize;
    let points = || (0..=steps).map(|i| curve.at(curve.length() * i as f64 / steps as f64));
    let (low, high) = points().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
    let tip = points().max_by(|a, b| a.z.total_cmp(&b.z));
    tip.filter(|tip| tip.y < low + TIP_WITHIN * (high - low)).map_or(0.0, |tip| tip.t)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::profile::{BUILT_INS, ReadOptions};

    /// A rail head of 0.3 m radius, its points moved up and down by a scatter (m).
    fn arc(scatter: f64) -> Profile {
        let point = |i: i32| {
            let angle = f64::from(i) / 1000.0;
            let noise = libm::sin(1e4 * libm::sin(f64::from(i) * 12.9898));
            [0.3 * libm::sin(angle), 0.3 * (1.0 - libm::cos(angle)) + scatter * noise]
        };
        Profile {
            kind: ProfileKind::Rail,
            name: "arc".into(),
            points: (-100..=100).map(point).collect(),
            joints: vec![],
            recognised: vec![],
            source_hash: [0; 32],
            smoothing: 0.0,
        }
    }

    fn warning_of(profile: &Profile, smoothing: f64) -> Option<String> {
        let curve = Curve::fit(profile, smoothing).unwrap();
        warning(profile, &curve, smoothing, contactable(&curve, profile.kind))
    }

    #[test]
    fn a_noisy_arc_warns_and_a_clean_or_smoothed_one_does_not() {
        assert_eq!(warning_of(&arc(0.0), 0.0), None);
        let said = warning_of(&arc(1e-5), 0.0).unwrap();
        assert!(said.starts_with("arc: the rail profile's curvature is noise: near y = "), "{said}");
        assert!(said.contains("smoothing_m"), "{said}");
        assert_eq!(warning_of(&arc(1e-5), 7e-6), None);
    }

    #[test]
    fn the_built_ins_do_not_warn() {
        for name in BUILT_INS {
            let profile = Profile::load(name, Path::new(""), None, &ReadOptions::default()).unwrap();
            let curve = Curve::fit(&profile, 0.0).unwrap();
            let band = contactable(&curve, profile.kind);
            println!("{name}: {:?}", worst(&curve, band));
            assert_eq!(warning(&profile, &curve, 0.0, band), None);
        }
    }
}
