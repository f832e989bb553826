//! Rows across the contact: what lies between a yawed wheel and the rail at given places of the rail's profile.
//!
//! A row runs along the track at one arc length s of the rail's profile. Distances are measured along the rail's own
//! normal there, so where the contact angle turns within a patch the contact "plane" follows the rail's surface.

use super::Body;
use super::ridge::{Ridge, Sample};
use super::wheel::WheelPoint;
use crate::curve::CurvePoint;

/// Steps of the secant method for a point of the wheel over a point of the rail, and the distance (m) it comes to.
const SECANT_STEPS: usize = 8;
const SECANT_TOLERANCE: f64 = 1e-13;

/// A stretch of the rail's profile over which the wheel and the rail overlap without a break.
#[derive(Debug, Clone)]
pub struct Zone {
    /// Rail parameters (m) of its ends.
    pub ends: [f64; 2],
    /// Rail parameter, wheel parameter and overlap (m) of points in it, in order.
    feet: Vec<[f64; 3]>,
}

impl Zone {
    /// First guess of the wheel's parameter over a rail parameter.
    fn wheel_near(&self, s: f64) -> f64 {
        let above = self.feet.partition_point(|foot| foot[0] < s).clamp(1, self.feet.len() - 1);
        let [[s0, t0, _], [s1, t1, _]] = [self.feet[above - 1], self.feet[above]];
        if s1 > s0 { t0 + (t1 - t0) * (s - s0) / (s1 - s0) } else { t0 }
    }
}

/// Rail parameters (m) that cut each zone into strips, `count` of them over all zones and a few more: denser where the
/// overlap is deep, each with the same part of ∫ √w ds.
///
/// They are continuous in the pose: what is left over at the end of a zone is continued in the next, so zones that merge
/// or part change nothing but the strip they meet in, which does not touch because there is no overlap there.
pub(super) fn cuts(zones: &[Zone], count: usize) -> Vec<Vec<f64>> {
    let part = |low: &[f64; 3], high: &[f64; 3]| 0.5 * (low[2].sqrt() + high[2].sqrt()) * (high[0] - low[0]).max(0.0);
    let pairs = |zone: &'_ Zone| zone.feet.windows(2).map(|pair| part(&pair[0], &pair[1])).sum::<f64>();
    let quantum = zones.iter().map(pairs).sum::<f64>() / count as f64;
    let mut filled = 0.0;
    let cut = |zone: &Zone| {
        let mut cuts = vec![zone.ends[0]];
        for pair in zone.feet.windows(2) {
            let part = part(&pair[0], &pair[1]);
            filled += part;
            while filled >= quantum && part > 0.0 {
                filled -= quantum;
                cuts.push(pair[1][0] - (pair[1][0] - pair[0][0]) * (filled / part));
            }
        }
        cuts.push(zone.ends[1]);
        cuts
    };
    zones.iter().map(cut).collect()
}

/// One row: the highest point of the wheel over it.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The rail's point.
    pub rail: CurvePoint,
    /// The wheel's profile point whose overlap is the greatest in the row.
    pub wheel: WheelPoint,
    /// Where along the track it is (m, from the wheelset's centre).
    pub x: f64,
    /// R sin τ (m).
    pub longitudinal: f64,
    /// Greatest overlap in the row (m), along the rail's normal.
    pub overlap: f64,
    /// Half of the curvature along the track (1/m), the profile's share of it the mean over the row's width: the overlap
    /// is about w - A (x - x0)².
    pub half_curvature: f64,
    /// Change of the wheel's place along the rail with its parameter.
    speed: f64,
}

/// All zones of overlap, flange side first.
pub(super) fn zones(body: &Body, ridge: &Ridge<'_>, centre: f64, samples: &[Sample]) -> Vec<Zone> {
    let wheel = body.wheel.samples();
    let mut zones = Vec::new();
    let mut i = 0;
    while i < samples.len() {
        if samples[i].depth() <= 0.0 {
            i += 1;
            continue;
        }
        let first = i;
        while i < samples.len() && samples[i].depth() > 0.0 {
            i += 1;
        }
        // Where the overlap ends between two samples.
        let crossing =
            |inside: usize, outside: Option<usize>| match outside.and_then(|k| samples.get(k).map(|s| (k, s))) {
                Some((k, Sample::Near { depth, .. })) => {
                    let share = samples[inside].depth() / (samples[inside].depth() - depth);
                    wheel[inside].t + share * (wheel[k].t - wheel[inside].t)
                }
                _ => wheel[inside].t,
            };
        let ends = [crossing(first, first.checked_sub(1)), crossing(i - 1, Some(i))];
        let parameters = std::iter::once(ends[0]).chain(wheel[first..i].iter().map(|p| p.t)).chain([ends[1]]);
        let foot = |t: f64| ridge.at(t, centre).map(|point| [point.foot.t, point.wheel.t, point.depth().max(0.0)]);
        let feet: Vec<[f64; 3]> = parameters.filter_map(foot).collect();
        if let [first, .., last] = feet.as_slice() {
            zones.push(Zone { ends: [first[0], last[0]], feet });
        }
    }
    zones
}

