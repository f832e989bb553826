//! The table's header: what the table is of, how it was made and how good it is.

use serde::{Deserialize, Serialize};

use crate::channel::{CHANNELS, SLOTS, Scale, Scales};
use crate::pose::{Side, WheelGeometry};

/// Nodes and bins of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AxisCounts {
    /// Nodes, at least 2.
    pub nodes: u16,
    /// Bins, 1 to 4096.
    pub bins: u16,
}

/// Most parts that the rigid map can divide an interval of an axis into.
pub const MAX_PARTS: u8 = 16;

/// Elastic constants of wheel and rail (the same for both).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// Measured errors of the table against the direct solver; zero samples if nobody measured.
///
/// Force error is |N_table - N_direct| / max(N_direct, 5 kN) of the wheel's total over random poses.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ErrorFigures {
    /// Poses sampled.
    pub samples: u32,
    /// Seed of the sampling.
    pub seed: u64,
    /// Root mean square of the force error.
    pub force_rms: f32,
    /// Median of the force error.
    pub force_median: f32,
    /// 95 % quantile of the force error.
    pub force_p95: f32,
    /// 99 % quantile of the force error.
    pub force_p99: f32,
    /// Largest force error.
    pub force_max: f32,
    /// Largest relative change of total force over a step of 10 nm or 10 nrad.
    pub continuity: f32,
}

/// What belongs to one side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SideHeader<'a> {
    /// Name of the wheel profile.
    #[serde(borrow)]
    pub wheel: &'a str,
    /// Name of the rail profile with its inclination.
    #[serde(borrow)]
    pub rail: &'a str,
    /// SHA-256 of the wheel profile's source.
    pub wheel_sha256: [u8; 32],
    /// SHA-256 of the rail profile's source.
    pub rail_sha256: [u8; 32],
    /// Size and place of the wheel.
    pub geometry: WheelGeometry,
    /// Boundaries of the slots on the wheel-profile coordinate s, m: tread above the first, flange below the second.
    pub slot_boundaries: [f32; 2],
    /// Scales of the record's channels, `[slot][channel]`.
    pub scales: Scales,
}

/// The header.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Header<'a> {
    /// Program and version that wrote the table.
    #[serde(borrow)]
    pub generator: &'a str,
    /// The solver and its settings, in words.
    #[serde(borrow)]
    pub solver: &'a str,
    /// SHA-256 of the recipe.
    pub recipe_sha256: [u8; 32],
    /// Track gauge, m.
    pub gauge: f64,
    /// Material of wheels and rails.
    pub material: Material,
    /// Counts of the four axes in the order of [`AxisName::ALL`](crate::AxisName::ALL).
    pub axes: [AxisCounts; 4],
    /// Parts that the rigid map divides each interval of the lateral and yaw axis into: a power of two, at most
    /// [`MAX_PARTS`].
    pub refinement: [u8; 2],
    /// Measured errors.
    pub errors: ErrorFigures,
    /// The right side.
    #[serde(borrow)]
    pub right: SideHeader<'a>,
    /// The left side, in its own canonical (mirrored) form; none where left is the mirror of right.
    #[serde(borrow)]
    pub left: Option<SideHeader<'a>>,
}

impl<'a> SideHeader<'a> {
    /// To decode into.
    pub(crate) const EMPTY: Self = Self {
        wheel: "",
        rail: "",
        wheel_sha256: [0; 32],
        rail_sha256: [0; 32],
        geometry: WheelGeometry { nominal_radius: 0.0, lateral_position: 0.0 },
        slot_boundaries: [0.0; 2],
        scales: [[Scale { offset: 0.0, step: 0.0 }; CHANNELS]; SLOTS],
    };

    #[inline(never)]
    fn decode(&mut self, rest: &mut &'a [u8]) -> Option<()> {
        let Self { wheel, rail, wheel_sha256, rail_sha256, geometry, slot_boundaries, scales } = self;
        take(wheel, rest)?;
        take(rail, rest)?;
        take(wheel_sha256, rest)?;
        take(rail_sha256, rest)?;
        take(geometry, rest)?;
        take(slot_boundaries, rest)?;
        scales.as_flattened_mut().iter_mut().try_for_each(|scale| take(scale, rest))
    }
}

