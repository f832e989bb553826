//! `flangeway rigid`: the rigid contact over lateral position and yaw.

use std::path::PathBuf;

use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::{progress, rigid};

/// Arguments of `flangeway rigid`.
#[derive(Debug, Clone, clap::Args)]
pub struct RigidArgs {
    /// Recipe (TOML); its lateral and yaw ranges are covered
    #[arg(long)]
    pub recipe: PathBuf,
    /// Nodes over lateral position and yaw
    #[arg(long, default_value = "121x9", value_name = "LATERALxYAW")]
    pub nodes: String,
    /// Rigid map (CSV)
    #[arg(short, long)]
    pub output: PathBuf,
}

/// Solves the grid and writes the map.
///
/// # Errors
/// On a bad recipe, where a wheel misses its rail, or when the output cannot be written.
pub fn run(args: &RigidArgs) -> Result<()> {
    let recipe = Recipe::load(&args.recipe)?;
    let (columns, rows) = counts(&args.nodes)?;
    let pair = Pair::build(&recipe)?;
    let node = |range: [f64; 2], i: usize, n: usize| range[0] + (range[1] - range[0]) * i as f64 / (n - 1) as f64;
    let grid: Vec<(f64, f64)> = (0..columns * rows)
        .map(|k| {
            let lateral = node(recipe.grid.lateral_m.range, k / rows, columns);
            (lateral, node(recipe.grid.yaw_rad.range, k % rows, rows))
        })
        .collect();
    let bar = progress::bar(grid.len() as u64, "rigid");
    let rigid: Vec<_> = grid.par_iter().progress_with(bar).map(|&(y, yaw)| rigid::two_wheels(&pair, y, yaw)).collect();
    let failed = |e: csv::Error| Error::file(&args.output, e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let columns = ["y_m", "yaw_rad", "z_m", "roll_rad", "right_profile_m", "left_profile_m"];
    writer.write_record(columns).map_err(failed)?;
    for ((y, yaw), found) in grid.iter().zip(rigid) {
        let found = found.ok_or_else(|| {
            let message = format!("a wheel misses its rail at a lateral position of {y} m");
            Error::field(&args.recipe, "grid.lateral_m.range", message)
        })?;
        let values = [*y, *yaw, found.vertical, found.roll, found.right.wheel.s, found.left.wheel.s];
        writer.write_record(values.map(|v| format!("{v:.12e}"))).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::file(&args.output, e.to_string()))?;
    write_atomically(&args.output, &bytes)?;
    eprintln!("{} nodes: {}", grid.len(), args.output.display());
    Ok(())
}

fn counts(text: &str) -> Result<(usize, usize)> {
    let parsed = text.split_once('x').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match parsed {
        Some((a, b)) if (2..=10_000).contains(&a) && (2..=1000).contains(&b) => Ok((a, b)),
        _ => Err(Error::field("", "--nodes", format!("\"{text}\" is not two node counts such as 121x9"))),
    }
}
