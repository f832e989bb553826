//! Processor in the loop: a board looks a trajectory's poses up, and every answer is held against the host's own.
//! `kernel/pil/PROTOCOL.md` specifies what goes over the line.

mod damage;
mod port;
mod report;
mod session;

use std::io::IsTerminal as _;
use std::time::{Duration, Instant, SystemTime};

use flangeway::{ContactTable, Pose, layout};
use flangeway_pil::{Step, Unit, WheelAnswer, sides};

pub use damage::{Damages, Damaging};
pub use port::{Address, Came, Line, Port};
pub use report::{json, lines};
pub use session::{BoardIdentity, Patience, Retries, Session};

use crate::error::{Error, Result};
use crate::progress;

/// Both wheels.
const BOTH: u8 = 3;
/// Parts of the run after which something is said where there is no bar.
const PARTS: u64 = 10;

/// What to run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Steps to ask for.
    pub exchanges: u64,
    /// Share of the frames that are damaged on purpose, in each direction.
    pub damage: f64,
    /// Seed of that damage.
    pub seed: u64,
    /// How long an answer is waited for until it is asked for again (s).
    pub timeout: f64,
    /// How long any sign of the board is waited for (s).
    pub patience: f64,
}

impl Settings {
    /// Refuses values out of range.
    ///
    /// # Errors
    /// With the option and its value.
    pub fn check(&self) -> Result<()> {
        let refuse = |option: &str, message: String| Err(Error::field("", option, message));
        if self.exchanges == 0 || u32::try_from(self.exchanges).is_err() {
            return refuse("--exchanges", format!("{} is not from 1 to {}", self.exchanges, u32::MAX));
        }
        // With more nothing would come through.
        if !(0.0..=0.5).contains(&self.damage) {
            return refuse("--damage", format!("{} is not from 0 to 0.5", self.damage));
        }
        for (option, time) in [("--timeout", self.timeout), ("--patience", self.patience)] {
            if !(0.001..=3600.0).contains(&time) {
                return refuse(option, format!("{time} is not from 0.001 to 3600 s"));
            }
        }
        Ok(())
    }
}

/// What came of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The board.
    pub board: BoardIdentity,
    /// Steps that were answered.
    pub exchanges: u64,
    /// Answers in which a bit is not the host's.
    pub mismatches: u64,
    /// The first of them: its step.
    pub first_mismatch: Option<u64>,
    /// What was asked again.
    pub retries: Retries,
    /// Answers that were late or came twice, and were dropped.
    pub dropped: u64,
    /// Frames damaged on purpose on the way to the board, and to the host.
    pub damaged: [Damages; 2],
    /// The board's least and largest count of a step.
    pub counts: [u32; 2],
    /// Contacts in all answers.
    pub contacts: u64,
    /// How long it took (s).
    pub seconds: f64,
}

/// Has the board on a line look poses up, in turn and from the beginning when they end, and compares every answer.
///
/// # Errors
/// If no board answers, or one with another table.
pub fn pil<L: Line>(
    settings: &Settings,
    table: &ContactTable<'_>,
    image: &[u8],
    poses: &[Pose],
    line: L,
) -> Result<Report> {
    settings.check()?;
    let patience = Patience {
        answer: Duration::from_secs_f64(settings.timeout),
        board: Duration::from_secs_f64(settings.patience),
    };
    let line = Damaging::new(line, settings.damage, settings.seed);
    let mut session = Session::begin(line, new_number(), patience)?;
    same_table(&session.board, image)?;
    let started = Instant::now();
    let mut report = Report {
        board: session.board.clone(),
        exchanges: 0,
        mismatches: 0,
        first_mismatch: None,
        retries: Retries::default(),
        dropped: 0,
        damaged: [Damages::default(); 2],
        counts: [u32::MAX, 0],
        contacts: 0,
        seconds: 0.0,
    };
    let bar = progress::bar(settings.exchanges, "pil");
    for (sequence, pose) in (0..settings.exchanges).zip(poses.iter().cycle()) {
        let Pose { lateral, yaw, vertical, roll } = *pose;
        // `check` has seen to it that the number fits; the session fills in its own.
        let step = Step { session: 0, sequence: sequence as u32, sides: BOTH, pose: [lateral, yaw, vertical, roll] };
        let answer = session.step(&step)?;
        let here: Vec<WheelAnswer> = sides(BOTH).map(|side| (&table.contacts(side, pose)).into()).collect();
        let same = here.len() == answer.wheels.len() && here.iter().zip(&answer.wheels).all(|(a, b)| a.same_bits(b));
        if !same {
            report.mismatches += 1;
            report.first_mismatch = report.first_mismatch.or(Some(sequence));
        }
        report.exchanges += 1;
        report.contacts += answer.wheels.iter().map(|wheel| wheel.contacts.len() as u64).sum::<u64>();
        let [least, most] = report.counts;
        report.counts = [least.min(answer.count), most.max(answer.count)];
        bar.inc(1);
        say_part(report.exchanges, settings.exchanges);
    }
    bar.finish_and_clear();
    report.seconds = started.elapsed().as_secs_f64();
    report.retries = session.retries;
    report.dropped = session.dropped;
    report.damaged = [session.line.to_board, session.line.to_host];
    Ok(report)
}

/// A number for a session that hardly any before had: of the time.
fn new_number() -> u32 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(1, |time| time.as_micros() as u32)
}

/// Refuses a board with another table than the host's.
fn same_table(board: &BoardIdentity, image: &[u8]) -> Result<()> {
    let (checksum, length) = (layout::checksum(image), image.len());
    if (board.table_checksum, board.table_length as usize) == (checksum, length) {
        return Ok(());
    }
    let message = format!(
        "the table has {length} bytes and checksum {checksum:08x}, that of the board \"{}\" {} and {:08x}",
        board.name, board.table_length, board.table_checksum
    );
    Err(Error::field("", "--port", message))
}

/// Says on stderr how far it is, at every tenth part, where nobody would see a bar.
fn say_part(done: u64, all: u64) {
    if done * PARTS % all < PARTS && !std::io::stderr().is_terminal() {
        eprintln!("pil: {done} of {all} exchanges");
    }
}

/// A unit in words, for many.
fn unit_words(unit: Unit) -> &'static str {
    match unit {
        Unit::Nothing => "nothing",
        Unit::Instructions => "instructions",
        Unit::Cycles => "cycles",
    }
}
