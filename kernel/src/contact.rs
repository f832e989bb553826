//! Contacts: what a lookup answers, and how it is rebuilt from the blended channels.

use heapless::Vec;
use nalgebra::Vector3;

use crate::channel::{CHANNELS, SLOTS, Slot};
use crate::displacement::{Attitude, Displacement};
use crate::flags::Flags;
use crate::math::{single, sqrt};
use crate::pose::{Canonical, WheelGeometry};

/// One contact between wheel and rail, in the [track frame](crate#frame).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Region of the wheel profile.
    pub slot: Slot,
    /// Normal force N = C delta^1.5, N.
    pub normal_force: f32,
    /// Indentation delta along the common normal, m.
    pub indentation: f32,
    /// Position of the contact point, m.
    pub position: Vector3<f32>,
    /// Contact angle: slope angle of the common tangent dz/dy, rad; negative on the right rail's gauge side, positive
    /// on the left one's.
    pub angle: f32,
    /// Rolling radius at the contact point, m.
    pub rolling_radius: f32,
    /// Wheel-profile coordinate of the contact point, lateral distance from the tape circle, positive outwards, m.
    pub wheel_coordinate: f32,
    /// Semi-axes of the contact ellipse along x and across, m.
    pub semi_axes: [f32; 2],
    /// Curvature of the wheel profile, 1/m.
    pub wheel_curvature: f32,
    /// Curvature of the rail profile, 1/m.
    pub rail_curvature: f32,
}

impl Contact {
    const NONE: Self = Self {
        slot: Slot::Tread,
        normal_force: 0.0,
        indentation: 0.0,
        position: Vector3::new(0.0, 0.0, 0.0),
        angle: 0.0,
        rolling_radius: 0.0,
        wheel_coordinate: 0.0,
        semi_axes: [0.0; 2],
        wheel_curvature: 0.0,
        rail_curvature: 0.0,
    };

    /// Unit vector of the normal force on the wheel, (0, sin α, -cos α): up, and on the gauge side towards the track's
    /// centre. It has no x component, since the rail is prismatic.
    #[must_use]
    pub fn normal(&self) -> Vector3<f32> {
        Vector3::new(0.0, libm::sinf(self.angle), -libm::cosf(self.angle))
    }

    /// [`Contact::normal`] by micromath's approximations: components within 1.1e-3 of it over all angles (measured by
    /// a test), and not exactly of unit length. For displays and the like; the force itself never uses it.
    #[cfg(feature = "micromath")]
    #[must_use]
    pub fn normal_fast(&self) -> Vector3<f32> {
        let angle = micromath::F32(self.angle);
        Vector3::new(0.0, angle.sin().0, -angle.cos().0)
    }
}

/// The contacts of one wheel.
#[derive(Debug, Clone, PartialEq)]
pub struct Contacts {
    /// Contacts that carry force, in the order of [`Slot::ALL`].
    pub list: Vec<Contact, SLOTS>,
    /// Remarks about the lookup.
    pub flags: Flags,
}

impl Contacts {
    /// The contacts in the order of [`Slot::ALL`].
    pub fn iter(&self) -> core::slice::Iter<'_, Contact> {
        self.list.iter()
    }

    /// Sum of the normal forces' magnitudes, N.
    #[must_use]
    pub fn total_normal_force(&self) -> f32 {
        self.iter().map(|contact| contact.normal_force).sum()
    }

    /// The contact with the largest normal force.
    #[must_use]
    pub fn strongest(&self) -> Option<&Contact> {
        self.iter().reduce(|best, next| if next.normal_force > best.normal_force { next } else { best })
    }
}

impl<'a> IntoIterator for &'a Contacts {
    type Item = &'a Contact;
    type IntoIter = core::slice::Iter<'a, Contact>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// What rebuilding needs beside the channels.
pub(crate) struct Frame<'a> {
    pub(crate) geometry: &'a WheelGeometry,
    pub(crate) canonical: &'a Canonical,
    pub(crate) attitude: &'a Attitude,
    pub(crate) displacement: &'a Displacement,
}

/// The contact of a slot from its channels, mirrored back to the wheel that was asked for.
///
/// Force and ellipse (Johnson, Contact Mechanics, 4.2; the paper's lookup), with δ+ = max(δ, 0):
///
/// ```text
/// N = C δ+^1.5        a = K sqrt(δ+)        b = K' sqrt(δ+)
/// ```
#[inline]
pub(crate) fn rebuild(slot: Slot, channels: &[f32; CHANNELS], frame: &Frame<'_>) -> Contact {
    let [indentation, c, k, k_across, e, s, radius_offset, angle, wheel_curvature, rail_curvature] = *channels;
    let depth = indentation.max(0.0);
    let root = sqrt(depth);
    let rolling_radius = single(frame.geometry.nominal_radius) + radius_offset;
    let (lateral_sign, longitudinal_sign) =
        (single(frame.canonical.lateral_sign), single(frame.canonical.longitudinal_sign));
    let [x, y, z] = position(e, s, radius_offset, rolling_radius, frame);
    Contact {
        slot,
        // N = C δ+ sqrt(δ+)
        normal_force: c.max(0.0) * (depth * root),
        indentation,
        position: Vector3::new(longitudinal_sign * x, lateral_sign * y, z),
        angle: lateral_sign * angle,
        rolling_radius,
        wheel_coordinate: s,
        semi_axes: [k.max(0.0) * root, k_across.max(0.0) * root],
        wheel_curvature,
        rail_curvature,
    }
}

