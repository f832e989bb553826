//! The direct solver: every contact of one wheel with its rail, for any pose, without a table.
//!
//! Everything is computed for the right wheel with yaw ≥ 0; the kernel's [`flangeway::Pose`] says how the left wheel
//! and backward yaw are mirrored onto it.

mod rail;
mod ridge;
mod rows;
mod shares;
mod slots;
mod wheel;

pub use rail::{FAR, Foot, Rail};
pub use ridge::{Method, Ridge, RidgePoint};
pub use rows::{Row, Zone};
pub use slots::{Peak, SlotState};
pub use wheel::{Orientation, SAMPLE_STEP, SurfacePoint, Wheel, WheelPoint};

use ridge::Sample;

use crate::halfspace::{self, Patch, RowLoad};
use crate::semi_hertzian;

/// Slots of a wheel: tread, flange root, flange.
pub const SLOTS: usize = 3;

/// Between samples [`SAMPLE_STEP`] apart the overlap exceeds them by a few micrometres at the most (m).
const BETWEEN_SAMPLES: f64 = 20e-6;
/// Indentation (m) up to which Hertz is asked whatever the model: its force, some 10 N, is of no account, and a patch is
/// hardly wider than the profile's samples.
const ONSET: f64 = 0.5e-6;
/// A height within this (m) of an earlier one need look only at samples that can have become the highest.
const NEARBY: f64 = 0.2e-3;

/// Whether the yaw takes part in the search of the contact (paper 2.2 and 2.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
pub enum Dimension {
    /// The section through the axle only.
    #[serde(rename = "2d")]
    Two,
    /// The contact may lie ahead of or behind the axle.
    #[default]
    #[serde(rename = "3d")]
    Three,
}

/// Which curvatures of the profiles Hertz is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Curvature {
    /// Averaged over about the width of the contact.
    #[default]
    Mean,
    /// At the point of greatest overlap (the paper).
    Local,
}

/// Model of the normal contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Normal {
    /// Hertz with the curvatures at the contact.
    #[default]
    Hertz,
    /// Strips with Hertz's pressure along the track ([`crate::semi_hertzian`]).
    SemiHertzian,
    /// The elastic half-space on a grid ([`crate::halfspace`]).
    HalfSpace,
}

/// Settings of the direct solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How the normal force is found.
    pub normal: Normal,
    /// Largest edges (m) of the half-space's elements, along the track and across.
    pub elements: [f64; 2],
    /// Search with or without yaw.
    pub dimension: Dimension,
    /// How the greatest overlap around the wheel is found.
    pub method: Method,
    /// Curvatures at the point, or averaged over the contact.
    pub curvature: Curvature,
    /// Smallest combined principal curvature (1/m) that Hertz is asked about: the policy for conformal contact. A
    /// smaller or negative one is taken as this, and the contact is flagged.
    pub curvature_floor: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            normal: Normal::Hertz,
            elements: halfspace::EDGES,
            dimension: Dimension::Three,
            method: Method::Locus,
            curvature: Curvature::Mean,
            curvature_floor: 0.1,
        }
    }
}

/// A wheel over its rail, right-hand side.
#[derive(Debug, Clone)]
pub struct Body {
    wheel: Wheel,
    rail: Rail,
    contact_modulus: f64,
    settings: Settings,
    boundaries: [f64; 2],
    boundary_parameters: [Option<f64>; 2],
}

impl Body {
    /// Puts a wheel over a rail. The slot boundaries are wheel-profile coordinates (m): tread above the first, flange
    /// below the second.
    pub fn new(wheel: Wheel, rail: Rail, contact_modulus: f64, settings: Settings, boundaries: [f64; 2]) -> Self {
        let boundary_parameters = boundaries.map(|s| wheel.curve().parameter_at_lateral(s));
        Self { wheel, rail, contact_modulus, settings, boundaries, boundary_parameters }
    }

    /// The same bodies with other settings.
    pub fn with_settings(&self, settings: Settings) -> Self {
        Self { settings, ..self.clone() }
    }

    /// The same bodies with other slot boundaries.
    pub fn with_boundaries(self, boundaries: [f64; 2]) -> Self {
        Self::new(self.wheel, self.rail, self.contact_modulus, self.settings, boundaries)
    }

    /// The wheel.
    pub fn wheel(&self) -> &Wheel {
        &self.wheel
    }

    /// The rail.
    pub fn rail(&self) -> &Rail {
        &self.rail
    }

    /// The solver's settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Slot boundaries on the wheel-profile coordinate (m).
    pub fn boundaries(&self) -> [f64; 2] {
        self.boundaries
    }

    /// Wheel-profile coordinates (below, above] of a slot's region.
    fn region(&self, slot: usize) -> (f64, f64) {
        let [upper, lower] = self.boundaries;
        match slot {
            0 => (upper, f64::INFINITY),
            1 => (lower, upper),
            _ => (f64::NEG_INFINITY, lower),
        }
    }

