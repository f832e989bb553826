//! Scenarios: which vehicle on which track, from a TOML file whose every key is checked.
//!
//! `tables/scenarios/` holds worked examples, each number with its reason.

use std::path::{Path, PathBuf};

use flangeway::creep::Friction;
use serde::Deserialize;

use super::irregularity::Irregularity;
use super::spectrum::Roughness;
use super::suspension::Suspension;
use super::track::{Section, Track};
use super::vehicle::{Carried, FrameParameters, Parameters};
use super::wheel_rail::Law;
use super::wheelset;
use crate::error::{Error, Result};

/// A scenario as written, its values checked.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What it shows, in a line.
    pub title: String,
    /// A wheelset or a bogie.
    pub model: Model,
    /// Wheels and rails: the name of a committed recipe, or a recipe file from the scenario's folder.
    pub recipe: String,
    /// How it is run.
    pub run: RunSettings,
    /// Contact and creep.
    pub contact: ContactSettings,
    /// Each wheelset.
    pub wheelset: wheelset::Parameters,
    /// Each wheelset's suspension.
    pub suspension: Suspension,
    /// What is carried.
    pub carried: Carried,
    /// The bogie's frame.
    pub frame: Option<FrameParameters>,
    /// What leads a single wheelset.
    pub guide: Option<Guide>,
    /// The track, section by section.
    #[serde(rename = "track")]
    pub sections: Vec<SectionSettings>,
    /// How the rails deviate.
    pub irregularity: Option<IrregularitySettings>,
    /// The file it came from, for errors; other files are looked for from its folder.
    #[serde(skip)]
    pub path: PathBuf,
}

/// Kind of vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Model {
    /// One wheelset, whose suspension is led along the track.
    Wheelset,
    /// Two wheelsets and a frame.
    Bogie,
}

/// `[guide]`: the frame that holds a single wheelset and runs along the track exactly.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guide {
    /// How far behind the axle the frame takes the track's direction, m: half of the wheelbase that it stands for.
    pub behind_m: f64,
}

/// `[run]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSettings {
    /// Speed along the track, m/s.
    pub speed_m_per_s: f64,
    /// Step of the integration, s.
    pub step_s: f64,
    /// Time between two rows of the output, s; a whole number of steps.
    pub output_interval_s: f64,
}

/// `[contact]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactSettings {
    /// Where contacts come from.
    pub method: Method,
    /// The table; a committed recipe has its own.
    pub table: Option<PathBuf>,
    /// How creep forces follow.
    pub creep: Law,
    /// Coefficient of friction without slip.
    pub friction: f64,
    /// A of Polach's falling friction: the coefficient at infinite slip over that without.
    #[serde(default = "constant")]
    pub friction_limit_ratio: f64,
    /// B of Polach's falling friction, s/m.
    #[serde(default)]
    pub friction_decay_s_per_m: f64,
    /// Damping of the contacts' approach, s/m: force is raised by this share per m/s.
    #[serde(default)]
    pub damping_s_per_m: f64,
    /// Stiffness (N/m) of the penalty that keeps the constraint of rigid contact.
    #[serde(default = "penalty")]
    pub penalty_n_per_m: f64,
}

/// Where contacts come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The table, by the kernel
    Table,
    /// The direct elastic solver, in the section through the axle
    #[serde(rename = "direct-2d")]
    #[value(name = "direct-2d")]
    Direct2d,
    /// The direct elastic solver, ahead of or behind the axle too
    #[serde(rename = "direct-3d")]
    #[value(name = "direct-3d")]
    Direct3d,
    /// Rigid contact by a penalty
    Rigid,
}

/// `[[track]]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionSettings {
    /// Kind of section.
    pub kind: SectionKind,
    /// Length, m.
    pub length_m: f64,
    /// Radius of a curve, m; negative to the left.
    pub radius_m: Option<f64>,
    /// Cant angle of a curve, rad, positive where the right rail is lower.
    pub cant_rad: Option<f64>,
}

/// Kind of a section of track.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SectionKind {
    /// Straight and level.
    Straight,
    /// From the section before to the one after, curvature and cant changing linearly.
    Transition,
    /// Of one radius.
    Curve,
}

