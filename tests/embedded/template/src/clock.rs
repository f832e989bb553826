//! What the answers count: here instructions, by the system timer of the emulated board, to within 40. On a board of
//! yours: cycles (`Unit::Cycles`), by `cortex_m::peripheral::DWT::cycle_count`, which the emulator does not have.

use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// With QEMU's `-icount shift=0` an instruction takes a nanosecond, and a tick of the 25 MHz timer 40.
const PER_TICK: u32 = 40;
/// The timer counts down over 24 bits: 0.67 s.
const LONGEST: u32 = 0x00ff_ffff;

/// The system timer, running.
pub(crate) struct Clock(SYST);

impl Clock {
    pub(crate) fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(LONGEST);
        timer.clear_current();
        timer.enable_counter();
        Self(timer)
    }

    /// Begins anew, so that a step does not see it wrap.
    pub(crate) fn restart(&mut self) {
        self.0.clear_current();
        // It is loaded at the next tick.
        while SYST::get_current() == 0 {}
    }

    /// Instructions since then.
    pub(crate) fn now(&self) -> u32 {
        (LONGEST - SYST::get_current()) * PER_TICK
    }
}
