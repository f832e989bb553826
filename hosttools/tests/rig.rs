//! `flangeway rig`: short runs. Nothing here depends on how long anything takes: on a busy machine periods are missed,
//! and then they are counted as such.

use std::sync::atomic::AtomicU64;

use crate::common::{Folder, POSES};
use flangeway::{ContactTable, Pose};
use flangeway_host::rig::{Clock, Grid, HIGHEST_RATE, Log, Wheels, run, synthetic};
use serde_json::Value;

const SHORT: &str = "rig table.fwt --duration 0.2";

fn document(folder: &Folder, words: &str) -> Value {
    let said = folder.run_well(&format!("{words} --json"));
    serde_json::from_str(&said).unwrap_or_else(|e| panic!("{e}: {said}"))
}

fn count(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count"))
}

/// Every period is accounted for, and every step looked all wheels up.
fn assert_adds_up(document: &Value, periods: u64, wheels: u64) {
    let [total, late, overruns, skipped] =
        ["total", "late_starts", "overruns", "skipped"].map(|key| count(&document["missed"][key]));
    let [steps, in_time] = ["steps", "in_time"].map(|key| count(&document[key]));
    assert_eq!(count(&document["periods"]), periods);
    assert_eq!(in_time + total, periods);
    assert_eq!(late + overruns + skipped, total);
    assert_eq!(steps + skipped, periods);
    assert_eq!(count(&document["lookups"]), steps * wheels);
}

