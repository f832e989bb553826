//! The instance's state, kept and restored (2.1.8), and what this unit does not offer.

use std::ffi::{c_char, c_int, c_void};

use flangeway_host::fmu::instance::Snapshot;

use crate::common::on;
use crate::{Boolean, Component, Reference, Status, Text};

/// Keeps the state: in a new place where `*state` is null, else in the place of the state that is there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, state: *mut *mut c_void) -> Status {
    // SAFETY: the standard's promise: `state` is null or points to null or to a state of this instance.
    unsafe {
        on(c, |unit| {
            let state = state.as_mut().ok_or("the state's place is NULL")?;
            let snapshot = unit.instance.snapshot();
            match state.cast::<Snapshot>().as_mut() {
                Some(place) => *place = snapshot,
                None => *state = Box::into_raw(Box::new(snapshot)).cast(),
            }
            Ok(())
        })
    }
}

/// Goes back to a state, which stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: Component, state: *mut c_void) -> Status {
    // SAFETY: the standard's promise: a state of this instance.
    unsafe { on(c, |unit| unit.instance.restore(state.cast::<Snapshot>().as_ref().ok_or("the state is NULL")?)) }
}

/// Frees a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Component, state: *mut *mut c_void) -> Status {
    // SAFETY: the standard's promise: `state` is null or points to null or to a state of this instance.
    unsafe {
        on(c, |_| {
            let Some(state) = state.as_mut() else { return Ok(()) };
            if !state.is_null() {
                drop(Box::from_raw(state.cast::<Snapshot>()));
                *state = std::ptr::null_mut();
            }
            Ok(())
        })
    }
}

/// Tells that a function is not offered, as the description says.
unsafe fn not_offered(c: Component, name: &str) -> Status {
    // SAFETY: the caller's promise.
    unsafe { on(c, |_| Err(format!("{name} is not offered"))) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Component, _state: *mut c_void, _size: *mut usize) -> Status {
    // SAFETY: the standard's promise, as below.
    unsafe { not_offered(c, "fmi2SerializedFMUstateSize") }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: Component,
    _state: *mut c_void,
    _bytes: *mut c_char,
    _size: usize,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2SerializeFMUstate") }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Component,
    _bytes: *const c_char,
    _size: usize,
    _state: *mut *mut c_void,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2DeSerializeFMUstate") }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: Component,
    _unknowns: *const Reference,
    _unknown_count: usize,
    _knowns: *const Reference,
    _known_count: usize,
    _known_changes: *const f64,
    _unknown_changes: *mut f64,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetDirectionalDerivative") }
}

/// Not offered: inputs are interpolated from the step before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: Component,
    _references: *const Reference,
    _count: usize,
    _orders: *const c_int,
    _values: *const f64,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2SetRealInputDerivatives") }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: Component,
    _references: *const Reference,
    _count: usize,
    _orders: *const c_int,
    _values: *mut f64,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetRealOutputDerivatives") }
}

/// Steps are done when they return: nothing is pending.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: Component, _kind: c_int, _value: *mut Status) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetStatus") }
}

/// As [`fmi2GetStatus`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Component, _kind: c_int, _value: *mut f64) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetRealStatus") }
}

/// As [`fmi2GetStatus`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(c: Component, _kind: c_int, _value: *mut c_int) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetIntegerStatus") }
}

/// As [`fmi2GetStatus`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: Component, _kind: c_int, _value: *mut Boolean) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetBooleanStatus") }
}

/// As [`fmi2GetStatus`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(c: Component, _kind: c_int, _value: *mut Text) -> Status {
    // SAFETY: the standard's promise.
    unsafe { not_offered(c, "fmi2GetStringStatus") }
}