/// `[irregularity]`: a file or a spectrum.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IrregularitySettings {
    /// Measured series, CSV.
    pub file: Option<PathBuf>,
    /// Spectrum of a generated one.
    pub spectrum: Option<Roughness>,
    /// Its seed.
    #[serde(default)]
    pub seed: u64,
    /// Its shortest and longest wave, m.
    #[serde(default = "waves")]
    pub waves_m: [f64; 2],
}

impl ContactSettings {
    /// Friction between wheel and rail.
    #[must_use]
    pub fn friction(&self) -> Friction {
        let [coefficient, limit_ratio, decay] =
            [self.friction, self.friction_limit_ratio, self.friction_decay_s_per_m].map(|x| x as f32);
        Friction { coefficient, limit_ratio, decay }
    }
}

fn constant() -> f64 {
    1.0
}

fn penalty() -> f64 {
    5e9
}

fn waves() -> [f64; 2] {
    [3.0, 100.0]
}

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// When the file cannot be read, is no valid TOML, has an unknown or missing key, or a value out of range.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
        Self::parse(&text, path)
    }

    /// Reads a scenario from text; `path` names it in errors.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let mut scenario: Self = crate::recipe::parse_toml(text, path)?;
        scenario.path = path.into();
        scenario.check()?;
        Ok(scenario)
    }

    /// A file named in the scenario, from its folder.
    #[must_use]
    pub fn file(&self, name: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    /// The vehicle's constants.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        let Self { wheelset, suspension, carried, frame, guide, .. } = *self;
        Parameters { wheelset, suspension, carried, frame, led_from_m: guide.map_or(0.0, |guide| guide.behind_m) }
    }

    /// The centre line.
    #[must_use]
    pub fn track(&self) -> Track {
        let sections = &self.sections;
        let ends = |section: Option<&SectionSettings>| {
            let curvature = section.and_then(|s| s.radius_m).map_or(0.0, |radius| 1.0 / radius);
            [curvature, section.and_then(|s| s.cant_rad).unwrap_or(0.0)]
        };
        let place = |(index, section): (usize, &SectionSettings)| {
            let [before, after] = match section.kind {
                SectionKind::Transition => {
                    [index.checked_sub(1).and_then(|i| sections.get(i)), sections.get(index + 1)].map(ends)
                }
                _ => [ends(Some(section)); 2],
            };
            Section { length: section.length_m, curvature: [before[0], after[0]], cant: [before[1], after[1]] }
        };
        Track::new(&sections.iter().enumerate().map(place).collect::<Vec<_>>())
    }

    /// How the rails deviate over the whole track.
    ///
    /// # Errors
    /// When a measured series cannot be read.
    pub fn irregularity(&self, half_base: f64) -> Result<Irregularity> {
        match &self.irregularity {
            None => Ok(Irregularity::default()),
            Some(IrregularitySettings { file: Some(file), .. }) => Irregularity::read(&self.file(file)),
            Some(IrregularitySettings { spectrum, seed, waves_m, .. }) => {
                let length = self.track().length().max(waves_m[1]);
                Ok(spectrum.map_or(Irregularity::default(), |s| s.series(length, *waves_m, half_base, *seed)))
            }
        }
    }

    /// Steps of the integration between two rows of the output.
    #[must_use]
    pub fn steps_a_row(&self) -> usize {
        (self.run.output_interval_s / self.run.step_s).round() as usize
    }

    fn check(&self) -> Result<()> {
        let refuse = |key: &str, message: String| Err(Error::field(&self.path, key, message));
        let within = |key: &str, value: f64, low: f64, high: f64| {
            let inside = value >= low && value <= high;
            if inside { Ok(()) } else { refuse(key, format!("{value} is not between {low} and {high}")) }
        };
        let RunSettings { speed_m_per_s, step_s, output_interval_s } = self.run;
        within("run.speed_m_per_s", speed_m_per_s, 0.1, 200.0)?;
        within("run.step_s", step_s, 1e-6, 1e-2)?;
        within("run.output_interval_s", output_interval_s, step_s, 10.0)?;
        let steps = output_interval_s / step_s;
        if (steps - steps.round()).abs() > 1e-6 * steps {
            return refuse(
                "run.output_interval_s",
                format!("{output_interval_s} is no whole number of steps of {step_s}"),
            );
        }
        within("contact.friction", self.contact.friction, 0.0, 2.0)?;
        within("contact.friction_limit_ratio", self.contact.friction_limit_ratio, 0.0, 1.0)?;
        within("contact.friction_decay_s_per_m", self.contact.friction_decay_s_per_m, 0.0, 1e3)?;
        within("contact.damping_s_per_m", self.contact.damping_s_per_m, 0.0, 100.0)?;
        within("contact.penalty_n_per_m", self.contact.penalty_n_per_m, 1e6, 1e12)?;
        within("wheelset.mass_kg", self.wheelset.mass_kg, 1.0, 1e5)?;
        within("wheelset.roll_yaw_inertia_kgm2", self.wheelset.roll_yaw_inertia_kgm2, 0.1, 1e6)?;
        within("wheelset.spin_inertia_kgm2", self.wheelset.spin_inertia_kgm2, 0.1, 1e6)?;
        for value in self.suspension.stiffness_n_per_m {
            within("suspension.stiffness_n_per_m", value, 0.0, 1e10)?;
        }
        for value in self.suspension.damping_ns_per_m {
            within("suspension.damping_ns_per_m", value, 0.0, 1e9)?;
        }
        within("suspension.half_spacing_m", self.suspension.half_spacing_m, 0.1, 3.0)?;
        within("suspension.below_frame_m", self.suspension.below_frame_m, -2.0, 2.0)?;
        within("carried.mass_kg", self.carried.mass_kg, 0.0, 1e6)?;
        within("carried.height_m", self.carried.height_m, -5.0, 5.0)?;
        match (&self.frame, self.model) {
            (Some(frame), Model::Bogie) => {
                within("frame.mass_kg", frame.mass_kg, 1.0, 1e6)?;
                within("frame.wheelbase_m", frame.wheelbase_m, 0.2, 10.0)?;
                for value in frame.inertia_kgm2 {
                    within("frame.inertia_kgm2", value, 0.1, 1e7)?;
                }
            }
            (None, Model::Bogie) => return refuse("frame", "a bogie has a [frame]".into()),
            (Some(_), Model::Wheelset) => return refuse("frame", "a single wheelset has none".into()),
            (None, Model::Wheelset) => {}
        }
        if let (Some(_), Model::Bogie) = (&self.guide, self.model) {
            return refuse("guide", "is of a single wheelset".into());
        }
        within("guide.behind_m", self.guide.map_or(0.0, |guide| guide.behind_m), 0.0, 20.0)?;
        self.check_track()?;
        match &self.irregularity {
            Some(IrregularitySettings { file: None, spectrum: None, .. })
            | Some(IrregularitySettings { file: Some(_), spectrum: Some(_), .. }) => {
                refuse("irregularity", "names either a file or a spectrum".into())
            }
            Some(IrregularitySettings { waves_m: [shortest, longest], .. }) => {
                within("irregularity.waves_m", *shortest, 1.0, 200.0)?;
                within("irregularity.waves_m", *longest, *shortest, 1000.0)
            }
            None => Ok(()),
        }
    }

    fn check_track(&self) -> Result<()> {
        let refuse = |key: &str, message: String| Err(Error::field(&self.path, format!("track.{key}"), message));
        if self.sections.is_empty() {
            return refuse("kind", "the track has no section".into());
        }
        for (index, section) in self.sections.iter().enumerate() {
            let number = index + 1;
            if !(section.length_m > 0.0 && section.length_m <= 1e6) {
                return refuse(
                    "length_m",
                    format!("{} of section {number} is not above 0 and up to 1e6", section.length_m),
                );
            }
            let curved = section.kind == SectionKind::Curve;
            if curved != section.radius_m.is_some() {
                return refuse("radius_m", format!("section {number}: a curve has one, other sections have none"));
            }
            if !curved && section.cant_rad.is_some() {
                return refuse("cant_rad", format!("section {number}: only a curve has a cant"));
            }
            if let Some(radius) = section.radius_m.filter(|r| !(10.0..=1e6).contains(&r.abs())) {
                return refuse("radius_m", format!("{radius} of section {number} is not 10 to 1e6 m, to either side"));
            }
            if let Some(cant) = section.cant_rad.filter(|cant| !(-0.3..=0.3).contains(cant)) {
                return refuse("cant_rad", format!("{cant} of section {number} is not between -0.3 and 0.3"));
            }
            let next = self.sections.get(index + 1);
            if section.kind == SectionKind::Transition && next.is_some_and(|s| s.kind == SectionKind::Transition) {
                return refuse("kind", format!("section {} : a transition follows a transition", number + 1));
            }
        }
        Ok(())
    }
}
