//! A wheel as a body of revolution, and where a plane across the track cuts or grazes it.
//!
//! A point of the wheel is named by its profile parameter and the angle τ around the axle from the lowest point:
//! `(R sin τ, η, R cos τ)` in the wheelset's frame, η the distance from the wheelset's centre along the axle and
//! R the radius there. With roll ρ, then yaw ψ, the wheelset's frame is turned by Rz(ψ) Rx(ρ).

use crate::curve::{Curve, CurvePoint};
use flangeway::WheelGeometry;

/// Spacing (m) of the profile samples in which contact is searched before it is refined.
pub const SAMPLE_STEP: f64 = 0.25e-3;

/// A point of the wheel's profile in the wheelset's frame.
#[derive(Debug, Clone, Copy)]
pub struct WheelPoint {
    /// Parameter on the profile's curve (m).
    pub t: f64,
    /// Wheel-profile coordinate s (m): lateral, 0 at the tape circle, positive to the field side.
    pub s: f64,
    /// Distance η from the wheelset's centre along the axle (m).
    pub axial: f64,
    /// Radius R about the axle (m).
    pub radius: f64,
    /// Outward unit normal in the plane through the axle: `[along the axle, radial]`.
    pub normal: [f64; 2],
    /// Curvature of the profile (1/m), positive where the wheel is convex.
    pub curvature: f64,
}

/// Roll and yaw of the wheelset, with what the search needs of them.
#[derive(Debug, Clone, Copy)]
pub struct Orientation {
    sin_yaw: f64,
    cos_yaw: f64,
    tan_yaw: f64,
    sin_roll: f64,
    cos_roll: f64,
    slant: f64,
    slant2: f64,
}

/// A point of the wheel's surface in the track frame, of a wheelset whose centre stands at the origin.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePoint {
    /// sin τ and cos τ.
    pub around: [f64; 2],
    /// `[x, y, z]` (m) from the wheelset's centre, axes of the track frame.
    pub position: [f64; 3],
}

impl Orientation {
    /// Orientation from yaw and roll (rad).
    pub fn new(yaw: f64, roll: f64) -> Self {
        let (sin_yaw, cos_yaw) = (libm::sin(yaw), libm::cos(yaw));
        let (sin_roll, cos_roll) = (libm::sin(roll), libm::cos(roll));
        let tan_yaw = sin_yaw / cos_yaw;
        let slant = tan_yaw * sin_roll;
        Self { sin_yaw, cos_yaw, tan_yaw, sin_roll, cos_roll, slant, slant2: 1.0 + slant * slant }
    }

    /// sin τ and cos τ that solve sin τ + B cos τ = c with B = tan ψ sin ρ, on the wheel's lower half.
    #[inline]
    fn around(&self, c: f64) -> Option<[f64; 2]> {
        let root2 = self.slant2 - c * c;
        if root2 <= 0.0 {
            return None;
        }
        let root = root2.sqrt();
        Some([(c - self.slant * root) / self.slant2, (self.slant * c + root) / self.slant2])
    }

    /// The silhouette: where the wheel's normal at this profile point has no component along the track.
    ///
    /// ```text
    /// n = (n_r sin τ, n_a, n_r cos τ);   [Rz(ψ) Rx(ρ) n]_x = 0
    /// sin τ + tan ψ sin ρ cos τ = tan ψ cos ρ n_a / n_r      (ρ = 0: sin τ = -tan ψ dR/dη)
    /// ```
    /// `None` where no such point exists, or where the wheel is hollow along the track there, so that the point is a
    /// least and not a greatest overlap.
    #[inline]
    pub fn silhouette(&self, p: &WheelPoint) -> Option<SurfacePoint> {
        let around = self.around(self.tan_yaw * self.cos_roll * p.normal[0] / p.normal[1])?;
        let along2 = self.along(around).powi(2);
        // Euler: curvature of the wheel along the track, κ_x = κ_roll cos²α + κ_profile sin²α
        let hollow = p.normal[1] / p.radius * along2 + p.curvature * (1.0 - along2) <= 0.0;
        if hollow { None } else { Some(self.place(p, around)) }
    }

    /// Where the plane across the track at `x` (m from the wheelset's centre) cuts the parallel circle of this point.
    #[inline]
    pub fn section(&self, p: &WheelPoint, x: f64) -> Option<SurfacePoint> {
        // x = cos ψ R sin τ - sin ψ (η cos ρ - R cos τ sin ρ)
        let around = self.around((x + self.sin_yaw * p.axial * self.cos_roll) / (self.cos_yaw * p.radius))?;
        Some(self.place(p, around))
    }

    /// As [`Orientation::section`] for a point `axial` along the axle at this radius: `[y, z]` alone.
    #[inline]
    pub fn cut(&self, axial: f64, radius: f64, x: f64) -> Option<[f64; 2]> {
        let [sin, cos] = self.around((x + self.sin_yaw * axial * self.cos_roll) / (self.cos_yaw * radius))?;
        let (forward, down) = (radius * sin, radius * cos);
        let side = axial * self.cos_roll - down * self.sin_roll;
        Some([self.sin_yaw * forward + self.cos_yaw * side, axial * self.sin_roll + down * self.cos_roll])
    }

    /// The x (m, from the wheelset's centre) of the section through the axle at a distance along it.
    pub fn section_centre(&self, axial: f64) -> f64 {
        -self.sin_yaw * axial * self.cos_roll
    }

