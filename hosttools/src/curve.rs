//! A profile as a smooth curve: cubic splines of y and z over arc length, with exact derivatives.
//!
//! Inside a piece the curve is twice continuously differentiable; at a joint (where an analytic profile changes
//! formula, or a measured one has a kink) only the position is shared, so the curvature may jump there as it does on
//! the real S1002. Source: the paper, section 2.1 (cubic splines between points 0.5 to 3 mm apart).

use crate::error::{Error, Result};
use crate::profile::{Profile, ProfileKind};
use crate::spline::{self, Cubic, End};

/// A point of a [`Curve`] with what contact needs of it.
#[derive(Debug, Clone, Copy)]
pub struct CurvePoint {
    /// Arc length from the curve's first point (m).
    pub t: f64,
    /// Lateral coordinate (m), positive to the field side.
    pub y: f64,
    /// Vertical coordinate (m), positive down.
    pub z: f64,
    /// Unit tangent `[y, z]` towards increasing `t`.
    pub tangent: [f64; 2],
    /// Curvature (1/m), positive where the body is convex: rail crown, flange tip.
    pub curvature: f64,
}

/// Position and raw derivatives with respect to the parameter, for Newton steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet {
    pub(crate) position: [f64; 2],
    pub(crate) first: [f64; 2],
    pub(crate) second: [f64; 2],
}

#[derive(Debug, Clone, Copy)]
struct Segment {
    start: f64,
    y: Cubic,
    z: Cubic,
}

/// Piecewise cubic curve over (chordal) arc length.
#[derive(Debug, Clone)]
pub struct Curve {
    segments: Vec<Segment>,
    length: f64,
    /// Index of the segment that holds the start of each of the uniform bins.
    bins: Vec<u32>,
    bins_per_metre: f64,
    /// +1 for a rail, -1 for a wheel: turns the curve's turning rate into convexity.
    convex_sign: f64,
    /// Parameters of the joints.
    joints: Vec<f64>,
    /// Root mean square distance (m) by which smoothing moved the points.
    residual: f64,
}

impl Curve {
    /// Fits a curve to a profile. `smoothing` is the root mean square distance (m) by which the curve may leave the
    /// points; 0 passes through every point.
    ///
    /// # Errors
    /// When the smoothing is negative or not finite, or a piece between two joints has fewer than two points.
    pub fn fit(profile: &Profile, smoothing: f64) -> Result<Self> {
        if !(smoothing.is_finite() && smoothing >= 0.0) {
            return Err(Error::field("", "smoothing_m", format!("{smoothing} is not a distance of zero or more")));
        }
        let points = &profile.points;
        if points.len() < 2 {
            return Err(Error::file(&profile.name, format!("{} points make no curve", points.len())));
        }
        let knots = chord_lengths(points);
        let mut curve = Self {
            segments: Vec::with_capacity(points.len()),
            length: knots[knots.len() - 1],
            bins: Vec::new(),
            bins_per_metre: 0.0,
            convex_sign: if profile.kind == ProfileKind::Rail { 1.0 } else { -1.0 },
            joints: Vec::new(),
            residual: 0.0,
        };
        let mut squares = 0.0;
        let last = points.len() - 1;
        let mut start = (0, None);
        let inner = profile.joints.iter().filter(|j| j.index > 0 && j.index < last);
        let ends = inner.map(|j| (j.index, j.tangent_before, j.tangent_after)).chain([(last, None, None)]);
        for (end, before, after) in ends {
            squares += curve.push_piece(&knots, points, start, (end, before), smoothing);
            if end < last {
                curve.joints.push(knots[end]);
            }
            start = (end, after);
        }
        curve.residual = (squares / points.len() as f64).sqrt();
        curve.index();
        Ok(curve)
    }

    /// Length of the curve (m): its parameter runs from 0 to this.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Parameters (m) of the joints, where the curvature may jump.
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// Root mean square distance (m) between the curve and the profile's points.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// The point at parameter `t` (m), held to the curve's ends.
    pub fn at(&self, t: f64) -> CurvePoint {
        let t = t.clamp(0.0, self.length);
        let Jet { position, first, second } = self.jet(t);
        let speed = (first[0] * first[0] + first[1] * first[1]).sqrt();
        // κ = (y' z'' - z' y'') / |r'|³
        let turning = (first[0] * second[1] - first[1] * second[0]) / (speed * speed * speed);
        CurvePoint {
            t,
            y: position[0],
            z: position[1],
            tangent: [first[0] / speed, first[1] / speed],
            curvature: self.convex_sign * turning,
        }
    }

