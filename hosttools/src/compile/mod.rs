//! The table compiler: from a pair and a recipe to a table image (paper, section 4; coordinates of our own).
//!
//! Settle the axes, map the rigid contact, sample the direct solver at every node, quantise, write. Every step is a
//! function of the recipe alone, so the image is the same for any number of threads.

mod axes;
mod quantise;
mod rigid_maps;

use flangeway::{Coordinates, ErrorFigures, Header, LANES, SLOTS, Side, SideHeader};
use indicatif::{ParallelProgressIterator, ProgressBar};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

pub use axes::{Axes, Uniform};

use crate::contact::{Curvature, Dimension, SlotState};
use crate::error::{Error, Result};
use crate::image::{ImageParts, OwnedRigidMaps, SideParts, write_image};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::verify;

/// Poses sampled for the error figures that the compiler writes into the header, and their seed.
const FIGURE_SAMPLES: usize = 4000;
const FIGURE_SEED: u64 = 1;

/// One side, compiled.
struct CompiledSide {
    roll: Vec<f32>,
    vertical: Vec<f32>,
    records: Vec<[i16; LANES]>,
    scales: flangeway::Scales,
}

impl CompiledSide {
    fn parts(&self) -> SideParts<'_> {
        SideParts { rigid_roll: &self.roll, rigid_vertical: &self.vertical, records: &self.records }
    }
}

/// A finished table and what it took.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// The image, ready to be written to a file.
    pub image: Vec<u8>,
    /// Its axes.
    pub axes: Axes,
    /// Its measured errors, as in its header.
    pub errors: ErrorFigures,
}

/// Compiles the table of a pair. `uniform` overrides the recipe's node counts.
///
/// # Errors
/// When the axes do not fit the byte budget, or a wheel misses its rail inside the recipe's ranges.
pub fn compile(recipe: &Recipe, pair: &Pair, uniform: Option<Uniform>) -> Result<Compiled> {
    let axes = Axes::choose(recipe, pair.sides(), uniform)?;
    let sides: Vec<CompiledSide> = Side::ALL
        .into_iter()
        .take(pair.sides())
        .map(|side| compile_side(recipe, pair, side, &axes))
        .collect::<Result<_>>()?;
    let unmeasured = image(recipe, pair, &axes, &sides, ErrorFigures::default())?;
    let errors = verify::figures(&unmeasured, pair, FIGURE_SAMPLES, FIGURE_SEED)?;
    Ok(Compiled { image: image(recipe, pair, &axes, &sides, errors)?, axes, errors })
}

fn compile_side(recipe: &Recipe, pair: &Pair, side: Side, axes: &Axes) -> Result<CompiledSide> {
    let (roll, vertical) = rigid_maps::solve(recipe, pair, side, axes)?;
    let maps = OwnedRigidMaps::new(axes.rigid(), &roll, &vertical)?;
    let samples = sample(pair, side, axes, &maps);
    let scales = quantise::scales(&samples, pair.body(side).boundaries());
    let records = samples.par_iter().map(|states| quantise::record(states, &scales)).collect();
    Ok(CompiledSide { roll, vertical, records, scales })
}

/// The direct solver at every node, `[lateral][yaw][roll offset][vertical]`. The silhouette and its search serve a
/// whole column of heights.
fn sample(pair: &Pair, side: Side, axes: &Axes, maps: &OwnedRigidMaps) -> Vec<[SlotState; SLOTS]> {
    let maps = maps.view();
    let body = pair.body(side);
    let columns = axes.lateral.len() * axes.yaw.len() * axes.roll.len();
    let column = |k: usize| {
        let (rest, l) = (k / axes.roll.len(), k % axes.roll.len());
        let (i, j) = (rest / axes.yaw.len(), rest % axes.yaw.len());
        let at = |vertical: f32| {
            let [lateral, yaw, roll_offset, vertical] =
                [axes.lateral[i], axes.yaw[j], axes.roll[l], vertical].map(f64::from);
            maps.pose(body.wheel().geometry(), &Coordinates { lateral, yaw, roll_offset, vertical })
        };
        let pose = at(0.0);
        let mut column = pair.column(side, &pose);
        axes.vertical.iter().map(move |&vertical| column.slots(at(vertical).vertical)).collect::<Vec<_>>()
    };
    let bar = bar(columns, "sampling");
    (0..columns).into_par_iter().progress_with(bar).flat_map_iter(column).collect()
}

fn bar(length: usize, what: &'static str) -> ProgressBar {
    crate::progress::bar(length as u64, what)
}

fn image(recipe: &Recipe, pair: &Pair, axes: &Axes, sides: &[CompiledSide], errors: ErrorFigures) -> Result<Vec<u8>> {
    let settings = pair.body(Side::Right).settings();
    let solver = format!(
        "hertz, {}, {} curvature, curvature floor {} 1/m",
        if settings.dimension == Dimension::Two { "2d" } else { "3d" },
        if settings.curvature == Curvature::Mean { "mean" } else { "local" },
        settings.curvature_floor
    );
    let side_header = |side: Side, compiled: &CompiledSide| {
        let (source, body) = (pair.source(side), pair.body(side));
        SideHeader {
            wheel: &source.wheel.name,
            rail: &source.rail.name,
            wheel_sha256: source.wheel.source_hash,
            rail_sha256: source.rail.source_hash,
            geometry: *body.wheel().geometry(),
            slot_boundaries: body.boundaries().map(|b| b as f32),
            scales: compiled.scales,
        }
    };
    let Some(right) = sides.first() else { return Err(Error::field("", "sides", "a table has a right side")) };
    let material = recipe.material();
    let header = Header {
        generator: concat!("flangeway-host ", env!("CARGO_PKG_VERSION")),
        solver: &solver,
        recipe_sha256: recipe_hash(recipe),
        gauge: recipe.rail.gauge_m.unwrap_or(0.0),
        material: flangeway::Material { young_modulus: material.youngs_modulus, poisson_ratio: material.poisson_ratio },
        axes: Default::default(),
        errors,
        right: side_header(Side::Right, right),
        left: sides.get(1).map(|left| side_header(Side::Left, left)),
    };
    write_image(&ImageParts {
        header,
        axes: axes.all(),
        right: right.parts(),
        left: sides.get(1).map(CompiledSide::parts),
    })
}

fn recipe_hash(recipe: &Recipe) -> [u8; 32] {
    Sha256::digest(recipe.text.as_bytes()).into()
}
