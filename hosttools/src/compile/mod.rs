//! The table compiler: from a pair and a recipe to a table image (paper, section 4; coordinates of our own).
//!
//! Settle the axes, map the rigid contact, sample the direct solver at every node, fit the node values to what lies
//! between, quantise, write. Every step is a function of the recipe alone, so the image is the same for any number of threads.

mod adaptive;
mod axes;
mod budget;
mod checkpoint;
mod fit;
mod half_space;
mod quantise;
mod rigid_map;
mod sampler;
mod shard;
mod solved;
mod stencil;
mod trial;

use flangeway::{ContactTable, ErrorFigures, Header, LANES, SLOTS, Scales, Side, SideHeader, Slot};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

pub use adaptive::Bound;
pub use axes::{Axes, Uniform};
pub use budget::{Budget, ChannelBudget};
pub use checkpoint::Checkpoint;
pub use shard::{Part, Settled, Shard, merge};

use crate::contact::{Curvature, Dimension, Normal, SlotState};
use crate::error::{Error, Result};
use crate::image::{ImageParts, SideParts, write_image};
use crate::pair::Pair;
use crate::recipe::{NodeValues, Nodes, Recipe};
use crate::verify;
use sampler::Sampler;
use solved::Solved;

/// The program and its version, as they stand in every table.
pub const GENERATOR: &str = concat!("flangeway-host ", env!("CARGO_PKG_VERSION"));

/// CRC-32C (Castagnoli), as the tables have, of what is kept between runs.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI);

/// Poses and lines for the error figures that the compiler writes into the header, and their seed.
const FIGURE_SAMPLES: usize = 4000;
const FIGURE_LINES: usize = 200;
const FIGURE_SEED: u64 = 1;
/// The same for half-space tables, whose solver takes several times as long.
const HALF_SPACE_SAMPLES: usize = 1000;
const HALF_SPACE_LINES: usize = 12;

/// A finished table and what it took.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// The image, ready to be written to a file.
    pub image: Vec<u8>,
    /// Its axes.
    pub axes: Axes,
    /// Its measured errors, as in its header.
    pub errors: ErrorFigures,
    /// What they are made of.
    pub budget: Budget,
    /// What ended the refinement of the axes.
    pub bound: Bound,
}

/// Compiles the table of a pair. `uniform` overrides the recipe's node counts.
///
/// # Errors
/// When the axes do not fit the byte budget, or a wheel misses its rail inside the recipe's ranges.
pub fn compile(recipe: &Recipe, pair: &Pair, uniform: Option<Uniform>) -> Result<Compiled> {
    compile_from(recipe, pair, uniform, &mut Checkpoint::none())
}

/// As [`compile`], going on where `checkpoint` stands: half-space tables take minutes.
///
/// # Errors
/// As [`compile`], and when the checkpoint cannot be written.
pub fn compile_from(
    recipe: &Recipe,
    pair: &Pair,
    uniform: Option<Uniform>,
    checkpoint: &mut Checkpoint,
) -> Result<Compiled> {
    let preparing = half_space::preparing(pair);
    let mut compiler = Compiler::new(recipe, &preparing);
    let (axes, bound) = match checkpoint.found() {
        Some(found) => found,
        None => compiler.settle(uniform)?,
    };
    checkpoint.begin(&axes, bound)?;
    let table = compiler.table(pair, axes, checkpoint)?;
    finish(recipe, pair, table, bound)
}

/// Measures a table and puts the figures into its image.
fn finish(recipe: &Recipe, pair: &Pair, table: Assembled, bound: Bound) -> Result<Compiled> {
    let view = ContactTable::new(&table.image).map_err(|e| Error::field("", "table", e.to_string()))?;
    let (samples, lines) = match pair.body(Side::Right).settings().normal {
        Normal::HalfSpace => (HALF_SPACE_SAMPLES, HALF_SPACE_LINES),
        _ => (FIGURE_SAMPLES, FIGURE_LINES),
    };
    // Fewer or more poses, and as many lines in proportion.
    let poses = recipe.grid.error_poses.unwrap_or(samples);
    let lines = (lines * poses / samples).max(1);
    let measured = verify::measure(&view, table.image.len(), pair, poses, lines, FIGURE_SEED);
    let errors = measured.report.figures();
    let budget = budget::measure(&table, &view, &measured.samples);
    let image = image(recipe, pair, &table.axes, &table.sides, errors)?;
    Ok(Compiled { image, axes: table.axes, errors, budget, bound })
}

/// One side, compiled.
struct CompiledSide {
    /// Node values before quantisation.
    nodes: Vec<[SlotState; SLOTS]>,
    rigid: Vec<[f32; 4]>,
    records: Vec<[i16; LANES]>,
    scales: Scales,
}

/// A table of some axes, its errors not yet measured.
struct Assembled {
    axes: Axes,
    sides: Vec<CompiledSide>,
    image: Vec<u8>,
}

impl Assembled {
    fn new(recipe: &Recipe, pair: &Pair, axes: Axes, sides: Vec<CompiledSide>) -> Result<Self> {
        let image = image(recipe, pair, &axes, &sides, ErrorFigures::default())?;
        Ok(Self { axes, sides, image })
    }
}

