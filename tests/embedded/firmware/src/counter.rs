//! Instructions, counted by the system timer. Under QEMU's `-icount shift=0` an instruction takes a nanosecond of virtual
//! time, whatever it does: these are instructions, not cycles of any processor.

use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// Calls that are timed together: enough that the error of a tick at either end is less than half an instruction a call.
const CALLS: u32 = 256;
/// Instructions between two ticks: both boards run their timer at 25 MHz, a tick in 40 ns.
const PER_TICK: u32 = 40;
/// The timer counts down over 24 bits.
const LONGEST: u32 = 0x00ff_ffff;

/// The system timer, running.
pub(crate) struct Counter(());

impl Counter {
    pub(crate) fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(LONGEST);
        timer.clear_current();
        timer.enable_counter();
        Self(())
    }

    /// Ticks that a number of calls take, and the loop around them.
    pub(crate) fn ticks(&self, mut call: impl FnMut()) -> u32 {
        let before = SYST::get_current();
        (0..CALLS).for_each(|_| call());
        before.wrapping_sub(SYST::get_current()) & LONGEST
    }
}

/// Instructions of a call, from the ticks of all, rounded to the nearest.
pub(crate) fn instructions(ticks: u32) -> u32 {
    (ticks * PER_TICK + CALLS / 2) / CALLS
}

/// A thousand instructions that do nothing: the counter is checked against them.
pub(crate) fn thousand() {
    // SAFETY: they do nothing.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack, preserves_flags)) }
}
