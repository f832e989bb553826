//! Contacts: what a lookup answers, and how it is rebuilt from the blended channels.

use core::sync::atomic::{Ordering, compiler_fence};

use heapless::Vec;
use nalgebra::Vector3;

use crate::channel::{BLOCK, Channels, LANES, SLOTS, Slot};
use crate::displacement::{Attitude, Displacement};
use crate::flags::Flags;
use crate::instructions::{Eight as _, Instructions};
use crate::math::{Four, Quad, single};
use crate::pose::{Side, WheelGeometry};

/// One contact between wheel and rail, in the [track frame](crate#frame).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Contact {
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
    /// Region of the wheel profile.
    pub slot: Slot,
}

impl Contact {
    #[cfg(test)]
    const NONE: Self = Self::new(Slot::Tread, [0.0; 4]);

    /// A contact with its last numbers; the others are to be written.
    #[inline]
    const fn new(slot: Slot, [along, across, wheel_curvature, rail_curvature]: [f32; 4]) -> Self {
        Self {
            normal_force: 0.0,
            indentation: 0.0,
            position: Vector3::new(0.0, 0.0, 0.0),
            angle: 0.0,
            rolling_radius: 0.0,
            wheel_coordinate: 0.0,
            semi_axes: [along, across],
            wheel_curvature,
            rail_curvature,
            slot,
        }
    }

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
    #[inline]
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

    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// Radius of a wheel and the factor of lateral positions that mirrors back, four times. (Contact angles are mirrored by
/// the scales, [`LaneScales::turn_angles`](crate::blend::LaneScales::turn_angles).)
#[derive(Clone, Copy)]
pub(crate) struct Wheel {
    radius: Four,
    pub(crate) lateral_sign: Four,
}

impl Wheel {
    /// None yet.
    pub(crate) const EMPTY: Self = Self { radius: Four::ZERO, lateral_sign: Four::ZERO };

    pub(crate) fn new(geometry: &WheelGeometry, side: Side) -> Self {
        let all = |x: f64| Four::all(single(x));
        Self { radius: all(geometry.nominal_radius), lateral_sign: all(side.sign()) }
    }
}

/// What rebuilding needs of the pose.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// sin ψ, sin φ, cos ψ, cos φ.
    rotation: Four,
    /// u + b and w: where the tape-circle point lies, m; b cos φ - r0 sin φ: how far it is from the wheelset's centre, in the
    /// direction of the axle before roll, m; the factor of longitudinal positions that mirrors back.
    place: Four,
}

impl Frame {
    #[inline(always)]
    pub(crate) fn new(
        geometry: &WheelGeometry,
        attitude: &Attitude,
        displacement: &Displacement,
        arm: f64,
        longitudinal_sign: f64,
    ) -> Self {
        let (psi, phi) = (&attitude.yaw, &attitude.roll);
        let place = [displacement.lateral + geometry.lateral_position, displacement.vertical, arm, longitudinal_sign];
        Self { rotation: Quad::new([psi.sin, phi.sin, psi.cos, phi.cos]).single(), place: Quad::new(place).single() }
    }
}

/// Contacts of the three slots and one that is not used, quantity by quantity.
struct Candidates {
    /// N, δ, x, y, as the first four numbers of a [`Contact`].
    first: [Four; 4],
    /// z, angle, rolling radius, wheel coordinate.
    second: [Four; 4],
    /// Semi-axes, curvatures of wheel and rail.
    third: [Four; 4],
}

/// The slots' contacts from their blended channels, mirrored back to the wheel that was asked for. Each block of lanes
/// holds a channel, see [`Channel::lane`](crate::Channel::lane).
///
/// Force and ellipse (Johnson, Contact Mechanics, 4.2; the paper's lookup), with δ+ = max(δ, 0):
///
/// ```text
/// N = C δ+^1.5        a = K sqrt(δ+)        b = K' sqrt(δ+)
/// ```
#[inline(always)]
fn rebuild(lanes: &Channels, wheel: &Wheel, frame: &Frame) -> Candidates {
    let blocks: &[[f32; BLOCK]; LANES / BLOCK] =
        lanes.0.as_chunks().0.first_chunk().unwrap_or(&[[0.0; BLOCK]; LANES / BLOCK]);
    let [_, _, _, _, e, s, radius_offset, _] = blocks.each_ref().map(Four::load);
    let rolling_radius = wheel.radius + radius_offset;
    let [x, y, z] = position(e, s, radius_offset, rolling_radius, frame);
    let y = wheel.lateral_sign * y;
    // Read again, so that no register holds them meanwhile.
    compiler_fence(Ordering::SeqCst);
    let [indentation, c, k, k_across, e, s, _, angle] = blocks.each_ref().map(Four::load);
    let wheel_curvature = Four::fourths([indentation, c, k]);
    let rail_curvature = Four::fourths([k_across, e, s]);
    let zero = Four::all(0.0);
    let depth = indentation.at_least(zero);
    let root = depth.sqrt();
    // N = C δ+ sqrt(δ+)
    let normal_force = c.at_least(zero) * (depth * root);
    Candidates {
        first: [normal_force, indentation, x, y],
        second: [z, angle, rolling_radius, s],
        third: [k.at_least(zero) * root, k_across.at_least(zero) * root, wheel_curvature, rail_curvature],
    }
}

