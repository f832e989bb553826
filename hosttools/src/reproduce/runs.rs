//! Wheels, rails and simulations that several figures share.

use std::path::Path;

use flangeway_tables::{BOGIE_R60, SIMPLIFIED_PAIR, SMALL_BYTES, URBAN_ARCS, WHEELSET_R1000};
use indicatif::ProgressBar;

use crate::compile::compile;
use crate::dynamics::record::Sample;
use crate::dynamics::run::{Ground, rows, run};
use crate::dynamics::scenario::{Method, Scenario};
use crate::error::Result;
use crate::recipe::Recipe;

/// What figures of the urban pair say of it.
pub(super) const STAND_IN: &str = "stand-in for DT14: wheel of lines and arcs on 54E1";
/// What its second slot is.
pub(super) const THROAT: &str = "throat (slot of the flange root)";

/// Rows of all runs, for the progress bar.
pub(super) const LENGTH: u64 = 2 * 2_800 + 4 * 3_330;

/// Both pairs of the paper; the urban one with a table of the recipe's own size, and again with a small one.
pub(super) struct Grounds {
    pub(super) simplified: Ground,
    pub(super) urban: Ground,
    pub(super) urban_small: Ground,
}

impl Grounds {
    pub(super) fn new() -> Result<Self> {
        let recipe = |text: &str, name: &str| Recipe::parse(text, Path::new(name));
        let with_table = |recipe: Recipe| {
            let mut ground = Ground::new(recipe.clone(), None)?;
            ground.image = Some(compile(&recipe, &ground.pair, None)?.image);
            Ok(ground)
        };
        let urban = recipe(URBAN_ARCS, "urban_arcs.toml")?;
        let mut small = urban.clone();
        small.grid.max_bytes = SMALL_BYTES;
        Ok(Self {
            simplified: Ground::new(recipe(SIMPLIFIED_PAIR, "simplified_pair.toml")?, None)?,
            urban: with_table(urban)?,
            urban_small: with_table(small)?,
        })
    }
}

/// The paper's two simulations, in 2-D and 3-D on line, and the bogie's by the table.
pub(super) struct Runs {
    pub(super) wheelset_flat: Vec<Sample>,
    pub(super) wheelset: Vec<Sample>,
    pub(super) bogie_flat: Vec<Sample>,
    pub(super) bogie: Vec<Sample>,
    pub(super) bogie_by_table: Vec<Sample>,
    pub(super) bogie_by_small_table: Vec<Sample>,
    /// Coefficient of friction of each, for Nadal's limit.
    pub(super) friction: f64,
}

/// The committed scenario of section 5.
pub(super) fn single() -> Result<Scenario> {
    Scenario::parse(WHEELSET_R1000, Path::new("wheelset_r1000.toml"))
}

/// The committed scenario of section 6.
pub(super) fn bogie() -> Result<Scenario> {
    Scenario::parse(BOGIE_R60, Path::new("bogie_r60.toml"))
}

impl Runs {
    pub(super) fn new(grounds: &Grounds, bar: &ProgressBar) -> Result<Self> {
        let (single, bogie) = (single()?, bogie()?);
        bar.set_length(rows(&single) * 2 + rows(&bogie) * 4 + 33);
        let with = |scenario: &Scenario, ground: &Ground, method: Method| {
            let mut scenario = scenario.clone();
            scenario.contact.method = method;
            run(&scenario, ground, bar)
        };
        let (wheelset, vehicle) = rayon::join(
            || {
                let runs = [Method::Direct2d, Method::Direct3d].map(|m| with(&single, &grounds.simplified, m));
                let [flat, full] = runs;
                let tables = [&grounds.urban, &grounds.urban_small].map(|ground| with(&bogie, ground, Method::Table));
                Ok((flat?, full?, tables))
            },
            || {
                let [flat, full] = [Method::Direct2d, Method::Direct3d].map(|m| with(&bogie, &grounds.urban, m));
                Ok((flat?, full?))
            },
        );
        let (wheelset_flat, wheelset, [by_table, by_small_table]) = wheelset?;
        let (bogie_by_table, bogie_by_small_table) = (by_table?, by_small_table?);
        let (bogie_flat, bogie) = vehicle?;
        let friction = single.contact.friction;
        Ok(Self { wheelset_flat, wheelset, bogie_flat, bogie, bogie_by_table, bogie_by_small_table, friction })
    }
}
