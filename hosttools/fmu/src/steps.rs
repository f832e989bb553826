//! Life of an instance (2.1.4 to 2.1.6) and its steps (4.2).

use std::ffi::{CStr, CString, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use flangeway_host::fmu::instance::Instance;
use flangeway_host::fmu::{Mode, description};

use crate::common::{Unit, on};
use crate::logging::{Callbacks, Log};
use crate::{Boolean, Component, Status, Text};

/// fmi2CoSimulation among the types of units.
const CO_SIMULATION: c_int = 1;

/// Header version that the types are of.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> Text {
    c"default".as_ptr()
}

/// Version of FMI.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> Text {
    c"2.0".as_ptr()
}

/// Whether everything is logged. Errors always are, whatever the categories.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: Component,
    on_or_off: Boolean,
    _count: usize,
    _categories: *const Text,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            unit.log.all = on_or_off != 0;
            Ok(())
        })
    }
}

/// Makes an instance; null, and a message in the log, if it cannot be made.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: Text,
    kind: c_int,
    guid: Text,
    resources: Text,
    callbacks: *const Callbacks,
    _visible: Boolean,
    logging: Boolean,
) -> Component {
    // SAFETY: the standard's promise: a text or null.
    let text = |text: Text| (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy());
    let (name, guid, resources) = (text(name).unwrap_or_default(), text(guid).unwrap_or_default(), text(resources));
    // SAFETY: the standard's promise: the callbacks outlive the instance.
    let log = unsafe { Log::new(callbacks, &name, logging) };
    let made = catch_unwind(AssertUnwindSafe(|| {
        if kind != CO_SIMULATION {
            return Err("this unit is for co-simulation".into());
        }
        let Some(mode) = Mode::ALL.into_iter().find(|mode| description::guid(*mode) == guid) else {
            return Err(format!("modelDescription.xml is of another version: its guid is {guid}"));
        };
        Ok(Instance::new(mode, &folder(&resources.unwrap_or_default())))
    }));
    match made {
        Ok(Ok(instance)) => {
            log.note("instantiated");
            Box::into_raw(Box::new(Unit { instance, log, last_string: CString::default() })).cast()
        }
        Ok(Err(message)) => {
            log.error(Status::Error, &message);
            std::ptr::null_mut()
        }
        Err(_) => {
            log.error(Status::Fatal, "an error inside the library: please report it");
            std::ptr::null_mut()
        }
    }
}

/// The folder of a URI such as file:///a%20b/resources; a plain path is taken as well.
fn folder(uri: &str) -> PathBuf {
    let path = uri.strip_prefix("file:").unwrap_or(uri);
    // file:///path and file://host/path have an authority, file:/path has none.
    let path = path.strip_prefix("//").map_or(path, |rest| rest.find('/').map_or(rest, |slash| &rest[slash..]));
    let bytes = path.as_bytes();
    let mut plain = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = path.get(at + 1..at + 3).and_then(|hex| u8::from_str_radix(hex, 16).ok());
        match code {
            Some(code) if bytes[at] == b'%' => {
                plain.push(code);
                at += 3;
            }
            _ => {
                plain.push(bytes[at]);
                at += 1;
            }
        }
    }
    let plain = String::from_utf8_lossy(&plain).into_owned();
    // file:///C:/path
    let drive = plain.as_bytes().get(2) == Some(&b':');
    Path::new(if cfg!(windows) && drive { &plain[1..] } else { &plain }).into()
}

/// Frees an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: Component) {
    if !c.is_null() {
        // SAFETY: made by fmi2Instantiate, and by the standard's promise not freed yet.
        drop(unsafe { Box::from_raw(c.cast::<Unit>()) });
    }
}

/// Start and end of the simulation; nothing here depends on the time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: Component,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start: f64,
    _stop_defined: Boolean,
    _stop: f64,
) -> Status {
    // SAFETY: the standard's promise.
    unsafe { on(c, |_| if start.is_finite() { Ok(()) } else { Err(format!("the start time cannot be {start}")) }) }
}

/// Reads the table.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: Component) -> Status {
    // SAFETY: the standard's promise.
    unsafe { on(c, |unit| unit.instance.enter_initialization()) }
}

/// Puts the wheelset at rest on its rails.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: Component) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            unit.instance.exit_initialization()?;
            unit.log.note("initialized");
            Ok(())
        })
    }
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: Component) -> Status {
    // SAFETY: the standard's promise.
    unsafe { on(c, |unit| unit.instance.terminate()) }
}

/// Back to the start values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: Component) -> Status {
    // SAFETY: the standard's promise.
    unsafe {
        on(c, |unit| {
            unit.instance.reset();
            Ok(())
        })
    }
}

/// A communication step (4.2.2).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(c: Component, _time: f64, length: f64, _no_return: Boolean) -> Status {
    // SAFETY: the standard's promise.
    unsafe { on(c, |unit| unit.instance.step(length)) }
}

/// Steps are done when they return: there is none to cancel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: Component) -> Status {
    // SAFETY: the standard's promise.
    unsafe { on(c, |_| Err("no step is pending".into())) }
}