/// Contact point in the track frame of the canonical wheel, x mirrored back.
///
/// In the wheelset's frame it is (e, b + s, sqrt(R² - e²)); with h = sqrt(R² - e²) - r0 written without cancellation,
/// and the tape-circle point's place (u + b, w) known from the displacement, the rotation leaves only small terms:
///
/// ```text
/// h  = (R - r0) - e² / (R + sqrt(R² - e²))
/// k  = s cos φ - h sin φ
/// x  = e cos ψ - (b cos φ - r0 sin φ + k) sin ψ
/// y  = u + b + e sin ψ + k cos ψ
/// z  = w + s sin φ + h cos φ
/// ```
#[inline(always)]
fn position(e: Four, s: Four, radius_offset: Four, radius: Four, frame: &Frame) -> [Four; 3] {
    let [sin_psi, sin_phi, cos_psi, cos_phi] = frame.rotation.spread();
    let [place_y, place_z, arm, sign] = frame.place.spread();
    // e and ψ with their signs before the mirror at x = 0: y, and what is squared, are the same with both signs turned.
    let e = sign * e;
    // h = (R - r0) - e² / (R + sqrt(R² - e²))
    let e_squared = e * e;
    let h = radius_offset - e_squared / (radius + (radius * radius - e_squared).at_least(Four::all(0.0)).sqrt());
    // k = s cos φ - h sin φ
    let k = s * cos_phi - h * sin_phi;
    [
        // x = e cos ψ - (b cos φ - r0 sin φ + k) sin ψ
        e * cos_psi - (arm + k) * sin_psi,
        // y = u + b + e sin ψ + k cos ψ
        place_y + (e * sin_psi + k * cos_psi),
        // z = w + s sin φ + h cos φ
        place_z + (s * sin_phi + h * cos_phi),
    ]
}

impl Contacts {
    /// None, without remarks.
    pub const NONE: Self = Self { list: Vec::new(), flags: Flags::NONE };

    /// Takes the slots' contacts that carry force, none if not `valid`; the same work for any number of them. Returns
    /// whether there is any.
    #[inline(always)]
    pub(crate) fn fill<I: Instructions>(
        &mut self,
        with: I,
        lanes: &Channels,
        wheel: &Wheel,
        frame: &Frame,
        valid: bool,
    ) -> bool {
        let candidates = rebuild(lanes, wheel, frame);
        let carries = candidates.first[0].above_zero() & usize::from(valid).wrapping_neg();
        let (eight, four) = (with.transposed([candidates.first, candidates.second]), Four::transpose(candidates.third));
        self.list.clear();
        let mut length = 0;
        for ((slot, eight), four) in Slot::ALL.into_iter().zip(eight).zip(four) {
            let mut contact = Contact::new(slot, four.numbers());
            eight.write(&mut contact);
            // There is room for as many as there are slots. A contact without force is written too, and taken back.
            let _ = self.list.push(contact);
            length += carries >> slot.index() & 1;
            self.list.truncate(length);
        }
        length > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channel::Channel;
    use crate::instructions::Baseline;

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
        let geometry = WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 };
        let (wheel, attitude) = (Wheel::new(&geometry, Side::Right), Attitude::new(0.0, 0.0));
        let frame = Frame::new(&geometry, &attitude, &Displacement::default(), 0.75, 1.0);
        for bits in 0..8_usize {
            let mut lanes = Channels::ZERO;
            let carrying = || Slot::ALL.into_iter().filter(|slot| bits >> slot.index() & 1 == 1);
            for slot in Slot::ALL {
                lanes.0[Channel::Stiffness.lane(slot)] = [1e10, 2e10, 3e10][slot.index()];
                lanes.0[Channel::Indentation.lane(slot)] = if bits >> slot.index() & 1 == 1 { 1e-4 } else { -1e-4 };
            }
            let mut contacts = Contacts::NONE;
            assert_eq!(contacts.fill(Baseline, &lanes, &wheel, &frame, true), bits != 0);
            assert!(contacts.iter().map(|contact| contact.slot).eq(carrying()));
            assert_eq!(contacts.total_normal_force(), contacts.iter().map(|c| c.normal_force).sum::<f32>());
            // Forces grow with the slot.
            assert_eq!(contacts.strongest().map(|c| c.slot), carrying().next_back());
            assert!(!contacts.fill(Baseline, &lanes, &wheel, &frame, false) && contacts.list.is_empty());
        }
    }
}
