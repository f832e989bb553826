//! Creep forces of every contact of a case: creepages, forces by a law, wrench; with the instructions that they take.

use core::hint::black_box;

use flangeway::creep::{CreepForces, Creepages, Elasticity, Patch, fastsim, polach};
use flangeway::wheelset::{Footing, Motion, Rolling, Wrench};
use flangeway::{Contact, SLOTS, WheelGeometry};

use crate::counter::Counter;

/// Bytes of a case beside its pose: rates, speed, spin and curvature (`f64`), added creepages and friction (`f32`).
pub(crate) const CASE: usize = 7 * 8 + 4 * 4;
/// Bytes of a law's answer: instructions, creepages and forces (`f32`), wrench (`f64`).
const LAW: usize = 4 + 6 * 4 + 6 * 8;
/// Bytes of a contact's answer: Polach's law and FASTSIM on 10 by 10.
const CONTACT: usize = 2 * LAW;
/// Bytes of an answer: three contacts, those that are none zero.
pub(crate) const ANSWER: usize = SLOTS * CONTACT;

/// What the forces of a contact depend on.
pub(crate) struct Case {
    pub(crate) geometry: WheelGeometry,
    pub(crate) elasticity: Elasticity,
    pub(crate) motion: Motion,
    /// Added to the motion's creepages: none, or something strange.
    pub(crate) added: Creepages,
    pub(crate) friction: f32,
}

/// Of one contact.
#[derive(Default)]
struct Forces {
    creepages: Creepages,
    forces: CreepForces,
    wrench: Wrench,
}

/// What is counted: all of a contact, or nothing at all.
type Call = fn(&Case, &Contact, &mut Forces);
/// A law of creep forces.
type Law = fn(&Patch, &Elasticity, &Creepages, f32) -> CreepForces;

#[inline(never)]
fn by_polach(case: &Case, contact: &Contact, out: &mut Forces) {
    compute(case, contact, out, polach);
}

#[inline(never)]
fn by_fastsim(case: &Case, contact: &Contact, out: &mut Forces) {
    compute(case, contact, out, fastsim::<10, 10>);
}

#[inline(never)]
fn nothing(case: &Case, contact: &Contact, out: &mut Forces) {
    black_box((case, contact, out));
}

#[inline(always)]
fn compute(case: &Case, contact: &Contact, out: &mut Forces, law: Law) {
    let Case { geometry, elasticity, motion, added, friction } = case;
    let footing = Footing::new(geometry, &motion.pose, contact);
    let of_motion = footing.creepages(&Rolling::new(motion));
    let creepages = Creepages {
        longitudinal: of_motion.longitudinal + added.longitudinal,
        lateral: of_motion.lateral + added.lateral,
        spin: of_motion.spin + added.spin,
    };
    let forces = law(&contact.into(), elasticity, &creepages, *friction);
    let wrench = footing.wrench(contact.normal_force, &forces);
    *out = Forces { creepages: of_motion, forces, wrench };
}

/// The answers of a wheel's contacts, in bytes.
pub(crate) fn answer<'a>(
    counter: &Counter,
    case: &Case,
    contacts: impl Iterator<Item = &'a Contact>,
    bytes: &mut [u8; ANSWER],
) {
    for (contact, place) in contacts.zip(bytes.as_chunks_mut::<CONTACT>().0) {
        let floor = ticks(counter, nothing, case, contact, &mut Forces::default());
        for (call, place) in [by_polach, by_fastsim].into_iter().zip(place.as_chunks_mut().0) {
            let mut out = Forces::default();
            let ticks = ticks(counter, call, case, contact, &mut out);
            *place = law_bytes(counter.instructions(ticks - floor), &out);
        }
    }
}

/// Ticks that a number of calls take.
#[inline(never)]
fn ticks(counter: &Counter, call: Call, case: &Case, contact: &Contact, out: &mut Forces) -> u32 {
    let call = black_box(call);
    counter.ticks(|| call(case, contact, out))
}

fn law_bytes(instructions: u32, out: &Forces) -> [u8; LAW] {
    let Forces { creepages: c, forces: f, wrench: w } = out;
    let singles = [c.longitudinal, c.lateral, c.spin, f.longitudinal, f.lateral, f.spin_moment].map(f32::to_le_bytes);
    let doubles = [w.force.x, w.force.y, w.force.z, w.moment.x, w.moment.y, w.moment.z].map(f64::to_le_bytes);
    let all = instructions.to_le_bytes();
    let all = all.iter().chain(singles.as_flattened()).chain(doubles.as_flattened());
    let mut bytes = [0; LAW];
    bytes.iter_mut().zip(all).for_each(|(place, byte)| *place = *byte);
    bytes
}
