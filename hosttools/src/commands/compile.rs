//! `flangeway compile`: a contact table from a recipe.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::json;

use super::print_json;
use crate::compile::{Checkpoint, Compiled, Part, Settled, Shard, Uniform, compile_from};
use crate::error::Result;
use crate::image::{folder_of, write_atomically};
use crate::pair::Pair;
use crate::profile_noise;
use crate::recipe::Recipe;

/// Arguments of `flangeway compile`.
#[derive(Debug, Clone, clap::Args)]
pub struct CompileArgs {
    /// Recipe (TOML)
    pub recipe: PathBuf,
    /// Table to write; with --shard or --axes-only the shard or the axes
    #[arg(short, long, value_name = "T.fwt")]
    pub output: PathBuf,
    /// Threads; as many as there are cores by default. The table is the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Node counts, lateral x yaw x vertical x roll, instead of the recipe's
    #[arg(long, value_name = "121x9x25x21")]
    pub uniform: Option<Uniform>,
    /// Bytes that "auto" axes may spend, instead of the recipe's `max_bytes`
    #[arg(long, value_name = "BYTES")]
    pub max_bytes: Option<u64>,
    /// Solve only this part of the table, from 1/n to n/n; `flangeway merge` puts the parts together
    #[arg(long, value_name = "i/n", conflicts_with = "json")]
    pub shard: Option<Part>,
    /// Settle the axes and write them, no table: shards that are given them need not search
    #[arg(long, conflicts_with_all = ["shard", "axes", "json"])]
    pub axes_only: bool,
    /// Axes that --axes-only has settled for this recipe
    #[arg(long, value_name = "T.axes", conflicts_with_all = ["uniform", "max_bytes"])]
    pub axes: Option<PathBuf>,
    /// Print nodes, bytes, seconds and error figures as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Compiles and writes the table.
///
/// # Errors
/// On a bad recipe or profile, or when the table cannot be written.
pub fn run(args: &CompileArgs) -> Result<()> {
    let start = Instant::now();
    let mut recipe = Recipe::load(&args.recipe)?;
    // Before minutes of work are lost for it.
    folder_of(&args.output)?;
    recipe.grid.max_bytes = args.max_bytes.unwrap_or(recipe.grid.max_bytes);
    let recipe = recipe;
    let threads = super::threads(args.jobs)?;
    threads.install(|| {
        let pair = Pair::build(&recipe)?;
        let warnings = profile_noise::warnings(&recipe, &pair)?;
        for warning in &warnings {
            eprintln!("flangeway: warning: {warning}");
        }
        let settled = match &args.axes {
            None => None,
            Some(path) => {
                let settled = Settled::read(path)?;
                settled.check_recipe(path, &recipe)?;
                Some(settled)
            }
        };
        let settle = || settled.clone().map_or_else(|| Settled::new(&recipe, &pair, args.uniform), Ok);
        let seconds = || start.elapsed().as_secs_f64();
        if args.axes_only {
            let settled = settle()?;
            settled.write(&args.output)?;
            let [lateral, yaw, roll, vertical] = settled.counts();
            eprintln!(
                "{}: axes of {lateral} lateral x {yaw} yaw x {vertical} vertical x {roll} roll nodes, bounded by {}, \
                 {:.1} s",
                args.output.display(),
                settled.bound,
                seconds()
            );
        } else if let Some(part) = args.shard {
            Shard::new(&recipe, &pair, settle()?, part)?.write(&args.output)?;
            eprintln!("{}: shard {part}, {:.1} s", args.output.display(), seconds());
        } else {
            let mut checkpoint = Checkpoint::of_table(&args.output, &recipe, &pair, args.uniform, settled.as_ref())?;
            if let Some(path) = checkpoint.path().filter(|_| checkpoint.resumes()) {
                eprintln!("flangeway: going on from {}", path.display());
            }
            let compiled = match &settled {
                Some(settled) => settled.compile(&recipe, &pair, &mut checkpoint)?,
                None => compile_from(&recipe, &pair, args.uniform, &mut checkpoint)?,
            };
            write_atomically(&args.output, &compiled.image)?;
            checkpoint.finish()?;
            tell(&args.output, pair.sides(), &compiled, seconds());
            if args.json {
                print_json(&json(pair.sides(), &compiled, seconds(), &warnings))?;
            }
        }
        Ok(())
    })
}

/// Says what a table is and how good it is.
pub(super) fn tell(output: &Path, sides: usize, compiled: &Compiled, seconds: f64) {
    let [lateral, yaw, vertical, roll] = counts(compiled);
    let (nodes, bytes, errors) = (sides * compiled.axes.nodes(), compiled.image.len(), compiled.errors);
    eprintln!(
        "{}: {nodes} nodes ({lateral} lateral x {yaw} yaw x {vertical} vertical x {roll} roll, {sides} side{}), {bytes} \
         bytes, {seconds:.1} s",
        output.display(),
        if sides == 1 { "" } else { "s" },
    );
    eprintln!("  bounded by {}", compiled.bound);
    eprintln!(
        "  force error against the direct solver over {} poses: rms {:.2} %, median {:.3} %, p95 {:.2} %, p99 {:.2} %",
        errors.samples,
        1e2 * errors.force_rms,
        1e2 * errors.force_median,
        1e2 * errors.force_p95,
        1e2 * errors.force_p99
    );
    let budget = &compiled.budget;
    eprintln!(
        "  rms of it by the grid {:.2} %, by 16-bit integers {:.3} % ({:.3} % expected), by the kernel's arithmetic {:.4} %",
        1e2 * budget.grid.rms,
        1e2 * budget.quantisation.rms,
        1e2 * budget.quantisation_predicted_rms,
        1e2 * budget.arithmetic.rms
    );
}

/// Node counts as the paper writes them: lateral, yaw, vertical, roll.
fn counts(compiled: &Compiled) -> [usize; 4] {
    let axes = &compiled.axes;
    [&axes.lateral, &axes.yaw, &axes.vertical, &axes.roll].map(Vec::len)
}

/// The same as JSON.
pub(super) fn json(sides: usize, compiled: &Compiled, seconds: f64, warnings: &[String]) -> serde_json::Value {
    let [lateral, yaw, vertical, roll] = counts(compiled);
    let errors = compiled.errors;
    json!({
        "nodes": sides * compiled.axes.nodes(),
        "axes": { "lateral": lateral, "yaw": yaw, "vertical": vertical, "roll": roll },
        "sides": sides,
        "bytes": compiled.image.len(),
        "seconds": seconds,
        "bound": compiled.bound.to_string(),
        "force_error": {
            "samples": errors.samples,
            "rms": errors.force_rms,
            "median": errors.force_median,
            "p95": errors.force_p95,
            "p99": errors.force_p99,
            "max": errors.force_max,
        },
        "continuity": errors.continuity,
        "budget": compiled.budget,
        "warnings": warnings,
    })
}
