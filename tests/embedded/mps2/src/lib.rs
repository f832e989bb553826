//! The emulated MPS2 boards, as a vendor's peripheral access crate describes a real one: where memory lies (`memory.x`)
//! and how many interrupts there are.
#![no_std]

use cortex_m_rt as _;

unsafe extern "C" {
    /// The handler of interrupts that have no other, by `cortex-m-rt`.
    fn DefaultHandler();
}

/// The processor's table of interrupts.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [unsafe extern "C" fn(); 32] = [DefaultHandler; 32];
