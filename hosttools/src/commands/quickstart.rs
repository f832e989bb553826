//! `flangeway quickstart`: a common wheel and rail from recipe to report, in one go.

mod lookups;

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::view_table;
use crate::compile::compile;
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::report::{Content, html};
use crate::verify;

/// Names of what is written.
const RECIPE: &str = "s1002_60e1_40.toml";
const TABLE: &str = "s1002_60e1_40.fwt";
const REPORT: &str = "report.html";
/// Random poses and lines of the verification, and their seed: not the compiler's.
const SAMPLES: usize = 12_000;
const LINES: usize = 200;
const SEED: u64 = 2;

/// Arguments of `flangeway quickstart`.
#[derive(Debug, Clone, clap::Args)]
pub struct QuickstartArgs {
    /// Folder to write the recipe, the table and the report to
    #[arg(short, long, value_name = "DIR", default_value = "quickstart")]
    pub output: PathBuf,
}

/// Compiles S1002 on 60E1, verifies it, looks a few poses up, and writes the report.
///
/// # Errors
/// When the folder cannot be created or written to.
pub fn run(args: &QuickstartArgs) -> Result<()> {
    let folder = &args.output;
    make(folder)?;
    let [recipe_path, table_path, report_path] = [RECIPE, TABLE, REPORT].map(|name| folder.join(name));

    write_atomically(&recipe_path, flangeway_tables::S1002_60E1_40.as_bytes())?;
    eprintln!("{}: S1002 wheel on 60E1 rail inclined 1:40", recipe_path.display());
    let recipe = Recipe::parse(flangeway_tables::S1002_60E1_40, &recipe_path)?;

    let start = Instant::now();
    let pair = Pair::build(&recipe)?;
    let compiled = compile(&recipe, &pair, None)?;
    write_atomically(&table_path, &compiled.image)?;
    let (seconds, bytes) = (start.elapsed().as_secs_f64(), compiled.image.len());
    eprintln!("{}: {} nodes, {bytes} bytes, {seconds:.1} s", table_path.display(), compiled.axes.nodes());

    let start = Instant::now();
    let table = view_table(&table_path, &compiled.image)?;
    let (report, samples) = verify::report(&table, bytes, &pair, SAMPLES, LINES, SEED);
    let force = report.normal_force;
    eprintln!(
        "  force error against the direct solver over {} poses: median {:.3} %, p95 {:.2} %, p99 {:.2} % ({:.1} s)",
        report.samples,
        1e2 * force.median,
        1e2 * force.p95,
        1e2 * force.p99,
        start.elapsed().as_secs_f64()
    );

    lookups::print(&pair, &table)?;

    let start = Instant::now();
    let table_name = TABLE;
    let content = Content {
        recipe: &recipe,
        pair: &pair,
        table: &table,
        table_name,
        bytes,
        seconds,
        report: &report,
        samples: &samples,
    };
    write_atomically(&report_path, html(&content)?.as_bytes())?;
    eprintln!("{}: figures and error figures ({:.1} s)", report_path.display(), start.elapsed().as_secs_f64());
    eprintln!();
    next(folder);
    Ok(())
}

/// Makes the folder, where it is not there; its parent has to be.
pub(super) fn make(folder: &Path) -> Result<()> {
    match std::fs::create_dir(folder) {
        Err(_) if folder.is_dir() => Ok(()),
        made => made.map_err(|e| Error::file(folder, format!("the folder cannot be created: {e}"))),
    }
}

/// What to try next.
fn next(folder: &Path) {
    let [recipe, table, report] = [RECIPE, TABLE, REPORT].map(|name| folder.join(name).display().to_string());
    eprintln!("Next:");
    for (purpose, command) in [
        ("look at the figures", format!("open {report}")),
        ("see whether a profile of yours is read as you expect", "flangeway profile yourfile.prw".into()),
        ("copy the recipe, name your profiles in it, compile", "flangeway compile yours.toml -o yours.fwt".into()),
        ("contacts of poses y_m,yaw_rad,z_m,roll_rad", format!("flangeway lookup {table} --poses P.csv -o C.csv")),
        ("errors over more poses", format!("flangeway verify {table} --recipe {recipe}")),
    ] {
        eprintln!("  {purpose}:\n    {command}");
    }
}
