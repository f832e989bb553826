//! Recipes: which wheel on which rail, and what to make a table of.
//!
//! A recipe is a TOML file; `tables/recipes/` holds worked examples. Every key is checked: an unknown one, a missing
//! one and a value out of its range are errors that name the file, the line or the key, and the value.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::contact::{Curvature, Dimension, Normal, Settings};
use crate::error::{Error, Result};
use crate::hertz::Material;
use crate::profile::{LengthUnit, Profile, ProfileKind, ReadOptions, is_built_in, read_file};

/// A recipe as written, its values checked.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The wheels, both sides alike unless `[wheel.left]` differs.
    pub wheel: WheelRecipe,
    /// The rails, both sides alike unless `[rail.left]` differs.
    pub rail: RailRecipe,
    /// Elastic constants.
    pub material: MaterialRecipe,
    /// Ranges and node counts of the table.
    pub grid: Grid,
    /// Slot boundaries, where they are not to be found from the rigid contact's path.
    #[serde(default)]
    pub slots: SlotRecipe,
    /// Settings of the direct solver.
    #[serde(default)]
    pub solver: SolverRecipe,
    /// The file it came from, for errors; profiles are resolved against its folder.
    #[serde(skip)]
    pub path: PathBuf,
    /// Its text, whose hash goes into the table's header.
    #[serde(skip)]
    pub text: String,
    /// Contents of profile files that are at hand, by the names that the recipe gives them; others are read from disk.
    #[serde(skip)]
    pub profiles: BTreeMap<String, Vec<u8>>,
}

/// `[wheel]`: profile and place of a wheel.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelRecipe {
    /// Built-in name, or a path from the recipe's folder.
    pub profile: String,
    /// Rolling radius at the tape circle (m).
    pub nominal_radius_m: f64,
    /// Distance between the backs of the two flanges (m).
    pub flange_back_spacing_m: f64,
    /// Profile coordinate of the flange's back (m), as in the profile file after mirroring.
    pub flange_back_position_m: f64,
    /// Profile coordinate of the tape circle (m), where the nominal radius is measured.
    #[serde(default)]
    pub tape_circle_position_m: f64,
    /// Root mean square distance (m) by which the smoothed curve may leave the points.
    pub smoothing_m: Option<f64>,
    /// Whether to mirror the file's lateral coordinate, over what its reader recognises.
    pub mirror_y: Option<bool>,
    /// Whether to mirror the file's vertical coordinate.
    pub mirror_z: Option<bool>,
    /// The file's length unit: `"m"`, `"mm"` or `"inch"`.
    pub length_unit: Option<LengthUnit>,
    /// The left wheel where it is another.
    pub left: Option<OtherProfile>,
}

/// `[rail]`: profile and place of a rail.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RailRecipe {
    /// Built-in name, or a path from the recipe's folder.
    pub profile: String,
    /// Track gauge (m), between the gauge faces.
    pub gauge_m: Option<f64>,
    /// Depth below the crown (m) at which the gauge is measured.
    #[serde(default = "gauge_height")]
    pub gauge_height_m: f64,
    /// Inclination of the rail towards the track's centre (rad), 0.025 for 1:40.
    #[serde(default)]
    pub cant_rad: f64,
    /// Place `[y, z]` (m) of the profile's own origin in the track frame, instead of placing by gauge and crown.
    pub origin_m: Option<[f64; 2]>,
    /// Root mean square distance (m) by which the smoothed curve may leave the points.
    pub smoothing_m: Option<f64>,
    /// Whether to mirror the file's lateral coordinate, over what its reader recognises.
    pub mirror_y: Option<bool>,
    /// Whether to mirror the file's vertical coordinate.
    pub mirror_z: Option<bool>,
    /// The file's length unit: `"m"`, `"mm"` or `"inch"`.
    pub length_unit: Option<LengthUnit>,
    /// The left rail where it is another.
    pub left: Option<OtherProfile>,
}

