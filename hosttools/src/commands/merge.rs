//! `flangeway merge`: one table from its shards.

use std::path::PathBuf;
use std::time::Instant;

use super::print_json;
use crate::compile::merge;
use crate::error::Result;
use crate::image::{folder_of, write_atomically};

/// Arguments of `flangeway merge`.
#[derive(Debug, Clone, clap::Args)]
pub struct MergeArgs {
    /// All shards of a table, as `compile --shard` wrote them, in any order
    #[arg(required = true, value_name = "SHARD")]
    pub shards: Vec<PathBuf>,
    /// Table to write
    #[arg(short, long, value_name = "T.fwt")]
    pub output: PathBuf,
    /// Print nodes, bytes, seconds and error figures as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Fits and quantises what the shards have solved, and writes the table.
///
/// # Errors
/// On a shard that is damaged, missing, there twice or of another table, or when the table cannot be written.
pub fn run(args: &MergeArgs) -> Result<()> {
    let start = Instant::now();
    folder_of(&args.output)?;
    let (pair, compiled) = merge(&args.shards)?;
    write_atomically(&args.output, &compiled.image)?;
    let seconds = start.elapsed().as_secs_f64();
    super::compile::tell(&args.output, pair.sides(), &compiled, seconds);
    if args.json {
        print_json(&super::compile::json(pair.sides(), &compiled, seconds, &[]))?;
    }
    Ok(())
}