    /// Angle (rad) by which the tangent turns from one parameter to another, positive where the body is convex.
    pub fn turn(&self, from: f64, to: f64) -> f64 {
        let [a, b] = [from, to].map(|t| self.jet(t.clamp(0.0, self.length)).first);
        self.convex_sign * libm::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
    }

    /// Position and derivatives at `t`, extrapolated by the end segments outside the curve.
    #[inline]
    pub(crate) fn jet(&self, t: f64) -> Jet {
        let s = &self.segments[self.segment(t)];
        let u = t - s.start;
        let eval = |c: &Cubic| {
            (
                c[0] + u * (c[1] + u * (c[2] + u * c[3])),
                c[1] + u * (2.0 * c[2] + u * (3.0 * c[3])),
                2.0 * c[2] + u * (6.0 * c[3]),
            )
        };
        let (y, dy, ddy) = eval(&s.y);
        let (z, dz, ddz) = eval(&s.z);
        Jet { position: [y, z], first: [dy, dz], second: [ddy, ddz] }
    }

    /// Parameter of the first point whose lateral coordinate reaches `y` (m), where the curve spans it.
    pub fn parameter_at_lateral(&self, y: f64) -> Option<f64> {
        let reach = |i: usize| if i < self.segments.len() { self.segments[i].y[0] } else { self.at(self.length).y };
        let i = (0..self.segments.len()).find(|&i| (reach(i) <= y) && (y <= reach(i + 1)))?;
        let (mut low, mut high) = (self.segments[i].start, self.segments.get(i + 1).map_or(self.length, |s| s.start));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.jet(middle).position[0] < y { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    #[inline]
    fn segment(&self, t: f64) -> usize {
        let bin = ((t * self.bins_per_metre).max(0.0) as usize).min(self.bins.len() - 1);
        let mut i = self.bins[bin] as usize;
        while i + 1 < self.segments.len() && self.segments[i + 1].start <= t {
            i += 1;
        }
        i
    }

    fn index(&mut self) {
        let count = 2 * self.segments.len();
        self.bins_per_metre = count as f64 / self.length;
        let mut segment = 0;
        for bin in 0..count {
            let start = bin as f64 / self.bins_per_metre;
            while segment + 1 < self.segments.len() && self.segments[segment + 1].start <= start {
                segment += 1;
            }
            self.bins.push(segment as u32);
        }
    }

    /// Appends the piece between two joints and returns the summed squared distance of its points from it.
    fn push_piece(
        &mut self,
        knots: &[f64],
        points: &[[f64; 2]],
        (from, tangent_from): (usize, Option<[f64; 2]>),
        (to, tangent_to): (usize, Option<[f64; 2]>),
        smoothing: f64,
    ) -> f64 {
        let knots = &knots[from..=to];
        let axis = |k: usize| -> Vec<f64> { points[from..=to].iter().map(|p| p[k]).collect() };
        let (ys, zs) = (axis(0), axis(1));
        let squares;
        let (y, z) = if smoothing > 0.0 && knots.len() > 3 {
            let fit = |penalty: f64| {
                let (fy, y) = spline::smooth(knots, &ys, penalty);
                let (fz, z) = spline::smooth(knots, &zs, penalty);
                let moved = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(p, q)| (p - q).powi(2)).sum::<f64>();
                (moved(&fy, &ys) + moved(&fz, &zs), y, z)
            };
            let allowed = smoothing * smoothing * knots.len() as f64;
            let penalty = penalty_for(allowed, |penalty| fit(penalty).0);
            let (moved, y, z) = fit(penalty);
            squares = moved;
            (y, z)
        } else {
            squares = 0.0;
            let end = |tangent: Option<[f64; 2]>, k: usize| tangent.map_or(End::NotAKnot, |d| End::Slope(d[k]));
            (
                spline::interpolate(knots, &ys, end(tangent_from, 0), end(tangent_to, 0)),
                spline::interpolate(knots, &zs, end(tangent_from, 1), end(tangent_to, 1)),
            )
        };
        self.segments.extend(knots.iter().zip(y).zip(z).map(|((&start, y), z)| Segment { start, y, z }));
        squares
    }
}

fn chord_lengths(points: &[[f64; 2]]) -> Vec<f64> {
    let mut knots = vec![0.0];
    for w in points.windows(2) {
        knots.push(knots[knots.len() - 1] + libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]));
    }
    knots
}

