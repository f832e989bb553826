//! Structs of the header, and how they become the kernel's.

use core::mem::offset_of;

use flangeway::creep::{CreepForces, Creepages, Elasticity, Friction, Patch};
use flangeway::wheelset::{self, Rates};
use flangeway::{Contact, Contacts, Flags, SLOTS, Side, Slot};

use crate::status::Status;

/// Slots of a wheel profile: the most contacts that a wheel can have.
pub const FLANGEWAY_SLOTS: usize = 3;

/// A wheel of the wheelset.
#[repr(i32)]
pub enum WheelSide {
    /// The wheel at positive y.
    Right = 0,
    /// The wheel at negative y.
    Left = 1,
}

/// Region of the wheel profile.
#[repr(i32)]
pub enum WheelSlot {
    /// The tread.
    Tread = 0,
    /// Between tread and flange.
    FlangeRoot = 1,
    /// The flange.
    Flange = 2,
}

/// How creep forces follow from creepages.
#[repr(i32)]
pub enum CreepLaw {
    /// Kalker's linear theory, without a limit.
    Kalker = 0,
    /// Kalker's linear theory with the saturation of Shen, Hedrick and Elkins.
    ShenHedrickElkins = 1,
    /// Polach's closed form.
    Polach = 2,
    /// FASTSIM on 10 by 10 elements.
    Fastsim10 = 3,
    /// FASTSIM on 20 by 20 elements.
    Fastsim20 = 4,
}

/// Bits of `flags`.
#[repr(u32)]
pub enum LookupFlag {
    /// The lateral displacement lies outside the table: its edge answers.
    ClampedLateral = 1,
    /// The yaw lies outside the table: its edge answers.
    ClampedYaw = 2,
    /// The roll lies outside the table; little is lost.
    ClampedRoll = 4,
    /// The vertical coordinate lies outside the table: the indentation is extrapolated.
    ClampedVertical = 8,
    /// Yaw or roll is beyond 0.125 rad: the answer is that of the limit.
    AngleLimited = 16,
    /// A coordinate of the pose is NaN, infinite or beyond 1000: there are no contacts.
    InvalidInput = 32,
    /// Wheel and rail are nearly conformal somewhere: ellipse and stiffness follow the solver's policy.
    Conformal = 64,
}

// The header's bits are the kernel's.
const _: () = assert!(
    Flags::CLAMPED_LATERAL.bits() as u32 == LookupFlag::ClampedLateral as u32
        && Flags::CLAMPED_YAW.bits() as u32 == LookupFlag::ClampedYaw as u32
        && Flags::CLAMPED_ROLL.bits() as u32 == LookupFlag::ClampedRoll as u32
        && Flags::CLAMPED_VERTICAL.bits() as u32 == LookupFlag::ClampedVertical as u32
        && Flags::ANGLE_LIMITED.bits() as u32 == LookupFlag::AngleLimited as u32
        && Flags::INVALID_INPUT.bits() as u32 == LookupFlag::InvalidInput as u32
        && Flags::CONFORMAL.bits() as u32 == LookupFlag::Conformal as u32
        && SLOTS == FLANGEWAY_SLOTS
);

/// Pose of the wheelset in the track frame; all zero is centred with the axle at nominal radius above the rails.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Pose {
    /// Lateral displacement, positive to the right, m.
    pub lateral: f64,
    /// Yaw (angle of attack) about z, positive turns x towards y, rad.
    pub yaw: f64,
    /// Vertical displacement, positive down, m.
    pub vertical: f64,
    /// Roll about x, positive moves the right wheel down, rad; applied before yaw.
    pub roll: f64,
}

/// A wheel to look up.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Wheel {
    /// Pose of its wheelset.
    pub pose: Pose,
    /// A `flangeway_side`.
    pub side: i32,
    /// Not used; there so that the size is the same everywhere.
    pub reserved: i32,
}

/// One contact between wheel and rail, in the track frame.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ContactPoint {
    /// Normal force, N.
    pub normal_force: f32,
    /// Indentation along the common normal, m.
    pub indentation: f32,
    /// Contact point x, y, z, m.
    pub position: [f32; 3],
    /// Contact angle: slope angle dz/dy of the common tangent, rad; negative on the right rail's gauge side.
    pub angle: f32,
    /// Rolling radius, m.
    pub rolling_radius: f32,
    /// Wheel-profile coordinate: lateral distance from the tape circle, positive outwards, m.
    pub wheel_coordinate: f32,
    /// Semi-axes of the contact ellipse along x and across, m.
    pub semi_axes: [f32; 2],
    /// Curvature of the wheel profile, 1/m.
    pub wheel_curvature: f32,
    /// Curvature of the rail profile, 1/m.
    pub rail_curvature: f32,
    /// Region of the wheel profile, a `flangeway_slot`.
    pub slot: i32,
}

