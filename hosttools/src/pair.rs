//! A recipe's wheels put on its rails: profiles read, fitted and placed in the track frame.

use flangeway::{Pose, Side, WheelGeometry};

use crate::contact::{Body, Column, Method, Rail, Settings, SlotState, Wheel};
use crate::curve::Curve;
use crate::error::{Error, Result};
use crate::profile::{Joint, Profile, ProfileKind, ReadOptions};
use crate::recipe::{RailRecipe, Recipe};
use crate::rigid;

/// The two sides of a wheelset on track. The left side is kept as its mirror image, so both are right-hand bodies.
#[derive(Debug, Clone)]
pub struct Pair {
    right: Body,
    left: Option<Body>,
    sources: Vec<Source>,
}

/// Where one side's profiles came from.
#[derive(Debug, Clone)]
pub struct Source {
    /// The wheel's profile as read.
    pub wheel: Profile,
    /// The rail's profile as read.
    pub rail: Profile,
}

impl Pair {
    /// Builds both sides from a recipe, with the recipe's solver settings.
    ///
    /// # Errors
    /// When a profile cannot be read or placed, or the wheel misses the rail.
    pub fn build(recipe: &Recipe) -> Result<Self> {
        let wheel = &recipe.wheel;
        let rail = &recipe.rail;
        let load = |spec: &str, kind: ProfileKind, options: ReadOptions| recipe.load_profile(spec, kind, &options);
        let right_wheel = load(&wheel.profile, ProfileKind::Wheel, wheel.options())?;
        let right_rail = load(&rail.profile, ProfileKind::Rail, rail.options())?;
        let right = Side::Right;
        let body = place(recipe, right, &right_wheel, wheel.smoothing_m, &right_rail, rail.smoothing_m)?;
        let left = if wheel.left.is_none() && rail.left.is_none() {
            None
        } else {
            let (profile, smoothing) = match &wheel.left {
                Some(other) => (load(&other.profile, ProfileKind::Wheel, other.options())?, other.smoothing_m),
                None => (right_wheel.clone(), wheel.smoothing_m),
            };
            let (rail_profile, rail_smoothing) = match &rail.left {
                Some(other) => (load(&other.profile, ProfileKind::Rail, other.options())?, other.smoothing_m),
                None => (right_rail.clone(), rail.smoothing_m),
            };
            let body = place(recipe, Side::Left, &profile, smoothing, &rail_profile, rail_smoothing)?;
            Some((body, Source { wheel: profile, rail: rail_profile }))
        };
        let mut pair = Self { right: body, left: None, sources: vec![Source { wheel: right_wheel, rail: right_rail }] };
        if let Some((body, source)) = left {
            pair.left = Some(body);
            pair.sources.push(source);
        }
        if rigid::two_wheels(&pair, 0.0, 0.0).is_none() {
            let message = "the wheel profile cannot reach the rail with the wheelset centred: check gauge, flange-back \
                           spacing and flange-back position";
            return Err(Error::field(&recipe.path, "wheel.profile", message));
        }
        for side in Side::ALL.into_iter().take(pair.sides()) {
            let boundaries = match recipe.slots.boundaries_m {
                Some(given) => given,
                None => rigid::slot_boundaries(&pair, side, recipe.grid.lateral_m.range, recipe.grid.yaw_rad.range[1]),
            };
            let body = pair.body(side).clone().with_boundaries(boundaries);
            match side {
                Side::Right => pair.right = body,
                Side::Left => pair.left = Some(body),
            }
        }
        Ok(pair)
    }

    /// The same pair with other solver settings.
    pub fn with_settings(&self, settings: Settings) -> Self {
        let with = |body: &Body| body.with_settings(settings);
        Self { right: with(&self.right), left: self.left.as_ref().map(with), sources: self.sources.clone() }
    }

    /// The same pair solved by another method.
    pub fn with_method(&self, method: Method) -> Self {
        self.with_settings(Settings { method, ..*self.right.settings() })
    }

    /// 1 where the left side mirrors the right one, 2 where it is its own.
    pub fn sides(&self) -> usize {
        if self.left.is_some() { 2 } else { 1 }
    }

    /// The right-hand body that stands for a side.
    pub fn body(&self, side: Side) -> &Body {
        match (side, &self.left) {
            (Side::Left, Some(left)) => left,
            _ => &self.right,
        }
    }

    /// The profiles behind a side.
    pub fn source(&self, side: Side) -> &Source {
        match side {
            Side::Left => self.sources.last(),
            Side::Right => self.sources.first(),
        }
        .unwrap_or_else(|| unreachable!("a pair has a right side"))
    }

    /// Contacts of one wheel by the direct solver, in the canonical (right-hand, yaw ≥ 0) frame of the table.
    pub fn solve(&self, side: Side, pose: &Pose) -> [SlotState; crate::contact::SLOTS] {
        let pose = pose.canonical(side).pose;
        self.column(side, &pose).slots(pose.vertical)
    }

