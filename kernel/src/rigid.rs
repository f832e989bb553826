//! The rigid map: where the wheelset touches both rails without indentation, by interpolation.

use crate::axis::{Axis, AxisPair, Places};
use crate::corners::two;
use crate::displacement::{Displacement, pose_with};
use crate::header::MAX_PARTS;
use crate::instructions::{Baseline, Instructions, Quads};
use crate::layout::{RIGID, refined, rigid_strides};
use crate::math::{Two, at_least, at_most};
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

/// The rigid map of a side, read in place: the roll at which both wheels touch, and the height at which this one does, a
/// parabola in the roll offset. Its cells are the records', each interval of an axis divided evenly into as many parts as
/// the refinement says: whoever has found the record's cell has found its own.
#[derive(Clone, Copy)]
pub struct RigidMap<'a> {
    plane: AxisPair<'a>,
    /// First and last roll offset, rad.
    roll_offset: [f64; 2],
    parts: Parts,
    /// Bytes from one lateral node to the next and from one yaw node to the next, and two zeros.
    strides: [u32; 4],
    /// A whole number of them.
    nodes: &'a [u8],
}

/// Parts that the intervals of two axes are divided into. Aligned as [`AxisPair`] is.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct Parts {
    numbers: [f64; 2],
    /// One less: the last part.
    last: [f64; 2],
}

impl Parts {
    fn new(counts: [u8; 2]) -> Self {
        let numbers = counts.map(f64::from);
        Self { numbers, last: numbers.map(|n| n - 1.0) }
    }

    /// Parts of the records' cells and the fractions in them from those in the cells, n parts of an interval each:
    ///
    /// ```text
    /// part     = min(floor(n t), n - 1)
    /// fraction = n t - part
    /// ```
    ///
    /// Exact, since n is a power of two. Answers the bytes to the part instead of its numbers.
    #[inline(always)]
    fn of<I: Instructions>(&self, with: I, fraction: Two, bytes: &[u32; 4]) -> (u32, Two) {
        let position = fraction * Two::new(self.numbers);
        let (bytes, whole) = with.integer_parts(position.at_most(Two::new(self.last)), bytes);
        (bytes, position - whole)
    }
}

impl core::fmt::Debug for RigidMap<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("RigidMap")
            .field("bytes", &self.nodes.len())
            .field("strides", &self.strides)
            .finish_non_exhaustive()
    }
}

/// Bytes of a rigid contact as `u32`.
const RIGID_BYTES: u32 = 16;
const _: () = assert!(RIGID_BYTES as usize == RIGID);

/// a + t (b - a)
#[inline(always)]
fn lerp<I: Instructions>(with: I, a: I::Quad, b: I::Quad, t: f64) -> I::Quad {
    a + I::Quad::all(with, t) * (b - a)
}

/// The rigid contact at a lateral displacement and yaw.
#[derive(Clone, Copy)]
struct RigidContact {
    /// Roll at which both wheels touch, rad, and h0, m.
    roll_and_height: Two,
    /// h1, m/rad, and h2, m/rad².
    slopes: Two,
}

