//! Creepages, creep forces, and the wrench of both wheels on the wheelset.

use flangeway::creep::{self, CreepForces, Creepages, Elasticity, Friction, Patch};
use flangeway::wheelset::{self, Footing, Rolling, WheelLoads, Wrench, creepages};
use flangeway::{ContactTable, Contacts, Flags, Side};

use crate::pointer::{read, write};
use crate::status::Status;
use crate::table::{Table, view};
use crate::types::{
    ContactPatch, ContactPoint, CreepForce, Creepage, Elastic, FLANGEWAY_SLOTS, FrictionLaw, Motion, WheelContacts,
    WheelForces, WheelsetForces, side,
};

/// A creep law as a function.
type Law = fn(&Patch, &Elasticity, &Creepages, f32) -> CreepForces;

fn law(number: i32) -> Result<Law, Status> {
    match number {
        0 => Ok(|patch, elasticity, creepages, _| creep::kalker_linear(patch, elasticity, creepages)),
        1 => Ok(creep::shen_hedrick_elkins),
        2 => Ok(creep::polach),
        3 => Ok(creep::fastsim::<10, 10>),
        4 => Ok(creep::fastsim::<20, 20>),
        _ => Err(Status::Law),
    }
}

/// Whether all are finite.
fn finite<const N: usize>(numbers: [f32; N]) -> Result<(), Status> {
    if numbers.into_iter().all(f32::is_finite) { Ok(()) } else { Err(Status::NotANumber) }
}

/// Forces of a contact by a creep law (a `flangeway_creep_law`), with a coefficient of friction. An input that is no
/// number gives FLANGEWAY_STATUS_NOT_A_NUMBER and zero forces; a semi-axis, force or friction that is not positive gives
/// zero forces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_creep_forces(
    creep_law: i32,
    patch: *const ContactPatch,
    elastic: *const Elastic,
    creepage: *const Creepage,
    friction: f32,
    forces: *mut CreepForce,
) -> i32 {
    let compute = || {
        let law = law(creep_law)?;
        // SAFETY: the caller's promise.
        let patch = unsafe { read(patch) }?;
        // SAFETY: the caller's promise.
        let elastic = unsafe { read(elastic) }?;
        // SAFETY: the caller's promise.
        let creepage = unsafe { read(creepage) }?;
        let found = law(&(&patch).into(), &(&elastic).into(), &(&creepage).into(), friction);
        // SAFETY: the caller's promise.
        unsafe { write(forces, found.into()) }?;
        let [a, b] = patch.semi_axes;
        finite([a, b, patch.normal_force, elastic.shear_modulus, elastic.poisson_ratio, friction])?;
        finite([creepage.longitudinal, creepage.lateral, creepage.spin])
    };
    Status::of(compute())
}

/// Creepages of a contact of a wheel in motion. A motion or contact that is no number, or beyond 1e6, gives
/// FLANGEWAY_STATUS_NOT_A_NUMBER and none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_creepages(
    table: *const Table,
    wheel_side: i32,
    motion: *const Motion,
    contact: *const ContactPoint,
    creepage: *mut Creepage,
) -> i32 {
    let compute = || {
        // SAFETY: the caller's promise.
        let table = unsafe { view(table) }?;
        // SAFETY: the caller's promise.
        let motion = unsafe { read(motion) }?;
        // SAFETY: the caller's promise.
        let point = unsafe { read(contact) }?;
        let geometry = table.header().side(side(wheel_side)?).geometry;
        let found = creepages(&geometry, &(&motion).into(), &point.contact()?);
        // SAFETY: the caller's promise.
        unsafe { write(creepage, found.into()) }?;
        let [x, y, z] = point.position;
        finite([x, y, z, point.angle])?;
        valid(&motion)
    };
    Status::of(compute())
}

/// All forces between a wheelset and its rails: contacts of both wheels, creepages, creep forces by a law (a
/// `flangeway_creep_law`), and their wrench on the wheelset. Material is the table's. A motion that is no number, or
/// beyond 1000 in the pose and 1e6 elsewhere, gives FLANGEWAY_STATUS_NOT_A_NUMBER and no forces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_wheelset(
    table: *const Table,
    motion: *const Motion,
    creep_law: i32,
    friction: *const FrictionLaw,
    forces: *mut WheelsetForces,
) -> i32 {
    let compute = || {
        // SAFETY: the caller's promise.
        let table = unsafe { view(table) }?;
        // SAFETY: the caller's promise.
        let motion = unsafe { read(motion) }?;
        // SAFETY: the caller's promise.
        let friction = unsafe { read(friction) }?;
        let law = law(creep_law)?;
        let validity = valid(&motion).and(finite([friction.coefficient, friction.limit_ratio, friction.decay]));
        let found = match validity {
            Ok(()) => both(table, &(&motion).into(), law, &(&friction).into()),
            Err(_) => WheelsetForces { force: [0.0; 3], moment: [0.0; 3], wheel: [WheelForces::INVALID; 2] },
        };
        // SAFETY: the caller's promise.
        unsafe { write(forces, found) }?;
        validity
    };
    Status::of(compute())
}

