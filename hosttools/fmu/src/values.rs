//! Getting and setting values (2.1.7).

use std::ffi::CStr;

use crate::common::{array, array_mut, on};
use crate::logging::text;
use crate::{Boolean, Component, Reference, Status, Text};

/// Gets real variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *mut f64,
) -> Status {
    // SAFETY: the standard's promise, as for all calls below.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            for (reference, value) in references.iter().zip(array_mut(values, count)?) {
                *value = unit.instance.real(*reference)?;
            }
            Ok(())
        })
    }
}

/// Gets integer variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *mut i32,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            for (reference, value) in references.iter().zip(array_mut(values, count)?) {
                *value = unit.instance.integer(*reference)?;
            }
            Ok(())
        })
    }
}

/// Gets boolean variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *mut Boolean,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            for (reference, value) in references.iter().zip(array_mut(values, count)?) {
                *value = Boolean::from(unit.instance.boolean(*reference)?);
            }
            Ok(())
        })
    }
}

/// Gets string variables; a text stays until the next call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *mut Text,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            for (reference, value) in references.iter().zip(array_mut(values, count)?) {
                unit.last_string = text(unit.instance.string(*reference)?);
                *value = unit.last_string.as_ptr();
            }
            Ok(())
        })
    }
}

/// Sets real variables, up to the first that cannot be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *const f64,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            references.iter().zip(array(values, count)?).try_for_each(|(r, value)| unit.instance.set_real(*r, *value))
        })
    }
}

/// Sets integer variables, up to the first that cannot be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *const i32,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            references
                .iter()
                .zip(array(values, count)?)
                .try_for_each(|(r, value)| unit.instance.set_integer(*r, *value))
        })
    }
}

/// Sets boolean variables, up to the first that cannot be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *const Boolean,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            let references = array(references, count)?;
            references
                .iter()
                .zip(array(values, count)?)
                .try_for_each(|(r, value)| unit.instance.set_boolean(*r, *value != 0))
        })
    }
}

/// Sets string variables, up to the first that cannot be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: Component,
    references: *const Reference,
    count: usize,
    values: *const Text,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            for (reference, value) in array(references, count)?.iter().zip(array(values, count)?) {
                if value.is_null() {
                    return Err("a string is NULL".into());
                }
                let value = CStr::from_ptr(*value).to_str().map_err(|_| "a string is not UTF-8")?;
                unit.instance.set_string(*reference, value)?;
            }
            Ok(())
        })
    }
}
