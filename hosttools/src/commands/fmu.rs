//! `flangeway fmu`: a wheelset as a co-simulation unit.

use std::path::PathBuf;

use super::{read_table, view_table};
use crate::error::Result;
use crate::fmu::{Mode, package};
use crate::image::{folder_of, write_atomically};

/// Arguments of `flangeway fmu`.
#[derive(Debug, Clone, clap::Args)]
pub struct FmuArgs {
    /// Table to pack
    #[arg(value_name = "T.fwt")]
    pub table: PathBuf,
    /// Unit to write
    #[arg(short, long, value_name = "OUT.fmu")]
    pub output: PathBuf,
    /// What the unit computes
    #[arg(long, default_value = "wheelset")]
    pub mode: Mode,
    /// The library to pack; by default the one that cargo built beside this program
    #[arg(long)]
    pub library: Option<PathBuf>,
}

/// Packs the unit.
///
/// # Errors
/// On a bad table, a missing library, or when the output cannot be written.
pub fn run(args: &FmuArgs) -> Result<()> {
    let image = read_table(&args.table)?;
    view_table(&args.table, &image)?;
    folder_of(&args.output)?;
    let library = args.library.clone().map_or_else(package::library_beside_program, Ok)?;
    let packed = package::pack(args.mode, &library, &image)?;
    write_atomically(&args.output, &packed)?;
    eprintln!("{}: {} bytes, {}", args.output.display(), packed.len(), args.mode.identifier());
    Ok(())
}
