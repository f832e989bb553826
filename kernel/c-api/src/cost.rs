//! The lookups of `tests/cost.c`, called from Rust: what the C interface is held against.

#![expect(unreachable_pub, reason = "called from C")]

use core::hint::black_box;

use flangeway::{ContactTable, Contacts, Pose, Side};

use crate::table::{Table, view};

/// Looks `count` poses up, as `tests/cost.c` does through the C interface; the sum of the first contacts' forces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cost_rust(table: *const Table, poses: *const [f64; 4], count: usize) -> f64 {
    // SAFETY: a loaded table.
    let Ok(table) = (unsafe { view(table) }) else { return f64::NAN };
    // SAFETY: as many poses.
    let poses = unsafe { core::slice::from_raw_parts(poses, count) };
    cost_rust_loop(table, poses)
}

/// The loop: its instructions are counted by this name.
#[inline(never)]
#[unsafe(no_mangle)]
fn cost_rust_loop(table: &ContactTable<'_>, poses: &[[f64; 4]]) -> f64 {
    let mut sum = 0.0;
    for [lateral, yaw, vertical, roll] in poses {
        let pose = Pose { lateral: *lateral, yaw: *yaw, vertical: *vertical, roll: *roll };
        let mut contacts = Contacts::NONE;
        table.contacts_into(Side::Right, &pose, &mut contacts);
        let contacts = black_box(&contacts);
        sum += contacts.list.first().map_or(0.0, |first| f64::from(first.normal_force));
    }
    sum
}
