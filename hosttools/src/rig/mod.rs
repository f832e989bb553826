//! A fixed-step loop as a hardware-in-the-loop rig runs it: a grid of periods, all wheels looked up in each.

mod clock;
mod realtime;
mod report;
mod schedule;
mod trajectory;

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use flangeway::{ContactTable, Contacts, Pose, SLOTS, Side};

pub use clock::{Clock, PortableClock, SystemClock};
pub use realtime::Realtime;
pub use report::{Figures, NOTE, Quantiles, json, lines};
pub use schedule::{Counts, Grid, Log, run};
pub use trajectory::synthetic;

use crate::error::{Error, Result};
use crate::progress;

/// Most periods a second (Hz).
pub const HIGHEST_RATE: u32 = 20_000;
/// Most wheels in a step.
pub const MOST_WHEELS: usize = 1024;
/// Longest run (s).
pub const LONGEST_RUN: f64 = 86_400.0;

/// Steps before the loop, not written down: they bring in code, table and stack.
const REHEARSAL: u64 = 200;
/// From the end of the preparations to the first release (ns); the neighbour gets going meanwhile.
const LEAD: u64 = 100_000_000;
/// Bytes that the neighbour writes over: more than most caches hold.
const POLLUTED: usize = 64 << 20;
/// How often a bar is redrawn.
const WATCH: Duration = Duration::from_millis(200);

/// What to run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Periods a second (Hz).
    pub rate: u32,
    /// Wheels in a step, from the right one of the first wheelset.
    pub wheels: usize,
    /// Length of the run (s).
    pub duration: f64,
    /// Have a neighbour thread write over memory all the time.
    pub pollute: bool,
    /// Wishes for the loop's thread.
    pub realtime: Realtime,
}

impl Settings {
    /// Refuses values out of range.
    ///
    /// # Errors
    /// With the option and its value.
    pub fn check(&self) -> Result<()> {
        let refuse = |option: &str, message: String| Err(Error::field("", option, message));
        if !(1..=HIGHEST_RATE).contains(&self.rate) {
            return refuse("--rate", format!("{} is not from 1 to {HIGHEST_RATE} Hz", self.rate));
        }
        if !(1..=MOST_WHEELS).contains(&self.wheels) {
            return refuse("--wheels", format!("{} is not from 1 to {MOST_WHEELS}", self.wheels));
        }
        // NaN is not above zero.
        if !(self.duration > 0.0 && self.duration <= LONGEST_RUN) {
            return refuse("--duration", format!("{} is not above 0 and up to {LONGEST_RUN} s", self.duration));
        }
        if self.periods() == 0 {
            return refuse("--duration", format!("{} s is shorter than a period at {} Hz", self.duration, self.rate));
        }
        self.realtime.check()
    }

    /// Periods in the run.
    #[must_use]
    pub fn periods(&self) -> u64 {
        (self.duration * f64::from(self.rate)).round() as u64
    }
}

/// The wheels of a train on a trajectory with a row for each period, repeated when it ends. The wheelsets are spread
/// evenly over it, so that one step looks up different regions of the table.
#[derive(Debug, Clone)]
pub struct Wheels<'a> {
    table: &'a ContactTable<'a>,
    poses: &'a [Pose],
    /// Row of each wheel at period 0.
    starts: Vec<usize>,
    /// The wheels of a step, and what is found of them: room made once.
    wheels: Vec<(Side, Pose)>,
    found: Vec<Contacts>,
    /// What was found.
    pub tally: Tally,
}

/// What the lookups found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Lookups of a wheel.
    pub lookups: u64,
    /// Contacts by slot.
    pub contacts: [u64; SLOTS],
    /// Lookups with flags (outside the table, conformal).
    pub remarks: u64,
}

impl<'a> Wheels<'a> {
    /// A number of wheels, two a wheelset, on a trajectory of at least one pose.
    #[must_use]
    pub fn new(table: &'a ContactTable<'a>, poses: &'a [Pose], count: usize) -> Self {
        let sets = count.div_ceil(2).max(1);
        Self {
            table,
            poses,
            starts: (0..count).map(|i| i / 2 * poses.len() / sets).collect(),
            wheels: (0..count).map(|i| (Side::ALL[i % 2], Pose::default())).collect(),
            found: vec![Contacts::NONE; count],
            tally: Tally::default(),
        }
    }

    /// The step of a period: all wheels in one call, which asks for their records before it needs them. Allocates
    /// nothing.
    pub fn step(&mut self, period: u64) {
        let row = (period % self.poses.len() as u64) as usize;
        for ((_, pose), start) in self.wheels.iter_mut().zip(&self.starts) {
            let at = row + start;
            *pose = self.poses[if at < self.poses.len() { at } else { at - self.poses.len() }];
        }
        self.table.contacts_many(&self.wheels, &mut self.found);
        for found in black_box(&self.found) {
            self.tally.lookups += 1;
            self.tally.remarks += u64::from(!found.flags.is_empty());
            for contact in found {
                self.tally.contacts[contact.slot.index()] += 1;
            }
        }
    }
}

/// Runs the loop on a thread of its own, with the wishes of `settings` for it, and watches it from this one.
///
/// # Errors
/// When the system refuses a wish; then no step was done.
pub fn rig(settings: &Settings, table: &ContactTable<'_>, poses: &[Pose]) -> Result<(Log, Tally)> {
    settings.check()?;
    if poses.is_empty() {
        return Err(Error::field("", "--trajectory", "no poses"));
    }
    let periods = settings.periods();
    let bar = if settings.duration > 1.0 { progress::bar(periods, "rig") } else { indicatif::ProgressBar::hidden() };
    let (mut log, mut wheels) = (Log::new()?, Wheels::new(table, poses, settings.wheels));
    let (done, stop) = (AtomicU64::new(0), AtomicBool::new(false));
    let (ready, is_ready) = mpsc::sync_channel(1);
    let watcher = thread::current();
    thread::scope(|scope| {
        let the_loop = scope.spawn(|| {
            let applied = settings.realtime.apply();
            let refused = applied.is_err();
            if ready.send(applied).is_err() || refused {
                return;
            }
            (0..REHEARSAL).for_each(|period| wheels.step(period));
            wheels.tally = Tally::default();
            let mut clock = SystemClock::default();
            let grid = Grid { start: clock.now() + LEAD, rate: settings.rate };
            run(&mut clock, &grid, periods, &mut log, &done, |period| wheels.step(period));
            watcher.unpark();
        });
        // No message: the thread panicked, and the scope hands that on.
        if let Ok(applied) = is_ready.recv() {
            applied?;
        }
        if settings.pollute {
            scope.spawn(|| pollute(&stop));
        }
        while !the_loop.is_finished() {
            bar.set_position(done.load(Ordering::Relaxed));
            thread::park_timeout(WATCH);
        }
        bar.finish_and_clear();
        stop.store(true, Ordering::Relaxed);
        Ok(())
    })?;
    Ok((log, wheels.tally))
}

/// Writes one byte of every cache line of a large buffer, over and over.
fn pollute(stop: &AtomicBool) {
    let mut memory = vec![0_u8; POLLUTED];
    while !stop.load(Ordering::Relaxed) {
        for block in memory.chunks_mut(1 << 20) {
            block.iter_mut().step_by(64).for_each(|byte| *byte = byte.wrapping_add(1));
            if stop.load(Ordering::Relaxed) {
                break;
            }
        }
        black_box(&mut memory);
    }
}
