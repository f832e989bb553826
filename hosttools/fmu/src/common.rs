//! What every function does: takes the instance, keeps panics inside, tells errors.

use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

use flangeway_host::fmu::instance::{Instance, Result};

use crate::logging::Log;
use crate::{Component, Status};

/// What a component points to.
pub(crate) struct Unit {
    pub(crate) instance: Instance,
    pub(crate) log: Log,
    /// The string that was got last; it stays until the next is.
    pub(crate) last_string: CString,
}

/// Runs a call on a component.
///
/// # Safety
/// The component must be null or come from fmi2Instantiate and not be freed; no other call may run on it.
pub(crate) unsafe fn on(component: Component, call: impl FnOnce(&mut Unit) -> Result<()>) -> Status {
    // SAFETY: the caller's promise.
    let Some(unit) = (unsafe { component.cast::<Unit>().as_mut() }) else { return Status::Error };
    match catch_unwind(AssertUnwindSafe(|| call(unit))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(message)) => {
            unit.log.error(Status::Error, &message);
            Status::Error
        }
        Err(_) => {
            unit.log.error(Status::Fatal, "an error inside the library: please report it");
            Status::Fatal
        }
    }
}

/// An array of the importer's.
///
/// # Safety
/// A pointer that is not null must point to `count` values, which nobody writes while they are used.
pub(crate) unsafe fn array<'a, T>(values: *const T, count: usize) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if values.is_null() || !values.is_aligned() {
        return Err("an array is NULL or not aligned".into());
    }
    // SAFETY: not null and aligned; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(values, count) })
}

/// An array of the importer's, to be written.
///
/// # Safety
/// As [`array`], and nobody else may read it meanwhile.
pub(crate) unsafe fn array_mut<'a, T>(values: *mut T, count: usize) -> Result<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    if values.is_null() || !values.is_aligned() {
        return Err("an array is NULL or not aligned".into());
    }
    // SAFETY: not null and aligned; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(values, count) })
}
