//! Slots and channels of a record, and the scales that turn its integers into numbers.

use core::fmt;

use crate::math::Four;

/// Slots of a record.
pub const SLOTS: usize = 3;
/// Channels of a slot.
pub const CHANNELS: usize = 10;
/// Lanes of a block: a 128-bit vector of `i32` or `f32`.
pub(crate) const BLOCK: usize = 4;
/// Lanes (16-bit integers) of a record.
pub const LANES: usize = 32;
/// The lane that holds the record's conformal share, 0 to 32767: above zero where the solver's policy for a combined
/// curvature that is not positive was applied to one of the record's slots.
pub const CONFORMAL_LANE: usize = 27;
/// The lane that is reserved and zero.
pub const RESERVED_LANE: usize = 31;

/// Region of the wheel profile that a contact lies in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// The tread, above the first slot boundary on the wheel-profile coordinate.
    Tread,
    /// Between tread and flange.
    FlangeRoot,
    /// The flange, below the second slot boundary.
    Flange,
}

impl Slot {
    /// All slots in the order of the record.
    pub const ALL: [Self; SLOTS] = [Self::Tread, Self::FlangeRoot, Self::Flange];

    /// Position in [`Slot::ALL`].
    #[inline]
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for Slot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Tread => "tread",
            Self::FlangeRoot => "flange root",
            Self::Flange => "flange",
        })
    }
}

/// A quantity stored for each slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// Signed indentation delta along the common normal, negative for a gap, m.
    Indentation,
    /// Hertz's C of N = C delta^1.5, N m^-1.5.
    Stiffness,
    /// K of the semi-axis a = K sqrt(delta) along x, m^0.5.
    SemiAxisAlong,
    /// K' of the semi-axis b = K' sqrt(delta) across the rail, m^0.5.
    SemiAxisAcross,
    /// Longitudinal offset e of the contact point from the axle's vertical plane, in the wheelset's frame, m.
    Longitudinal,
    /// Wheel-profile coordinate s of the contact point: lateral distance from the tape circle, positive outwards, m.
    WheelCoordinate,
    /// Rolling radius less the nominal radius, R - r0, m.
    RadiusOffset,
    /// Contact angle, slope of the common tangent dz/dy in the track frame of the right wheel, rad.
    Angle,
    /// Curvature of the wheel profile, 1/m.
    WheelCurvature,
    /// Curvature of the rail profile, 1/m.
    RailCurvature,
}

impl Channel {
    /// All channels in the order of the record.
    pub const ALL: [Self; CHANNELS] = [
        Self::Indentation,
        Self::Stiffness,
        Self::SemiAxisAlong,
        Self::SemiAxisAcross,
        Self::Longitudinal,
        Self::WheelCoordinate,
        Self::RadiusOffset,
        Self::Angle,
        Self::WheelCurvature,
        Self::RailCurvature,
    ];

    /// Position in [`Channel::ALL`].
    #[inline]
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Lane of this channel of a slot: the slots of one of the first eight channels are the first three lanes of its block
    /// of four; the curvatures' are the fourth lanes of the first six blocks. A lookup reads what a vector wrote, whole.
    #[inline]
    #[must_use]
    pub const fn lane(self, slot: Slot) -> usize {
        match self {
            Self::WheelCurvature => BLOCK * slot.index() + SLOTS,
            Self::RailCurvature => BLOCK * (SLOTS + slot.index()) + SLOTS,
            _ => BLOCK * self.index() + slot.index(),
        }
    }

    /// Largest magnitude a scale may give this channel, in its own unit. A table with a wider scale is refused: no
    /// wheel on a rail has such values, so the scale is damaged.
    #[must_use]
    pub const fn limit(self) -> f32 {
        match self {
            Self::Indentation | Self::RadiusOffset => 0.1,
            Self::Stiffness => 1e13,
            Self::SemiAxisAlong | Self::SemiAxisAcross => 100.0,
            Self::Longitudinal => 1.0,
            Self::WheelCoordinate => 0.5,
            Self::Angle => 1.6,
            Self::WheelCurvature | Self::RailCurvature => 1e6,
        }
    }

    /// Name in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Indentation => "indentation",
            Self::Stiffness => "stiffness",
            Self::SemiAxisAlong => "semi-axis along",
            Self::SemiAxisAcross => "semi-axis across",
            Self::Longitudinal => "longitudinal offset",
            Self::WheelCoordinate => "wheel coordinate",
            Self::RadiusOffset => "radius offset",
            Self::Angle => "contact angle",
            Self::WheelCurvature => "wheel curvature",
            Self::RailCurvature => "rail curvature",
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The channels of a wheel's slots, in their units, as the blend leaves them: lane by lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(16))]
pub struct Channels(pub(crate) [f32; LANES]);

impl Channels {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);

    /// A channel of a slot, in the channel's unit.
    #[inline]
    #[must_use]
    pub fn get(&self, slot: Slot, channel: Channel) -> f32 {
        self.0.get(channel.lane(slot)).copied().unwrap_or_default()
    }

    /// All of them, `[slot][channel]`.
    #[inline]
    #[must_use]
    pub fn slots(&self) -> [[f32; CHANNELS]; SLOTS] {
        Slot::ALL.map(|slot| Channel::ALL.map(|channel| self.get(slot, channel)))
    }

    /// Contact angles times a side's sign, four times the same.
    #[inline(always)]
    pub(crate) fn turn_angles(&mut self, sign: Four) {
        if let Some(angles) = self.0.as_chunks_mut::<BLOCK>().0.get_mut(Channel::Angle.index()) {
            *angles = (Four::load(angles) * sign).numbers();
        }
    }
}

/// Affine scale of a channel: value = offset + step q, with q the stored integer or a blend of stored integers.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Scale {
    /// Value at q = 0, in the channel's unit.
    pub offset: f32,
    /// Value of one quantisation step, in the channel's unit; above zero.
    pub step: f32,
}

impl Scale {
    /// offset + step q
    #[inline]
    #[must_use]
    pub fn value(&self, q: f32) -> f32 {
        self.offset + self.step * q
    }
}

/// The scales of a side: `scales[slot][channel]`.
pub type Scales = [[Scale; CHANNELS]; SLOTS];