impl CompiledSide {
    fn new(pair: &Pair, side: Side, axes: &Axes, values: NodeValues, solved: Solved) -> Self {
        let Solved { rigid, mut nodes, points, half_space } = solved;
        let prepared = (!half_space.is_empty()).then(|| nodes.clone());
        borrow_geometry(&mut nodes, axes);
        if values == NodeValues::Fitted {
            fit::fit(&points, axes, &mut nodes);
        }
        if let Some(prepared) = prepared {
            half_space::correct(&mut nodes, &prepared, &half_space);
        }
        let scales = quantise::scales(&nodes, pair.body(side).boundaries());
        let records = nodes.par_iter().map(|states| quantise::record(states, &scales)).collect();
        Self { nodes, rigid, records, scales }
    }

    fn parts(&self) -> SideParts<'_> {
        SideParts { rigid: &self.rigid, records: &self.records }
    }
}

/// Gives slots without contact the geometry of the nearest node along the lateral axis where the slot has one.
///
/// Beside a node without contact the lookup still blends its geometry in. What the solver knows there, the edge of the
/// slot's region or nothing at all, is no contact's geometry: at the edge wheel and rail may be nearly conformal, with
/// an ellipse many times as long. Indentation and stiffness stay as they are.
fn borrow_geometry(samples: &mut [[SlotState; SLOTS]], axes: &Axes) {
    let plane = samples.len() / axes.lateral.len();
    for slot in Slot::ALL.map(Slot::index) {
        for k in 0..plane {
            let touching: Vec<usize> =
                (0..axes.lateral.len()).filter(|i| samples[i * plane + k][slot].stiffness > 0.0).collect();
            for i in 0..axes.lateral.len() {
                let after = touching.partition_point(|&j| j < i);
                let distance = |&&j: &&usize| (axes.lateral[j] - axes.lateral[i]).abs();
                let near = touching[after.saturating_sub(1)..touching.len().min(after + 1)].iter();
                let Some(&j) = near.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { break };
                let SlotState { indentation, stiffness, .. } = samples[i * plane + k][slot];
                if stiffness == 0.0 {
                    samples[i * plane + k][slot] = SlotState { indentation, stiffness, ..samples[j * plane + k][slot] };
                }
            }
        }
    }
}

/// Makes tables of one pair, and remembers what it has solved for them.
struct Compiler<'a> {
    recipe: &'a Recipe,
    pair: &'a Pair,
    samplers: Vec<Sampler<'a>>,
}

impl<'a> Compiler<'a> {
    fn new(recipe: &'a Recipe, pair: &'a Pair) -> Self {
        let sides = Side::ALL.into_iter().take(pair.sides());
        Self { recipe, pair, samplers: sides.map(|side| Sampler::new(recipe, pair, side)).collect() }
    }

    /// The table of these axes by the solver that the compiler prepares tables with.
    fn assemble(&mut self, axes: Axes, values: NodeValues) -> Result<Assembled> {
        let mut sides = Vec::with_capacity(self.samplers.len());
        for sampler in &mut self.samplers {
            let solved = Solved::new(sampler, self.pair, &axes, values)?;
            sides.push(CompiledSide::new(self.pair, sampler.side, &axes, values, solved));
        }
        Assembled::new(self.recipe, self.pair, axes, sides)
    }

    /// The finished table of these axes by the pair's own solver.
    fn table(&mut self, pair: &Pair, axes: Axes, checkpoint: &mut Checkpoint) -> Result<Assembled> {
        let values = self.recipe.grid.node_values;
        let mut sides = Vec::with_capacity(self.samplers.len());
        for sampler in &mut self.samplers {
            sampler.prepare(&axes)?;
            let half_space = half_space::solve(sampler, pair, &axes, checkpoint)?;
            let solved = Solved { half_space, ..Solved::new(sampler, self.pair, &axes, values)? };
            sides.push(CompiledSide::new(pair, sampler.side, &axes, values, solved));
        }
        Assembled::new(self.recipe, pair, axes, sides)
    }

    /// The axes that the recipe asks for, or the counts given instead.
    fn settle(&mut self, uniform: Option<Uniform>) -> Result<(Axes, Bound)> {
        let (recipe, grid) = (self.recipe, &self.recipe.grid);
        let axes = [grid.lateral_m, grid.yaw_rad, grid.vertical_m, grid.roll_rad];
        Ok(match uniform {
            Some(uniform) => (Axes::uniform(recipe, uniform), Bound::Counts),
            None if axes.iter().any(|axis| axis.nodes == Nodes::Auto) => adaptive::refine(recipe, self)?,
            None => (Axes::coarsest(recipe, self.pair.sides())?, Bound::Counts),
        })
    }
}

fn image(recipe: &Recipe, pair: &Pair, axes: &Axes, sides: &[CompiledSide], errors: ErrorFigures) -> Result<Vec<u8>> {
    let settings = pair.body(Side::Right).settings();
    let solver = format!(
        "{}, {}, {} curvature, curvature floor {} 1/m, {} nodes",
        match settings.normal {
            Normal::Hertz => "hertz",
            Normal::SemiHertzian => "semi-hertzian",
            Normal::HalfSpace => "half-space",
        },
        if settings.dimension == Dimension::Two { "2d" } else { "3d" },
        if settings.curvature == Curvature::Mean { "mean" } else { "local" },
        settings.curvature_floor,
        if recipe.grid.node_values == NodeValues::Fitted { "fitted" } else { "sampled" }
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
        generator: GENERATOR,
        solver: &solver,
        recipe_sha256: recipe_hash(recipe),
        gauge: recipe.rail.gauge_m.unwrap_or(0.0),
        material: flangeway::Material { young_modulus: material.youngs_modulus, poisson_ratio: material.poisson_ratio },
        axes: Default::default(),
        refinement: axes::REFINEMENT,
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
