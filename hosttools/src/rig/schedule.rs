//! The fixed-step loop and its bookkeeping: which periods were answered in time.
//!
//! Period k is released at `start + k / rate` and its answer is due when the next one is released. A step is
//!
//! - **in time** when it ended by then,
//! - **started late** when it began only then or later (the wake-up took all of the period),
//! - **overrun** when it began in its period and ended after it.
//!
//! After a step that ended past its period the loop waits for the next release; releases that went by meanwhile are
//! **skipped**: counted as missed, and not made up for. A rig wants that, because its inputs and outputs are sampled on
//! the grid by hardware: a burst of catch-up steps would answer several old periods between two samples, of which only
//! the last is seen, and would take the time that the present period needs. The grid stands still, and the trajectory
//! goes on with it: simulated time never falls behind.

use std::sync::atomic::{AtomicU64, Ordering};

use hdrhistogram::Histogram;

use super::clock::{Clock, NANOSECONDS};
use crate::error::{Error, Result};

/// The times at which periods are released.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Release of period 0 (ns).
    pub start: u64,
    /// Periods a second (Hz).
    pub rate: u32,
}

impl Grid {
    /// Release of a period (ns), rounded down to the nanosecond from the exact grid, so that it never drifts.
    #[inline]
    #[must_use]
    pub fn release(&self, period: u64) -> u64 {
        self.start + period * NANOSECONDS / u64::from(self.rate)
    }

    /// The first period released at a time (ns) or after it.
    #[inline]
    #[must_use]
    pub fn first_from(&self, time: u64) -> u64 {
        (time.saturating_sub(self.start) * u64::from(self.rate)).div_ceil(NANOSECONDS)
    }
}

/// How many periods ended how.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Periods whose step ended in them.
    pub in_time: u64,
    /// Periods whose step began after their end.
    pub late_starts: u64,
    /// Periods whose step began in them and ended after their end.
    pub overruns: u64,
    /// Periods without a step.
    pub skipped: u64,
}

impl Counts {
    /// Steps done.
    #[must_use]
    pub const fn steps(&self) -> u64 {
        self.in_time + self.late_starts + self.overruns
    }

    /// Missed deadlines: periods without an answer in time.
    #[must_use]
    pub const fn missed(&self) -> u64 {
        self.late_starts + self.overruns + self.skipped
    }
}

/// What the loop writes down. All its memory is there before the loop begins.
#[derive(Debug, Clone)]
pub struct Log {
    /// How the periods ended.
    pub counts: Counts,
    /// From a period's release to the begin of its step (ns).
    pub lateness: Histogram<u64>,
    /// From the begin of a step to its end (ns).
    pub step: Histogram<u64>,
    /// From a period's release to the end of its step (ns): what the deadline is held against.
    pub answer: Histogram<u64>,
}

/// Longest time (ns) that the histograms tell from longer ones.
const LONGEST: u64 = 100 * NANOSECONDS;

impl Log {
    /// An empty log, its memory touched.
    ///
    /// # Errors
    /// When the histograms cannot be made.
    pub fn new() -> Result<Self> {
        let histogram = || {
            let made = Histogram::new_with_bounds(1, LONGEST, 3);
            let mut histogram = made.map_err(|e| Error::field("", "histogram", e.to_string()))?;
            // Writes to every page of it, so that none is fetched in the loop.
            histogram.reset();
            Ok::<_, Error>(histogram)
        };
        Ok(Self { counts: Counts::default(), lateness: histogram()?, step: histogram()?, answer: histogram()? })
    }

    /// Writes a step down, by its period and the times (ns) of its begin and end.
    #[inline]
    fn record(&mut self, grid: &Grid, period: u64, began: u64, ended: u64) {
        let (release, due) = (grid.release(period), grid.release(period + 1));
        self.lateness.saturating_record(began.saturating_sub(release));
        self.step.saturating_record(ended.saturating_sub(began));
        self.answer.saturating_record(ended.saturating_sub(release));
        if ended <= due {
            self.counts.in_time += 1;
        } else if began >= due {
            self.counts.late_starts += 1;
        } else {
            self.counts.overruns += 1;
        }
    }
}

