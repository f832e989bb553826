//! The importer's log.

use std::ffi::{CString, c_char, c_void};

use crate::{Boolean, Status, Text};

/// fmi2CallbackLogger.
type Logger =
    unsafe extern "C" fn(environment: *mut c_void, instance: Text, status: Status, category: Text, message: Text, ...);

/// fmi2CallbackFunctions (2.1.5). Memory is this library's own, which the standard allows.
#[repr(C)]
pub struct Callbacks {
    logger: Option<Logger>,
    allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    environment: *mut c_void,
}

/// Where messages of an instance go.
pub(crate) struct Log {
    logger: Option<Logger>,
    environment: *mut c_void,
    name: CString,
    /// Errors are told always, the rest if asked for.
    pub(crate) all: bool,
}

impl Log {
    /// # Safety
    /// `callbacks` must be null or point to the importer's callbacks, which stay valid as long as the log.
    pub(crate) unsafe fn new(callbacks: *const Callbacks, name: &str, all: Boolean) -> Self {
        // SAFETY: null is none; the rest is the caller's promise.
        let callbacks = unsafe { callbacks.as_ref() };
        Self {
            logger: callbacks.and_then(|callbacks| callbacks.logger),
            environment: callbacks.map_or(std::ptr::null_mut(), |callbacks| callbacks.environment),
            name: text(name),
            all: all != 0,
        }
    }

    /// Tells the importer why a call failed.
    pub(crate) fn error(&self, status: Status, message: &str) {
        self.tell(status, c"logStatusError".as_ptr(), message);
    }

    /// Tells the importer what is going on, if it wants to know.
    pub(crate) fn note(&self, message: &str) {
        if self.all {
            self.tell(Status::Ok, c"logAll".as_ptr(), message);
        }
    }

    fn tell(&self, status: Status, category: *const c_char, message: &str) {
        let Some(logger) = self.logger else { return };
        // The message is a format of printf without arguments: not all importers take arguments.
        let message = text(&message.replace('%', "%%"));
        // SAFETY: the importer's function as the standard declares it; texts end with zero and live through the call.
        unsafe { logger(self.environment, self.name.as_ptr(), status, category, message.as_ptr()) };
    }
}

/// Text for C, without zeros inside.
pub(crate) fn text(message: &str) -> CString {
    CString::new(message.replace('\0', " ")).unwrap_or_default()
}
