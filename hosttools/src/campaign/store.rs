//! A campaign's folder.

use std::path::{Path, PathBuf};
use std::time::Duration;

use flangeway::{ContactTable, Side};
use sha2::{Digest, Sha256};

use super::manifest::{Entry, hex};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::recipe::Recipe;

/// Age from which a temporary file belongs to nobody any more; writing one takes far less than a second.
const STALE: Duration = Duration::from_secs(600);

/// What there is of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// Whole, and the right one.
    Whole,
    /// Not there.
    Missing,
    /// There, but not what it should be.
    Damaged(String),
}

/// The folder of a campaign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder(PathBuf);

impl Folder {
    /// A folder that may not be there yet.
    pub fn new(path: &Path) -> Self {
        Self(path.into())
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The manifest's file.
    pub fn manifest(&self) -> PathBuf {
        self.0.join("manifest.jsonl")
    }

    /// A table's file.
    pub fn table(&self, id: &str) -> PathBuf {
        self.0.join("tables").join(format!("{id}.fwt"))
    }

    /// Where processes write down what they have done.
    pub fn records(&self) -> PathBuf {
        self.0.join("records")
    }

    /// Scripts, task lists and logs of Slurm.
    pub fn slurm(&self) -> PathBuf {
        self.0.join("slurm")
    }

    fn profile(&self, hash: &str) -> PathBuf {
        self.0.join("profiles").join(hash)
    }

    /// Makes the folder and those inside.
    ///
    /// # Errors
    /// When one cannot be made.
    pub fn create(&self) -> Result<()> {
        for folder in ["tables", "profiles", "records", "slurm"].map(|name| self.0.join(name)) {
            std::fs::create_dir_all(&folder).map_err(|e| Error::file(&folder, e.to_string()))?;
        }
        Ok(())
    }

    /// Keeps a copy of a profile file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn put_profile(&self, hash: &str, bytes: &[u8]) -> Result<()> {
        let path = self.profile(hash);
        match std::fs::read(&path) {
            Ok(there) if there == bytes => Ok(()),
            _ => write_atomically(&path, bytes),
        }
    }

    /// A table's recipe with its profiles.
    ///
    /// # Errors
    /// When a profile's copy is not there or not what it was.
    pub fn recipe(&self, entry: &Entry) -> Result<Recipe> {
        let mut recipe = entry.recipe(&self.manifest())?;
        for (name, hash) in &entry.profiles {
            let path = self.profile(hash);
            let bytes = std::fs::read(&path).map_err(|e| Error::file(&path, e.to_string()))?;
            if hex(&Sha256::digest(&bytes)) != *hash {
                return Err(Error::file(&path, format!("is not the profile {name} that was planned: plan again")));
            }
            recipe.profiles.insert(name.clone(), bytes);
        }
        Ok(recipe)
    }

    /// What there is of a table: its CRC and every section are checked, and that it is of the entry's recipe and profiles.
    pub fn state(&self, entry: &Entry) -> State {
        let image = match std::fs::read(self.table(&entry.id)) {
            Ok(image) => image,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return State::Missing,
            Err(e) => return State::Damaged(e.to_string()),
        };
        let table = match ContactTable::new(&image) {
            Ok(table) => table,
            Err(e) => return State::Damaged(e.to_string()),
        };
        let header = table.header();
        let sides = Side::ALL.map(|side| header.side(side));
        let hashes = sides.map(|side| [side.wheel_sha256, side.rail_sha256].map(|hash| hex(&hash)));
        let known = |hash: &String| hashes.as_flattened().contains(hash);
        let recipe: [u8; 32] = Sha256::digest(entry.recipe.as_bytes()).into();
        if header.recipe_sha256 == recipe && entry.profiles.values().all(known) {
            State::Whole
        } else {
            State::Damaged("the table of another recipe".into())
        }
    }

    /// Takes away temporary files that killed processes have left.
    pub fn sweep(&self) {
        let Ok(files) = std::fs::read_dir(self.0.join("tables")) else { return };
        for file in files.flatten() {
            let temporary = file.file_name().to_string_lossy().starts_with(".flangeway-");
            let age = file.metadata().and_then(|m| m.modified()).ok().and_then(|time| time.elapsed().ok());
            if temporary && age.is_some_and(|age| age > STALE) {
                let _ = std::fs::remove_file(file.path());
            }
        }
    }
}
