//! The rigid maps: where the wheelset touches both rails without indentation, by interpolation.

use crate::axis::{Axis, Place};
use crate::displacement::{Displacement, pose_with};
use crate::pose::{Pose, WheelGeometry};

/// Coordinates of a canonical pose in the table.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coordinates {
    /// Lateral displacement u of the tape-circle point, m.
    pub lateral: f64,
    /// Yaw, >= 0, rad.
    pub yaw: f64,
    /// Roll less the rigid roll at (u, yaw), rad.
    pub roll_offset: f64,
    /// zeta: vertical displacement w of the tape-circle point less the rigid one at (u, yaw, roll offset), m;
    /// positive presses the wheel into the rail.
    pub vertical: f64,
}

/// The two rigid maps of a side, read in place.
#[derive(Clone, Copy)]
pub struct RigidMaps<'a> {
    lateral: Axis<'a>,
    yaw: Axis<'a>,
    roll_offset: Axis<'a>,
    roll: &'a [[u8; 4]],
    vertical: &'a [[u8; 4]],
}

impl core::fmt::Debug for RigidMaps<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("RigidMaps").field(&self.lateral).field(&self.yaw).field(&self.roll_offset).finish()
    }
}

/// a + t (b - a)
#[inline]
fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

impl<'a> RigidMaps<'a> {
    /// Maps over little-endian `f32`: `roll[lateral][yaw]` in rad and `vertical[lateral][yaw][roll offset]` in m.
    /// None if the lengths do not fit the axes.
    #[must_use]
    pub fn new(
        lateral: Axis<'a>,
        yaw: Axis<'a>,
        roll_offset: Axis<'a>,
        roll: &'a [[u8; 4]],
        vertical: &'a [[u8; 4]],
    ) -> Option<Self> {
        let plane = lateral.len().checked_mul(yaw.len())?;
        let fits = roll.len() == plane && vertical.len() == plane.checked_mul(roll_offset.len())?;
        fits.then_some(Self { lateral, yaw, roll_offset, roll, vertical })
    }

    #[inline]
    fn at(map: &[[u8; 4]], index: usize) -> f64 {
        f64::from(f32::from_le_bytes(map.get(index).copied().unwrap_or_default()))
    }

    #[inline]
    fn roll_at(&self, u: &Place, yaw: &Place) -> f64 {
        let row = |i: usize| {
            let base = i * self.yaw.len() + yaw.cell;
            lerp(Self::at(self.roll, base), Self::at(self.roll, base + 1), yaw.fraction)
        };
        lerp(row(u.cell), row(u.cell + 1), u.fraction)
    }

    #[inline]
    fn vertical_at(&self, u: &Place, yaw: &Place, roll: &Place) -> f64 {
        let edge = |i: usize, j: usize| {
            let base = (i * self.yaw.len() + j) * self.roll_offset.len() + roll.cell;
            lerp(Self::at(self.vertical, base), Self::at(self.vertical, base + 1), roll.fraction)
        };
        let face = |i: usize| lerp(edge(i, yaw.cell), edge(i, yaw.cell + 1), yaw.fraction);
        lerp(face(u.cell), face(u.cell + 1), u.fraction)
    }

    /// Roll at which both wheels touch, rad, bilinear in (u, yaw), clamped to the map.
    #[inline]
    #[must_use]
    pub fn roll(&self, lateral: f64, yaw: f64) -> f64 {
        self.roll_at(&self.lateral.locate(lateral), &self.yaw.locate(yaw))
    }

    /// Vertical displacement w at which this wheel touches, m, trilinear in (u, yaw, roll offset), clamped to the map.
    #[inline]
    #[must_use]
    pub fn vertical(&self, lateral: f64, yaw: f64, roll_offset: f64) -> f64 {
        self.vertical_at(&self.lateral.locate(lateral), &self.yaw.locate(yaw), &self.roll_offset.locate(roll_offset))
    }

    /// Table coordinates of a displacement, yaw >= 0 and roll:
    ///
    /// ```text
    /// roll offset = roll - roll_rigid(u, yaw)
    /// ζ           = w - w_rigid(u, yaw, roll offset)
    /// ```
    #[inline]
    #[must_use]
    pub fn coordinates(&self, displacement: &Displacement, yaw: f64, roll: f64) -> Coordinates {
        let lateral = self.lateral.locate(displacement.lateral);
        let at_yaw = self.yaw.locate(yaw);
        let roll_offset = roll - self.roll_at(&lateral, &at_yaw);
        let rigid = self.vertical_at(&lateral, &at_yaw, &self.roll_offset.locate(roll_offset));
        Coordinates { lateral: displacement.lateral, yaw, roll_offset, vertical: displacement.vertical - rigid }
    }

    /// The canonical pose at table coordinates: the inverse of [`RigidMaps::coordinates`]. A compiler samples its
    /// nodes at these poses.
    #[inline]
    #[must_use]
    pub fn pose(&self, geometry: &WheelGeometry, at: &Coordinates) -> Pose {
        let roll = self.roll(at.lateral, at.yaw) + at.roll_offset;
        let vertical = self.vertical(at.lateral, at.yaw, at.roll_offset) + at.vertical;
        pose_with(geometry, &Displacement { lateral: at.lateral, vertical }, at.yaw, roll)
    }
}
