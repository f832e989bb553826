//! The rigid maps: where the wheelset touches both rails without indentation, by interpolation.

use crate::axis::{Axis, AxisPair, index, pair};
use crate::displacement::{Displacement, pose_with};
use crate::math::Two;
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
    plane: AxisPair<'a>,
    roll_offset: Axis<'a>,
    /// Values of the vertical map from one yaw and from one lateral node to the next, of the roll map from one lateral
    /// node to the next.
    row: u32,
    slab: u32,
    roll_row: u32,
    roll: &'a [[u8; 4]],
    vertical: &'a [[u8; 4]],
}

impl core::fmt::Debug for RigidMaps<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("RigidMaps").field(&self.lateral).field(&self.roll_offset).finish_non_exhaustive()
    }
}

/// a + t (b - a)
#[inline(always)]
fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

/// [`lerp`] of two.
#[inline(always)]
fn lerp2(a: Two, b: Two, t: f64) -> Two {
    a + Two::all(t) * (b - a)
}

/// A cell of the maps and the fractions in it.
#[derive(Clone, Copy)]
struct InPlane {
    lateral: u32,
    yaw: u32,
    u: f64,
    psi: f64,
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
        fits.then_some(Self {
            lateral,
            plane: AxisPair::new([lateral, yaw]),
            roll_offset,
            row: u32::try_from(roll_offset.len()).ok()?,
            slab: u32::try_from(yaw.len().checked_mul(roll_offset.len())?).ok()?,
            roll_row: u32::try_from(yaw.len()).ok()?,
            roll,
            vertical,
        })
    }

    #[inline(always)]
    fn in_plane(&self, lateral: f64, yaw: f64) -> InPlane {
        let places = self.plane.locate(Two::new([lateral, yaw]));
        let ([lateral, yaw], [u, psi]) = (places.cells, places.fraction.numbers());
        InPlane { lateral, yaw, u, psi }
    }

    #[inline(always)]
    fn roll_at(&self, at: InPlane) -> f64 {
        let base = at.lateral * self.roll_row + at.yaw;
        let [a, b] = lerp2(pair(self.roll, base), pair(self.roll, base + self.roll_row), at.u).numbers();
        lerp(a, b, at.psi)
    }

    #[inline(always)]
    fn vertical_at(&self, at: InPlane, roll_offset: f64) -> f64 {
        let roll = self.roll_offset.locate(roll_offset);
        let base = at.lateral * self.slab + at.yaw * self.row + index(roll.cell);
        let along = |base| lerp2(pair(self.vertical, base), pair(self.vertical, base + self.slab), at.u);
        let [a, b] = lerp2(along(base), along(base + self.row), at.psi).numbers();
        lerp(a, b, roll.fraction)
    }

    /// Roll at which both wheels touch, rad, bilinear in (u, yaw), clamped to the map.
    #[inline]
    #[must_use]
    pub fn roll(&self, lateral: f64, yaw: f64) -> f64 {
        self.roll_at(self.in_plane(lateral, yaw))
    }

    /// Vertical displacement w at which this wheel touches, m, trilinear in (u, yaw, roll offset), clamped to the map.
    #[inline]
    #[must_use]
    pub fn vertical(&self, lateral: f64, yaw: f64, roll_offset: f64) -> f64 {
        self.vertical_at(self.in_plane(lateral, yaw), roll_offset)
    }

    /// Table coordinates of a displacement, yaw >= 0 and roll:
    ///
    /// ```text
    /// roll offset = roll - roll_rigid(u, yaw)
    /// ζ           = w - w_rigid(u, yaw, roll offset)
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn coordinates(&self, displacement: &Displacement, yaw: f64, roll: f64) -> Coordinates {
        let at = self.in_plane(displacement.lateral, yaw);
        let roll_offset = roll - self.roll_at(at);
        let rigid = self.vertical_at(at, roll_offset);
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
