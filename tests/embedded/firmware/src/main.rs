//! Looks up the poses of a file, computes the creep forces of their contacts, and writes every answer with the instructions it took. `compare` writes the file, and
//! holds the answers against the host's.
#![no_std]
#![no_main]

mod counter;
mod creep;
mod semihosting;
mod stack;

use core::hint::black_box;
use core::mem::MaybeUninit;

use cortex_m::singleton;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use flangeway::creep::Creepages;
use flangeway::wheelset::{Motion, Rates};
use flangeway::{ContactTable, Contacts, Pose, SLOTS, Side};
use flangeway_mps2 as _;
use flangeway_pil::ContactNumbers;

use counter::Counter;
use semihosting::{File, Output};

/// A made-up table in which all three slots can carry force; `tests/kernel_gates.rs` writes it.
static THREE: &[u8] = include_bytes!("../../../gates/three_contacts.fwt");

/// Bytes of a case in the file: table, side, the pose's four `f64`, what its creep forces depend on.
const CASE: usize = 2 + 4 * 8 + creep::CASE;
/// Bytes of a contact: slot, twelve `f32`.
const CONTACT: usize = 1 + 12 * 4;
/// Bytes of a lookup's answer: instructions, flags, number of contacts, three contacts, those that are none zero.
const ANSWER: usize = 4 + 1 + 1 + SLOTS * CONTACT;

/// A case of the file.
struct Case<'a> {
    table: &'a ContactTable<'static>,
    side: Side,
    /// With the pose to look up.
    creep: creep::Case,
}

/// What is counted: a lookup, or nothing at all.
type Call = fn(&ContactTable<'_>, Side, &Pose, &mut Contacts);

#[inline(never)]
fn lookup(table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    table.contacts_into(side, pose, contacts);
}

#[inline(never)]
fn nothing(table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    black_box((table, side, pose, contacts));
}

/// As many instructions as its name says, besides those of the call.
#[inline(never)]
fn thousand(table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    counter::thousand();
    black_box((table, side, pose, contacts));
}

#[entry]
fn main() -> ! {
    debug::exit(if run().is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

/// Everything; none where something is missing.
fn run() -> Option<()> {
    let counter = Counter::start(cortex_m::Peripherals::take()?.SYST);
    let first = singleton!(: MaybeUninit<ContactTable<'static>> = MaybeUninit::uninit())?;
    let second = singleton!(: MaybeUninit<ContactTable<'static>> = MaybeUninit::uninit())?;
    let mut table = None;
    let startup_stack =
        stack::used_by(|| table = ContactTable::new_in(first, flangeway_tables::S1002_60E1_40_TABLE).ok());
    let tables = [table?, ContactTable::new_in(second, THREE).ok()?];
    let (poses, mut answers) = (File::open("poses.bin\0")?, Output::open()?);
    let mut bytes = [0; CASE];
    let mut lookup_stack = 0;
    let [table, _] = &tables;
    let mut contacts = Contacts::NONE;
    let mut without_lookup = |counter, call| ticks(counter, call, table, Side::Right, &Pose::default(), &mut contacts);
    let calibration = counter.instructions(without_lookup(&counter, thousand) - without_lookup(&counter, nothing));
    let counter = counter.for_lookups();
    let floor = without_lookup(&counter, nothing);
    while poses.read(&mut bytes) {
        let Case { table, side, creep } = parse(&bytes, &tables)?;
        let pose = &creep.motion.pose;
        let mut contacts = Contacts::NONE;
        lookup_stack = lookup_stack.max(stack::used_by(|| lookup(table, side, pose, &mut contacts)));
        let ticks = ticks(&counter, lookup, table, side, pose, &mut contacts);
        answers.write(&answer(counter.instructions(ticks - floor), &contacts))?;
        let mut forces = [0; creep::ANSWER];
        creep::answer(&counter, &creep, contacts.iter(), &mut forces);
        answers.write(&forces)?;
    }
    // What was seen besides: nops counted, stack of a lookup, of the startup with the check of a table.
    for number in [calibration, lookup_stack, startup_stack] {
        answers.write(&number.to_le_bytes())?;
    }
    Some(())
}

/// Ticks that a number of calls take.
#[inline(never)]
fn ticks(
    counter: &Counter,
    call: Call,
    table: &ContactTable<'_>,
    side: Side,
    pose: &Pose,
    contacts: &mut Contacts,
) -> u32 {
    let call = black_box(call);
    counter.ticks(|| call(table, side, pose, contacts))
}

/// A case from its bytes.
fn parse<'a>(bytes: &[u8; CASE], tables: &[&'a ContactTable<'static>; 2]) -> Option<Case<'a>> {
    let ([table, side], rest) = bytes.split_first_chunk()?;
    let (doubles, singles) = rest.split_first_chunk::<{ 11 * 8 }>()?;
    let [lateral, yaw, vertical, roll, rates @ .., speed, spin, track_curvature] =
        doubles.as_chunks().0.first_chunk::<11>()?.map(f64::from_le_bytes);
    let [longitudinal, lateral_creepage, spin_creepage, friction] =
        singles.as_chunks().0.first_chunk::<4>()?.map(f32::from_le_bytes);
    let pose = Pose { lateral, yaw, vertical, roll };
    let [lateral, yaw, vertical, roll] = rates;
    let rates = Rates { lateral, yaw, vertical, roll };
    let (table, side) = (tables.get(usize::from(*table))?, *Side::ALL.get(usize::from(*side))?);
    let header = table.header();
    let creep = creep::Case {
        geometry: header.side(side).geometry,
        elasticity: (&header.material).into(),
        motion: Motion { pose, rates, speed, spin, track_curvature },
        added: Creepages { longitudinal, lateral: lateral_creepage, spin: spin_creepage },
        friction,
    };
    Some(Case { table, side, creep })
}

/// A lookup's answer in bytes.
fn answer(instructions: u32, contacts: &Contacts) -> [u8; ANSWER] {
    let mut bytes = [0; ANSWER];
    if let Some((head, rest)) = bytes.split_first_chunk_mut() {
        let [a, b, c, d] = instructions.to_le_bytes();
        *head = [a, b, c, d, contacts.flags.bits(), contacts.list.len() as u8];
        for (contact, place) in contacts.iter().zip(rest.as_chunks_mut().0) {
            *place = contact_bytes(&contact.into());
        }
    }
    bytes
}

fn contact_bytes(contact: &ContactNumbers) -> [u8; CONTACT] {
    let mut bytes = [0; CONTACT];
    if let Some((slot, places)) = bytes.split_first_mut() {
        *slot = contact.slot;
        for (number, place) in contact.numbers.iter().zip(places.as_chunks_mut().0) {
            *place = number.to_le_bytes();
        }
    }
    bytes
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
