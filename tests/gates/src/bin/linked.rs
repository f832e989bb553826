//! A program without the standard library that uses the whole of the kernel. What is linked into it is checked: nothing
//! that panics, nothing that allocates.
#![no_std]
#![no_main]
#![allow(improper_ctypes_definitions, reason = "called from here alone, by a name the check can find")]

use core::hint::black_box;

use flangeway::{ContactTable, Contacts, Pose, Side};

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
    black_box((channels, strongest, first.total_normal_force()));
    0
}
