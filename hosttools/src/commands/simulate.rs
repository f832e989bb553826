//! `flangeway simulate`: a vehicle along a track.

use std::path::PathBuf;
use std::time::Instant;

use crate::dynamics::record::write_csv;
use crate::dynamics::run::{Ground, rows, run as simulate};
use crate::dynamics::scenario::{Method, Scenario};
use crate::dynamics::wheel_rail::Law;
use crate::error::Result;
use crate::image::folder_of;
use crate::progress;

/// Arguments of `flangeway simulate`.
#[derive(Debug, Clone, clap::Args)]
pub struct SimulateArgs {
    /// Scenario (TOML)
    pub scenario: PathBuf,
    /// Rows of the vehicle's state and wheel forces (CSV)
    #[arg(short, long)]
    pub output: PathBuf,
    /// Where contacts come from, instead of the scenario's
    #[arg(long)]
    pub contact: Option<Method>,
    /// Creep law, instead of the scenario's
    #[arg(long)]
    pub creep: Option<Law>,
}

/// Runs the scenario and writes what happened.
///
/// # Errors
/// On a bad scenario, recipe or table, when the vehicle leaves the rails, or when the output cannot be written.
pub fn run(args: &SimulateArgs) -> Result<()> {
    let mut scenario = Scenario::load(&args.scenario)?;
    folder_of(&args.output)?;
    scenario.contact.method = args.contact.unwrap_or(scenario.contact.method);
    scenario.contact.creep = args.creep.unwrap_or(scenario.contact.creep);
    let ground = Ground::of(&scenario)?;
    let bar = progress::bar(rows(&scenario), "simulating");
    let start = Instant::now();
    let samples = simulate(&scenario, &ground, &bar)?;
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    write_csv(&args.output, &samples)?;
    let simulated = samples.last().map_or(0.0, |sample| sample.time);
    eprintln!("{}: {} rows, {simulated:.2} s in {seconds:.2} s", args.output.display(), samples.len());
    Ok(())
}