/// Contacts of one wheel: those that carry force, in the order of their slots.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct WheelContacts {
    /// The first `count` are contacts, the others all zero.
    pub contact: [ContactPoint; FLANGEWAY_SLOTS],
    /// Contacts, 0 to 3.
    pub count: i32,
    /// Remarks about the lookup, bits of `flangeway_flag`.
    pub flags: u32,
}

/// Motion of the wheelset as far as its contacts move by it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Motion {
    /// Pose in the track frame.
    pub pose: Pose,
    /// Rates of the pose, seen in the track frame that moves along: m/s, rad/s.
    pub rates: Pose,
    /// Speed along the track, forward, m/s.
    pub speed: f64,
    /// Angular speed about the axle, positive when rolling forward, rad/s; speed / nominal radius when free.
    pub spin: f64,
    /// Curvature of the track, positive in a right-hand curve, 1/m.
    pub track_curvature: f64,
}

/// A contact's ellipse and normal force, as the creep laws take it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ContactPatch {
    /// Semi-axes along x and across, m.
    pub semi_axes: [f32; 2],
    /// Normal force, N.
    pub normal_force: f32,
}

/// Elastic constants of wheel and rail.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Elastic {
    /// Shear modulus, Pa.
    pub shear_modulus: f32,
    /// Poisson's ratio.
    pub poisson_ratio: f32,
}

/// Friction that may fall with slip velocity w (m/s): coefficient ((1 - limit_ratio) exp(-decay w) + limit_ratio).
/// Coulomb's constant friction has limit_ratio 1 and decay 0.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct FrictionLaw {
    /// Coefficient without slip.
    pub coefficient: f32,
    /// Coefficient at infinite slip over that without.
    pub limit_ratio: f32,
    /// How fast it falls, s/m.
    pub decay: f32,
}

/// Creepages: velocity of the wheel relative to the rail at the contact over speed.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Creepage {
    /// Longitudinal.
    pub longitudinal: f32,
    /// Lateral, along the contact's tangent, positive to the right.
    pub lateral: f32,
    /// Spin about the contact's normal (down), positive from x towards y, 1/m.
    pub spin: f32,
}

/// Forces on the wheel in the contact plane.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct CreepForce {
    /// Longitudinal force, positive forward, N.
    pub longitudinal: f32,
    /// Lateral force along the contact's tangent, positive to the right, N.
    pub lateral: f32,
    /// Spin moment about the contact's normal (down), N m.
    pub spin_moment: f32,
}

/// What one wheel's contacts do.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct WheelForces {
    /// Its contacts.
    pub contacts: WheelContacts,
    /// Creepages of each contact, as many as contacts.
    pub creepages: [Creepage; FLANGEWAY_SLOTS],
    /// Creep forces of each contact.
    pub creep_forces: [CreepForce; FLANGEWAY_SLOTS],
    /// Guiding force Y on the rail, positive outwards, N.
    pub guiding_force: f64,
    /// Wheel load Q on the rail, N.
    pub wheel_load: f64,
    /// Y / Q; zero without load.
    pub derailment_quotient: f64,
    /// Wear index T gamma: work of the creep forces a metre of track, N.
    pub wear_index: f64,
}

/// Forces of both wheels' contacts on the wheelset, track frame.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct WheelsetForces {
    /// Force, N.
    pub force: [f64; 3],
    /// Moment about the wheelset's centre, N m.
    pub moment: [f64; 3],
    /// Right wheel, left wheel.
    pub wheel: [WheelForces; 2],
}

/// A side by its number.
pub(crate) fn side(number: i32) -> Result<Side, Status> {
    match number {
        0 => Ok(Side::Right),
        1 => Ok(Side::Left),
        _ => Err(Status::Side),
    }
}

impl From<&Pose> for flangeway::Pose {
    #[inline(always)]
    fn from(pose: &Pose) -> Self {
        let Pose { lateral, yaw, vertical, roll } = *pose;
        Self { lateral, yaw, vertical, roll }
    }
}