    /// The column of a canonical pose: everything but its height.
    pub fn column(&self, side: Side, canonical: &Pose) -> Column<'_> {
        self.body(side).column(canonical.lateral, canonical.yaw, canonical.roll)
    }
}

fn place(
    recipe: &Recipe,
    side: Side,
    wheel: &Profile,
    wheel_smoothing: Option<f64>,
    rail: &Profile,
    rail_smoothing: Option<f64>,
) -> Result<Body> {
    let wheel = place_wheel(recipe, side, wheel, wheel_smoothing.unwrap_or(0.0))?;
    let rail = place_rail(recipe, rail, rail_smoothing.unwrap_or(0.0))?;
    let nowhere = [f64::NEG_INFINITY; 2];
    Ok(Body::new(wheel, Rail::new(rail), recipe.material().contact_modulus(), recipe.settings(), nowhere))
}

/// The wheel's profile with its origin on the tape circle, and where that is on the wheelset.
fn place_wheel(recipe: &Recipe, side: Side, profile: &Profile, smoothing: f64) -> Result<Wheel> {
    let wheel = &recipe.wheel;
    let tape = wheel.tape_circle_position_m;
    let curve = Curve::fit(profile, smoothing)?;
    let Some(t) = curve.parameter_at_lateral(tape) else {
        let message = format!("{tape} is not on the profile, which ends before it");
        return Err(Error::field(&recipe.path, "wheel.tape_circle_position_m", message));
    };
    let moved = moved(profile, |[y, z]| [y - tape, z - curve.at(t).z], |d| d);
    let other = if side == Side::Left { wheel.left.as_ref().and_then(|l| l.nominal_radius_m) } else { None };
    let geometry = WheelGeometry {
        nominal_radius: other.unwrap_or(wheel.nominal_radius_m),
        lateral_position: 0.5 * wheel.flange_back_spacing_m + (tape - wheel.flange_back_position_m),
    };
    Ok(Wheel::new(Curve::fit(&moved, smoothing)?, geometry))
}

/// The rail's profile in the track frame.
fn place_rail(recipe: &Recipe, profile: &Profile, smoothing: f64) -> Result<Curve> {
    let rail = &recipe.rail;
    // Inclined towards the track's centre: a turn about x by -cant.
    let (sin, cos) = (libm::sin(-rail.cant_rad), libm::cos(rail.cant_rad));
    let turn = |[y, z]: [f64; 2]| [y * cos - z * sin, y * sin + z * cos];
    let turned = moved(profile, turn, turn);
    let shift = match (rail.origin_m, rail.gauge_m) {
        (Some(origin), _) => origin,
        (None, gauge) => by_gauge(recipe, rail, &Curve::fit(&turned, smoothing)?, gauge.unwrap_or_default())?,
    };
    Curve::fit(&moved(&turned, |[y, z]| [y + shift[0], z + shift[1]], |d| d), smoothing)
}

/// The shift that puts the crown at z = 0 and the gauge face, at the gauge height below it, at half the gauge.
fn by_gauge(recipe: &Recipe, rail: &RailRecipe, curve: &Curve, gauge: f64) -> Result<[f64; 2]> {
    let steps = (curve.length() / 1e-4).ceil() as usize;
    let t = |i: usize| curve.length() * i as f64 / steps as f64;
    let crown = (1..steps).min_by(|&a, &b| curve.at(t(a)).z.total_cmp(&curve.at(t(b)).z)).unwrap_or(0);
    let top = bisect(t(crown.saturating_sub(1)), t(crown + 1), |t| curve.at(t).tangent[1] > 0.0);
    let crown_height = curve.at(top).z;
    let depth = |t: f64| curve.at(t).z - crown_height;
    let Some(face) = (0..crown).rev().find(|&i| depth(t(i)) >= rail.gauge_height_m) else {
        let message = format!(
            "the rail's gauge side reaches {:.1} mm below its crown, but the gauge is measured at {:.1} mm; place it by origin_m",
            1e3 * depth(0.0),
            1e3 * rail.gauge_height_m
        );
        return Err(Error::field(&recipe.path, "rail.gauge_height_m", message));
    };
    let face = bisect(t(face), t(face + 1), |t| depth(t) < rail.gauge_height_m);
    Ok([0.5 * gauge - curve.at(face).y, -crown_height])
}

/// Where a condition that is false at `low` and true at `high` changes.
fn bisect(mut low: f64, mut high: f64, condition: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if condition(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

fn moved(profile: &Profile, point: impl Fn([f64; 2]) -> [f64; 2], direction: impl Fn([f64; 2]) -> [f64; 2]) -> Profile {
    let joint = |j: &Joint| Joint {
        index: j.index,
        tangent_before: j.tangent_before.map(&direction),
        tangent_after: j.tangent_after.map(&direction),
    };
    Profile {
        points: profile.points.iter().map(|&p| point(p)).collect(),
        joints: profile.joints.iter().map(joint).collect(),
        ..profile.clone()
    }
}
