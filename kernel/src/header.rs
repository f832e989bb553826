//! The table's header: what the table is of, how it was made and how good it is.

use serde::{Deserialize, Serialize};

use crate::channel::Scales;
use crate::pose::{Side, WheelGeometry};

/// Nodes and bins of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AxisCounts {
    /// Nodes, at least 2.
    pub nodes: u16,
    /// Bins of its search map, 1 to 4096.
    pub bins: u16,
}

/// Most parts that the rigid maps can divide an interval of an axis into.
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
    /// Parts that the rigid maps divide each interval of the lateral, yaw and roll offset axis into: a power of two,
    /// at most [`MAX_PARTS`].
    pub refinement: [u8; 3],
    /// Measured errors.
    pub errors: ErrorFigures,
    /// The right side.
    #[serde(borrow)]
    pub right: SideHeader<'a>,
    /// The left side, in its own canonical (mirrored) form; none where left is the mirror of right.
    #[serde(borrow)]
    pub left: Option<SideHeader<'a>>,
}

impl<'a> Header<'a> {
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
