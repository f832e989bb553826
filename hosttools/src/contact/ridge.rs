//! The ridge of overlap: for every profile point of the wheel, the greatest overlap with the rail around the wheel.
//!
//! A contact is a local maximum of the overlap over the wheel's surface, so it is a local maximum along the ridge.
//! The ridge is found in two independent ways: in closed form, because the overlap with a prismatic rail is greatest
//! where the wheel's normal has no component along the track ([`Method::Locus`]); and by the paper's sweep of sections
//! across the track, D/8 to each side, coarse then fine ([`Method::Sweep`], the reference).

use super::rail::{FAR, Foot, Nearness};
use super::wheel::{Orientation, SurfacePoint, WheelPoint};
use super::{Body, golden};

/// How the greatest overlap around the wheel is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Closed form: the wheel's silhouette seen along the track.
    #[default]
    Locus,
    /// The paper's longitudinal sweep (section 2.3), slow and independent.
    Sweep,
}

/// A point of the ridge: a point of the wheel, the rail's point under it, and how deep the one is in the other.
#[derive(Debug, Clone, Copy)]
pub struct RidgePoint {
    /// Point of the wheel's profile.
    pub wheel: WheelPoint,
    /// Its place, from the wheelset's centre.
    pub surface: SurfacePoint,
    /// The rail's nearest point.
    pub foot: Foot,
}

impl RidgePoint {
    /// Signed overlap (m), negative for a gap.
    pub fn depth(&self) -> f64 {
        self.foot.depth
    }
}

/// What a sample of the ridge tells.
#[derive(Debug, Clone, Copy)]
pub(super) enum Sample {
    /// No ridge here: beside the rail, or the wheel is hollow along the track.
    Invalid,
    /// A gap wider than [`FAR`].
    Far,
    /// Overlap (m), and for the locus the sign of its change along the profile.
    Near { depth: f64, slope: f64 },
}

impl Sample {
    pub(super) fn depth(self) -> f64 {
        match self {
            Self::Invalid => f64::NEG_INFINITY,
            Self::Far => -FAR,
            Self::Near { depth, .. } => depth,
        }
    }
}

/// Coarse step (m) of the sweep's sections; the fine steps end at a nanometre.
const COARSE: f64 = 5e-3;

/// The ridge of one wheel at one lateral position, yaw and roll; it serves every height.
pub struct Ridge<'a> {
    body: &'a Body,
    orientation: Orientation,
    method: Method,
    lateral: f64,
    /// The silhouette's `[y, z]` and normal at each profile sample (locus only).
    silhouette: Vec<Option<([f64; 2], [f64; 2])>>,
}

impl<'a> Ridge<'a> {
    pub(super) fn new(body: &'a Body, lateral: f64, yaw: f64, roll: f64, method: Method) -> Self {
        let orientation = Orientation::new(yaw, roll);
        let silhouette = match method {
            Method::Sweep => Vec::new(),
            Method::Locus => {
                let at = |p: &WheelPoint| {
                    let s = orientation.silhouette(p)?;
                    Some(([s.position[1] + lateral, s.position[2]], orientation.normal(p, s.around)))
                };
                body.wheel.samples().iter().map(at).collect()
            }
        };
        Self { body, orientation, method, lateral, silhouette }
    }

    pub(super) fn orientation(&self) -> &Orientation {
        &self.orientation
    }

    /// Lateral position of the wheelset's centre (m).
    pub(super) fn lateral(&self) -> f64 {
        self.lateral
    }

    /// Samples of the ridge with the wheelset's centre at height `centre` (m, down).
    pub(super) fn samples(&self, centre: f64, samples: &mut Vec<Sample>) {
        samples.clear();
        match self.method {
            Method::Locus => samples.extend(self.silhouette.iter().map(|s| self.locus_sample(s.as_ref(), centre))),
            Method::Sweep => samples.extend(self.body.wheel.samples().iter().map(|p| {
                let depth = self.swept(p, centre).map(|r| r.depth());
                depth.map_or(Sample::Invalid, |depth| Sample::Near { depth, slope: 0.0 })
            })),
        }
    }

    /// As [`Ridge::samples`], but only where the `earlier` samples were at least `least` (m) deep; the others are
    /// counted as far.
    pub(super) fn samples_above(&self, centre: f64, earlier: &[Sample], least: f64, samples: &mut Vec<Sample>) {
        samples.clear();
        samples.extend(self.silhouette.iter().zip(earlier).map(|(s, earlier)| {
            if earlier.depth() >= least { self.locus_sample(s.as_ref(), centre) } else { Sample::Far }
        }));
    }

