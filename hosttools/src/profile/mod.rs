//! Wheel and rail profiles: built-in ones from their formulas, others read from measurement and simulation files.
//!
//! Whatever the source, a [`Profile`] is a contour in metres in one frame: y to the field side (the flange of a wheel
//! and the gauge face of a rail at negative y), z down, points in order from the flange or gauge side to the field
//! side. A reader says in plain sentences what it recognised and changed, and refuses what it cannot place.

mod arcs;
mod builtin;
mod cleanup;
mod kinks;
mod miniprof;
mod pieces;
mod place;
mod rails;
mod reading;
mod s1002;
mod simpack;
mod text;

use std::fmt;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use reading::{Format, Reading};

pub use builtin::{BUILT_INS, is_built_in};
pub use rails::{RailHead, rail_54e1, rail_60e1};
pub use s1002::{s1002_height, s1002_slope};

/// What a profile belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProfileKind {
    /// A wheel: flange at negative y, flange tip at the largest z.
    Wheel,
    /// A rail: gauge face at negative y, crown at the smallest z.
    Rail,
}

impl fmt::Display for ProfileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Wheel => "wheel",
            Self::Rail => "rail",
        })
    }
}

/// Length unit of a profile file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Metre.
    M,
    /// Millimetre.
    Mm,
    /// Inch, 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Metres in one unit.
    pub fn metres(self) -> f64 {
        match self {
            Self::M => 1.0,
            Self::Mm => 1e-3,
            Self::Inch => 0.0254,
        }
    }
}

/// What the user says about a file, over what its reader would recognise; `None` leaves it to the reader.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Whether the file's lateral coordinate changes sign.
    pub mirror_y: Option<bool>,
    /// Whether the file's vertical coordinate changes sign.
    pub mirror_z: Option<bool>,
    /// The file's length unit.
    pub length_unit: Option<LengthUnit>,
}

/// A point where a contour changes its formula or has a kink: the curvature, and at a kink the tangent, may jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Index into [`Profile::points`].
    pub index: usize,
    /// Unit tangent `[y, z]` towards the field side, on the flange or gauge side of the joint.
    pub tangent_before: Option<[f64; 2]>,
    /// Unit tangent `[y, z]` towards the field side, on the field side of the joint.
    pub tangent_after: Option<[f64; 2]>,
}

/// A wheel or rail contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Wheel or rail.
    pub kind: ProfileKind,
    /// Built-in name or file name.
    pub name: String,
    /// Points `[y, z]` (m), from the flange or gauge side to the field side.
    pub points: Vec<[f64; 2]>,
    /// Joints by increasing index; of a file, its kinks.
    pub joints: Vec<Joint>,
    /// What was recognised and changed, in plain sentences.
    pub recognised: Vec<String>,
    /// SHA-256 of the file's bytes; of a built-in, of its coordinates as little-endian `f64`, y and z by turns.
    pub source_hash: [u8; 32],
    /// `approx.smooth` of a Simpack file as it stands there, 0 otherwise.
    pub smoothing: f64,
}

impl Profile {
    /// Loads a built-in profile by name, or a file by its path relative to `base`.
    ///
    /// # Errors
    /// When the file cannot be read or placed, the built-in's parameter makes no sense, or the profile is not of the
    /// `kind` wanted; the error names the file, the line or field, and the value.
    pub fn load(spec: &str, base: &Path, kind: Option<ProfileKind>, options: &ReadOptions) -> Result<Self> {
        if is_built_in(spec) {
            return Self::built_in(spec, kind, options);
        }
        let path = base.join(spec);
        Self::parse(&path, &read_file(&path)?, kind, options)
    }

    /// Reads a profile from a file's bytes; `path` gives its name, its extension, and the errors' place.
    ///
    /// # Errors
    /// As [`Profile::load`].
    pub fn parse(path: &Path, bytes: &[u8], kind: Option<ProfileKind>, options: &ReadOptions) -> Result<Self> {
        let content = String::from_utf8_lossy(bytes);
        let content = content.strip_prefix('\u{feff}').unwrap_or(&content);
        let mut reading = match Format::of(path, content) {
            Format::Simpack => simpack::read(path, content)?,
            Format::MiniProf => miniprof::read(path, content)?,
            Format::Text => text::read(path, content)?,
        };
        let kind = agreed_kind(path, kind, &reading)?;
        let (points, lines) = place::place(path, &mut reading, kind, options)?;
        let mut recognised = reading.recognised;
        let (points, lines) = cleanup::clean(path, points, lines, reading.least_distance, &mut recognised)?;
        let joints = kinks::find(&points, &lines, &mut recognised);
        let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
        let source_hash = Sha256::digest(bytes).into();
        Ok(Self { kind, name, points, joints, recognised, source_hash, smoothing: reading.smoothing })
    }

    fn built_in(spec: &str, kind: Option<ProfileKind>, options: &ReadOptions) -> Result<Self> {
        if *options != ReadOptions::default() {
            return Err(Error::field("", spec, "a built-in profile takes no unit and no mirroring"));
        }
        let profile = builtin::build(spec)?;
        match kind {
            Some(wanted) if wanted != profile.kind => {
                Err(Error::field("", spec, format!("is a {} profile where a {wanted} profile is wanted", profile.kind)))
            }
            _ => Ok(profile),
        }
    }
}

/// Contents of a profile file.
///
/// # Errors
/// When it cannot be read; the message names the built-in profiles, which it may have been meant for.
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| {
        Error::file(path, format!("cannot be read ({e}); the built-in profiles are {}", BUILT_INS.join(", ")))
    })
}

/// SHA-256 of coordinates as little-endian `f64`.
fn hash_points(points: &[[f64; 2]]) -> [u8; 32] {
    let mut hasher = Sha256::new();
    for p in points {
        hasher.update(p[0].to_le_bytes());
        hasher.update(p[1].to_le_bytes());
    }
    hasher.finalize().into()
}

/// The kind on which the user, the file's header and its extension agree.
fn agreed_kind(path: &Path, wanted: Option<ProfileKind>, reading: &Reading) -> Result<ProfileKind> {
    let claims =
        [("the caller", wanted), ("the header", reading.kind), ("the extension", reading::kind_of_extension(path))];
    let mut claims = claims.into_iter().filter_map(|(who, kind)| kind.map(|kind| (who, kind)));
    let Some((first, kind)) = claims.next() else {
        return Err(Error::file(path, "does not say whether it is a wheel or a rail profile; give its kind"));
    };
    match claims.find(|&(_, other)| other != kind) {
        Some((second, other)) => {
            Err(Error::file(path, format!("is a {kind} profile by {first} and a {other} profile by {second}")))
        }
        None => Ok(kind),
    }
}
