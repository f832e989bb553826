//! `flangeway rig`: a fixed-step loop with deadlines, and how long its steps took.

use std::path::PathBuf;

use flangeway::{ContactTable, InstructionSet};

use super::{print_json, read_table};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::poses;
use crate::report::rig::histograms;
use crate::rig::{Figures, Realtime, Settings, json, lines, rig, synthetic};

/// Name of the table that is used without one.
const OWN_TABLE: &str = "s1002_60e1_40 (built in)";

/// Arguments of `flangeway rig`.
#[derive(Debug, Clone, clap::Args)]
pub struct RigArgs {
    /// Table; a small one of S1002 on 60E1 by default
    #[arg(value_name = "T.fwt")]
    pub table: Option<PathBuf>,
    /// Steps a second (Hz), up to 20000
    #[arg(long, value_name = "HZ", default_value_t = 1000)]
    pub rate: u32,
    /// Wheels looked up in a step, two a wheelset
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub wheels: usize,
    /// Length of the run (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub duration: f64,
    /// Recorded poses, one a step, repeated at the end (CSV: y_m,yaw_rad,z_m,roll_rad); hunting and a curve by default
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Real-time priority of the loop, 1 to 99 (SCHED_FIFO)
    #[arg(long, value_name = "N")]
    pub priority: Option<u8>,
    /// CPU that the loop runs on, counted from 0
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// Keep all memory in RAM (mlockall)
    #[arg(long)]
    pub lock_memory: bool,
    /// Leave AVX2 unused: the instructions that every x86-64 processor has, for the same bits
    #[arg(long)]
    pub baseline: bool,
    /// Have a neighbour thread pollute the caches all the time
    #[arg(long)]
    pub pollute: bool,
    /// Print the figures as JSON to stdout
    #[arg(long)]
    pub json: bool,
    /// Draw the histograms of step time and wake-up lateness
    #[arg(long, value_name = "OUT.svg")]
    pub svg: Option<PathBuf>,
}

/// Runs the loop and prints the figures.
///
/// # Errors
/// On a bad table, trajectory or value, when the system refuses a priority, a CPU or locked memory, or when the
/// drawing cannot be written.
pub fn run(args: &RigArgs) -> Result<()> {
    let settings = Settings {
        rate: args.rate,
        wheels: args.wheels,
        duration: args.duration,
        pollute: args.pollute,
        realtime: Realtime { priority: args.priority, cpu: args.cpu, lock_memory: args.lock_memory },
    };
    settings.check()?;
    let read = args.table.as_deref().map(read_table).transpose()?;
    let aligned = read.map(Aligned::new);
    let image = aligned.as_ref().map_or(flangeway_tables::S1002_60E1_40_TABLE, Aligned::bytes);
    let name = args.table.as_ref().map_or_else(|| OWN_TABLE.into(), |path| path.display().to_string());
    let mut table = ContactTable::new(image).map_err(|e| Error::file(&name, e.to_string()))?;
    if args.baseline {
        table.set_instruction_set(InstructionSet::Baseline);
    }
    let (trajectory, poses) = match &args.trajectory {
        Some(path) => (path.display().to_string(), poses::read(path)?),
        None => ("hunting and a curve".into(), synthetic(&table, settings.rate)),
    };
    let (log, tally) = rig(&settings, &table, &poses)?;
    let figures = Figures {
        table: &name,
        table_bytes: image.len(),
        instructions: table.instruction_set(),
        trajectory: &trajectory,
        poses: poses.len(),
        settings: &settings,
        log: &log,
        tally: &tally,
    };
    eprintln!("{}", lines(&figures));
    if args.json {
        print_json(&json(&figures))?;
    }
    if let Some(output) = &args.svg {
        write_atomically(output, histograms(&figures)?.as_bytes())?;
        eprintln!("  drawn in {}", output.display());
    }
    Ok(())
}

/// Bytes moved so that they begin on a cache line, as a table in flash does.
struct Aligned {
    memory: Vec<u8>,
    start: usize,
    length: usize,
}

impl Aligned {
    const LINE: usize = 64;

    fn new(bytes: Vec<u8>) -> Self {
        let mut memory = vec![0; bytes.len() + Self::LINE];
        let start = memory.as_ptr().align_offset(Self::LINE).min(Self::LINE);
        memory[start..start + bytes.len()].copy_from_slice(&bytes);
        Self { memory, start, length: bytes.len() }
    }

    fn bytes(&self) -> &[u8] {
        &self.memory[self.start..self.start + self.length]
    }
}