/// The row of this width (m) at a rail parameter (m) inside a zone.
pub(super) fn row(body: &Body, ridge: &Ridge<'_>, centre: f64, zone: &Zone, s: f64, width: f64) -> Option<Row> {
    let rail = body.rail.curve().at(s);
    let place = |t: f64| {
        let wheel = body.wheel.at(t);
        let surface = ridge.orientation().silhouette(&wheel)?;
        Some((wheel, surface, from_rail(&rail, [surface.position[1] + ridge.lateral(), surface.position[2] + centre])))
    };
    let start = zone.wheel_near(s);
    let (t, speed) = secant(start, 1.0, |t| place(t).map(|(_, _, [along, _])| along))?;
    let (wheel, surface, [_, overlap]) = place(t)?;
    // Euler: curvature of the wheel along the track. Arcs of a profile meet with a step of curvature, which the row must not
    // feel all at once when its middle crosses it: the mean over the width is how far the profile turns.
    let along2 = ridge.orientation().along(surface.around).powi(2);
    let profile = body.wheel.curve().turn(t - 0.5 * width, t + 0.5 * width) / width;
    let curvature = wheel.normal[1] / wheel.radius * along2 + profile * (1.0 - along2);
    Some(Row {
        rail,
        wheel,
        x: surface.position[0],
        longitudinal: wheel.radius * surface.around[0],
        overlap,
        half_curvature: 0.5 * curvature,
        speed,
    })
}

/// Overlaps (m) of a row with the wheel's true surface at x = `origin` + i `step`, for the i on both sides of the
/// row's own x until the overlap ends: `found` is told i and the overlap.
pub(super) fn along(
    body: &Body,
    ridge: &Ridge<'_>,
    centre: f64,
    row: &Row,
    step: f64,
    mut found: impl FnMut(i64, f64),
) {
    let first = (row.x / step).floor() as i64;
    for (mut i, towards) in [(first, -1), (first + 1, 1)] {
        let (mut t, mut change) = (row.wheel.t, 0.0);
        loop {
            let x = i as f64 * step;
            let place = |t: f64| {
                let (axial, radius) = body.wheel.place(t);
                let [y, z] = ridge.orientation().cut(axial, radius, x)?;
                Some(from_rail(&row.rail, [y + ridge.lateral(), z + centre]))
            };
            // Two steps with the row's speed: what they leave moves the wheel's point along its own tangent, which is
            // nearly the rail's, so the overlap is off by far less than a nanometre.
            let mut t_new = t + change;
            for _ in 0..2 {
                let Some([offset, _]) = place(t_new) else { return };
                t_new -= offset / row.speed;
            }
            let Some([_, overlap]) = place(t_new) else { return };
            change = t_new - t;
            t = t_new;
            if overlap <= 0.0 {
                break;
            }
            found(i, overlap);
            i += towards;
        }
    }
}

/// A point's place along the rail's tangent and its depth along the rail's normal (m).
#[inline]
fn from_rail(rail: &CurvePoint, [y, z]: [f64; 2]) -> [f64; 2] {
    let [ty, tz] = rail.tangent;
    let (dy, dz) = (y - rail.y, z - rail.z);
    [dy * ty + dz * tz, dz * ty - dy * tz]
}

/// Zero of f near `start` by the secant method, and the last slope.
fn secant(start: f64, slope: f64, f: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let (mut t, mut slope) = (start, slope);
    let mut value = f(t)?;
    for _ in 0..SECANT_STEPS {
        let next = t - (value / slope).clamp(-1e-3, 1e-3);
        let at_next = f(next)?;
        if (next - t).abs() > 1e-9 {
            slope = ((at_next - value) / (next - t)).clamp(0.2, 5.0);
        }
        (t, value) = (next, at_next);
        if value.abs() < SECANT_TOLERANCE {
            break;
        }
    }
    Some((t, slope))
}
