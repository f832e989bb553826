//! From the ridge of overlap to the contacts of a wheel: peaks, Hertz's coefficients, shares, slots.
//!
//! A slot is a region of the wheel's profile: tread, flange root, flange. Its indentation is the *signed* greatest
//! overlap in the region, so it stays continuous through contact onset; where that greatest overlap only leans on the
//! region's edge there is no contact, and the coefficient C is zero.
//!
//! **Peaks that share one zone of interpenetration.** With δ_i, δ_j their overlaps, σ the overlap of the saddle
//! between them (positive while they share a zone) and e = δ - σ their height above it, peak i keeps the share
//!
//! ```text
//! w_i = min over j of [1 - (max(σ, 0) / δ_i)² · e_j / (e_i + e_j)]
//! ```
//! Separate zones (σ ≤ 0) keep everything, as in the paper; a peak that drowns in the flank of another (e_i → 0) fades
//! to nothing; two equal peaks are treated alike; a shoulder of another peak takes nothing away that this one does not
//! take already. So the total force is continuous when zones merge, when a peak
//! appears on a flank, and when two peaks change rank.
//!
//! **Curvatures** jump at every junction of arcs of a real profile, and Hertz's force with them. They are therefore
//! averaged over about the width of the contact ([`Curvature::Mean`]), which is continuous, nearer to CONTACT, and
//! positive nearly everywhere; the paper's curvatures at the point ([`Curvature::Local`]) can be asked for.

use super::rail::FAR;
use super::ridge::{Ridge, RidgePoint, Sample};
use super::{Body, Curvature, SLOTS};
use crate::curve::Curve;
use crate::hertz;

/// Indentation (m) that a gap or a lighter contact is taken for where curvatures are averaged.
const LEAST_DEPTH: f64 = 2e-6;

/// The share q of the indentation that the gap reaches at the ends of the averaging width. Measured on the Manchester
/// rows (ARCHITECTURE.md): of 0.01 to 0.5, 0.2 is nearest to CONTACT.
const AVERAGED_SHARE: f64 = 0.2;

/// First shell (m) of the averaging width, and where it ends at the latest.
const FIRST_SHELL: f64 = 0.1e-3;
const WIDEST_AVERAGE: f64 = 5e-3;

/// An edge counts as higher than a peak from this much on (m), well above rounding, well below an indentation.
const LEANING: f64 = 1e-10;

/// One slot of a wheel: what the table stores of it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SlotState {
    /// Signed indentation δ (m): the greatest overlap in the slot's region.
    pub indentation: f64,
    /// C = N / δ^1.5 (N m^-1.5), all shares of the slot's peaks included; 0 where the maximum leans on an edge.
    pub stiffness: f64,
    /// K = semi-axis along x / √δ (m^0.5).
    pub semi_axis_x: f64,
    /// K' = semi-axis across / √δ (m^0.5).
    pub semi_axis_y: f64,
    /// Longitudinal offset R sin τ (m) from the axle's vertical plane, in the wheelset's frame.
    pub longitudinal: f64,
    /// Wheel-profile coordinate s (m).
    pub profile: f64,
    /// Radius at the contact less the nominal radius (m).
    pub radius_offset: f64,
    /// Contact angle (rad): slope of the common tangent in the track frame.
    pub angle: f64,
    /// Curvature of the wheel's profile (1/m), positive where convex.
    pub wheel_curvature: f64,
    /// Curvature of the rail's profile (1/m), positive where convex.
    pub rail_curvature: f64,
    /// Whether the policy for nearly conformal contact took part.
    pub conformal: bool,
    /// Whether anything of the slot's region is near the rail; the rest is filled in where nothing is.
    pub present: bool,
}

impl SlotState {
    /// A slot with nothing near the rail.
    pub const ABSENT: Self = Self {
        indentation: -FAR,
        stiffness: 0.0,
        semi_axis_x: 0.0,
        semi_axis_y: 0.0,
        longitudinal: 0.0,
        profile: 0.0,
        radius_offset: 0.0,
        angle: 0.0,
        wheel_curvature: 0.0,
        rail_curvature: 0.0,
        conformal: false,
        present: false,
    };

    /// Normal force (N): N = C δ^1.5 where δ > 0.
    pub fn normal_force(&self) -> f64 {
        hertz::normal_force(self.stiffness, self.indentation)
    }
}

/// A local maximum of the overlap, with Hertz's coefficients at its own curvatures.
#[derive(Debug, Clone, Copy)]
pub struct Peak {
    /// Where it is.
    pub point: RidgePoint,
    /// The slot's view of this peak alone.
    pub state: SlotState,
    /// Share of its Hertzian force that it keeps beside other peaks of its zone, 0 to 1.
    pub share: f64,
}

impl Peak {
    fn force(&self) -> f64 {
        self.share * self.state.normal_force()
    }
}

