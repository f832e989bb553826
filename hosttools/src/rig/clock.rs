//! The clock of the loop: nanoseconds that only grow, and sleep until one of them.

use std::time::{Duration, Instant};

/// What the loop needs of a clock. The tests have one of their own, so that the bookkeeping is the same every time.
pub trait Clock {
    /// The time (ns) since some moment in the past.
    fn now(&mut self) -> u64;
    /// Sleeps until a time (ns); never returns before it.
    fn sleep_until(&mut self, time: u64);
}

/// The best clock of this system.
#[cfg(target_os = "linux")]
pub type SystemClock = MonotonicClock;
/// The best clock of this system.
#[cfg(not(target_os = "linux"))]
pub type SystemClock = PortableClock;

/// CLOCK_MONOTONIC, and `clock_nanosleep` to an absolute time of it: however long the loop is held up between reading
/// the clock and falling asleep, it is woken on the grid.
#[cfg(target_os = "linux")]
#[derive(Debug, Clone, Copy, Default)]
pub struct MonotonicClock;

#[cfg(target_os = "linux")]
impl Clock for MonotonicClock {
    #[inline]
    fn now(&mut self) -> u64 {
        // Monotonic time starts at zero with the machine: both parts are positive.
        let time = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        time.tv_sec as u64 * NANOSECONDS + time.tv_nsec as u64
    }

    #[inline]
    fn sleep_until(&mut self, time: u64) {
        let target = rustix::time::Timespec {
            tv_sec: (time / NANOSECONDS) as rustix::time::Secs,
            tv_nsec: (time % NANOSECONDS) as rustix::time::Nsecs,
        };
        // A signal ends the sleep early.
        while self.now() < time {
            let _ = rustix::thread::clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &target);
        }
    }
}

/// Nanoseconds in a second.
pub(super) const NANOSECONDS: u64 = 1_000_000_000;

/// A clock of the standard library alone, which sleeps for the time that is left. Held up between reading the time and
/// falling asleep it wakes as much later.
#[derive(Debug, Clone, Copy)]
pub struct PortableClock {
    origin: Instant,
}

impl Default for PortableClock {
    fn default() -> Self {
        Self { origin: Instant::now() }
    }
}

impl Clock for PortableClock {
    fn now(&mut self) -> u64 {
        self.origin.elapsed().as_nanos() as u64
    }

    fn sleep_until(&mut self, time: u64) {
        loop {
            let left = time.saturating_sub(self.now());
            if left == 0 {
                return;
            }
            std::thread::sleep(Duration::from_nanos(left));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn never_wakes_early(clock: &mut impl Clock) {
        let before = clock.now();
        let target = before + 2_000_000;
        clock.sleep_until(target);
        let after = clock.now();
        assert!(after >= target);
        // What is past is not waited for: no more can be said of a machine with other work.
        clock.sleep_until(before);
        assert!(clock.now() >= after);
    }

    #[test]
    fn clocks_never_wake_early() {
        never_wakes_early(&mut SystemClock::default());
        never_wakes_early(&mut PortableClock::default());
    }
}