impl<'a> RigidMap<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self = Self {
        plane: AxisPair::EMPTY,
        roll_offset: [0.0; 2],
        parts: Parts { numbers: [0.0; 2], last: [0.0; 2] },
        strides: [0; 4],
        nodes: &[],
    };

    /// A map over nodes of four little-endian `f32`, `[lateral][yaw]`: the rigid roll in rad, and h0, h1, h2 of the rigid
    /// height in m, m/rad, m/rad². The axes are lateral, yaw and roll offset; the intervals of the first two are divided
    /// evenly into parts. None if the length or what the axes' bins say does not fit, or an interval has other than 1, 2, 4,
    /// 8 or 16 parts.
    #[must_use]
    pub fn new(axes: [Axis<'a>; 3], refinement: [u8; 2], nodes: &'a [[u8; RIGID]]) -> Option<Self> {
        let [lateral, yaw, roll_offset] = axes;
        let [lateral_parts, yaw_parts] = refinement;
        let (rows, row) = (refined(lateral.len(), lateral_parts), refined(yaw.len(), yaw_parts));
        let strides = rigid_strides(refinement, yaw.len())?;
        let fits = [lateral, yaw].map(|axis| axis.strides().rigid) == strides
            && refinement.iter().all(|parts| parts.is_power_of_two() && *parts <= MAX_PARTS)
            && nodes.len() == rows.checked_mul(row)?;
        fits.then_some(Self {
            plane: AxisPair::new([lateral, yaw]),
            roll_offset: roll_offset.range().into(),
            parts: Parts::new(refinement),
            strides: [u32::try_from(row.checked_mul(RIGID)?).ok()?, RIGID_BYTES, 0, 0],
            nodes: nodes.as_flattened(),
        })
    }

    /// Places of lateral displacement and yaw on the records' axes.
    #[inline(always)]
    pub(crate) fn plane<I: Instructions>(&self, with: I, lateral: f64, yaw: f64) -> Option<Places> {
        self.plane.locate(with, Two::new([lateral, yaw]))
    }

    /// Bilinear between the nodes around a place; every place on a checked map has them.
    #[inline(always)]
    fn contact<I: Instructions>(&self, with: I, places: &Places) -> Option<RigidContact> {
        let (bytes, fractions) = self.parts.of(with, places.fraction, &self.strides);
        let [u, psi] = fractions.numbers();
        let [row, ..] = self.strides;
        let [low, high] = two::<_, { 2 * RIGID }>(self.nodes, places.rigid + bytes, row)?;
        // Not by `map` of arrays, which a build without link-time optimisation may call instead of inlining.
        let ([a, b], [c, d]) = (low.as_chunks().0.first_chunk()?, high.as_chunks().0.first_chunk()?);
        let node = |bytes| I::Quad::of_singles(with, bytes);
        let along = |low, high| lerp(with, node(low), node(high), u);
        let [roll_and_height, slopes] = lerp(with, along(a, c), along(b, d), psi).halves();
        Some(RigidContact { roll_and_height, slopes })
    }

    fn contact_at(&self, lateral: f64, yaw: f64) -> RigidContact {
        let nowhere = RigidContact { roll_and_height: Two::all(0.0), slopes: Two::all(0.0) };
        self.plane(Baseline, lateral, yaw).and_then(|plane| self.contact(Baseline, &plane)).unwrap_or(nowhere)
    }

    /// h1 ρ + h2 ρ² with the roll offset ρ clamped to its axis.
    #[inline(always)]
    fn rise(&self, contact: &RigidContact, roll_offset: f64) -> f64 {
        let ([first, last], [h1, h2]) = (self.roll_offset, contact.slopes.numbers());
        let offset = at_most(at_least(roll_offset, first), last);
        offset * (h1 + offset * h2)
    }

    /// Roll at which both wheels touch, rad, bilinear in (u, yaw), clamped to the map.
    #[inline]
    #[must_use]
    pub fn roll(&self, lateral: f64, yaw: f64) -> f64 {
        let [roll, _] = self.contact_at(lateral, yaw).roll_and_height.numbers();
        roll
    }

    /// Vertical displacement w at which this wheel touches, m, a parabola in the roll offset with coefficients bilinear in
    /// (u, yaw), clamped to the map.
    #[inline]
    #[must_use]
    pub fn vertical(&self, lateral: f64, yaw: f64, roll_offset: f64) -> f64 {
        let contact = self.contact_at(lateral, yaw);
        let [_, height] = contact.roll_and_height.numbers();
        height + self.rise(&contact, roll_offset)
    }

    /// Table coordinates of a displacement, yaw >= 0 and roll:
    ///
    /// ```text
    /// ρ = roll - roll_rigid(u, yaw)                  the roll offset
    /// ζ = w - (h0 + h1 ρ + h2 ρ²)                    with h0, h1, h2 of (u, yaw)
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn coordinates(&self, displacement: &Displacement, yaw: f64, roll: f64) -> Coordinates {
        self.locate(Baseline, displacement, yaw, roll).map_or(Coordinates::default(), |(coordinates, _)| coordinates)
    }

    /// [`RigidMap::coordinates`] with the places of lateral and yaw found on the way.
    #[inline(always)]
    pub(crate) fn locate<I: Instructions>(
        &self,
        with: I,
        displacement: &Displacement,
        yaw: f64,
        roll: f64,
    ) -> Option<(Coordinates, Places)> {
        let plane = self.plane(with, displacement.lateral, yaw)?;
        let contact = self.contact(with, &plane)?;
        let [roll_offset, above] = (Two::new([roll, displacement.vertical]) - contact.roll_and_height).numbers();
        let vertical = above - self.rise(&contact, roll_offset);
        Some((Coordinates { lateral: displacement.lateral, yaw, roll_offset, vertical }, plane))
    }

    /// The canonical pose at table coordinates: the inverse of [`RigidMap::coordinates`]. A compiler samples its
    /// nodes at these poses.
    #[inline]
    #[must_use]
    pub fn pose(&self, geometry: &WheelGeometry, at: &Coordinates) -> Pose {
        let roll = self.roll(at.lateral, at.yaw) + at.roll_offset;
        let vertical = self.vertical(at.lateral, at.yaw, at.roll_offset) + at.vertical;
        pose_with(geometry, &Displacement { lateral: at.lateral, vertical }, at.yaw, roll)
    }
}
