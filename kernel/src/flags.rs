//! What a lookup says about its input beside the contacts.

use core::fmt;
use core::ops::{BitOr, BitOrAssign};

/// A set of remarks about a lookup; empty when the pose lay inside the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Flags(u8);

impl Flags {
    /// No remark.
    pub const NONE: Self = Self(0);
    /// The lateral displacement lies outside the table: the records at its edge answer.
    pub const CLAMPED_LATERAL: Self = Self(1);
    /// The yaw lies outside the table: the records at its edge answer.
    pub const CLAMPED_YAW: Self = Self(1 << 1);
    /// The roll lies outside the table. Little is lost: the displacement of the wheel by roll is exact, only the
    /// small rotation of its profile is that of the table's edge.
    pub const CLAMPED_ROLL: Self = Self(1 << 2);
    /// The vertical coordinate lies outside the table: the indentation (and so force and ellipse) is extrapolated
    /// linearly, everything else is that of the table's edge.
    pub const CLAMPED_VERTICAL: Self = Self(1 << 3);
    /// Yaw or roll is larger than [`ANGLE_LIMIT`](crate::ANGLE_LIMIT): the answer is that of the limit.
    pub const ANGLE_LIMITED: Self = Self(1 << 4);
    /// A coordinate of the pose is NaN, infinite or beyond [`POSE_LIMIT`](crate::POSE_LIMIT): there are no contacts.
    pub const INVALID_INPUT: Self = Self(1 << 5);
    /// There is force, and one of the records behind it used the solver's policy for a combined curvature that is
    /// not positive (wheel and rail nearly conformal): ellipse and stiffness are the policy's, not Hertz's.
    pub const CONFORMAL: Self = Self(1 << 6);

    const NAMES: [(Self, &'static str); 7] = [
        (Self::CLAMPED_LATERAL, "clamped-lateral"),
        (Self::CLAMPED_YAW, "clamped-yaw"),
        (Self::CLAMPED_ROLL, "clamped-roll"),
        (Self::CLAMPED_VERTICAL, "clamped-vertical"),
        (Self::ANGLE_LIMITED, "angle-limited"),
        (Self::INVALID_INPUT, "invalid-input"),
        (Self::CONFORMAL, "conformal"),
    ];

    /// Whether there is no remark.
    #[inline]
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether all of `other` are set.
    #[inline]
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The bits, bit 0 for [`Flags::CLAMPED_LATERAL`] and on in the order above.
    #[inline]
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// The flags with these [`Flags::bits`]; bits without a meaning are left out.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u8) -> Self {
        Self(bits & 0x7f)
    }

    /// Remarks about a pose: bit i of `axes` for axis i of the records, any of two bits for angles that are limited; those
    /// of an invalid pose say nothing.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "bits of flags")]
    pub(crate) const fn of_pose(axes: u32, limited_angles: u32, valid: bool) -> Self {
        const ANGLE: u32 = Flags::ANGLE_LIMITED.0 as u32;
        // 0 stays below the flag's bit, 1 to 3 do not.
        let remarks = axes | ((limited_angles + (ANGLE - 1)) & ANGLE);
        Self(if valid { remarks } else { Self::INVALID_INPUT.0 as u32 } as u8)
    }

    /// These flags where `condition` holds, none otherwise; without a branch.
    #[inline]
    pub(crate) const fn when(self, condition: bool) -> Self {
        Self(self.0 & (condition as u8).wrapping_neg())
    }
}

impl BitOr for Flags {
    type Output = Self;
    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Flags {
    #[inline]
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl fmt::Display for Flags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        let mut separator = "";
        for (_, name) in Self::NAMES.iter().filter(|(flag, _)| self.contains(*flag)) {
            write!(f, "{separator}{name}")?;
            separator = ", ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn remarks_about_a_pose() {
        for axes in 0..16_u8 {
            for limited in 0..4 {
                let flags = Flags::of_pose(axes.into(), limited, true);
                let angle = Flags::ANGLE_LIMITED.when(limited != 0);
                assert_eq!(flags, Flags::from_bits(axes) | angle);
                assert_eq!(Flags::of_pose(axes.into(), limited, false), Flags::INVALID_INPUT);
            }
        }
    }

    #[test]
    fn lists_names() {
        assert_eq!(Flags::NONE.to_string(), "none");
        assert_eq!((Flags::CLAMPED_YAW | Flags::CONFORMAL).to_string(), "clamped-yaw, conformal");
        assert_eq!(Flags::CLAMPED_YAW.when(false), Flags::NONE);
        assert_eq!(Flags::CLAMPED_YAW.when(true), Flags::CLAMPED_YAW);
    }
}