/// Contact point in the track frame of the canonical wheel.
///
/// In the wheelset's frame it is (e, b + s, sqrt(R² - e²)); with h = sqrt(R² - e²) - r0 written without cancellation,
/// and the tape-circle point's place (u + b, w) known from the displacement, the rotation leaves only small terms:
///
/// ```text
/// h  = (R - r0) - e² / (R + sqrt(R² - e²))
/// y' = (b + s) cos φ - (r0 + h) sin φ
/// x  = e cos ψ - y' sin ψ
/// y  = u + b + e sin ψ + cos ψ (s cos φ - h sin φ)
/// z  = w + s sin φ + h cos φ
/// ```
#[inline]
fn position(e: f32, s: f32, radius_offset: f32, radius: f32, frame: &Frame<'_>) -> [f32; 3] {
    let (b, r0) = (frame.geometry.lateral_position, frame.geometry.nominal_radius);
    let (sin_psi, cos_psi) = (single(frame.attitude.yaw.sin), single(frame.attitude.yaw.cos));
    let (sin_phi, cos_phi) = (single(frame.attitude.roll.sin), single(frame.attitude.roll.cos));
    // h = (R - r0) - e² / (R + sqrt(R² - e²))
    let h = radius_offset - e * e / (radius + sqrt(radius * radius - e * e));
    // y' = (b + s) cos φ - (r0 + h) sin φ
    let turned = (single(b) + s) * cos_phi - (single(r0) + h) * sin_phi;
    [
        // x = e cos ψ - y' sin ψ
        e * cos_psi - turned * sin_psi,
        // y = u + b + e sin ψ + cos ψ (s cos φ - h sin φ)
        single(frame.displacement.lateral + b) + (e * sin_psi + cos_psi * (s * cos_phi - h * sin_phi)),
        // z = w + s sin φ + h cos φ
        single(frame.displacement.vertical) + (s * sin_phi + h * cos_phi),
    ]
}

/// The contacts that carry force, the same work for any number of them.
#[inline]
pub(crate) fn select(candidates: [Contact; SLOTS], valid: bool, flags: Flags) -> Contacts {
    let mut list = [Contact::NONE; SLOTS];
    let mut length = 0;
    for candidate in candidates {
        // A contact without force is written too, and overwritten by the next or cut off at the end.
        if let Some(place) = list.get_mut(length) {
            *place = candidate;
        }
        length += usize::from(valid & (candidate.normal_force > 0.0));
    }
    let mut list = Vec::from_array(list);
    list.truncate(length);
    Contacts { list, flags }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted(angle: f32) -> Contact {
        Contact { angle, ..Contact::NONE }
    }

    #[test]
    fn normal_pushes_the_wheel_up_and_inwards() {
        // Right wheel on the gauge side: the angle is negative, inwards is -y.
        let normal = tilted(-1.0).normal();
        assert!(normal.y < 0.0 && normal.z < 0.0);
        for i in -160_i16..=160 {
            let angle = f32::from(i) / 100.0;
            let (normal, tangent) = (tilted(angle).normal(), Vector3::new(0.0, libm::cosf(angle), libm::sinf(angle)));
            assert!((normal.norm() - 1.0).abs() < 2e-7 && normal.dot(&tangent).abs() < 1e-7);
        }
    }

    #[cfg(feature = "micromath")]
    #[test]
    fn fast_normal_over_all_angles() {
        let worst = (-16_000_i16..=16_000)
            .map(|i| tilted(f32::from(i) * 1e-4))
            .map(|contact| (contact.normal_fast() - contact.normal()).amax())
            .fold(0.0, f32::max);
        std::println!("largest error of a component: {worst:.2e}");
        assert!(worst < 1.1e-3);
    }

    #[test]
    fn contacts_without_force_are_left_out() {
        let loaded = |slot, normal_force| Contact { slot, normal_force, ..Contact::NONE };
        for bits in 0..8_u8 {
            let force = |i: u8| if bits >> i & 1 == 1 { 10.0 * f32::from(i + 1) } else { 0.0 };
            let all =
                [loaded(Slot::Tread, force(0)), loaded(Slot::FlangeRoot, force(1)), loaded(Slot::Flange, force(2))];
            let contacts = select(all, true, Flags::NONE);
            assert!(contacts.iter().eq(all.iter().filter(|c| c.normal_force > 0.0)));
            assert_eq!(contacts.total_normal_force(), force(0) + force(1) + force(2));
            // Forces grow with the slot.
            assert_eq!(contacts.strongest().map(|c| c.slot), contacts.iter().last().map(|c| c.slot));
            assert!(select(all, false, Flags::INVALID_INPUT).list.is_empty());
        }
    }
}