/// The penalty λ whose smoothing spline leaves the points by the allowed sum of squares (monotone in λ): bisection of
/// log λ over all penalties that make sense for lengths in metres.
fn penalty_for(allowed: f64, moved: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-60.0_f64, 20.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if moved(libm::exp(middle)) < allowed { low = middle } else { high = middle }
    }
    libm::exp(low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Joint;

    fn profile(kind: ProfileKind, points: Vec<[f64; 2]>, joints: Vec<Joint>) -> Profile {
        let name = String::from("test");
        Profile { kind, name, points, joints, recognised: vec![], source_hash: [0; 32], smoothing: 0.0 }
    }

    fn arc(radius: f64, from: f64, to: f64, count: usize) -> Vec<[f64; 2]> {
        let angle = |i: usize| from + (to - from) * i as f64 / (count - 1) as f64;
        (0..count).map(|i| [radius * libm::sin(angle(i)), radius * (1.0 - libm::cos(angle(i)))]).collect()
    }

    #[test]
    fn a_circle_has_its_curvature_and_tangent() {
        let rail = Curve::fit(&profile(ProfileKind::Rail, arc(0.08, -0.6, 0.9, 400), vec![]), 0.0).unwrap();
        for i in 1..100 {
            let p = rail.at(rail.length() * f64::from(i) / 100.0);
            assert!((libm::hypot(p.y, p.z - 0.08) - 0.08).abs() < 1e-12);
            assert!((p.curvature * 0.08 - 1.0).abs() < 1e-4, "{}", p.curvature);
            assert!((p.tangent[0] * p.y + p.tangent[1] * (p.z - 0.08)).abs() < 1e-10);
        }
    }

    #[test]
    fn curvature_jumps_at_a_joint_without_ringing() {
        let mut points = arc(0.3, -0.02, 0.0, 30);
        points.pop();
        let index = points.len();
        points.extend(arc(0.013, 0.0, 0.8, 60));
        let tangent = Some([1.0, 0.0]);
        let joints = vec![Joint { index, tangent_before: tangent, tangent_after: tangent }];
        let rail = Curve::fit(&profile(ProfileKind::Rail, points, joints), 0.0).unwrap();
        let joint = rail.joints()[0];
        assert!((rail.at(joint - 1e-5).curvature * 0.3 - 1.0).abs() < 1e-3);
        assert!((rail.at(joint + 1e-5).curvature * 0.013 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn smoothing_leaves_the_points_by_what_was_allowed() {
        let mut points = arc(0.3, -0.1, 0.1, 300);
        for (i, p) in points.iter_mut().enumerate() {
            p[1] += 1e-5 * libm::sin(1e4 * libm::sin(i as f64 * 12.9898));
        }
        let rough = Curve::fit(&profile(ProfileKind::Rail, points.clone(), vec![]), 0.0).unwrap();
        let smooth = Curve::fit(&profile(ProfileKind::Rail, points, vec![]), 7e-6).unwrap();
        let spread = |c: &Curve| {
            (10..90).map(|i| (c.at(c.length() * f64::from(i) / 100.0).curvature * 0.3 - 1.0).abs()).fold(0.0, f64::max)
        };
        assert!((smooth.residual() / 7e-6 - 1.0).abs() < 0.01, "{}", smooth.residual());
        assert!(spread(&rough) > 100.0 && spread(&smooth) < 2.0, "{} {}", spread(&rough), spread(&smooth));
    }

    #[test]
    fn parameter_at_lateral_inverts_the_curve() {
        let rail = Curve::fit(&profile(ProfileKind::Rail, arc(0.08, -0.6, 0.9, 400), vec![]), 0.0).unwrap();
        let t = rail.parameter_at_lateral(0.01).unwrap();
        assert!((rail.at(t).y - 0.01).abs() < 1e-12);
        assert!(rail.parameter_at_lateral(1.0).is_none());
    }
}
