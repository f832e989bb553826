//! Pointers from C: checked as far as a pointer can be, then read or written whole. No reference to the caller's memory
//! is made (but to a loaded table), so arguments may overlap.

use crate::status::Status;

/// Whether a pointer could hold `count` values: not null, aligned, and not longer than memory.
pub(crate) fn check<T>(pointer: *const T, count: usize) -> Result<(), Status> {
    if pointer.is_null() {
        return Err(Status::Null);
    }
    if !pointer.is_aligned() {
        return Err(Status::Misaligned);
    }
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(Status::Length),
    }
}

/// Reads a value.
///
/// # Safety
/// A pointer that is not null and aligned must point to a value.
#[inline(always)]
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Result<T, Status> {
    check(pointer, 1)?;
    // SAFETY: not null and aligned by the check, the value is the caller's promise.
    Ok(unsafe { pointer.read() })
}

/// Writes a value.
///
/// # Safety
/// A pointer that is not null and aligned must point to room for a value.
#[inline(always)]
pub(crate) unsafe fn write<T: Copy>(pointer: *mut T, value: T) -> Result<(), Status> {
    check(pointer, 1)?;
    // SAFETY: not null and aligned by the check, the room is the caller's promise.
    unsafe { pointer.write(value) };
    Ok(())
}
