//! The paper's figures again, each beside what the paper says of it in words, and every claim measured.

mod bands;
mod bogie;
mod costs;
mod curving;
mod page;
mod rigid_contact;
mod runs;
mod wheelset;

use indicatif::ProgressBar;
use serde::Serialize;

pub use page::html;

use crate::error::Result;
use crate::progress;
use runs::{Grounds, Runs};

/// One claim of the paper and what was measured of it.
#[derive(Debug, Clone, Serialize)]
pub struct Check {
    /// Number of the figure.
    pub figure: u8,
    /// The claim.
    pub claim: &'static str,
    /// What decides.
    pub measured: f64,
    /// Its unit, and what it is.
    pub unit: &'static str,
    /// Whether the claim holds.
    pub holds: bool,
}

/// A figure with its numbers, the paper's words and ours.
#[derive(Debug, Clone)]
pub struct Plate {
    /// Number in the paper.
    pub number: u8,
    /// File stem.
    pub stem: String,
    /// Title.
    pub title: &'static str,
    /// The picture.
    pub svg: String,
    /// Its numbers.
    pub csv: Vec<u8>,
    /// What the paper says, in our words.
    pub theirs: &'static str,
    /// What comes out here.
    pub ours: String,
    /// Where the two agree and where they differ.
    pub difference: &'static str,
    /// The claims.
    pub checks: Vec<Check>,
}

/// Makes all figures.
///
/// # Errors
/// When a run fails, or the drawing library does.
pub fn plates() -> Result<Vec<Plate>> {
    let grounds = Grounds::new()?;
    let bar = progress::bar(runs::LENGTH + 30, "reproducing");
    let done = |bar: &ProgressBar, plate: Result<Plate>| {
        bar.inc(3);
        plate
    };
    // The machine is quiet before the runs use all of it.
    let costs = done(&bar, costs::plate(&grounds))?;
    let runs = Runs::new(&grounds, &bar)?;
    let mut plates = vec![
        done(&bar, curving::plate(&grounds))?,
        done(&bar, rigid_contact::plate(&grounds))?,
        done(&bar, bands::simplified(&grounds))?,
        done(&bar, wheelset::lateral(&runs))?,
        done(&bar, wheelset::loads(&runs))?,
        done(&bar, wheelset::wear(&runs))?,
        done(&bar, bands::urban(&grounds))?,
    ];
    plates.push(done(&bar, bogie::regions(&runs))?);
    plates.push(done(&bar, bogie::table(&runs))?);
    plates.push(done(&bar, bogie::wear(&runs))?);
    plates.push(costs);
    bar.finish_and_clear();
    Ok(plates)
}