    #[inline]
    fn locus_sample(&self, silhouette: Option<&([f64; 2], [f64; 2])>, centre: f64) -> Sample {
        let Some(([y, z], normal)) = silhouette else { return Sample::Invalid };
        let p = [*y, z + centre];
        match self.body.rail.nearness(p) {
            Nearness::Outside => Sample::Invalid,
            Nearness::Far => Sample::Far,
            Nearness::Near(guess) => self
                .body
                .rail
                .foot(p, guess, 2)
                .map_or(Sample::Invalid, |foot| Sample::Near { depth: foot.depth, slope: rise(normal, &foot) }),
        }
    }

    /// The ridge's point at profile parameter `t`, by whichever method.
    pub(super) fn at(&self, t: f64, centre: f64) -> Option<RidgePoint> {
        let wheel = self.body.wheel.at(t);
        match self.method {
            Method::Locus => {
                let surface = self.orientation.silhouette(&wheel)?;
                self.overlap(wheel, surface, centre)
            }
            Method::Sweep => self.swept(&wheel, centre),
        }
    }

    /// Refines a maximum that lies between two profile parameters (m).
    pub(super) fn maximum(&self, low: f64, high: f64, centre: f64) -> Option<RidgePoint> {
        match self.method {
            Method::Locus => self.common_normal(low, high, centre),
            Method::Sweep => {
                let t = golden(low, high, 1e-8, |t| self.at(t, centre).map_or(f64::NEG_INFINITY, |r| r.depth()));
                self.at(t, centre)
            }
        }
    }

    /// The common normal: the overlap stops rising where wheel and rail have the same tangent. Regula falsi with the
    /// Illinois rule on [`rise`], which is positive at `low` and not at `high`.
    fn common_normal(&self, mut low: f64, mut high: f64, centre: f64) -> Option<RidgePoint> {
        let at = |t: f64| {
            let r = self.at(t, centre)?;
            Some((rise(&self.orientation.normal(&r.wheel, r.surface.around), &r.foot), r))
        };
        let (mut f_low, at_low) = at(low)?;
        let (mut f_high, at_high) = at(high)?;
        if f_low <= 0.0 || f_high > 0.0 {
            return Some(if at_low.depth() > at_high.depth() { at_low } else { at_high });
        }
        let mut best = at_low;
        for step in 0..90 {
            let t = if step % 4 == 3 { 0.5 * (low + high) } else { low + (high - low) * f_low / (f_low - f_high) };
            let (f, r) = at(t)?;
            best = r;
            if f.abs() < 1e-11 || high - low < 1e-10 {
                break;
            }
            if f > 0.0 {
                (low, f_low) = (t, f);
                f_high *= 0.5;
            } else {
                (high, f_high) = (t, f);
                f_low *= 0.5;
            }
        }
        Some(best)
    }

    /// The paper's sweep for one profile point: the greatest overlap over sections D/8 to each side of the wheel.
    fn swept(&self, wheel: &WheelPoint, centre: f64) -> Option<RidgePoint> {
        let at = |x: f64| self.overlap(*wheel, self.orientation.section(wheel, x)?, centre);
        let depth = |x: f64| at(x).map_or(f64::NEG_INFINITY, |r| r.depth());
        let geometry = self.body.wheel.geometry();
        let middle = self.orientation.section_centre(geometry.lateral_position);
        let reach = 0.25 * geometry.nominal_radius;
        let steps = (2.0 * reach / COARSE).ceil() as usize;
        let x = |i: usize| middle - reach + 2.0 * reach * i as f64 / steps as f64;
        let coarse: Vec<f64> = (0..=steps).map(|i| depth(x(i))).collect();
        let best = (0..=steps).max_by(|&i, &j| coarse[i].total_cmp(&coarse[j]))?;
        if best == 0 || best == steps || coarse[best] == f64::NEG_INFINITY {
            return None;
        }
        at(golden(x(best - 1), x(best + 1), 1e-9, depth))
    }

    #[inline]
    fn overlap(&self, wheel: WheelPoint, surface: SurfacePoint, centre: f64) -> Option<RidgePoint> {
        let p = [surface.position[1] + self.lateral, surface.position[2] + centre];
        let Nearness::Near(guess) = self.body.rail.nearness(p) else { return None };
        let foot = self.body.rail.foot(p, guess, 4)?;
        Some(RidgePoint { wheel, surface, foot })
    }

    /// First guess of the centre's height (m) at which the wheel touches, from the vertical gaps at the samples.
    pub(super) fn rough_touching_centre(&self) -> Option<f64> {
        let gap = |s: &Option<([f64; 2], [f64; 2])>| {
            let (p, _) = s.as_ref()?;
            let top = self.body.rail.rough_top(p[0]);
            top.is_finite().then_some(top - p[1])
        };
        self.silhouette.iter().filter_map(gap).min_by(f64::total_cmp)
    }
}

/// Change of overlap along the wheel's profile: t_wheel · n, with n into the rail. Positive while the overlap grows
/// towards the field side.
#[inline]
fn rise(normal: &[f64; 2], foot: &Foot) -> f64 {
    -normal[1] * foot.tangent[1] - normal[0] * foot.tangent[0]
}
