//! The library inside a Flangeway FMU: the functions of FMI 2.0 for co-simulation, around
//! [`flangeway_host::fmu::instance::Instance`].
//!
//! What can be checked is checked and ends in `fmi2Error` with a message in the importer's log: null pointers, unknown
//! references, values out of range, calls at the wrong time, a missing or damaged table. A panic, which nothing here
//! should cause, becomes `fmi2Fatal` and stays inside. All functions are those of the standard's header fmi2Functions.h;
//! its section numbers stand beside them.
#![expect(unsafe_code, reason = "FMI is an interface of C")]

mod common;
mod logging;
mod state;
mod steps;
mod values;

use std::ffi::{c_char, c_int, c_void};

/// What a function returns.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, with a remark.
    Warning = 1,
    /// Not done; a step that can be tried with another length.
    Discard = 2,
    /// Not done, and the instance cannot go on.
    Error = 3,
    /// Nothing can go on.
    Fatal = 4,
    /// Not done yet.
    Pending = 5,
}

/// fmi2Boolean.
pub type Boolean = c_int;
/// fmi2ValueReference.
pub type Reference = u32;
/// fmi2Component: an instance.
pub type Component = *mut c_void;
/// fmi2String.
pub type Text = *const c_char;
