//! A program without the standard library that uses the whole of the kernel. What is linked into it is checked: nothing
//! that panics, nothing that allocates.
#![no_std]
#![no_main]
#![allow(improper_ctypes_definitions, reason = "called from here alone, by a name the check can find")]

use core::hint::black_box;

use flangeway::creep::{
    CreepForces, Creepages, Elasticity, Friction, Patch, fastsim, kalker_linear, polach, power, shen_hedrick_elkins,
    wear_index,
};
use flangeway::wheelset::{Motion, WheelLoads, contact_wrench, creepages, nadal_limit};
use flangeway::{Contact, ContactTable, Contacts, Pose, Side};

// The C library: `main`'s surroundings and `memcpy`.
#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The lookup, with all it needs inlined: its frame is the stack a lookup takes.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn gate_contacts(table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    table.contacts_into(side, pose, contacts);
}

/// The same for several wheels.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn gate_many(table: &ContactTable<'_>, wheels: &[(Side, Pose); 8], contacts: &mut [Contacts; 8]) {
    table.contacts_many(wheels, contacts);
}

/// FASTSIM as real time has it.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn gate_fastsim(patch: &Patch, creepages: &Creepages, friction: f32, forces: &mut CreepForces) {
    *forces = fastsim::<10, 10>(patch, &Elasticity::STEEL, creepages, friction);
}

/// The rest of the creep forces and of the wheelset on one contact.
fn wheelset(table: &ContactTable<'_>, pose: &Pose, contact: &Contact) -> f64 {
    let header = table.header();
    let motion = Motion { pose: *pose, speed: black_box(20.0), spin: 20.0 / 0.46, ..Motion::default() };
    let creep = creepages(&header.right.geometry, &motion, contact);
    let friction = black_box(Friction { coefficient: 0.3, limit_ratio: 0.4, decay: 0.6 }).at(0.1);
    let (patch, steel) = (Patch::from(contact), Elasticity::from(&header.material));
    let mut forces = CreepForces::NONE;
    gate_fastsim(&patch, &creep, friction, &mut forces);
    let linear = kalker_linear(&patch, &steel, &creep).longitudinal;
    let bent = shen_hedrick_elkins(&patch, &steel, &creep, friction).longitudinal
        + polach(&patch, &steel, &creep, friction).lateral;
    let fine = fastsim::<20, 20>(&patch, &steel, &creep, friction);
    let wrench = contact_wrench(&header.right.geometry, pose, contact, &forces);
    let loads = WheelLoads::new(Side::Right, &wrench);
    let work = power(20.0, &creep, &fine) + wear_index(&creep, &forces) + nadal_limit(1.2, f64::from(friction));
    loads.ratio() + work + f64::from(linear + bent)
}

/// Uses everything once.
#[unsafe(no_mangle)]
extern "C" fn main() -> i32 {
    let image = black_box(flangeway_tables::S1002_60E1_40_TABLE);
    let Ok(table) = ContactTable::new(image) else { return 1 };
    let pose = black_box(Pose { lateral: 0.003, vertical: 1e-4, ..Pose::default() });
    let mut contacts = [Contacts::NONE; 8];
    table.prefetch(Side::Left, &pose);
    gate_many(&table, black_box(&[(Side::Right, pose); 8]), &mut contacts);
    let [first, ..] = &mut contacts;
    gate_contacts(&table, black_box(Side::Left), &pose, first);
    let channels = table.channels(Side::Right, &table.coordinates(Side::Left, &pose));
    let strongest = first.strongest().map_or(0.0, |contact| contact.normal_force + contact.normal().z);
    #[cfg(feature = "broken")]
    let strongest = strongest + [1.0, 2.0][black_box(1)];
    let creep = first.strongest().map_or(0.0, |contact| wheelset(&table, &pose, contact));
    black_box((channels, strongest, first.total_normal_force(), creep));
    0
}
