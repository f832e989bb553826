//! `flangeway reproduce`: every figure of the paper, and whether its claims hold.

use std::path::PathBuf;

use super::quickstart::make;
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::reproduce::{Check, html, plates};

/// Arguments of `flangeway reproduce`.
#[derive(Debug, Clone, clap::Args)]
pub struct ReproduceArgs {
    /// Folder for the figures (SVG, CSV), report.html and checks.json
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Makes the figures and writes them.
///
/// # Errors
/// When the folder cannot be created or written to.
pub fn run(args: &ReproduceArgs) -> Result<()> {
    let folder = &args.output;
    make(folder)?;
    let plates = plates()?;
    for plate in &plates {
        write_atomically(folder.join(format!("{}.svg", plate.stem)), plate.svg.as_bytes())?;
        write_atomically(folder.join(format!("{}.csv", plate.stem)), &plate.csv)?;
    }
    write_atomically(folder.join("report.html"), html(&plates).as_bytes())?;
    let checks: Vec<&Check> = plates.iter().flat_map(|plate| &plate.checks).collect();
    let json = serde_json::to_string_pretty(&checks).map_err(|e| Error::field("", "checks.json", e.to_string()))?;
    write_atomically(folder.join("checks.json"), json.as_bytes())?;
    for check in &checks {
        let verdict = if check.holds { "holds" } else { "DOES NOT HOLD" };
        eprintln!("figure {:2}: {verdict}: {} ({:.3} {})", check.figure, check.claim, check.measured, check.unit);
    }
    eprintln!("{}: {} figures", folder.join("report.html").display(), plates.len());
    Ok(())
}
