//! Instructions, counted by the system timer. Under QEMU's `-icount shift=0` an instruction takes a nanosecond of virtual
//! time, whatever it does: these are instructions, not cycles of any processor.

use cortex_m::peripheral::{CPUID, SYST, syst::SystClkSource};

/// Calls that are timed together: enough that the error of a tick at either end, of the calls and of the floor that is
/// subtracted, is less than half an instruction a call.
const CALLS: u32 = 176;
/// The same without an FPU for `f64`, where the count depends on the case, is thousands, and need be known to within five.
const FEW_CALLS: u32 = 16;
/// Instructions between two ticks: both boards run their timer at 25 MHz, a tick in 40 ns.
const PER_TICK: u32 = 40;
/// The timer counts down over 24 bits.
const LONGEST: u32 = 0x00ff_ffff;

/// The system timer, running.
pub(crate) struct Counter {
    calls: u32,
}

impl Counter {
    pub(crate) fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(LONGEST);
        timer.clear_current();
        timer.enable_counter();
        Self { calls: CALLS }
    }

    /// For what is looked up: few calls unless this is a Cortex-M7.
    pub(crate) fn for_lookups(&self) -> Self {
        const PART: u32 = 0xfff0;
        const CORTEX_M7: u32 = 0xc270;
        // SAFETY: a register that is only read.
        let base = unsafe { (*CPUID::PTR).base.read() };
        Self { calls: if base & PART == CORTEX_M7 { CALLS } else { FEW_CALLS } }
    }

    /// Ticks that a number of calls take, and the loop around them.
    pub(crate) fn ticks(&self, mut call: impl FnMut()) -> u32 {
        let before = SYST::get_current();
        (0..self.calls).for_each(|_| call());
        before.wrapping_sub(SYST::get_current()) & LONGEST
    }

    /// Instructions of a call, from the ticks of all, rounded to the nearest.
    pub(crate) fn instructions(&self, ticks: u32) -> u32 {
        (ticks * PER_TICK + self.calls / 2) / self.calls
    }
}

/// A thousand instructions that do nothing: the counter is checked against them.
pub(crate) fn thousand() {
    // SAFETY: they do nothing.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack, preserves_flags)) }
}
