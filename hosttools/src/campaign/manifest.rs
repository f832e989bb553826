//! What a campaign is made of: one line a table, in JSON.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::slurm::Settings;
use crate::compile::GENERATOR;
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::recipe::Recipe;

/// A table to compile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// SHA-256 (its first 128 bits, hexadecimal) of all that determines the table's bytes.
    pub id: String,
    /// Wheel, rail and what else varies, for people.
    pub label: String,
    /// The right wheel's profile.
    pub wheel: String,
    /// The right rail's profile.
    pub rail: String,
    /// Which of the listed values this table has, by key.
    pub varies: BTreeMap<String, String>,
    /// Expected seconds of one core.
    pub cost: f64,
    /// SHA-256 of the profile files by their names in the recipe.
    pub profiles: BTreeMap<String, String>,
    /// The recipe.
    pub recipe: String,
}

impl Entry {
    /// What varies besides the two profiles, in words.
    pub fn others(&self) -> String {
        others(&self.varies)
    }

    /// Wheel and rail as the campaign's file names them: files with their folders, where it lists several.
    pub fn names(&self) -> (&str, &str) {
        let name = |key: &str, name| self.varies.get(key).map_or(name, String::as_str);
        (name("wheel.profile", &self.wheel), name("rail.profile", &self.rail))
    }

    /// The recipe, without the contents of its profiles; `manifest` is named in errors.
    ///
    /// # Errors
    /// When the manifest was changed by hand into something else than a recipe.
    pub fn recipe(&self, manifest: &Path) -> Result<Recipe> {
        Recipe::parse(&self.recipe, manifest)
    }
}

/// A line of the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Planned {
    /// To be compiled.
    Table(Box<Entry>),
    /// Not to be compiled: a profile cannot be read.
    Broken {
        /// As of an entry.
        label: String,
        /// What is wrong, with the file.
        reason: String,
    },
}

impl Planned {
    /// The table, where there is one to compile.
    pub fn entry(&self) -> Option<&Entry> {
        match self {
            Self::Table(entry) => Some(entry),
            Self::Broken { .. } => None,
        }
    }
}

/// All tables of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// In the order of the campaign's lists.
    pub entries: Vec<Planned>,
    /// How they are run on a cluster.
    pub slurm: Settings,
}

/// First line of the file.
#[derive(Debug, Serialize, Deserialize)]
struct Head {
    generator: String,
    lines: usize,
    slurm: Settings,
}

impl Manifest {
    /// The tables to compile.
    pub fn tables(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter_map(Planned::entry)
    }

    /// Labels and reasons of those that cannot be compiled.
    pub fn broken(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().filter_map(|planned| match planned {
            Planned::Broken { label, reason } => Some((label.as_str(), reason.as_str())),
            Planned::Table(_) => None,
        })
    }

    /// Writes the manifest.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let failed = |e: serde_json::Error| Error::file(path, e.to_string());
        let head = Head { generator: GENERATOR.into(), lines: self.entries.len(), slurm: self.slurm.clone() };
        let mut text = serde_json::to_string(&head).map_err(failed)? + "\n";
        for planned in &self.entries {
            text += &serde_json::to_string(planned).map_err(failed)?;
            text.push('\n');
        }
        write_atomically(path, text.as_bytes())
    }

    /// Reads a manifest.
    ///
    /// # Errors
    /// When it cannot be read, a line is not what it should be, or lines are missing; when another version of the
    /// program has written it, whose identifiers are others.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
        let mut lines = text.lines().enumerate();
        let wrong = |number: usize, e: serde_json::Error| Error::line(path, number + 1, e.to_string());
        let Some((_, first)) = lines.next() else { return Err(Error::file(path, "is empty")) };
        let head: Head = serde_json::from_str(first).map_err(|e| wrong(0, e))?;
        if head.generator != GENERATOR {
            let message = format!("planned by {}, this is {GENERATOR}: plan again", head.generator);
            return Err(Error::line(path, 1, message));
        }
        let entry = |(number, line): (usize, &str)| serde_json::from_str(line).map_err(|e| wrong(number, e));
        let entries: Vec<Planned> = lines.map(entry).collect::<Result<_>>()?;
        if entries.len() != head.lines {
            return Err(Error::file(path, format!("has {} of its {} tables", entries.len(), head.lines)));
        }
        Ok(Self { entries, slurm: head.slurm })
    }
}

/// The identifier of a table: format, compiler, recipe, names and contents of its profile files. The compiler is known
/// by a table that it has made and that is held to it by a test, so that whatever changes its bytes changes the
/// identifiers.
pub(super) fn identifier(recipe: &str, profiles: &BTreeMap<String, String>) -> String {
    let mut hasher = Sha256::new();
    let mut add = |part: &[u8]| {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    };
    add(&flangeway::layout::VERSION.to_le_bytes());
    add(GENERATOR.as_bytes());
    add(&Sha256::digest(flangeway_tables::S1002_60E1_40_TABLE));
    add(recipe.as_bytes());
    for (name, hash) in profiles {
        add(name.as_bytes());
        add(hash.as_bytes());
    }
    hex(&hasher.finalize()[..16])
}

/// What varies besides the two profiles, in words.
pub(super) fn others(varies: &BTreeMap<String, String>) -> String {
    let other = |(key, _): &(&String, &String)| !matches!(key.as_str(), "wheel.profile" | "rail.profile");
    varies.iter().filter(other).map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

/// Bytes in hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
