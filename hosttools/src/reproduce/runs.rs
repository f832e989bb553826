//! Wheels, rails and simulations that several figures share.

use std::path::Path;

use flangeway_tables::{BOGIE_R60, SIMPLIFIED_PAIR, URBAN_METRE_GAUGE, WHEELSET_R1000};
use indicatif::ProgressBar;

use crate::compile::compile;
use crate::dynamics::record::Sample;
use crate::dynamics::run::{Ground, rows, run};
use crate::dynamics::scenario::{Method, Scenario};
use crate::error::Result;
use crate::recipe::Recipe;

/// Rows of all runs, for the progress bar.
pub(super) const LENGTH: u64 = 2 * 2_800 + 3 * 3_330;

/// Both pairs of the paper with tables of the recipes' own size.
pub(super) struct Grounds {
    pub(super) simplified: Ground,
    pub(super) urban: Ground,
}

impl Grounds {
    pub(super) fn new() -> Result<Self> {
        let ground = |text: &str, name: &str, table: bool| {
            let recipe = Recipe::parse(text, Path::new(name))?;
            let mut ground = Ground::new(recipe.clone(), None)?;
            if table {
                ground.image = Some(compile(&recipe, &ground.pair, None)?.image);
            }
            Ok(ground)
        };
        Ok(Self {
            simplified: ground(SIMPLIFIED_PAIR, "simplified_pair.toml", false)?,
            urban: ground(URBAN_METRE_GAUGE, "urban_metre_gauge.toml", true)?,
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
        bar.set_length(rows(&single) * 2 + rows(&bogie) * 3 + 33);
        let with = |scenario: &Scenario, ground: &Ground, method: Method| {
            let mut scenario = scenario.clone();
            scenario.contact.method = method;
            run(&scenario, ground, bar)
        };
        let (wheelset, vehicle) = rayon::join(
            || {
                let runs = [Method::Direct2d, Method::Direct3d].map(|m| with(&single, &grounds.simplified, m));
                let [flat, full] = runs;
                Ok((flat?, full?, with(&bogie, &grounds.urban, Method::Table)?))
            },
            || {
                let [flat, full] = [Method::Direct2d, Method::Direct3d].map(|m| with(&bogie, &grounds.urban, m));
                Ok((flat?, full?))
            },
        );
        let (wheelset_flat, wheelset, bogie_by_table) = wheelset?;
        let (bogie_flat, bogie) = vehicle?;
        Ok(Self { wheelset_flat, wheelset, bogie_flat, bogie, bogie_by_table, friction: single.contact.friction })
    }
}