    fn boundary_parameters(&self, slot: usize) -> [Option<f64>; 2] {
        let [upper, lower] = self.boundary_parameters;
        match slot {
            0 => [upper, None],
            1 => [upper, lower],
            _ => [lower, None],
        }
    }

    /// Everything that does not depend on the height, for one lateral position (m), yaw ≥ 0 and roll (rad).
    pub fn column(&self, lateral: f64, yaw: f64, roll: f64) -> Column<'_> {
        let yaw = if self.settings.dimension == Dimension::Two { 0.0 } else { yaw };
        let ridge = Ridge::new(self, lateral, yaw, roll, self.settings.method);
        Column { body: self, ridge, samples: Vec::with_capacity(self.wheel.samples().len()) }
    }
}

/// A wheel at one lateral position, yaw and roll: it answers for any height.
pub struct Column<'a> {
    body: &'a Body,
    ridge: Ridge<'a>,
    samples: Vec<Sample>,
}

impl Column<'_> {
    /// The wheel's slots with the axle's height `vertical` (m, down; 0 = nominal radius above the crowns).
    pub fn slots(&mut self, vertical: f64) -> [SlotState; SLOTS] {
        self.slots_by(self.body.settings.normal, vertical)
    }

    fn slots_by(&mut self, normal: Normal, vertical: f64) -> [SlotState; SLOTS] {
        let peaks = self.peaks(vertical);
        let mut slots = slots::gather(self.body, &self.ridge, self.centre(vertical), &self.samples, &peaks);
        let deepest = deepest(&slots);
        if normal != Normal::Hertz && deepest > ONSET {
            let surface = self.surface(vertical);
            let loads: Vec<RowLoad> = match normal {
                Normal::SemiHertzian => semi_hertzian::loads(&surface, self.body.contact_modulus),
                _ => surface.patches(deepest).iter().flat_map(Patch::loads).collect(),
            };
            if !loads.is_empty() {
                shares::assign(self.body, &mut slots, &loads);
            }
        }
        slots
    }

    /// The patches of the elastic half-space at a height (m), whatever the settings' model; none without contact.
    pub fn patches(&mut self, vertical: f64) -> Vec<Patch> {
        let peaks = self.peaks(vertical);
        let deepest = peaks.iter().map(|peak| peak.point.depth()).fold(0.0, f64::max);
        if deepest > ONSET { self.surface(vertical).patches(deepest) } else { Vec::new() }
    }

    /// What lies between wheel and rail where they overlap; the samples must be those of this height.
    fn surface(&self, vertical: f64) -> Surface<'_> {
        let centre = self.centre(vertical);
        let zones = rows::zones(self.body, &self.ridge, centre, &self.samples);
        Surface { body: self.body, ridge: &self.ridge, centre, zones }
    }

    /// Every local maximum of the overlap, flange side first.
    pub fn peaks(&mut self, vertical: f64) -> Vec<Peak> {
        let centre = self.centre(vertical);
        self.ridge.samples(centre, &mut self.samples);
        let by_slope = self.body.settings.method == Method::Locus;
        slots::peaks(self.body, &self.ridge, centre, &self.samples, by_slope)
    }

    /// Total normal force (N) at a height.
    pub fn total_force(&mut self, vertical: f64) -> f64 {
        self.slots(vertical).iter().map(SlotState::normal_force).sum()
    }

    /// Total normal force (N) at a height, by the semi-Hertzian method in place of the half-space: several times as
    /// fast, for searches that need not end at an exact load.
    pub fn estimated_force(&mut self, vertical: f64) -> f64 {
        let normal = match self.body.settings.normal {
            Normal::HalfSpace => Normal::SemiHertzian,
            normal => normal,
        };
        self.slots_by(normal, vertical).iter().map(SlotState::normal_force).sum()
    }

    /// The greatest signed overlap (m) anywhere on the wheel, and its point; `None` where the wheel is not near.
    pub fn deepest(&mut self, vertical: f64) -> Option<RidgePoint> {
        let centre = self.centre(vertical);
        self.ridge.samples(centre, &mut self.samples);
        self.highest_peak(centre)
    }

    /// The height (m) at which the wheel just touches, and where: rigid contact of one wheel.
    ///
    /// Newton's method on the greatest overlap, d δ / d z = cos γ with γ the contact angle, kept inside a bracket.
    /// `near` is a height close to it, where one is known. `None` where the wheel misses the rail.
    pub fn touching(&mut self, near: Option<f64>) -> Option<(f64, RidgePoint)> {
        let (mut above, mut below) = (f64::NEG_INFINITY, f64::INFINITY);
        let rough = self.ridge.rough_touching_centre()? + self.body.wheel.geometry().nominal_radius;
        let mut vertical = near.filter(|near| (near - rough).abs() < NEARBY).unwrap_or(rough);
        // Heights and samples of the last time that all samples were looked at.
        let mut looked: Option<(f64, Vec<Sample>)> = None;
        for _ in 0..60 {
            let centre = self.centre(vertical);
            match &looked {
                // No overlap grows faster than the wheel comes down: samples that were lower than the highest by more
                // than twice the way cannot be the highest now.
                Some((at, samples)) if (vertical - at).abs() < NEARBY => {
                    let highest = samples.iter().map(|s| s.depth()).fold(f64::NEG_INFINITY, f64::max);
                    let least = highest - 2.0 * (vertical - at).abs() - BETWEEN_SAMPLES;
                    self.ridge.samples_above(centre, samples, least, &mut self.samples);
                }
                _ => {
                    self.ridge.samples(centre, &mut self.samples);
                    looked = Some((vertical, self.samples.clone()));
                }
            }
            let Some(point) = self.highest_peak(centre) else {
                // The rough height was taken from a steep flank and is too high: come down.
                vertical += 0.5 * FAR;
                continue;
            };
            let depth = point.depth();
            if depth.abs() < 1e-13 || below - above < 1e-13 {
                return Some((vertical, point));
            }
            if depth > 0.0 {
                below = vertical
            } else {
                above = vertical
            }
            let newton = vertical - depth / point.foot.tangent[0].max(0.05);
            vertical = if newton > above && newton < below { newton } else { 0.5 * (above + below) };
            if !vertical.is_finite() {
                return None;
            }
        }
        self.deepest(vertical).map(|point| (vertical, point))
    }

    /// The highest of the ridge's maxima, from its samples.
    fn highest_peak(&self, centre: f64) -> Option<RidgePoint> {
        let wheel = self.body.wheel.samples();
        let highest = self.samples.iter().map(|s| s.depth()).fold(f64::NEG_INFINITY, f64::max);
        if highest <= -FAR {
            return None;
        }
        let near = highest - BETWEEN_SAMPLES;
        let mut best: Option<RidgePoint> = None;
        for i in 0..self.samples.len().saturating_sub(1) {
            let found = match (self.samples[i], self.samples[i + 1]) {
                (Sample::Near { depth: a, slope: rising }, Sample::Near { depth: b, slope: falling })
                    if a.max(b) > near && rising > 0.0 && falling <= 0.0 =>
                {
                    self.ridge.maximum(wheel[i].t, wheel[i + 1].t, centre)
                }
                (sample, _) if sample.depth() == highest => self.ridge.at(wheel[i].t, centre),
                _ => None,
            };
            if let Some(found) = found
                && best.as_ref().is_none_or(|best| found.depth() > best.depth())
            {
                best = Some(found);
            }
        }
        best
    }

    fn centre(&self, vertical: f64) -> f64 {
        vertical - self.body.wheel.geometry().nominal_radius
    }
}

