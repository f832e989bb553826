//! A run in figures: text and JSON.

use flangeway::{InstructionSet, Slot};
use hdrhistogram::Histogram;
use serde_json::{Value, json as object};

use super::{Counts, Log, Settings, Tally};

/// What must not be forgotten about every maximum here.
pub const NOTE: &str = "the maximum is an observation of this run on this machine, not a bound";

/// Quantiles of a time (s), to three significant digits.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Quantiles {
    /// Half of the steps took no longer.
    pub p50: f64,
    /// 99 % of them.
    pub p99: f64,
    /// 99.9 % of them.
    pub p99_9: f64,
    /// The longest seen.
    pub max: f64,
}

impl Quantiles {
    /// Of a histogram of nanoseconds.
    #[must_use]
    pub fn of(histogram: &Histogram<u64>) -> Self {
        let at = |quantile: f64| histogram.value_at_quantile(quantile) as f64 / 1e9;
        Self { p50: at(0.5), p99: at(0.99), p99_9: at(0.999), max: histogram.max() as f64 / 1e9 }
    }
}

/// A run and what came of it.
#[derive(Debug, Clone, Copy)]
pub struct Figures<'a> {
    /// Name of the table.
    pub table: &'a str,
    /// Size of the table (bytes).
    pub table_bytes: usize,
    /// What the lookups were made of.
    pub instructions: InstructionSet,
    /// Name of the trajectory.
    pub trajectory: &'a str,
    /// Poses of the trajectory.
    pub poses: usize,
    /// What was run.
    pub settings: &'a Settings,
    /// Times and counts.
    pub log: &'a Log,
    /// What the lookups found.
    pub tally: &'a Tally,
}

impl Figures<'_> {
    /// The times that are reported, with their names in words and in the JSON.
    fn times(&self) -> [(&'static str, &'static str, Quantiles); 3] {
        let Log { lateness, step, answer, .. } = self.log;
        [
            ("wake-up lateness (µs)", "wakeup_lateness_s", Quantiles::of(lateness)),
            ("step time (µs)", "step_time_s", Quantiles::of(step)),
            ("release to answer (µs)", "release_to_answer_s", Quantiles::of(answer)),
        ]
    }
}

/// The run in lines for people.
#[must_use]
pub fn lines(figures: &Figures<'_>) -> String {
    let Figures { settings, log, tally, .. } = figures;
    let Counts { in_time, late_starts, overruns, skipped } = log.counts;
    let mut lines = vec![
        format!(
            "table {} ({} bytes, {} instructions), {} wheel{} at {} Hz for {} s, trajectory {}{}",
            figures.table,
            figures.table_bytes,
            figures.instructions,
            settings.wheels,
            if settings.wheels == 1 { "" } else { "s" },
            settings.rate,
            settings.duration,
            figures.trajectory,
            if settings.pollute { ", beside a neighbour that pollutes the caches" } else { "" }
        ),
        format!(
            "{} periods, {in_time} in time, {} missed: {late_starts} started late, {overruns} overran, {skipped} skipped",
            settings.periods(),
            log.counts.missed()
        ),
        format!("{:>24} {:>10} {:>10} {:>10} {:>10}", "", "p50", "p99", "p99.9", "max"),
    ];
    lines.extend(figures.times().map(|(name, _, q)| {
        let values = [q.p50, q.p99, q.p99_9, q.max].map(|v| format!("{:>10.2}", 1e6 * v));
        format!("{name:>24} {}", values.join(" "))
    }));
    let contacts = Slot::ALL.map(|slot| format!("{} on the {slot}", tally.contacts[slot.index()]));
    let remarks = match tally.remarks {
        0 => String::new(),
        count => format!("; {count} with remarks (outside the table, conformal)"),
    };
    lines.push(format!("{} lookups, contacts: {}{remarks}", tally.lookups, contacts.join(", ")));
    lines.push(format!("note: {NOTE}"));
    lines.join("\n")
}

/// The run as a JSON document.
#[must_use]
pub fn json(figures: &Figures<'_>) -> Value {
    let Figures { settings, log, tally, .. } = figures;
    let mut document = object!({
        "table": figures.table,
        "table_bytes": figures.table_bytes,
        "instructions": figures.instructions.to_string(),
        "trajectory": figures.trajectory,
        "trajectory_poses": figures.poses,
        "wheels": settings.wheels,
        "rate_hz": settings.rate,
        "duration_s": settings.duration,
        "pollute": settings.pollute,
        "priority": settings.realtime.priority,
        "cpu": settings.realtime.cpu,
        "lock_memory": settings.realtime.lock_memory,
        "periods": settings.periods(),
        "steps": log.counts.steps(),
        "in_time": log.counts.in_time,
        "missed": {
            "total": log.counts.missed(),
            "late_starts": log.counts.late_starts,
            "overruns": log.counts.overruns,
            "skipped": log.counts.skipped,
        },
        "lookups": tally.lookups,
        "lookups_with_remarks": tally.remarks,
        "contacts": Slot::ALL.map(|slot| (slot.to_string().replace(' ', "_"), tally.contacts[slot.index()]))
            .into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        "max_is_a_bound": false,
        "note": NOTE,
    });
    for (_, key, quantiles) in figures.times() {
        document[key] = object!(quantiles);
    }
    document
}