/// `[wheel.left]` or `[rail.left]`: another profile, placed as the right one is.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OtherProfile {
    /// Built-in name, or a path from the recipe's folder.
    pub profile: String,
    /// Nominal radius (m) where it differs (wheels only).
    pub nominal_radius_m: Option<f64>,
    /// Root mean square distance (m) by which the smoothed curve may leave the points.
    pub smoothing_m: Option<f64>,
    /// Whether to mirror the file's lateral coordinate, over what its reader recognises.
    pub mirror_y: Option<bool>,
    /// Whether to mirror the file's vertical coordinate.
    pub mirror_z: Option<bool>,
    /// The file's length unit: `"m"`, `"mm"` or `"inch"`.
    pub length_unit: Option<LengthUnit>,
}

/// `[material]`.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialRecipe {
    /// Young's modulus (Pa).
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// `[slots]`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotRecipe {
    /// Wheel-profile coordinates (m) between tread and flange root, and between flange root and flange.
    pub boundaries_m: Option<[f64; 2]>,
}

/// `[solver]`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverRecipe {
    /// How the normal force is found.
    #[serde(default)]
    pub normal: Normal,
    /// `"3d"` or `"2d"`.
    #[serde(default)]
    pub dimension: Dimension,
    /// `"mean"` over the contact, or `"local"` as in the paper.
    #[serde(default)]
    pub curvature: Curvature,
    /// Smallest combined principal curvature (1/m) taken for Hertz.
    pub curvature_floor_per_m: Option<f64>,
}

/// `[grid]`: ranges of the table, a node count or `"auto"` an axis.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Lateral displacement of the tape-circle point (m).
    pub lateral_m: Axis,
    /// Yaw (rad); the other direction follows by symmetry.
    pub yaw_rad: Axis,
    /// Height above the rigid contact (m, positive into the rail).
    pub vertical_m: Axis,
    /// Roll about the rigid contact's (rad).
    pub roll_rad: Axis,
    /// Bytes that `"auto"` may spend.
    #[serde(default = "max_bytes")]
    pub max_bytes: u64,
    /// 95 % quantile of the relative force error at which `"auto"` has done enough.
    pub max_force_error_p95: Option<f64>,
    /// `"fitted"` to the solver between the nodes, or `"sampled"` at the nodes.
    #[serde(default)]
    pub node_values: NodeValues,
    /// Random poses at which the errors in the header are measured, 4000 (half-space: 1000) unless given; of a small table
    /// that is most of the work.
    pub error_poses: Option<usize>,
}

/// What a node holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NodeValues {
    /// What brings the table nearest to the solver between the nodes.
    #[default]
    Fitted,
    /// The solver's answer at the node.
    Sampled,
}

/// One axis of the table.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// First and last node.
    pub range: [f64; 2],
    /// Number of nodes.
    #[serde(default)]
    pub nodes: Nodes,
}

/// Node count of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Nodes {
    /// The compiler chooses.
    #[default]
    Auto,
    /// So many, evenly spaced.
    Count(usize),
}

impl<'de> Deserialize<'de> for Nodes {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Count(i64),
            Word(String),
        }
        match Written::deserialize(deserializer) {
            Ok(Written::Count(n)) if (2..=2048).contains(&n) => Ok(Self::Count(n as usize)),
            Ok(Written::Count(n)) => Err(serde::de::Error::custom(format!("nodes = {n}: an axis has 2 to 2048 nodes"))),
            Ok(Written::Word(word)) if word == "auto" => Ok(Self::Auto),
            Ok(Written::Word(word)) => {
                Err(serde::de::Error::custom(format!("nodes = \"{word}\": neither a count nor \"auto\"")))
            }
            Err(_) => Err(serde::de::Error::custom("nodes is neither a count nor \"auto\"")),
        }
    }
}

/// What a TOML file holds; `path` names it in errors, with the line.
///
/// # Errors
/// When it is no valid TOML, or a key is unknown, missing or of another type.
pub fn parse_toml<T: serde::de::DeserializeOwned>(text: &str, path: &Path) -> Result<T> {
    toml::from_str(text).map_err(|e| {
        let message = e.message().replace('\n', " ");
        match e.span() {
            Some(span) => Error::line(path, text[..span.start].matches('\n').count() + 1, message),
            None => Error::file(path, message),
        }
    })
}

