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
//! w_i = Π_j [1 - max(σ, 0) / δ_i · e_j / (e_i + e_j)]
//! ```
//! Separate zones (σ ≤ 0) keep everything, as in the paper; a peak that drowns in the flank of another (e_i → 0) fades
//! to nothing; two equal peaks are treated alike. So the total force is continuous when zones merge, when a peak
//! appears on a flank, and when two peaks change rank.

use super::rail::FAR;
use super::ridge::{Ridge, RidgePoint, Sample};
use super::{Body, SLOTS};
use crate::hertz;

/// An edge counts as higher than a peak from this much on (m), well above rounding, well below an indentation.
const LEANING: f64 = 1e-10;

/// One slot of a wheel: what the table stores of it.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        let delta = self.indentation.max(0.0);
        self.stiffness * delta * delta.sqrt()
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

/// What one point of the ridge would carry as a contact.
pub(super) fn hertzian(body: &Body, ridge: &Ridge<'_>, point: RidgePoint) -> SlotState {
    let rail_curvature = body.rail.curve().at(point.foot.t).curvature;
    let wheel = &point.wheel;
    // Second derivatives of the gap in the tangent plane: x along the track, y across. The wheel's principal
    // directions are turned by α against them (Johnson 4.1); the rail is straight along x.
    let along = ridge.orientation().along(point.surface.around);
    let (cos2, sin2) = (along * along, 1.0 - along * along);
    let rolling = wheel.normal[1] / wheel.radius;
    let xx = rolling * cos2 + wheel.curvature * sin2;
    let yy = rolling * sin2 + wheel.curvature * cos2 + rail_curvature;
    let xy2 = (rolling - wheel.curvature).powi(2) * cos2 * sin2;
    let (mean, spread) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy2).sqrt());
    let (small, large) = (mean - spread, mean + spread);
    // Policy: a combined curvature that is not positive, or less than the floor, is taken as the floor.
    let floor = body.settings.curvature_floor;
    let conformal = small < floor;
    let (half_a, half_b) = (0.5 * small.max(floor), 0.5 * large.max(floor));
    let c = hertz::coefficients(half_a / half_b);
    let size = 1.0 / (half_a + half_b).sqrt();
    let (semi_axis_x, semi_axis_y) = if xx <= yy { (c.long, c.short) } else { (c.short, c.long) };
    SlotState {
        indentation: point.depth(),
        stiffness: c.normal * body.contact_modulus * size,
        semi_axis_x: semi_axis_x * size,
        semi_axis_y: semi_axis_y * size,
        longitudinal: wheel.radius * point.surface.around[0],
        profile: wheel.s,
        radius_offset: wheel.radius - body.wheel.geometry().nominal_radius,
        angle: libm::atan2(point.foot.tangent[1], point.foot.tangent[0]),
        wheel_curvature: wheel.curvature,
        rail_curvature,
        conformal,
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
            peaks[i].share *= 1.0 - saddle / di * other;
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
