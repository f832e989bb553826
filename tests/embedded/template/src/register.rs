//! Registers of the board's devices. Your board's peripheral access crate has them by name.

/// Reads a device's register.
pub(crate) fn read(register: usize) -> u32 {
    // SAFETY: called with registers alone, which this firmware uses from one place each.
    unsafe { core::ptr::with_exposed_provenance::<u32>(register).read_volatile() }
}

/// Writes it.
pub(crate) fn write(register: usize, value: u32) {
    // SAFETY: as above.
    unsafe { core::ptr::with_exposed_provenance_mut::<u32>(register).write_volatile(value) }
}
