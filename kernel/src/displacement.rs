//! From the wheelset's pose to the displacement of one wheel's tape-circle point, and back.

use crate::instructions::{Baseline, Instructions};
use crate::math::{Angle, Two};
use crate::pose::{Pose, WheelGeometry};

/// Displacement of the wheel's tape-circle point at rail level from where it is at pose zero, in the
/// [track frame](crate#frame) of the canonical (right) wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displacement {
    /// u, positive to the right, m.
    pub lateral: f64,
    /// w, positive down, m.
    pub vertical: f64,
}

/// The wheelset's rotation R = Rz(yaw) Rx(roll), by its two angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// Yaw and its functions.
    pub yaw: Angle,
    /// Roll and its functions.
    pub roll: Angle,
}

impl Attitude {
    /// Attitude of a pose; angles beyond [`ANGLE_LIMIT`](crate::ANGLE_LIMIT) are clamped and say so.
    #[inline]
    #[must_use]
    pub fn new(yaw: f64, roll: f64) -> Self {
        let (attitude, _) = Self::by(Baseline, yaw, roll);
        attitude
    }

    /// The same, and in bits 0 and 1 whether yaw and roll were clamped.
    #[inline(always)]
    pub(crate) fn by<I: Instructions>(with: I, yaw: f64, roll: f64) -> (Self, u32) {
        let ([yaw, roll], limited) = Angle::pair(with, Two::new([yaw, roll]));
        (Self { yaw, roll }, limited)
    }

    /// What the rotation alone displaces the tape-circle point by.
    #[inline]
    #[must_use]
    pub fn displacement(&self, geometry: &WheelGeometry) -> Displacement {
        Turned::new(geometry, self).displacement
    }
}

/// Where a rotation alone brings the tape-circle point.
#[derive(Clone, Copy)]
pub(crate) struct Turned {
    pub(crate) displacement: Displacement,
    /// b cos φ - r0 sin φ: how far the point is from the wheelset's centre, in the direction of the axle before roll, m.
    pub(crate) arm: f64,
}

impl Turned {
    /// The tape-circle point is (0, b, r0) in the wheelset's frame and (0, y, z - r0) + R (0, b, r0) in the track
    /// frame. Its displacement from (0, b, 0), with 1 - cos written as the versine v so that nothing cancels:
    ///
    /// ```text
    /// g     = b - (b cos φ - r0 sin φ)       =  b vφ + r0 sin φ
    /// u - y = cos ψ (b cos φ - r0 sin φ) - b = -(g + vψ (b - g))
    /// w - z = b sin φ + r0 cos φ - r0        =  b sin φ - r0 vφ
    /// ```
    #[inline(always)]
    pub(crate) fn new(geometry: &WheelGeometry, attitude: &Attitude) -> Self {
        let (b, r0) = (geometry.lateral_position, geometry.nominal_radius);
        let (psi, phi) = (&attitude.yaw, &attitude.roll);
        let by_b = Two::all(b) * Two::new([phi.versine, phi.sin]);
        let by_r0 = Two::all(r0) * Two::new([phi.sin, phi.versine]);
        // g = b vφ + r0 sin φ
        let ([b_versine, _], [r0_sine, _]) = (by_b.numbers(), by_r0.numbers());
        let inwards = b_versine + r0_sine;
        let arm = b - inwards;
        // b sin φ - r0 vφ
        let [_, vertical] = (by_b - by_r0).numbers();
        let displacement = Displacement {
            // -(g + vψ (b - g))
            lateral: -(inwards + psi.versine * arm),
            vertical,
        };
        Self { displacement, arm }
    }
}

impl Displacement {
    /// Displacement at a canonical pose of this attitude.
    #[inline]
    #[must_use]
    pub fn new(geometry: &WheelGeometry, pose: &Pose, attitude: &Attitude) -> Self {
        Self::of(pose, &attitude.displacement(geometry))
    }

    #[inline(always)]
    pub(crate) fn of(pose: &Pose, turned: &Self) -> Self {
        Self { lateral: pose.lateral + turned.lateral, vertical: pose.vertical + turned.vertical }
    }
}

/// Displacement of the wheel's tape-circle point for a canonical pose (right wheel, yaw >= 0; see
/// [`Pose::canonical`]). Table compilers use this very function.
#[inline]
#[must_use]
pub fn displacement(geometry: &WheelGeometry, pose: &Pose) -> Displacement {
    Displacement::new(geometry, pose, &Attitude::new(pose.yaw, pose.roll))
}

/// The canonical pose with this displacement, yaw and roll: the inverse of [`displacement`].
#[inline]
#[must_use]
pub fn pose_with(geometry: &WheelGeometry, displacement: &Displacement, yaw: f64, roll: f64) -> Pose {
    let turned = Attitude::new(yaw, roll).displacement(geometry);
    Pose {
        lateral: displacement.lateral - turned.lateral,
        yaw,
        vertical: displacement.vertical - turned.vertical,
        roll,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};

    const WHEEL: WheelGeometry = WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 };

    #[test]
    fn agrees_with_rotation_matrices() {
        let mut worst = 0.0_f64;
        for i in -20..=20 {
            for j in -20..=20 {
                let (yaw, roll) = (f64::from(i) * 0.006, f64::from(j) * 0.006);
                let pose = Pose { lateral: 0.004, yaw, vertical: -2e-4, roll };
                let (b, r0) = (WHEEL.lateral_position, WHEEL.nominal_radius);
                let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw)
                    * Rotation3::from_axis_angle(&Vector3::x_axis(), roll);
                let point = Vector3::new(0.0, pose.lateral, pose.vertical - r0) + turn * Vector3::new(0.0, b, r0);
                let d = displacement(&WHEEL, &pose);
                worst = worst.max((d.lateral - (point.y - b)).abs()).max((d.vertical - point.z).abs());
                let back = pose_with(&WHEEL, &d, yaw, roll);
                assert!((back.lateral - pose.lateral).abs() < 1e-16 && (back.vertical - pose.vertical).abs() < 1e-16);
            }
        }
        std::println!("largest difference to rotation matrices: {worst:.1e} m");
        assert!(worst < 1e-15);
    }

    #[test]
    fn small_angles_keep_their_second_order() {
        // At yaw alone u = -b (1 - cos yaw): 1e-9 rad gives 3.75e-19 m, lost where 1 - cos cancels.
        let d = displacement(&WHEEL, &Pose { yaw: 1e-9, ..Pose::default() });
        assert!((d.lateral / -3.75e-19 - 1.0).abs() < 1e-12);
        assert_eq!(d.vertical, 0.0);
    }
}