fn gauge_height() -> f64 {
    0.014
}

fn max_bytes() -> u64 {
    1 << 20
}

impl WheelRecipe {
    /// What the recipe says about reading the profile.
    pub fn options(&self) -> ReadOptions {
        ReadOptions { mirror_y: self.mirror_y, mirror_z: self.mirror_z, length_unit: self.length_unit }
    }
}

impl RailRecipe {
    /// What the recipe says about reading the profile.
    pub fn options(&self) -> ReadOptions {
        ReadOptions { mirror_y: self.mirror_y, mirror_z: self.mirror_z, length_unit: self.length_unit }
    }
}

impl OtherProfile {
    /// What the recipe says about reading the profile.
    pub fn options(&self) -> ReadOptions {
        ReadOptions { mirror_y: self.mirror_y, mirror_z: self.mirror_z, length_unit: self.length_unit }
    }
}

impl Recipe {
    /// Reads a recipe file.
    ///
    /// # Errors
    /// When the file cannot be read, is no valid TOML, has an unknown or missing key, or a value out of range.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
        Self::parse(&text, path)
    }

    /// Reads a recipe from text; `path` names it in errors, and its folder is where profiles are looked for.
    ///
    /// # Errors
    /// As [`Recipe::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let mut recipe: Self = parse_toml(text, path)?;
        recipe.path = path.into();
        recipe.text = text.into();
        recipe.check()?;
        Ok(recipe)
    }

    /// Folder against which profile paths are resolved.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Loads one of its profiles.
    ///
    /// # Errors
    /// As [`Profile::load`]; of a built-in profile with the recipe's field.
    pub fn load_profile(&self, spec: &str, kind: ProfileKind, options: &ReadOptions) -> Result<Profile> {
        match self.profiles.get(spec) {
            Some(bytes) => Profile::parse(Path::new(spec), bytes, Some(kind), options),
            // A file's error names the file; a built-in has none, so its error is the recipe's.
            None => Profile::load(spec, self.folder(), Some(kind), options).map_err(|e| match is_built_in(spec) {
                true => Error::field(&self.path, format!("{kind}.profile"), e.to_string()),
                false => e,
            }),
        }
    }

    /// The profiles that it names, with what it says about reading them.
    pub fn named_profiles(&self) -> Vec<(ProfileKind, &str, ReadOptions)> {
        let mut named = vec![
            (ProfileKind::Wheel, &*self.wheel.profile, self.wheel.options()),
            (ProfileKind::Rail, &*self.rail.profile, self.rail.options()),
        ];
        let left = [(ProfileKind::Wheel, &self.wheel.left), (ProfileKind::Rail, &self.rail.left)];
        named.extend(left.into_iter().filter_map(|(kind, other)| {
            let other = other.as_ref()?;
            Some((kind, &*other.profile, other.options()))
        }));
        named
    }

    /// Contents of all profile files that it names.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn read_profiles(&self) -> Result<BTreeMap<String, Vec<u8>>> {
        let content = |(_, name, _): (ProfileKind, &str, ReadOptions)| match self.profiles.get(name) {
            Some(bytes) => Ok((name.to_owned(), bytes.clone())),
            None => Ok((name.to_owned(), read_file(&self.folder().join(name))?)),
        };
        self.named_profiles().into_iter().filter(|(_, name, _)| !is_built_in(name)).map(content).collect()
    }

    /// Elastic constants.
    pub fn material(&self) -> Material {
        let MaterialRecipe { youngs_modulus_pa, poisson_ratio } = self.material;
        Material { youngs_modulus: youngs_modulus_pa, poisson_ratio }
    }

    /// Settings of the direct solver.
    pub fn settings(&self) -> Settings {
        let default = Settings::default();
        Settings {
            normal: self.solver.normal,
            dimension: self.solver.dimension,
            curvature: self.solver.curvature,
            curvature_floor: self.solver.curvature_floor_per_m.unwrap_or(default.curvature_floor),
            ..default
        }
    }

    fn check(&self) -> Result<()> {
        let within = |key: &str, value: f64, low: f64, high: f64| {
            let inside = value >= low && value <= high;
            let message = format!("{value} is not between {low} and {high}");
            if inside { Ok(()) } else { Err(Error::field(&self.path, key, message)) }
        };
        let wheel = &self.wheel;
        within("wheel.nominal_radius_m", wheel.nominal_radius_m, 0.05, 2.0)?;
        if let Some(radius) = wheel.left.as_ref().and_then(|l| l.nominal_radius_m) {
            within("wheel.left.nominal_radius_m", radius, 0.05, 2.0)?;
        }
        within("wheel.flange_back_spacing_m", wheel.flange_back_spacing_m, 0.1, 4.0)?;
        within("wheel.flange_back_position_m", wheel.flange_back_position_m, -0.5, 0.5)?;
        within("wheel.tape_circle_position_m", wheel.tape_circle_position_m, -0.5, 0.5)?;
        let rail = &self.rail;
        match (rail.gauge_m, rail.origin_m) {
            (Some(gauge), None) => within("rail.gauge_m", gauge, 0.2, 4.0)?,
            (None, Some([y, z])) => {
                within("rail.origin_m", y, 0.0, 4.0)?;
                within("rail.origin_m", z, -1.0, 1.0)?;
            }
            _ => {
                let message = "a rail is placed either by gauge_m or by origin_m, and by one of them";
                return Err(Error::field(&self.path, "rail", message));
            }
        }
        within("rail.gauge_height_m", rail.gauge_height_m, 0.001, 0.1)?;
        within("rail.cant_rad", rail.cant_rad, -0.3, 0.3)?;
        let smoothings = [
            ("wheel.smoothing_m", wheel.smoothing_m),
            ("wheel.left.smoothing_m", wheel.left.as_ref().and_then(|l| l.smoothing_m)),
            ("rail.smoothing_m", rail.smoothing_m),
            ("rail.left.smoothing_m", rail.left.as_ref().and_then(|l| l.smoothing_m)),
        ];
        for (key, value) in smoothings {
            within(key, value.unwrap_or(0.0), 0.0, 1e-3)?;
        }
        within("material.youngs_modulus_pa", self.material.youngs_modulus_pa, 1e6, 1e13)?;
        within("material.poisson_ratio", self.material.poisson_ratio, 0.0, 0.5)?;
        within("solver.curvature_floor_per_m", self.settings().curvature_floor, 1e-3, 100.0)?;
        if let Some([upper, lower]) = self.slots.boundaries_m {
            within("slots.boundaries_m", upper, -0.5, 0.5)?;
            within("slots.boundaries_m", lower, -0.5, upper)?;
        }
        let grid = &self.grid;
        let axes = [
            ("grid.lateral_m.range", grid.lateral_m, 0.1),
            ("grid.yaw_rad.range", grid.yaw_rad, flangeway::ANGLE_LIMIT),
            ("grid.vertical_m.range", grid.vertical_m, 1e-3),
            ("grid.roll_rad.range", grid.roll_rad, flangeway::ANGLE_LIMIT),
        ];
        for (key, axis, limit) in axes {
            let [first, last] = axis.range;
            within(key, first, -limit, limit)?;
            within(key, last, -limit, limit)?;
            if first >= last {
                return Err(Error::field(&self.path, key, format!("[{first}, {last}] does not rise")));
            }
        }
        within("grid.error_poses", grid.error_poses.unwrap_or(1000) as f64, 100.0, 1e6)?;
        within("grid.max_force_error_p95", grid.max_force_error_p95.unwrap_or(1.0), 1e-6, 1.0)?;
        if grid.yaw_rad.range[0] != 0.0 {
            let message = format!("{} is not 0: backward yaw follows by symmetry", grid.yaw_rad.range[0]);
            return Err(Error::field(&self.path, "grid.yaw_rad.range", message));
        }
        Ok(())
    }
}