fn deepest(slots: &[SlotState; SLOTS]) -> f64 {
    slots.iter().map(|slot| slot.indentation).fold(f64::NEG_INFINITY, f64::max)
}

/// Wheel and rail at one pose, where they overlap.
pub struct Surface<'a> {
    body: &'a Body,
    ridge: &'a Ridge<'a>,
    centre: f64,
    zones: Vec<Zone>,
}

impl Surface<'_> {
    /// Stretches of the rail's profile with overlap, flange side first.
    pub fn zones(&self) -> &[Zone] {
        &self.zones
    }

    /// Rail parameters (m) that cut each zone into strips, about `count` in all.
    pub fn cuts(&self, count: usize) -> Vec<Vec<f64>> {
        rows::cuts(&self.zones, count)
    }

    /// The row of this width (m) at a rail parameter (m) in a zone.
    pub fn row(&self, zone: &Zone, s: f64, width: f64) -> Option<Row> {
        rows::row(self.body, self.ridge, self.centre, zone, s, width)
    }

    /// Overlaps (m) along a row at multiples of `step` (m): `found` is told the multiple and the overlap, if positive.
    pub fn along(&self, row: &Row, step: f64, found: impl FnMut(i64, f64)) {
        rows::along(self.body, self.ridge, self.centre, row, step, found);
    }

    fn patches(&self, deepest: f64) -> Vec<Patch> {
        halfspace::patches(self, deepest, self.body.contact_modulus, self.body.settings.elements)
    }
}

/// Golden-section search for the maximum of a function with one maximum between `low` and `high`.
fn golden(mut low: f64, mut high: f64, tolerance: f64, f: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > tolerance {
        if fa >= fb {
            (high, b, fb) = (b, a, fa);
            a = high - RATIO * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + RATIO * (high - low);
            fb = f(b);
        }
    }
    0.5 * (low + high)
}