/// Whether a motion is numbers within their limits.
fn valid(motion: &Motion) -> Result<(), Status> {
    let rates = &motion.rates;
    let numbers =
        [rates.lateral, rates.yaw, rates.vertical, rates.roll, motion.speed, motion.spin, motion.track_curvature];
    let valid = flangeway::Pose::from(&motion.pose).is_valid() && numbers.into_iter().all(|x| x.abs() <= 1e6);
    if valid { Ok(()) } else { Err(Status::NotANumber) }
}

impl WheelForces {
    const NONE: Self = Self {
        contacts: WheelContacts::NONE,
        creepages: [Creepage { longitudinal: 0.0, lateral: 0.0, spin: 0.0 }; FLANGEWAY_SLOTS],
        creep_forces: [CreepForce { longitudinal: 0.0, lateral: 0.0, spin_moment: 0.0 }; FLANGEWAY_SLOTS],
        guiding_force: 0.0,
        wheel_load: 0.0,
        derailment_quotient: 0.0,
        wear_index: 0.0,
    };

    /// What a motion that is no number gives.
    const INVALID: Self = Self {
        contacts: WheelContacts { flags: Flags::INVALID_INPUT.bits() as u32, ..WheelContacts::NONE },
        ..Self::NONE
    };
}

/// Both wheels.
fn both(table: &ContactTable<'_>, motion: &wheelset::Motion, law: Law, friction: &Friction) -> WheelsetForces {
    let elasticity = Elasticity::from(&table.header().material);
    let mut wheels = [WheelForces::NONE; 2];
    let (mut total, rolling) = (Wrench::default(), Rolling::new(motion));
    let mut contacts = [const { Contacts::NONE }; 2];
    table.contacts_many(&Side::ALL.map(|side| (side, motion.pose)), &mut contacts);
    for ((side, contacts), wheel) in Side::ALL.into_iter().zip(&contacts).zip(&mut wheels) {
        let geometry = table.header().side(side).geometry;
        let mut on_wheel = Wrench::default();
        for ((contact, creepage), creep_force) in contacts.iter().zip(&mut wheel.creepages).zip(&mut wheel.creep_forces)
        {
            let footing = Footing::new(&geometry, &motion.pose, contact);
            let slip = footing.creepages(&rolling);
            let coefficient = friction.at(slip_velocity(&slip, motion.speed));
            let force = law(&contact.into(), &elasticity, &slip, coefficient);
            on_wheel = on_wheel + footing.wrench(contact.normal_force, &force);
            wheel.wear_index += creep::wear_index(&slip, &force);
            (*creepage, *creep_force) = (slip.into(), force.into());
        }
        let loads = WheelLoads::new(side, &on_wheel);
        wheel.contacts.fill(contacts);
        (wheel.guiding_force, wheel.wheel_load) = (loads.guiding_force, loads.wheel_load);
        wheel.derailment_quotient = loads.ratio();
        total = total + on_wheel;
    }
    WheelsetForces { force: total.force.into(), moment: total.moment.into(), wheel: wheels }
}

/// Slip velocity without spin, m/s: the magnitude of the creepages times the speed.
fn slip_velocity(creepages: &Creepages, speed: f64) -> f32 {
    let forces = CreepForces { longitudinal: creepages.longitudinal, lateral: creepages.lateral, spin_moment: 0.0 };
    forces.magnitude() * speed.abs() as f32
}

/// Nadal's limit of Y / Q for a flange of contact angle `angle` (rad, its sign does not matter) and a coefficient of
/// friction. NaN or infinity gives FLANGEWAY_STATUS_NOT_A_NUMBER and zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_nadal_limit(angle: f64, friction: f64, limit: *mut f64) -> i32 {
    let valid = angle.is_finite() && friction.is_finite();
    let compute = || {
        // SAFETY: the caller's promise.
        unsafe { write(limit, if valid { wheelset::nadal_limit(angle, friction) } else { 0.0 }) }?;
        if valid { Ok(()) } else { Err(Status::NotANumber) }
    };
    Status::of(compute())
}