/// Principal combined curvatures at a contact, from the curvatures of wheel and rail profile.
struct Combined {
    half_a: f64,
    half_b: f64,
    along_is_long: bool,
    conformal: bool,
}

/// Second derivatives of the gap in the tangent plane, x along the track and y across. The wheel's principal
/// directions are turned by α against them (Johnson 4.1); the rail is straight along x.
///
/// ```text
/// κ_xx = κ_roll cos²α + κ_wheel sin²α,   κ_yy = κ_roll sin²α + κ_wheel cos²α + κ_rail
/// κ_xy = (κ_roll - κ_wheel) sin α cos α,   2 A, 2 B = the eigenvalues
/// ```
fn combine(rolling: f64, wheel: f64, rail: f64, cos2: f64, floor: f64) -> Combined {
    let sin2 = 1.0 - cos2;
    let xx = rolling * cos2 + wheel * sin2;
    let yy = rolling * sin2 + wheel * cos2 + rail;
    let xy2 = (rolling - wheel).powi(2) * cos2 * sin2;
    let (mean, spread) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy2).sqrt());
    let (small, large) = (mean - spread, mean + spread);
    // Policy: a combined curvature that is not positive, or less than the floor, is taken as the floor.
    Combined {
        half_a: 0.5 * small.max(floor),
        half_b: 0.5 * large.max(floor),
        along_is_long: xx <= yy,
        conformal: small < floor,
    }
}

/// Half of the width (m) over which the curvatures of a contact are averaged.
///
/// With Θ(h) the turn of wheel and rail against each other over h to both sides of the contact, Θ / 2h is the mean
/// curvature, and by it the gap at h is to be the share q of the indentation:
///
/// ```text
/// h Θ(h) / 4 = q δ
/// ```
/// Θ is summed over shells of growing width, where it is taken as linear, and only what bends the surfaces apart
/// counts, so that h Θ(h) rises, there is one solution, and it is continuous in the pose.
fn averaging_width(body: &Body, point: &RidgePoint) -> f64 {
    let target = 4.0 * AVERAGED_SHARE * point.depth().max(LEAST_DEPTH);
    let (wheel, rail) = (body.wheel.curve(), body.rail.curve());
    let (mut inner, mut turn, mut outer) = (0.0, 0.0, FIRST_SHELL);
    while inner < WIDEST_AVERAGE {
        let shell = |curve: &Curve, t: f64| curve.turn(t + inner, t + outer) + curve.turn(t - outer, t - inner);
        let gained = (shell(wheel, point.wheel.t) + shell(rail, point.foot.t)).max(0.0);
        if outer * (turn + gained) >= target {
            // h (turn + slope (h - inner)) = target
            let slope = gained / (outer - inner);
            let half = 0.5 * (turn - slope * inner);
            return target / (half + (half * half + slope * target).sqrt());
        }
        turn += gained;
        (inner, outer) = (outer, 1.5 * outer);
    }
    inner
}

/// What one point of the ridge would carry as a contact.
pub(super) fn hertzian(body: &Body, ridge: &Ridge<'_>, point: RidgePoint) -> SlotState {
    let wheel = &point.wheel;
    let rolling = wheel.normal[1] / wheel.radius;
    let along = ridge.orientation().along(point.surface.around);
    let (wheel_curvature, rail_curvature) = match body.settings.curvature {
        Curvature::Local => (wheel.curvature, body.rail.curve().at(point.foot.t).curvature),
        Curvature::Mean => {
            let half = averaging_width(body, &point);
            let mean = |curve: &Curve, t: f64| curve.turn(t - half, t + half) / (2.0 * half);
            (mean(body.wheel.curve(), wheel.t), mean(body.rail.curve(), point.foot.t))
        }
    };
    let combined = combine(rolling, wheel_curvature, rail_curvature, along * along, body.settings.curvature_floor);
    let c = hertz::coefficients(combined.half_a / combined.half_b);
    let size = 1.0 / (combined.half_a + combined.half_b).sqrt();
    let (semi_axis_x, semi_axis_y) = if combined.along_is_long { (c.long, c.short) } else { (c.short, c.long) };
    SlotState {
        indentation: point.depth(),
        stiffness: c.normal * body.contact_modulus * size,
        semi_axis_x: semi_axis_x * size,
        semi_axis_y: semi_axis_y * size,
        longitudinal: wheel.radius * point.surface.around[0],
        profile: wheel.s,
        radius_offset: wheel.radius - body.wheel.geometry().nominal_radius,
        angle: libm::atan2(point.foot.tangent[1], point.foot.tangent[0]),
        wheel_curvature,
        rail_curvature,
        conformal: combined.conformal,
        present: true,
    }
}

