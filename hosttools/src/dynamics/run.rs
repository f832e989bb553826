//! Runs a scenario from the track's begin to its end.

use std::path::Path;

use flangeway::creep::Elasticity;
use flangeway::{ContactTable, Side};
use indicatif::ProgressBar;

use super::record::Sample;
use super::scenario::{Method, Scenario};
use super::source::Source;
use super::vehicle::{Line, Vehicle};
use super::wheel_rail::WheelRail;
use crate::contact::{Dimension, Settings};
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;

/// Wheels, rails and their table: what any method needs to find contacts.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Wheels on rails, for the direct solver in 3-D.
    pub pair: Pair,
    /// The same for 2-D.
    pub flat: Pair,
    /// The table's image; none where the scenario names none and its recipe is not a committed one.
    pub image: Option<Vec<u8>>,
    recipe: Recipe,
}

impl Ground {
    /// The wheels, rails and table that a scenario names.
    ///
    /// # Errors
    /// When recipe or table cannot be read.
    pub fn of(scenario: &Scenario) -> Result<Self> {
        let committed = flangeway_tables::ALL.iter().find(|c| c.name == scenario.recipe);
        let recipe = match committed {
            Some(committed) => Recipe::parse(committed.recipe, Path::new(&format!("{}.toml", committed.name)))?,
            None if Path::new(&scenario.recipe).extension().is_none() => {
                let names: Vec<&str> = flangeway_tables::ALL.iter().map(|c| c.name).collect();
                let message = format!("\"{}\" is neither a file nor one of {}", scenario.recipe, names.join(", "));
                return Err(Error::field(&scenario.path, "recipe", message));
            }
            None => Recipe::load(&scenario.file(Path::new(&scenario.recipe)))?,
        };
        let image = match (&scenario.contact.table, committed) {
            (Some(table), _) => {
                let path = scenario.file(table);
                let image = std::fs::read(&path).map_err(|e| Error::file(&path, e.to_string()))?;
                ContactTable::new(&image).map_err(|e| Error::file(&path, e.to_string()))?;
                Some(image)
            }
            (None, Some(committed)) => Some(committed.image.to_vec()),
            (None, None) => None,
        };
        Self::new(recipe, image)
    }

    /// Wheels and rails of a recipe, with a table or without.
    ///
    /// # Errors
    /// When a profile cannot be read or placed.
    pub fn new(recipe: Recipe, image: Option<Vec<u8>>) -> Result<Self> {
        let pair = Pair::build(&recipe)?;
        let settings = *pair.body(Side::Right).settings();
        let with = |dimension| pair.with_settings(Settings { dimension, ..settings });
        Ok(Self { pair: with(Dimension::Three), flat: with(Dimension::Two), image, recipe })
    }

    /// The table.
    ///
    /// # Errors
    /// When there is none.
    pub fn table(&self) -> Result<Option<ContactTable<'_>>> {
        let view = |image| ContactTable::new(image).map_err(|e| Error::field("", "table", e.to_string()));
        self.image.as_deref().map(view).transpose()
    }

    /// Half of the distance between the running circles, m.
    #[must_use]
    pub fn half_base(&self) -> f64 {
        self.pair.body(Side::Right).wheel().geometry().lateral_position
    }

    /// Elastic constants for the creep forces.
    #[must_use]
    pub fn elasticity(&self) -> Elasticity {
        let crate::hertz::Material { youngs_modulus, poisson_ratio } = self.recipe.material();
        Elasticity::from(&flangeway::Material { young_modulus: youngs_modulus, poisson_ratio })
    }
}

/// A scenario's forces, track and rails, ready to run.
///
/// # Errors
/// When a table is needed and there is none, or the measured irregularity cannot be read.
pub fn run(scenario: &Scenario, ground: &Ground, bar: &ProgressBar) -> Result<Vec<Sample>> {
    let table = ground.table()?;
    let source = match (scenario.contact.method, &table) {
        (Method::Direct3d, _) => Source::Direct(&ground.pair),
        (Method::Direct2d, _) => Source::Direct(&ground.flat),
        (Method::Table, Some(table)) => Source::Table(table),
        (Method::Rigid, Some(table)) => Source::Rigid(table, scenario.contact.penalty_n_per_m),
        (Method::Table | Method::Rigid, None) => {
            let message = "is missing: compile the recipe's table (flangeway compile) and name it here";
            return Err(Error::field(&scenario.path, "contact.table", message));
        }
    };
    let contact = WheelRail {
        source,
        law: scenario.contact.creep,
        friction: scenario.contact.friction(),
        elasticity: ground.elasticity(),
        damping: scenario.contact.damping_s_per_m,
    };
    let (track, irregularity) = (scenario.track(), scenario.irregularity(ground.half_base())?);
    let line =
        Line { track: &track, irregularity: &irregularity, contact: &contact, speed: scenario.run.speed_m_per_s };
    along(scenario, &line, bar)
}

/// Rows that a run of a scenario writes.
#[must_use]
pub fn rows(scenario: &Scenario) -> u64 {
    let time = scenario.track().length() / scenario.run.speed_m_per_s;
    (time / scenario.run.output_interval_s) as u64
}

fn along(scenario: &Scenario, line: &Line<'_>, bar: &ProgressBar) -> Result<Vec<Sample>> {
    let mut vehicle =
        Vehicle::at_rest(scenario.parameters(), line).map_err(|e| Error::field(&scenario.path, "recipe", e.message))?;
    let mut samples = vec![Sample::of(&vehicle, line.track.at(vehicle.distance))];
    let steps = scenario.steps_a_row();
    while vehicle.distance < line.track.length() {
        for _ in 0..steps {
            vehicle.step(scenario.run.step_s, line);
        }
        let sample = Sample::of(&vehicle, line.track.at(vehicle.distance));
        let finite = sample.wheelsets.iter().all(|w| w.body.position.iter().all(|x| x.abs() < 1e12));
        let off = sample.wheelsets.iter().any(|w| w.body.position[0].abs() > DERAILED);
        samples.push(sample);
        bar.inc(1);
        if !finite || off {
            let place = format!("{:.2} s, {:.1} m", vehicle.time, vehicle.distance);
            let message =
                if finite { "the vehicle has left the rails" } else { "the step is too long for these forces" };
            return Err(Error::field(&scenario.path, "run", format!("{message} at {place}")));
        }
    }
    Ok(samples)
}

/// Lateral displacement (m) at which a wheelset has left the rails.
const DERAILED: f64 = 0.03;
