//! The rigid maps: where the wheelset touches both rails without indentation, by interpolation.

use crate::axis::{Axis, AxisPair, Place, Places, index};
use crate::corners::{four_pairs, two_pairs};
use crate::displacement::{Displacement, pose_with};
use crate::header::MAX_PARTS;
use crate::layout::refined;
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

/// The two rigid maps of a side, read in place. Their cells are the records', each interval of an axis divided evenly
/// into as many parts as the refinement says: whoever has found the record's cell has found theirs.
#[derive(Clone, Copy)]
pub struct RigidMaps<'a> {
    plane: AxisPair<'a>,
    roll_offset: Axis<'a>,
    /// Parts of an interval: of lateral and yaw, of roll offset.
    plane_parts: Parts,
    roll_parts: Parts,
    /// Values of the vertical map from one yaw and from one lateral node to the next, of the roll map from one lateral
    /// node to the next.
    row: u32,
    slab: u32,
    roll_row: u32,
    roll: &'a [[u8; 4]],
    vertical: &'a [[u8; 4]],
}

/// Parts that the intervals of two axes are divided into.
#[derive(Clone, Copy)]
struct Parts {
    counts: [u32; 2],
    numbers: [f64; 2],
    /// One less: the last part.
    last: [f64; 2],
}

impl Parts {
    fn new(counts: [u8; 2]) -> Self {
        let numbers = counts.map(f64::from);
        Self { counts: counts.map(u32::from), numbers, last: numbers.map(|n| n - 1.0) }
    }

    /// Cells of the maps and the fractions in them from those of the records, n parts of an interval each:
    ///
    /// ```text
    /// part     = min(floor(n t), n - 1)
    /// cell     = n cell + part
    /// fraction = n t - part
    /// ```
    ///
    /// Exact, since n is a power of two.
    #[inline(always)]
    fn of(&self, [a, b]: [u32; 2], fraction: Two) -> ([u32; 2], Two) {
        let position = fraction * Two::new(self.numbers);
        let ([part_a, part_b], part) = position.at_most(Two::new(self.last)).integer_parts();
        let [n_a, n_b] = self.counts;
        ([n_a * a + part_a, n_b * b + part_b], position - part)
    }
}

impl core::fmt::Debug for RigidMaps<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("RigidMaps").field(&self.roll_offset).finish_non_exhaustive()
    }
}

/// Values of a cell that a checked map does not have.
const NOTHING: &[[u8; 4]; 2] = &[[0; 4]; 2];