/// All peaks of the ridge, flange side first, with their shares.
pub(super) fn peaks(body: &Body, ridge: &Ridge<'_>, centre: f64, samples: &[Sample], by_slope: bool) -> Vec<Peak> {
    let wheel = body.wheel.samples();
    let mut found: Vec<(usize, RidgePoint)> = Vec::new();
    for i in 1..samples.len().saturating_sub(1) {
        let bracket = if by_slope {
            match (samples[i], samples[i + 1]) {
                (Sample::Near { slope: a, .. }, Sample::Near { slope: b, .. }) if a > 0.0 && b <= 0.0 => (i, i + 1),
                _ => continue,
            }
        } else {
            let [a, b, c] = [samples[i - 1], samples[i], samples[i + 1]].map(Sample::depth);
            if a > f64::NEG_INFINITY && c > f64::NEG_INFINITY && b > a && b >= c { (i - 1, i + 1) } else { continue }
        };
        if let Some(point) = ridge.maximum(wheel[bracket.0].t, wheel[bracket.1].t, centre) {
            found.push((i, point));
        }
    }
    let mut peaks: Vec<Peak> =
        found.iter().map(|&(_, point)| Peak { point, state: hertzian(body, ridge, point), share: 1.0 }).collect();
    for i in 0..peaks.len() {
        for j in 0..peaks.len() {
            let (di, dj) = (peaks[i].point.depth(), peaks[j].point.depth());
            if i == j || di <= 0.0 || dj <= 0.0 {
                continue;
            }
            let (from, to) = (found[i.min(j)].0 + 1, found[i.max(j)].0);
            let lowest = samples[from..=to.max(from)].iter().map(|s| s.depth()).fold(f64::INFINITY, f64::min);
            let saddle = lowest.min(di).min(dj).max(0.0);
            let (ei, ej) = (di - saddle, dj - saddle);
            let other = if ei + ej > 0.0 { ej / (ei + ej) } else { 0.5 };
            peaks[i].share = peaks[i].share.min(1.0 - (saddle / di).powi(2) * other);
        }
    }
    peaks
}

/// Gathers the peaks into slots. `samples` are the ridge's samples at the same height.
pub(super) fn gather(
    body: &Body,
    ridge: &Ridge<'_>,
    centre: f64,
    samples: &[Sample],
    peaks: &[Peak],
) -> [SlotState; SLOTS] {
    let mut slots = [SlotState::ABSENT; SLOTS];
    for (slot, state) in slots.iter_mut().enumerate() {
        let (below, above) = body.region(slot);
        let inside = |s: f64| s > below && s <= above;
        let own: Vec<&Peak> = peaks.iter().filter(|p| inside(p.point.wheel.s)).collect();
        let top = own.iter().max_by(|a, b| a.point.depth().total_cmp(&b.point.depth()));
        // The region's edges: its boundaries with its neighbours, and samples beside which the ridge ends.
        let boundary = body.boundary_parameters(slot).into_iter().flatten().filter_map(|t| ridge.at(t, centre));
        let sampled = body.wheel.samples().iter().zip(samples).filter(|(p, _)| inside(p.s));
        let highest = sampled.max_by(|a, b| a.1.depth().total_cmp(&b.1.depth()));
        let sampled = highest.filter(|(_, s)| s.depth() > -FAR).and_then(|(p, _)| ridge.at(p.t, centre));
        let edge = boundary.chain(sampled).max_by(|a, b| a.depth().total_cmp(&b.depth()));
        let leaning = match (top, &edge) {
            (Some(top), Some(edge)) => edge.depth() > top.point.depth() + LEANING,
            (None, Some(_)) => true,
            (_, None) => false,
        };
        if let (true, Some(edge)) = (leaning, edge) {
            *state = SlotState { stiffness: 0.0, ..hertzian(body, ridge, edge) };
        } else if let Some(top) = top {
            *state = top.state;
        } else {
            continue;
        }
        blend(state, &own);
    }
    slots
}

/// Lets the slot stand for all its peaks that carry force: its C gives their summed force at the slot's own
/// indentation, its geometry is their force-weighted mean.
fn blend(state: &mut SlotState, own: &[&Peak]) {
    let total: f64 = own.iter().map(|p| p.force()).sum();
    if total <= 0.0 {
        return;
    }
    let mean = |value: fn(&SlotState) -> f64| own.iter().map(|p| p.force() * value(&p.state)).sum::<f64>() / total;
    let delta = state.indentation;
    *state = SlotState {
        indentation: delta,
        stiffness: total / (delta * delta.sqrt()),
        semi_axis_x: mean(|s| s.semi_axis_x),
        semi_axis_y: mean(|s| s.semi_axis_y),
        longitudinal: mean(|s| s.longitudinal),
        profile: mean(|s| s.profile),
        radius_offset: mean(|s| s.radius_offset),
        angle: mean(|s| s.angle),
        wheel_curvature: mean(|s| s.wheel_curvature),
        rail_curvature: mean(|s| s.rail_curvature),
        conformal: own.iter().any(|p| p.force() > 0.0 && p.state.conformal),
        present: true,
    };
}
