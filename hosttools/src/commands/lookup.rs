//! `flangeway lookup`: contacts of poses by a table.

use std::path::PathBuf;

use super::{SideArg, read_table, sides, view_table};
use crate::contacts::{self, ContactRow};
use crate::error::Result;
use crate::poses;

/// Arguments of `flangeway lookup`.
#[derive(Debug, Clone, clap::Args)]
pub struct LookupArgs {
    /// Table
    #[arg(value_name = "T.fwt")]
    pub table: PathBuf,
    /// Poses (CSV: y_m,yaw_rad,z_m,roll_rad)
    #[arg(long)]
    pub poses: PathBuf,
    /// One wheel only
    #[arg(long)]
    pub side: Option<SideArg>,
    /// Contacts (CSV)
    #[arg(short, long)]
    pub output: PathBuf,
}

/// Looks all poses up and writes the contacts.
///
/// # Errors
/// On a bad table or pose file, or when the output cannot be written.
pub fn run(args: &LookupArgs) -> Result<()> {
    let image = read_table(&args.table)?;
    let table = view_table(&args.table, &image)?;
    let poses = poses::read(&args.poses)?;
    let sides = sides(args.side);
    let mut clamped = 0;
    let mut rows: Vec<ContactRow> = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        for &side in &sides {
            let found = table.contacts(side, pose);
            clamped += usize::from(!found.flags.is_empty());
            rows.extend(contacts::looked_up(index, side, &found));
        }
    }
    contacts::write_csv(&args.output, &rows)?;
    eprintln!("{} poses, {} contacts: {}", poses.len(), rows.len(), args.output.display());
    if clamped > 0 {
        eprintln!("  {clamped} wheels with remarks (outside the table, conformal): see the column remarks");
    }
    Ok(())
}
