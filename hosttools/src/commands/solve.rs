//! `flangeway solve`: contacts of poses by the direct elastic solver.

use std::path::PathBuf;

use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{SideArg, sides};
use crate::contact::{Dimension, Method, Settings};
use crate::contacts::{self, ContactRow};
use crate::error::Result;
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::{poses, progress};

/// Arguments of `flangeway solve`.
#[derive(Debug, Clone, clap::Args)]
pub struct SolveArgs {
    /// Recipe (TOML)
    #[arg(long)]
    pub recipe: PathBuf,
    /// Poses (CSV: y_m,yaw_rad,z_m,roll_rad)
    #[arg(long)]
    pub poses: PathBuf,
    /// One wheel only
    #[arg(long)]
    pub side: Option<SideArg>,
    /// With or without yaw in the search; the recipe's by default
    #[arg(long)]
    pub dim: Option<DimensionArg>,
    /// How the contact is found around the wheel
    #[arg(long, default_value = "locus")]
    pub method: MethodArg,
    /// Contacts (CSV)
    #[arg(short, long)]
    pub output: PathBuf,
}

/// `--dim`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum DimensionArg {
    /// Contacts may lie ahead of or behind the axle
    #[value(name = "3d")]
    Three,
    /// The section through the axle only
    #[value(name = "2d")]
    Two,
}

/// `--method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum MethodArg {
    /// The wheel's silhouette, in closed form
    Locus,
    /// The paper's sweep of sections along the wheel, slow
    Sweep,
}

/// Solves all poses and writes the contacts.
///
/// # Errors
/// On a bad recipe or pose file, or when the output cannot be written.
pub fn run(args: &SolveArgs) -> Result<()> {
    let recipe = Recipe::load(&args.recipe)?;
    let poses = poses::read(&args.poses)?;
    let settings = recipe.settings();
    let pair = Pair::build(&recipe)?.with_settings(Settings {
        dimension: match args.dim {
            Some(DimensionArg::Two) => Dimension::Two,
            Some(DimensionArg::Three) => Dimension::Three,
            None => settings.dimension,
        },
        method: if args.method == MethodArg::Sweep { Method::Sweep } else { Method::Locus },
        ..settings
    });
    let sides = sides(args.side);
    let solve = |(index, pose)| sides.iter().flat_map(|&s| contacts::solved(&pair, index, s, pose)).collect::<Vec<_>>();
    let bar = progress::bar(poses.len() as u64, "solving");
    let rows: Vec<ContactRow> = poses.par_iter().enumerate().progress_with(bar).flat_map_iter(solve).collect();
    contacts::write_csv(&args.output, &rows)?;
    eprintln!("{} poses, {} contacts: {}", poses.len(), rows.len(), args.output.display());
    Ok(())
}
