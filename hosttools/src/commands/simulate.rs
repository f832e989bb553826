//! `flangeway simulate`: a vehicle along a track.

use std::path::PathBuf;
use std::time::Instant;

use flangeway::{Flags, Side};

use crate::dynamics::record::{Sample, write_csv};
use crate::dynamics::run::{Ground, rows, run as simulate};
use crate::dynamics::scenario::{Method, Scenario};
use crate::dynamics::wheel_rail::{Law, Wheel};
use crate::error::Result;
use crate::image::{folder_of, write_atomically};
use crate::progress;
use crate::report::vehicle::picture;

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
    /// Draw displacements, forces by slot, Y/Q and wear
    #[arg(long, value_name = "OUT.svg")]
    pub svg: Option<PathBuf>,
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
    let step = 1e3 * scenario.run.step_s;
    eprintln!("{}: {}", args.scenario.display(), scenario.title);
    eprintln!("  {simulated:.2} s in steps of {step} ms, {seconds:.2} s of computing, {} rows", samples.len());
    summary(&samples);
    eprintln!("  {}", args.output.display());
    if let Some(path) = &args.svg {
        write_atomically(path, picture(&scenario.title, &samples)?.as_bytes())?;
        eprintln!("  {}", path.display());
    }
    Ok(())
}

/// What each wheel went through, a line a wheel.
fn summary(samples: &[Sample]) {
    let wheelsets = samples.first().map_or(0, |sample| sample.wheelsets.len());
    for index in 0..wheelsets {
        for (place, side) in Side::ALL.into_iter().enumerate() {
            let wheel = |sample: &Sample| sample.wheelsets[index].wheels[place];
            let most = |value: fn(&Wheel) -> f64| samples.iter().map(|s| value(&wheel(s))).fold(f64::MIN, f64::max);
            let last = samples.last().map_or(0.0, |sample| wheel(sample).wear());
            let remarks = samples.iter().fold(Flags::NONE, |all, s| all | Flags::from_bits(wheel(s).flags));
            eprintln!(
                "  wheelset {}, {side:5}: Y up to {:6.1} kN, Q {:6.1} kN, Y/Q {:5.2}; wear index at the end {last:6.1} N; \
                 flags: {remarks}",
                index + 1,
                1e-3 * most(|w| w.loads.guiding_force),
                1e-3 * most(|w| w.loads.wheel_load),
                most(|w| w.loads.ratio()),
            );
        }
    }
}
