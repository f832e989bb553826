//! Pairs, recipes and random poses that several tests share.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part of this")]

pub mod modules;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use flangeway::{Pose, Side};
use flangeway_host::compile::{Uniform, compile};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::{NodeValues, Recipe};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Millimetre.
pub const MM: f64 = 1e-3;

/// A file of the reference numbers' folder beside the repository; a note and `None` where the folder is absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

/// A recipe of built-in profiles.
pub fn recipe(text: &str) -> Recipe {
    Recipe::parse(text, Path::new("recipe.toml")).unwrap()
}

/// The recipe of the quickstart: S1002 on 60E1 inclined 1:40, all built in.
pub fn built_in() -> Recipe {
    recipe(flangeway_tables::S1002_60E1_40)
}

/// The Manchester benchmark's pair from its own profile files, where they are there.
pub fn manchester_files() -> Option<Recipe> {
    Some(Recipe::load(&shared("reference/mbench.toml")?).unwrap())
}

/// The Manchester benchmark's pair from built-in profiles: its geometry, its material.
pub fn manchester_built_in() -> Recipe {
    recipe(&flangeway_tables::S1002_60E1_40.replace("youngs_modulus_pa = 2.1e11", "youngs_modulus_pa = 2.0992e11"))
}

/// A table small enough for every test run: 41 lateral x 5 yaw x 3 vertical x 3 roll nodes, sampled, not fitted, so
/// that they can be held against the solver.
pub struct Small {
    pub recipe: Recipe,
    pub pair: Pair,
    pub image: Vec<u8>,
}

impl Small {
    /// Compiles a recipe with few nodes, lateral x yaw x vertical x roll.
    pub fn of(mut recipe: Recipe, nodes: &str) -> Self {
        recipe.grid.node_values = NodeValues::Sampled;
        recipe.grid.error_poses = Some(500); // the header's figures; what a test measures, it samples itself
        let uniform: Uniform = nodes.parse().unwrap();
        let pair = Pair::build(&recipe).unwrap();
        let image = compile(&recipe, &pair, Some(uniform)).unwrap().image;
        Self { recipe, pair, image }
    }

    /// The built-in pair's, compiled once.
    pub fn built_in() -> &'static Self {
        static SMALL: LazyLock<Small> = LazyLock::new(|| Small::of(built_in(), "41x5x3x3"));
        &SMALL
    }
}

/// Uniform random numbers, the same for the same seed.
pub struct Draws(Pcg64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }

    /// A number from `low` to `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count)
    }
}

/// The pose of which `pose` is the canonical one on a side.
pub fn on_side(side: Side, pose: &Pose) -> Pose {
    let sign = side.sign();
    Pose { lateral: sign * pose.lateral, yaw: sign * pose.yaw, roll: sign * pose.roll, ..*pose }
}