#[test]
fn a_short_run() {
    let folder = Folder::with_table();
    let document = document(&folder, &format!("{SHORT} --svg rig.svg"));
    println!("{document:#}");
    assert_adds_up(&document, 200, 8);
    assert_eq!((count(&document["rate_hz"]), count(&document["wheels"])), (1000, 8));
    assert_eq!((&document["table"], &document["duration_s"]), (&"table.fwt".into(), &0.2.into()));
    assert_eq!(document["max_is_a_bound"], false);
    assert!(document["note"].as_str().unwrap().contains("not a bound"));
    for time in ["wakeup_lateness_s", "step_time_s", "release_to_answer_s"] {
        let quantiles = ["p50", "p99", "p99_9", "max"].map(|key| document[time][key].as_f64().unwrap());
        assert!(quantiles.is_sorted() && quantiles[3] > 0.0, "{time}: {quantiles:?}");
    }
    assert!(count(&document["contacts"]["tread"]) > 0);
    let svg = folder.read("rig.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for words in ["step time", "wake-up lateness", "time (µs, log scale)", "p99.9", "not a bound"] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn words_for_people_say_that_the_maximum_is_no_bound() {
    let output = Folder::new().run("rig --duration 0.05 --rate 2000 --wheels 1 --pollute");
    let said = String::from_utf8(output.stderr).unwrap();
    println!("{said}");
    assert!(output.status.success() && output.stdout.is_empty());
    for words in ["s1002_60e1_40 (built in)", "1 wheel at 2000 Hz", "100 periods", "p99.9", "not a bound", "pollutes"] {
        assert!(said.contains(words), "{words}");
    }
    // No terminal, no bar.
    assert!(!said.contains('\r') && !said.contains('\u{1b}'));
}

#[test]
fn a_recorded_trajectory_is_repeated() {
    let folder = Folder::with_table();
    let document = document(&folder, &format!("{SHORT} --trajectory poses.csv --wheels 6 --rate 500"));
    assert_adds_up(&document, 100, 6);
    assert_eq!(count(&document["trajectory_poses"]), 3);
    // Three wheelsets on three rows: in every step one of them hangs in the air, the others touch with both wheels.
    assert!(count(&document["contacts"]["tread"]) >= count(&document["steps"]) * 2);
}

#[test]
fn refusals() {
    let header = POSES.lines().next().unwrap();
    for (words, says) in [
        ("rig --rate 0", vec!["--rate: 0 is not from 1 to 20000 Hz"]),
        ("rig --rate 20001", vec!["--rate: 20001 is not from 1 to 20000 Hz"]),
        ("rig --wheels 0", vec!["--wheels: 0 is not from 1 to 1024"]),
        ("rig --wheels 1025", vec!["--wheels: 1025 is not from 1 to 1024"]),
        ("rig --duration NaN", vec!["--duration: NaN is not above 0"]),
        ("rig --duration inf", vec!["--duration: inf is not above 0"]),
        ("rig --duration 0", vec!["--duration: 0 is not above 0"]),
        ("rig --duration=-1", vec!["--duration: -1 is not above 0"]),
        ("rig --duration 1e9", vec!["--duration: 1000000000 is not above 0 and up to 86400 s"]),
        ("rig --duration 1e-6", vec!["--duration: 0.000001 s is shorter than a period at 1000 Hz"]),
        ("rig --priority 0", vec!["--priority: 0 is not from 1 to 99"]),
        ("rig --priority 100", vec!["--priority: 100 is not from 1 to 99"]),
        ("rig --cpu 4000", vec!["--cpu: 4000 is not from 0 to 1023"]),
        ("rig nothing.fwt", vec!["nothing.fwt: ", "No such file"]),
        ("rig poses.csv", vec!["poses.csv: ", "not a contact table"]),
        ("rig --trajectory nothing.csv", vec!["nothing.csv: ", "No such file"]),
        ("rig --trajectory empty.csv", vec!["empty.csv: ", "no poses"]),
        ("rig --trajectory words.csv", vec!["words.csv:2: ", "yaw_rad: \"left\""]),
        ("rig --duration 0.01 --svg missing/out.svg", vec!["missing/out.svg: ", "missing does not exist"]),
        ("rig --cpu 1023 --duration 0.01", vec!["--cpu: 1023 refused by the system: ", "no such CPU here?"]),
    ] {
        if words.contains("--cpu 1023") && !cfg!(target_os = "linux") {
            continue;
        }
        let folder = Folder::with_table();
        folder.write("empty.csv", format!("{header}\n"));
        folder.write("words.csv", format!("{header}\n0,left,0,0\n"));
        let before = folder.contents();
        let output = folder.run(words);
        let said = String::from_utf8_lossy(&output.stderr);
        println!("{words}: {}", said.lines().last().unwrap_or_default());
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        let last = said.lines().last().unwrap();
        assert!(last.starts_with("flangeway: "), "{words}: {said}");
        // The figures stand before a drawing that cannot be written.
        assert!(said.lines().count() == 1 || words.contains("--svg"), "{words}: {said}");
        says.iter().for_each(|words| assert!(last.contains(words), "{words:?} is not in {last}"));
        assert!(before == folder.contents(), "{words}: something was left behind");
    }
}

/// Whoever runs the tests may have the rights or not: the run is done, or it is refused in one line.
#[test]
fn rights_are_granted_or_refused_in_one_line() {
    let folder = Folder::with_table();
    for (option, help) in [("--priority 10", "CAP_SYS_NICE"), ("--lock-memory", "CAP_IPC_LOCK")] {
        let output = folder.run(&format!("rig table.fwt --duration 0.01 {option}"));
        let said = String::from_utf8_lossy(&output.stderr);
        println!("{option}: {said}");
        if output.status.code() != Some(0) {
            assert_eq!(output.status.code(), Some(2), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
            assert!(said.starts_with(&format!("flangeway: {}", &option[..6])), "{said}");
            assert!(!cfg!(target_os = "linux") || said.contains(help), "{said}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let folder = Folder::new();
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.path("full.svg")).unwrap();
    for words in ["rig --duration 0.01 --json", "rig --duration 0.01 --svg full.svg"] {
        let output = folder.run_into(words, full().into());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        let last = said.lines().last().unwrap();
        assert!(last.starts_with("flangeway: ") && last.contains("No space left on device"), "{words}: {said}");
    }
}

/// A clock that goes on by a little with every look at it.
struct Ticking(u64);

impl Clock for Ticking {
    fn now(&mut self) -> u64 {
        self.0 += 100;
        self.0
    }

    fn sleep_until(&mut self, time: u64) {
        self.0 = self.0.max(time);
    }
}

#[test]
fn the_loop_allocates_nothing() {
    let table = ContactTable::new(flangeway_tables::S1002_60E1_40_TABLE).unwrap();
    let poses: Vec<Pose> = synthetic(&table, HIGHEST_RATE);
    let (mut log, mut wheels, done) = (Log::new().unwrap(), Wheels::new(&table, &poses, 32), AtomicU64::new(0));
    let grid = Grid { start: 1_000_000, rate: HIGHEST_RATE };
    let counted = allocation_counter::measure(|| {
        run(&mut Ticking(0), &grid, 2000, &mut log, &done, |period| {
            wheels.step(period);
        });
    });
    assert_eq!((counted.count_total, counted.bytes_total), (0, 0));
    assert_eq!((log.counts.in_time, wheels.tally.lookups), (2000, 64_000));
    assert!(wheels.tally.contacts.iter().all(|count| *count > 0), "{:?}", wheels.tally);
}

/// The clock of real runs allocates nothing either.
#[test]
fn the_clock_allocates_nothing() {
    let mut clock = flangeway_host::rig::SystemClock::default();
    let counted = allocation_counter::measure(|| {
        let now = clock.now();
        clock.sleep_until(now + 1_000_000);
    });
    assert_eq!(counted.count_total, 0);
}
