//! Pointers from C: checked as far as a pointer can be, then read or written whole. Inputs are read before outputs are
//! written, so arguments may overlap.

use crate::status::Status;

/// Whether a pointer could hold `count` values: not null, aligned, and not longer than memory.
#[inline(always)]
pub(crate) fn check<T>(pointer: *const T, count: usize) -> Result<(), Status> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(unusable(pointer.is_null()));
    }
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(Status::Length),
    }
}

/// Out of the way of calls with good pointers.
#[cold]
#[inline(never)]
fn unusable(null: bool) -> Status {
    if null { Status::Null } else { Status::Misaligned }
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

/// Writes a value and gives it back to be changed where it is.
///
/// # Safety
/// As [`write`], and nobody else may use the place while it is changed.
#[inline(always)]
pub(crate) unsafe fn place<'a, T: Copy>(pointer: *mut T, value: T) -> Result<&'a mut T, Status> {
    // SAFETY: the caller's promise.
    unsafe { write(pointer, value) }?;
    // SAFETY: a value was written there; that it is nobody else's is the caller's promise.
    Ok(unsafe { &mut *pointer })
}