    /// Cosine of the angle α between the wheel's circumference and the track's x axis at a surface point.
    #[inline]
    pub fn along(&self, [sin, cos]: [f64; 2]) -> f64 {
        self.cos_yaw * cos - self.sin_yaw * sin * self.sin_roll
    }

    /// The wheel's outward normal in the plane across the track, `[y, z]`.
    #[inline]
    pub fn normal(&self, p: &WheelPoint, [sin, cos]: [f64; 2]) -> [f64; 2] {
        let [axial, radial] = p.normal;
        [
            self.sin_yaw * radial * sin + self.cos_yaw * (axial * self.cos_roll - radial * cos * self.sin_roll),
            axial * self.sin_roll + radial * cos * self.cos_roll,
        ]
    }

    #[inline]
    fn place(&self, p: &WheelPoint, around: [f64; 2]) -> SurfacePoint {
        let (forward, down) = (p.radius * around[0], p.radius * around[1]);
        let side = p.axial * self.cos_roll - down * self.sin_roll;
        SurfacePoint {
            around,
            position: [
                self.cos_yaw * forward - self.sin_yaw * side,
                self.sin_yaw * forward + self.cos_yaw * side,
                p.axial * self.sin_roll + down * self.cos_roll,
            ],
        }
    }
}

/// A wheel: its profile's curve, its place on the wheelset, and samples of the part that can touch a rail.
#[derive(Debug, Clone)]
pub struct Wheel {
    curve: Curve,
    geometry: WheelGeometry,
    samples: Vec<WheelPoint>,
}

impl Wheel {
    /// Takes the profile's curve (origin at the tape circle) and samples it where its normal points downwards.
    pub fn new(curve: Curve, geometry: WheelGeometry) -> Self {
        let mut wheel = Self { curve, geometry, samples: Vec::new() };
        let steps = (wheel.curve.length() / SAMPLE_STEP).ceil() as usize;
        // Joints are samples too: no refinement has to cross a jump of curvature.
        let mut parameters: Vec<f64> = (0..=steps).map(|i| wheel.curve.length() * i as f64 / steps as f64).collect();
        parameters.extend_from_slice(wheel.curve.joints());
        parameters.sort_by(f64::total_cmp);
        parameters.dedup_by(|a, b| (*a - *b).abs() < 1e-7);
        wheel.samples =
            parameters.iter().map(|&t| wheel.at(t)).filter(|p| p.normal[1] > 0.05 && p.radius > 0.0).collect();
        wheel
    }

    /// Place on the wheelset.
    pub fn geometry(&self) -> &WheelGeometry {
        &self.geometry
    }

    /// The profile's curve, origin at the tape circle.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// Samples along the profile from flange to field side.
    pub fn samples(&self) -> &[WheelPoint] {
        &self.samples
    }

    /// Distance along the axle and radius (m) of the profile's point at parameter `t` (m).
    #[inline]
    pub fn place(&self, t: f64) -> (f64, f64) {
        let [y, z] = self.curve.jet(t).position;
        (self.geometry.lateral_position + y, self.geometry.nominal_radius + z)
    }

    /// The profile's point at parameter `t` (m).
    #[inline]
    pub fn at(&self, t: f64) -> WheelPoint {
        let CurvePoint { t, y, z, tangent, curvature } = self.curve.at(t);
        WheelPoint {
            t,
            s: y,
            axial: self.geometry.lateral_position + y,
            radius: self.geometry.nominal_radius + z,
            normal: [-tangent[1], tangent[0]],
            curvature,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(axial: f64, radius: f64, slope: f64) -> WheelPoint {
        let norm = libm::hypot(slope, 1.0);
        WheelPoint { t: 0.0, s: 0.0, axial, radius, normal: [-slope / norm, 1.0 / norm], curvature: 0.0 }
    }

    #[test]
    fn the_silhouette_has_no_normal_along_the_track() {
        for (yaw, roll, slope) in [(0.0, 0.0, 0.3), (0.04, 0.0, -2.7), (0.02, -0.011, -0.4), (0.04, 0.01, 0.05)] {
            let o = Orientation::new(yaw, roll);
            let p = point(0.72, 0.46, slope);
            let s = o.silhouette(&p).unwrap();
            let [sin, cos] = s.around;
            assert!((sin * sin + cos * cos - 1.0).abs() < 1e-14);
            // Rotation matrices, written out independently of `place` and `normal`.
            let (n, q) = ([p.normal[1] * sin, p.normal[0], p.normal[1] * cos], [0.46 * sin, 0.72, 0.46 * cos]);
            let turn = |v: [f64; 3]| {
                let (cr, sr, cy, sy) = (libm::cos(roll), libm::sin(roll), libm::cos(yaw), libm::sin(yaw));
                let (y, z) = (v[1] * cr - v[2] * sr, v[1] * sr + v[2] * cr);
                [v[0] * cy - y * sy, v[0] * sy + y * cy, z]
            };
            let (n, q) = (turn(n), turn(q));
            assert!(n[0].abs() < 1e-14);
            let normal = o.normal(&p, s.around);
            assert!((normal[0] - n[1]).abs() < 1e-14 && (normal[1] - n[2]).abs() < 1e-14);
            assert!((0..3).all(|k| (s.position[k] - q[k]).abs() < 1e-14));
            let cut = o.section(&p, s.position[0]).unwrap();
            assert!((0..3).all(|k| (s.position[k] - cut.position[k]).abs() < 1e-12));
            if roll == 0.0 {
                assert!((sin + libm::tan(yaw) * slope).abs() < 1e-14);
            }
        }
    }
}
