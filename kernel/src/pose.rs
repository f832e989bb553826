//! Poses of the wheelset, the two sides, and the mirror that maps every case to the right wheel with yaw >= 0.

use crate::instructions::{Baseline, Instructions, Quads};
use crate::math::{Quad, Two};

/// Largest magnitude of a pose's coordinate that is taken as a number, m or rad: beyond it, as for NaN and
/// infinity, the lookup answers no contact and [`Flags::INVALID_INPUT`](crate::Flags::INVALID_INPUT).
pub const POSE_LIMIT: f64 = 1000.0;

/// Pose of the wheelset in the [track frame](crate#frame); all zero is the wheelset in the track's centre with its
/// axle at nominal radius above the rail crowns.
///
/// `f64`, because implicit integrators take numerical derivatives with steps of 1e-8 m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Lateral displacement of the wheelset's centre, positive to the right, m.
    pub lateral: f64,
    /// Yaw (angle of attack) about z, positive turns x towards y, rad.
    pub yaw: f64,
    /// Vertical displacement of the wheelset's centre, positive down, m.
    pub vertical: f64,
    /// Roll about x, positive moves the right wheel down, rad; applied before yaw.
    pub roll: f64,
}

/// One of the wheelset's two wheels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// The wheel at positive y.
    Right,
    /// The wheel at negative y.
    Left,
}

impl Side {
    /// Both sides, in the order of a table's sections.
    pub const ALL: [Self; 2] = [Self::Right, Self::Left];

    /// +1 for the right wheel, -1 for the left one.
    #[inline]
    #[must_use]
    pub const fn sign(self) -> f64 {
        1.0 - 2.0 * (self as u8 as f64)
    }
}

impl core::fmt::Display for Side {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Right => "right",
            Self::Left => "left",
        })
    }
}

/// Size and place of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WheelGeometry {
    /// Rolling radius at the tape circle r0, m.
    pub nominal_radius: f64,
    /// Distance b of the wheel profile's origin (its tape circle) from the wheelset's centre, m.
    pub lateral_position: f64,
}

/// A pose mirrored to the canonical case, the right wheel with yaw >= 0, and the signs that mirror an answer back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Canonical {
    /// The mirrored pose, its yaw >= 0.
    pub pose: Pose,
    /// Factor of lateral positions and contact angles: -1 for the left wheel.
    pub lateral_sign: f64,
    /// Factor of longitudinal positions: -1 where the (mirrored) yaw was negative (and a normal number).
    pub longitudinal_sign: f64,
}

impl Pose {
    /// Whether every coordinate is a number within [`POSE_LIMIT`].
    #[inline]
    #[must_use]
    pub fn is_valid(&self) -> bool {
        // A comparison with NaN is false.
        Quad::new([self.lateral, self.yaw, self.vertical, self.roll]).all_within(POSE_LIMIT)
    }

    /// The pose as the right wheel with yaw >= 0 sees it: the mirror at y = 0 turns the signs of lateral, yaw and
    /// roll, the mirror at x = 0 the sign of yaw alone. Sign changes are exact, so mirrored poses give mirrored
    /// answers to the last bit.
    #[inline]
    #[must_use]
    pub fn canonical(&self, side: Side) -> Canonical {
        let (pose, _) = self.mirrored(Baseline, &PoseSigns::new(side));
        Canonical {
            pose: Self { yaw: pose.yaw.abs(), ..pose },
            lateral_sign: side.sign(),
            longitudinal_sign: longitudinal_sign(pose.yaw),
        }
    }

    /// The pose as the right wheel sees it, its yaw of either sign, and whether it is valid.
    #[inline(always)]
    pub(crate) fn mirrored<I: Instructions>(&self, with: I, signs: &PoseSigns) -> (Self, bool) {
        let place = Two::apart(&self.lateral, &self.vertical) * Two::new(signs.place);
        let angles = Two::apart(&self.yaw, &self.roll) * Two::new(signs.angles);
        let ([lateral, vertical], [yaw, roll]) = (place.numbers(), angles.numbers());
        (Self { lateral, yaw, vertical, roll }, I::Quad::join(with, [place, angles]).all_within(POSE_LIMIT))
    }
}

/// -1 for a negative yaw, otherwise 1.
#[inline(always)]
pub(crate) fn longitudinal_sign(yaw: f64) -> f64 {
    // The sum makes -0 positive, and whatever is no normal number.
    1.0_f64.copysign(yaw + f64::MIN_POSITIVE)
}

/// Factors of a pose's coordinates that mirror it to the right wheel.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct PoseSigns {
    /// Of lateral and vertical.
    place: [f64; 2],
    /// Of yaw and roll.
    angles: [f64; 2],
}

impl PoseSigns {
    /// None yet.
    pub(crate) const EMPTY: Self = Self { place: [0.0; 2], angles: [0.0; 2] };

    #[inline(always)]
    pub(crate) const fn new(side: Side) -> Self {
        let sign = side.sign();
        Self { place: [sign, 1.0], angles: [sign; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_backward_is_right_forward() {
        let pose = Pose { lateral: 0.003, yaw: -0.01, vertical: 1e-4, roll: 2e-3 };
        let left = pose.canonical(Side::Left);
        assert_eq!(left.pose, Pose { lateral: -0.003, yaw: 0.01, vertical: 1e-4, roll: -2e-3 });
        assert_eq!((left.lateral_sign, left.longitudinal_sign), (-1.0, 1.0));
        let right = pose.canonical(Side::Right);
        assert_eq!(right.pose, Pose { yaw: 0.01, ..pose });
        assert_eq!((right.lateral_sign, right.longitudinal_sign), (1.0, -1.0));
    }

    #[test]
    fn zero_and_subnormal_yaw_go_forward() {
        for (yaw, sign) in [(0.0, 1.0), (-0.0, 1.0), (-1e-310, 1.0), (-1e-300, -1.0), (1e-300, 1.0), (-0.01, -1.0)] {
            let canonical = Pose { yaw, ..Pose::default() }.canonical(Side::Right);
            assert_eq!((canonical.longitudinal_sign, canonical.pose.yaw), (sign, yaw.abs()), "{yaw}");
        }
    }

    #[test]
    fn invalid_in_any_field() {
        assert!(Pose::default().is_valid());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e4] {
            assert!(!Pose { lateral: bad, ..Pose::default() }.is_valid());
            assert!(!Pose { yaw: bad, ..Pose::default() }.is_valid());
            assert!(!Pose { vertical: bad, ..Pose::default() }.is_valid());
            assert!(!Pose { roll: bad, ..Pose::default() }.is_valid());
        }
    }
}