/// Two `f32` from their bytes.
#[inline(always)]
fn numbers([low, high]: &[[u8; 4]; 2]) -> Two {
    Two::new([f64::from(f32::from_le_bytes(*low)), f64::from(f32::from_le_bytes(*high))])
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
    /// None yet.
    pub(crate) const EMPTY: Self = Self {
        plane: AxisPair::EMPTY,
        roll_offset: Axis::EMPTY,
        plane_parts: Parts { counts: [0; 2], numbers: [0.0; 2], last: [0.0; 2] },
        roll_parts: Parts { counts: [0; 2], numbers: [0.0; 2], last: [0.0; 2] },
        row: 0,
        slab: 0,
        roll_row: 0,
        roll: &[],
        vertical: &[],
    };

    /// Maps over little-endian `f32`: `roll[lateral][yaw]` in rad and `vertical[lateral][yaw][roll offset]` in m, over
    /// the axes lateral, yaw and roll offset with every interval divided evenly into parts. None if the lengths do not
    /// fit, or an interval has other than 1, 2, 4, 8 or 16 parts.
    #[must_use]
    pub fn new(axes: [Axis<'a>; 3], refinement: [u8; 3], roll: &'a [[u8; 4]], vertical: &'a [[u8; 4]]) -> Option<Self> {
        let [lateral_axis, yaw_axis, roll_offset] = axes;
        let [lateral_parts, yaw_parts, roll_parts] = refinement;
        let lateral = refined(lateral_axis.len(), lateral_parts);
        let (yaws, rolls) = (refined(yaw_axis.len(), yaw_parts), refined(roll_offset.len(), roll_parts));
        let plane = lateral.checked_mul(yaws)?;
        let fits = refinement.iter().all(|parts| parts.is_power_of_two() && *parts <= MAX_PARTS)
            && roll.len() == plane
            && vertical.len() == plane.checked_mul(rolls)?;
        fits.then_some(Self {
            plane: AxisPair::new([lateral_axis, yaw_axis]),
            roll_offset,
            plane_parts: Parts::new([lateral_parts, yaw_parts]),
            roll_parts: Parts::new([roll_parts; 2]),
            row: u32::try_from(rolls).ok()?,
            slab: u32::try_from(yaws.checked_mul(rolls)?).ok()?,
            roll_row: u32::try_from(yaws).ok()?,
            roll,
            vertical,
        })
    }

    /// Places of lateral displacement and yaw on the records' axes.
    #[inline(always)]
    pub(crate) fn plane(&self, lateral: f64, yaw: f64) -> Places {
        self.plane.locate(Two::new([lateral, yaw]))
    }

    /// Place of a roll offset on the records' axis.
    #[inline(always)]
    pub(crate) fn roll_offset(&self, roll_offset: f64) -> Place {
        self.roll_offset.locate(roll_offset)
    }

    #[inline(always)]
    fn in_plane(&self, places: &Places) -> InPlane {
        let ([lateral, yaw], fractions) = self.plane_parts.of(places.cells, places.fraction);
        let [u, psi] = fractions.numbers();
        InPlane { lateral, yaw, u, psi }
    }

    #[inline(always)]
    fn roll_at(&self, at: InPlane) -> f64 {
        let base = at.lateral * self.roll_row + at.yaw;
        let [near, far] = two_pairs(self.roll, base, self.roll_row).unwrap_or([NOTHING; 2]).map(numbers);
        let [a, b] = lerp2(near, far, at.u).numbers();
        lerp(a, b, at.psi)
    }

    #[inline(always)]
    fn vertical_at(&self, at: InPlane, roll_offset: &Place) -> f64 {
        let ([roll, _], fraction) = self.roll_parts.of([index(roll_offset.cell); 2], Two::all(roll_offset.fraction));
        let base = at.lateral * self.slab + at.yaw * self.row + roll;
        let corners = four_pairs(self.vertical, base, [self.slab, self.row]).unwrap_or([NOTHING; 4]);
        let [near, near_next, far, far_next] = corners.map(numbers);
        let [a, b] = lerp2(lerp2(near, far, at.u), lerp2(near_next, far_next, at.u), at.psi).numbers();
        let [fraction, _] = fraction.numbers();
        lerp(a, b, fraction)
    }

    /// Roll at which both wheels touch, rad, bilinear in (u, yaw), clamped to the map.
    #[inline]
    #[must_use]
    pub fn roll(&self, lateral: f64, yaw: f64) -> f64 {
        self.roll_at(self.in_plane(&self.plane(lateral, yaw)))
    }

    /// Vertical displacement w at which this wheel touches, m, trilinear in (u, yaw, roll offset), clamped to the map.
    #[inline]
    #[must_use]
    pub fn vertical(&self, lateral: f64, yaw: f64, roll_offset: f64) -> f64 {
        self.vertical_at(self.in_plane(&self.plane(lateral, yaw)), &self.roll_offset(roll_offset))
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
        self.locate(displacement, yaw, roll).0
    }

    /// [`RigidMaps::coordinates`] with the places found on the way: of lateral and yaw, of the roll offset.
    #[inline(always)]
    pub(crate) fn locate(&self, displacement: &Displacement, yaw: f64, roll: f64) -> (Coordinates, Places, Place) {
        let plane = self.plane(displacement.lateral, yaw);
        let at = self.in_plane(&plane);
        let roll_offset = roll - self.roll_at(at);
        let place = self.roll_offset(roll_offset);
        let vertical = displacement.vertical - self.vertical_at(at, &place);
        (Coordinates { lateral: displacement.lateral, yaw, roll_offset, vertical }, plane, place)
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