/// Decodes one part from the front of what is left.
#[inline(never)]
fn take<'a, T: Deserialize<'a>>(place: &mut T, rest: &mut &'a [u8]) -> Option<()> {
    (*place, *rest) = postcard::take_from_bytes(rest).ok()?;
    Some(())
}

impl<'a> Header<'a> {
    /// To decode into.
    pub(crate) const EMPTY: Self = Self {
        generator: "",
        solver: "",
        recipe_sha256: [0; 32],
        gauge: 0.0,
        material: Material { young_modulus: 0.0, poisson_ratio: 0.0 },
        axes: [AxisCounts { nodes: 0, bins: 0 }; 4],
        refinement: [0; 2],
        errors: ErrorFigures {
            samples: 0,
            seed: 0,
            force_rms: 0.0,
            force_median: 0.0,
            force_p95: 0.0,
            force_p99: 0.0,
            force_max: 0.0,
            continuity: 0.0,
        },
        right: SideHeader::EMPTY,
        left: None,
    };

    /// Decodes a header in place, part by part, as [`Deserialize`] does as a whole: that would take a stack of several
    /// times its size. None if it is none, or bytes are left.
    #[inline(never)]
    pub(crate) fn decode(&mut self, bytes: &'a [u8]) -> Option<()> {
        let mut rest = bytes;
        let Self { generator, solver, recipe_sha256, gauge, material, axes, refinement, errors, right, left } = self;
        take(generator, &mut rest)?;
        take(solver, &mut rest)?;
        take(recipe_sha256, &mut rest)?;
        take(gauge, &mut rest)?;
        take(material, &mut rest)?;
        take(axes, &mut rest)?;
        take(refinement, &mut rest)?;
        take(errors, &mut rest)?;
        right.decode(&mut rest)?;
        let mut another = false;
        take(&mut another, &mut rest)?;
        if another {
            left.insert(SideHeader::EMPTY).decode(&mut rest)?;
        }
        rest.is_empty().then_some(())
    }

    /// Number of sides with data of their own, 1 or 2.
    #[must_use]
    pub const fn sides(&self) -> usize {
        if self.left.is_some() { 2 } else { 1 }
    }

    /// What applies to a side.
    #[must_use]
    pub fn side(&self, side: Side) -> &SideHeader<'a> {
        match (side, &self.left) {
            (Side::Left, Some(left)) => left,
            _ => &self.right,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of one side and of two, whole and cut off anywhere, the same as by serde.
    #[test]
    fn decoded_in_place_as_by_serde() {
        let mut side = SideHeader { wheel: "S1002", rail: "60E1 1:40", rail_sha256: [7; 32], ..SideHeader::EMPTY };
        side.geometry = WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 };
        side.slot_boundaries = [0.01, -0.02];
        for (i, scale) in (0_u8..).zip(side.scales.as_flattened_mut()) {
            *scale = Scale { offset: f32::from(i), step: 1.0 + f32::from(i) };
        }
        let one = Header {
            generator: "a program",
            solver: "a solver",
            recipe_sha256: [9; 32],
            gauge: 1.435,
            material: Material { young_modulus: 2.1e11, poisson_ratio: 0.28 },
            axes: [AxisCounts { nodes: 300, bins: 4000 }; 4],
            refinement: [4, 2],
            errors: ErrorFigures { samples: 4000, seed: 1 << 40, force_p95: 0.01, ..ErrorFigures::default() },
            right: side,
            left: None,
        };
        for header in [one, Header { left: Some(SideHeader { wheel: "worn", ..side }), ..one }] {
            let mut bytes = [0; 2048];
            let bytes = &*postcard::to_slice(&header, &mut bytes).unwrap();
            for end in 0..=bytes.len() {
                let part = &bytes[..end];
                let mut decoded = Header::EMPTY;
                let decoded = decoded.decode(part).map(|()| decoded);
                assert_eq!(decoded, postcard::from_bytes(part).ok());
                assert_eq!(decoded.is_some(), end == bytes.len());
            }
            let mut decoded = Header::EMPTY;
            assert_eq!(decoded.decode(&[bytes, &[0]].concat()), None);
        }
    }
}
