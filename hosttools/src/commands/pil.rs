//! `flangeway pil`: has a board look a trajectory up, and compares every answer with the host's.

use std::path::PathBuf;

use flangeway::ContactTable;

use super::{Outcome, print_json, read_table};
use crate::error::{Error, Result};
use crate::pil::{Address, Port, Settings, json, lines, pil};
use crate::poses;
use crate::rig::synthetic;

/// Steps a second of the trajectory that is used without one (Hz).
const RATE: u32 = 1000;

/// Arguments of `flangeway pil`.
#[derive(Debug, Clone, clap::Args)]
pub struct PilArgs {
    /// The board's table; the small one of S1002 on 60E1 by default
    #[arg(value_name = "T.fwt")]
    pub table: Option<PathBuf>,
    /// Where the board is: tcp:HOST:PORT, or a serial device as DEVICE:BAUD (115200 without)
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Recorded poses, in turn (CSV: y_m,yaw_rad,z_m,roll_rad); hunting and a curve by default
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Steps to ask for; by default as many as the trajectory has
    #[arg(long, value_name = "N")]
    pub exchanges: Option<u64>,
    /// Share of the frames to damage on purpose in each direction, up to 0.5
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    pub damage: f64,
    /// Seed of that damage
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// How long an answer is waited for until it is asked for again (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 0.25)]
    pub timeout: f64,
    /// How long any sign of the board is waited for (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub patience: f64,
    /// Print the figures as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Runs the exchange and prints the figures; the check fails if an answer is not the host's.
///
/// # Errors
/// On a bad table, trajectory or value, and if no board answers or one with another table.
pub fn run(args: &PilArgs) -> Result<Outcome> {
    let read = args.table.as_deref().map(read_table).transpose()?;
    let image = read.as_deref().unwrap_or(flangeway_tables::S1002_60E1_40_TABLE);
    let name = args.table.clone().unwrap_or_else(|| "built-in table".into());
    let table = ContactTable::new(image).map_err(|e| Error::file(&name, e.to_string()))?;
    let poses = match &args.trajectory {
        Some(path) => poses::read(path)?,
        None => synthetic(&table, RATE),
    };
    let settings = Settings {
        exchanges: args.exchanges.unwrap_or(poses.len() as u64),
        damage: args.damage,
        seed: args.seed,
        timeout: args.timeout,
        patience: args.patience,
    };
    settings.check()?;
    let report = pil(&settings, &table, image, &poses, Port::open(&args.port)?)?;
    eprintln!("{}", lines(&report, &settings));
    if args.json {
        print_json(&json(&report, &settings))?;
    }
    Ok(if report.mismatches == 0 { Outcome::Done } else { Outcome::CheckFailed })
}
