//! C interface to Flangeway, for simulators and rigs: `include/flangeway.h`, written by cbindgen from this crate.
//!
//! No std, no allocation, no state: a table is memory of the caller's. Whatever C can check is checked (null and
//! misaligned pointers, lengths, numbers that are none, tables that were not loaded), and every function returns a
//! [`Status`]. What C cannot check, that a pointer which looks good points to what it is declared to, is the caller's
//! promise.
#![no_std]
#![expect(clippy::missing_safety_doc, reason = "the same for all, and said above and in the header")]

#[cfg(feature = "cost")]
mod cost;
mod lookup;
mod pointer;
mod status;
mod table;
mod types;
mod wheelset;

pub use lookup::*;
pub use status::*;
pub use table::*;
pub use types::*;
pub use wheelset::*;

use core::ffi::c_char;

/// Version of this interface: grows when a struct or a function changes. Compare with `flangeway_interface_version()`.
pub const FLANGEWAY_INTERFACE_VERSION: u32 = 1;

/// FLANGEWAY_INTERFACE_VERSION of the library.
#[unsafe(no_mangle)]
pub extern "C" fn flangeway_interface_version() -> u32 {
    FLANGEWAY_INTERFACE_VERSION
}

/// Format version of the tables that the library reads.
#[unsafe(no_mangle)]
pub extern "C" fn flangeway_format_version() -> u32 {
    flangeway::layout::VERSION
}

/// The library's version, as in "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn flangeway_version() -> *const c_char {
    VERSION.as_ptr().cast()
}

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");

// The C library's memcpy and the like.
#[cfg(not(target_os = "none"))]
#[link(name = "c")]
unsafe extern "C" {}

/// The kernel never panics; whatever else did would stop here.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
