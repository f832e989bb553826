//! The least firmware that looks contacts up: its size is the kernel's.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::mem::MaybeUninit;

use cortex_m::singleton;
use cortex_m_rt::entry;
use flangeway::{ContactTable, Contacts, Pose, Side};
use flangeway_mps2 as _;
use panic_halt as _;

#[entry]
fn main() -> ! {
    let image = flangeway_tables::S1002_60E1_40_TABLE;
    let place = singleton!(: MaybeUninit<ContactTable<'static>> = MaybeUninit::uninit());
    let mut contacts = Contacts::NONE;
    if let Some(Ok(table)) = place.map(|place| ContactTable::new_in(place, image)) {
        loop {
            table.contacts_into(black_box(Side::Right), &black_box(Pose::default()), black_box(&mut contacts));
        }
    }
    loop {
        cortex_m::asm::wfi();
    }
}