impl From<&Motion> for wheelset::Motion {
    fn from(motion: &Motion) -> Self {
        let Pose { lateral, yaw, vertical, roll } = motion.rates;
        Self {
            pose: (&motion.pose).into(),
            rates: Rates { lateral, yaw, vertical, roll },
            speed: motion.speed,
            spin: motion.spin,
            track_curvature: motion.track_curvature,
        }
    }
}

impl ContactPoint {
    const NONE: Self = Self {
        normal_force: 0.0,
        indentation: 0.0,
        position: [0.0; 3],
        angle: 0.0,
        rolling_radius: 0.0,
        wheel_coordinate: 0.0,
        semi_axes: [0.0; 2],
        wheel_curvature: 0.0,
        rail_curvature: 0.0,
        slot: 0,
    };

    /// The kernel's contact.
    pub(crate) fn contact(&self) -> Result<Contact, Status> {
        let slot = usize::try_from(self.slot).ok().and_then(|slot| Slot::ALL.get(slot)).ok_or(Status::Slot)?;
        Ok(Contact {
            normal_force: self.normal_force,
            indentation: self.indentation,
            position: self.position.into(),
            angle: self.angle,
            rolling_radius: self.rolling_radius,
            wheel_coordinate: self.wheel_coordinate,
            semi_axes: self.semi_axes,
            wheel_curvature: self.wheel_curvature,
            rail_curvature: self.rail_curvature,
            slot: *slot,
        })
    }
}

/// Numbers of a contact before its slot.
type Numbers = [f32; 12];

// The kernel's contact and the header's both begin with the same numbers in the same order.
const _: () = assert!(
    offset_of!(Contact, position) == offset_of!(ContactPoint, position)
        && offset_of!(Contact, angle) == offset_of!(ContactPoint, angle)
        && offset_of!(Contact, semi_axes) == offset_of!(ContactPoint, semi_axes)
        && offset_of!(Contact, rail_curvature) == offset_of!(ContactPoint, rail_curvature)
        && offset_of!(ContactPoint, slot) == size_of::<Numbers>()
);

impl ContactPoint {
    /// Takes the kernel's contact.
    #[inline(always)]
    fn fill(&mut self, contact: &Contact) {
        // SAFETY: both structs are repr(C) and begin with these numbers, as asserted above. Copied at once they take a
        // sixth of the instructions: this is most of what a call through C costs over one from Rust.
        unsafe { (&raw mut *self).cast::<Numbers>().copy_from(core::ptr::from_ref(contact).cast(), 1) };
        self.slot = contact.slot as i32;
    }
}

impl WheelContacts {
    pub(crate) const NONE: Self = Self { contact: [ContactPoint::NONE; FLANGEWAY_SLOTS], count: 0, flags: 0 };

    /// Takes the kernel's contacts in place of none.
    #[inline(always)]
    pub(crate) fn fill(&mut self, contacts: &Contacts) {
        for (place, contact) in self.contact.iter_mut().zip(contacts) {
            place.fill(contact);
        }
        self.count = contacts.list.len() as i32;
        self.flags = contacts.flags.bits().into();
    }
}

impl From<&ContactPatch> for Patch {
    fn from(patch: &ContactPatch) -> Self {
        Self { semi_axes: patch.semi_axes, normal_force: patch.normal_force }
    }
}

impl From<&Elastic> for Elasticity {
    fn from(elastic: &Elastic) -> Self {
        Self { shear_modulus: elastic.shear_modulus, poisson_ratio: elastic.poisson_ratio }
    }
}

impl From<&FrictionLaw> for Friction {
    fn from(law: &FrictionLaw) -> Self {
        Self { coefficient: law.coefficient, limit_ratio: law.limit_ratio, decay: law.decay }
    }
}

impl From<&Creepage> for Creepages {
    fn from(creepage: &Creepage) -> Self {
        Self { longitudinal: creepage.longitudinal, lateral: creepage.lateral, spin: creepage.spin }
    }
}

impl From<Creepages> for Creepage {
    fn from(creepages: Creepages) -> Self {
        Self { longitudinal: creepages.longitudinal, lateral: creepages.lateral, spin: creepages.spin }
    }
}

impl From<CreepForces> for CreepForce {
    fn from(forces: CreepForces) -> Self {
        Self { longitudinal: forces.longitudinal, lateral: forces.lateral, spin_moment: forces.spin_moment }
    }
}
