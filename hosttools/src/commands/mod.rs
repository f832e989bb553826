//! The commands of the `flangeway` program, one module each. Machine output goes to stdout or `-o`, words and
//! progress to stderr.

pub mod campaign;
pub mod compile;
pub mod creep;
pub mod fmu;
pub mod inspect;
pub mod lookup;
pub mod merge;
pub mod pil;
pub mod profile;
pub mod quickstart;
pub mod reproduce;
pub mod rig;
pub mod rigid;
pub mod simulate;
pub mod solve;
pub mod verify;

use std::io::Write as _;
use std::path::Path;

use clap::{Parser, Subcommand};
use flangeway::ContactTable;

use crate::error::{Error, Result};

/// Wheel-rail contact tables for real-time simulators.
#[derive(Debug, Parser)]
#[command(name = "flangeway", version, about)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// How a command ended that did not fail on its input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Everything was done.
    Done,
    /// The work was done, and what it checked does not hold.
    CheckFailed,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Tables for every combination of wheels, rails and settings, here or on a Slurm cluster
    Campaign(campaign::CampaignArgs),
    /// Compile a contact table from a recipe
    Compile(compile::CompileArgs),
    /// Creep forces of contacts by one of four laws
    Creep(creep::CreepArgs),
    /// Pack a wheelset as a co-simulation unit (FMI 2.0)
    Fmu(fmu::FmuArgs),
    /// Print what a table says of itself
    Inspect(inspect::InspectArgs),
    /// Contacts of poses by a table
    Lookup(lookup::LookupArgs),
    /// Have a board look contacts up over a serial line, and compare every answer with the host's
    Pil(pil::PilArgs),
    /// Put the shards of a table together
    Merge(merge::MergeArgs),
    /// Say what a profile file was taken for, and draw it with its slope and curvature
    Profile(profile::ProfileArgs),
    /// S1002 on 60E1: compile, verify, look up, and write a report, in well under a minute
    Quickstart(quickstart::QuickstartArgs),
    /// Make the paper's figures again, and check its claims
    Reproduce(reproduce::ReproduceArgs),
    /// Run a fixed-step loop as a test rig does, and report missed deadlines and step times
    Rig(rig::RigArgs),
    /// Rigid contact: height and roll of the wheelset over lateral position and yaw
    Rigid(rigid::RigidArgs),
    /// Run a vehicle along a track: wheelset or bogie, contact by table or direct solver
    Simulate(simulate::SimulateArgs),
    /// Contacts of poses by the direct elastic solver
    Solve(solve::SolveArgs),
    /// Measure a table against the direct solver over random poses
    Verify(verify::VerifyArgs),
}

impl Cli {
    /// Runs the command.
    ///
    /// # Errors
    /// On bad input, with the file, the line or field and the value.
    pub fn run(&self) -> Result<Outcome> {
        match &self.command {
            Command::Campaign(args) => return campaign::run(args),
            Command::Compile(args) => compile::run(args)?,
            Command::Creep(args) => creep::run(args)?,
            Command::Fmu(args) => fmu::run(args)?,
            Command::Inspect(args) => inspect::run(args)?,
            Command::Lookup(args) => lookup::run(args)?,
            Command::Pil(args) => return pil::run(args),
            Command::Merge(args) => merge::run(args)?,
            Command::Profile(args) => profile::run(args)?,
            Command::Quickstart(args) => quickstart::run(args)?,
            Command::Reproduce(args) => reproduce::run(args)?,
            Command::Rig(args) => rig::run(args)?,
            Command::Rigid(args) => rigid::run(args)?,
            Command::Simulate(args) => simulate::run(args)?,
            Command::Solve(args) => solve::run(args)?,
            Command::Verify(args) => return verify::run(args),
        }
        Ok(Outcome::Done)
    }
}

/// A pool of so many threads, of as many as there are cores by default.
fn threads(jobs: Option<u16>) -> Result<rayon::ThreadPool> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(jobs.map_or(0, usize::from)).build();
    threads.map_err(|e| Error::field("", "--jobs", e.to_string()))
}

/// A table file read whole, to be checked by the kernel.
fn read_table(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| Error::file(path, e.to_string()))
}

/// The kernel's view of a table file.
fn view_table<'a>(path: &Path, image: &'a [u8]) -> Result<ContactTable<'a>> {
    ContactTable::new(image).map_err(|e| Error::file(path, e.to_string()))
}

/// Writes text and a line's end to stdout; a reader that has gone or a full disk behind it is an error, not a panic.
fn print(text: &str) -> Result<()> {
    writeln!(std::io::stdout(), "{text}").map_err(|e| Error::file("stdout", e.to_string()))
}

/// Writes a JSON document to stdout.
fn print_json(value: &serde_json::Value) -> Result<()> {
    print(&format!("{value:#}"))
}

/// A wheel of the wheelset, as an option.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SideArg {
    /// The wheel at positive y
    Right,
    /// The wheel at negative y
    Left,
}

/// The sides that an optional `--side` names: both without it.
fn sides(side: Option<SideArg>) -> Vec<flangeway::Side> {
    match side {
        Some(SideArg::Right) => vec![flangeway::Side::Right],
        Some(SideArg::Left) => vec![flangeway::Side::Left],
        None => flangeway::Side::ALL.to_vec(),
    }
}