/// Runs a number of periods. `step` is called with the period's number; `done` follows for those who watch. Allocates
/// nothing and prints nothing.
pub fn run(
    clock: &mut impl Clock,
    grid: &Grid,
    periods: u64,
    log: &mut Log,
    done: &AtomicU64,
    mut step: impl FnMut(u64),
) {
    let mut period = 0;
    while period < periods {
        clock.sleep_until(grid.release(period));
        let began = clock.now();
        step(period);
        let ended = clock.now();
        log.record(grid, period, began, ended);
        let next = grid.first_from(ended).clamp(period + 1, periods);
        log.counts.skipped += next - (period + 1);
        period = next;
        done.store(period, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    const PERIOD: u64 = 1_000_000;
    const GRID: Grid = Grid { start: 5 * PERIOD, rate: 1000 };

    /// A clock that the test moves: every wake-up comes late by what stands in the script for that period.
    struct Script<'a> {
        time: &'a Cell<u64>,
        late: fn(u64) -> u64,
    }

    impl Clock for Script<'_> {
        fn now(&mut self) -> u64 {
            self.time.get()
        }

        fn sleep_until(&mut self, time: u64) {
            let period = (time - GRID.start) / PERIOD;
            self.time.set(self.time.get().max(time) + (self.late)(period));
        }
    }

    /// Runs ten periods with wake-ups and steps of these lengths (ns) by period; answers the log, the periods that had
    /// a step, and the time at the end.
    fn scripted(late: fn(u64) -> u64, length: fn(u64) -> u64) -> (Log, Vec<u64>, u64) {
        let time = Cell::new(0);
        let (mut log, mut stepped, done) = (Log::new().unwrap(), Vec::new(), AtomicU64::new(0));
        run(&mut Script { time: &time, late }, &GRID, 10, &mut log, &done, |period| {
            stepped.push(period);
            time.set(time.get() + length(period));
        });
        assert_eq!(done.into_inner(), 10);
        assert_eq!(log.counts.steps() + log.counts.skipped, 10);
        assert_eq!(log.counts.in_time + log.counts.missed(), 10);
        assert_eq!(log.step.len(), log.counts.steps());
        (log, stepped, time.get())
    }

    #[test]
    fn all_in_time() {
        let (log, stepped, end) = scripted(|_| 2_000, |_| 10_000);
        assert_eq!(log.counts, Counts { in_time: 10, ..Counts::default() });
        assert_eq!(stepped, (0..10).collect::<Vec<_>>());
        assert_eq!(end, GRID.release(9) + 12_000);
        assert_eq!((log.lateness.min(), log.step.min(), log.answer.min()), (2_000, 10_000, 12_000));
    }

    #[test]
    fn an_end_on_the_next_release_is_in_time() {
        let (log, stepped, end) = scripted(|_| 0, |_| PERIOD);
        assert_eq!(log.counts, Counts { in_time: 10, ..Counts::default() });
        assert_eq!((stepped.len(), end), (10, GRID.release(10)));
        // A nanosecond more and every other period is lost.
        let (log, stepped, end) = scripted(|_| 0, |_| PERIOD + 1);
        assert_eq!(log.counts, Counts { overruns: 5, skipped: 5, ..Counts::default() });
        assert_eq!((stepped, end), (vec![0, 2, 4, 6, 8], GRID.release(9) + 1));
    }

    #[test]
    fn an_overrun_skips_releases_and_returns_to_the_grid() {
        // Step 3 takes 2.5 periods: it ends in period 5, so 4 and 5 are gone, and 6 begins on its release.
        let (log, stepped, end) = scripted(|_| 0, |period| if period == 3 { 5 * PERIOD / 2 } else { 1_000 });
        assert_eq!(log.counts, Counts { in_time: 7, overruns: 1, skipped: 2, ..Counts::default() });
        assert_eq!(stepped, [0, 1, 2, 3, 6, 7, 8, 9]);
        assert_eq!(end, GRID.release(9) + 1_000);
        assert_eq!(log.lateness.max(), 0);
    }

    #[test]
    fn a_late_wake_up_within_the_period_is_no_miss() {
        let (log, stepped, _) = scripted(|period| if period == 4 { PERIOD / 2 } else { 0 }, |_| 1_000);
        assert_eq!((log.counts.missed(), stepped.len()), (0, 10));
        assert!(log.lateness.equivalent(log.lateness.max(), PERIOD / 2));
    }

    #[test]
    fn a_wake_up_after_the_period_is_a_late_start() {
        // Period 4 is slept through to the middle of 6: its step is done and late, 5 and 6 are skipped.
        let (log, stepped, _) = scripted(|period| if period == 4 { 5 * PERIOD / 2 } else { 0 }, |_| 1_000);
        assert_eq!(log.counts, Counts { in_time: 7, late_starts: 1, skipped: 2, ..Counts::default() });
        assert_eq!(stepped, [0, 1, 2, 3, 4, 7, 8, 9]);
    }

    #[test]
    fn a_step_past_the_end_of_the_run_skips_what_is_left() {
        let (log, stepped, _) = scripted(|_| 0, |period| if period == 7 { 50 * PERIOD } else { 0 });
        assert_eq!(log.counts, Counts { in_time: 7, overruns: 1, skipped: 2, ..Counts::default() });
        assert_eq!(stepped.last(), Some(&7));
    }

    #[test]
    fn the_grid_does_not_drift_at_rates_that_do_not_divide_a_second() {
        let grid = Grid { start: 17, rate: 3000 };
        assert_eq!(grid.release(3000 * 86_400), 17 + 86_400 * NANOSECONDS);
        for period in [0, 1, 2, 3, 1000, 2999, 3000, 123_456_789] {
            let release = grid.release(period);
            assert_eq!(grid.first_from(release), period);
            assert_eq!(grid.first_from(release + 1), period + 1);
        }
        assert_eq!(grid.first_from(0), 0);
    }
}
