//! `flangeway compile`: a contact table from a recipe.

use std::path::PathBuf;
use std::time::Instant;

use serde_json::json;

use super::print_json;
use crate::compile::{Checkpoint, Uniform, checkpoint_key, compile_from};
use crate::contact::Normal;
use crate::error::{Error, Result};
use crate::image::{folder_of, write_atomically};
use crate::pair::Pair;
use crate::profile_noise;
use crate::recipe::Recipe;

/// Arguments of `flangeway compile`.
#[derive(Debug, Clone, clap::Args)]
pub struct CompileArgs {
    /// Recipe (TOML)
    pub recipe: PathBuf,
    /// Table to write
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
    let threads = rayon::ThreadPoolBuilder::new().num_threads(args.jobs.map_or(0, usize::from)).build();
    let threads = threads.map_err(|e| Error::field("", "--jobs", e.to_string()))?;
    let (pair, warnings, compiled) = threads.install(|| {
        let pair = Pair::build(&recipe)?;
        let warnings = profile_noise::warnings(&recipe, &pair)?;
        for warning in &warnings {
            eprintln!("flangeway: warning: {warning}");
        }
        let mut checkpoint = Checkpoint::none();
        if recipe.solver.normal == Normal::HalfSpace {
            let path = Checkpoint::path_beside(&args.output);
            checkpoint = Checkpoint::open(&path, checkpoint_key(&recipe, &pair, args.uniform))?;
            if checkpoint.resumes() {
                eprintln!("flangeway: going on from {}", path.display());
            }
        }
        let compiled = compile_from(&recipe, &pair, args.uniform, &mut checkpoint)?;
        write_atomically(&args.output, &compiled.image)?;
        checkpoint.finish()?;
        Ok::<_, Error>((pair, warnings, compiled))
    })?;
    let (seconds, bytes) = (start.elapsed().as_secs_f64(), compiled.image.len());
    let axes = &compiled.axes;
    let counts = [&axes.lateral, &axes.yaw, &axes.vertical, &axes.roll].map(Vec::len);
    let nodes = axes.nodes() * pair.sides();
    let errors = compiled.errors;
    eprintln!(
        "{}: {nodes} nodes ({} lateral x {} yaw x {} vertical x {} roll, {} side{}), {bytes} bytes, {seconds:.1} s",
        args.output.display(),
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        pair.sides(),
        if pair.sides() == 1 { "" } else { "s" },
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
    if args.json {
        print_json(&json!({
            "nodes": nodes,
            "axes": { "lateral": counts[0], "yaw": counts[1], "vertical": counts[2], "roll": counts[3] },
            "sides": pair.sides(),
            "bytes": bytes,
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
            "budget": budget,
            "warnings": warnings,
        }))?;
    }
    Ok(())
}
