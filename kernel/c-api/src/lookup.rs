//! Contacts of one wheel and of several.

use flangeway::{Contacts, Flags, Side};

use crate::pointer::{check, place, read};
use crate::status::Status;
use crate::table::{Table, view};
use crate::types::{Pose, Wheel, WheelContacts, side};

/// Wheels that are looked up together.
const TOGETHER: usize = 8;

/// Asks for the records of a pose, so that they are in the cache when the lookup comes, while the caller does other work.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_prefetch(table: *const Table, wheel_side: i32, pose: *const Pose) -> i32 {
    let ask = || {
        // SAFETY: the caller's promise.
        let table = unsafe { view(table) }?;
        // SAFETY: the caller's promise.
        let pose = unsafe { read(pose) }?;
        table.prefetch(side(wheel_side)?, &(&pose).into());
        Ok(())
    };
    Status::of(ask())
}

/// Contacts of a wheel (a `flangeway_side`) at a pose. The same work for every pose. A pose with NaN, infinity or a
/// coordinate beyond 1000 gives FLANGEWAY_STATUS_NOT_A_NUMBER, no contacts and a flag.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_contacts(
    table: *const Table,
    wheel_side: i32,
    pose: *const Pose,
    contacts: *mut WheelContacts,
) -> i32 {
    let look = || {
        // SAFETY: the caller's promise.
        let table = unsafe { view(table) }?;
        // SAFETY: the caller's promise.
        let pose = unsafe { read(pose) }?;
        let mut found = Contacts::NONE;
        table.contacts_into(side(wheel_side)?, &(&pose).into(), &mut found);
        // SAFETY: the caller's promise.
        unsafe { place(contacts, WheelContacts::NONE) }?.fill(&found);
        valid(&found)
    };
    Status::of(look())
}

/// Contacts of `count` wheels, as `flangeway_contacts` gives them, records asked for ahead of the wheel in hand.
/// `capacity` is how many wheels' contacts fit at `contacts`. If a pose is no number, the others are answered
/// all the same and FLANGEWAY_STATUS_NOT_A_NUMBER returned; if a side is none, nothing is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_contacts_many(
    table: *const Table,
    wheels: *const Wheel,
    count: usize,
    contacts: *mut WheelContacts,
    capacity: usize,
) -> i32 {
    let look = || {
        // SAFETY: the caller's promise.
        let table = unsafe { view(table) }?;
        check(wheels, count)?;
        check(contacts, capacity)?;
        if capacity < count {
            return Err(Status::ShortBuffer);
        }
        for index in 0..count {
            // SAFETY: inside the array, by the caller's promise.
            side(unsafe { read(wheels.wrapping_add(index)) }?.side)?;
        }
        let mut outcome = Ok(());
        for start in (0..count).step_by(TOGETHER) {
            let together = TOGETHER.min(count - start);
            let mut asked = [(Side::Right, flangeway::Pose::default()); TOGETHER];
            for (index, ask) in asked.iter_mut().enumerate().take(together) {
                // SAFETY: inside the array, by the caller's promise.
                let wheel = unsafe { read(wheels.wrapping_add(start + index)) }?;
                *ask = (side(wheel.side)?, (&wheel.pose).into());
            }
            let mut found = [const { Contacts::NONE }; TOGETHER];
            let asked = asked.get(..together).unwrap_or(&[]);
            table.contacts_many(asked, &mut found);
            for (index, one) in found.iter().enumerate().take(together) {
                // SAFETY: inside the array, by the caller's promise.
                unsafe { place(contacts.wrapping_add(start + index), WheelContacts::NONE) }?.fill(one);
                outcome = outcome.and(valid(one));
            }
        }
        outcome
    };
    Status::of(look())
}

/// Whether the pose was one.
#[inline(always)]
fn valid(contacts: &Contacts) -> Result<(), Status> {
    if contacts.flags.contains(Flags::INVALID_INPUT) { Err(Status::NotANumber) } else { Ok(()) }
}
