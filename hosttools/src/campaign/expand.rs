//! From a campaign file to its tables: every combination of what is listed.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use toml::{Table, Value};

use super::manifest::{Entry, Manifest, Planned, hex, identifier, others};
use super::slurm::Settings;
use super::store::Folder;
use crate::error::{Error, Result};
use crate::profile::{ProfileKind, ReadOptions, is_built_in, read_file};
use crate::recipe::Recipe;

/// Keys whose value in a recipe is a list of two numbers: a list of such lists is a list of values.
const PAIRS: [&str; 3] = ["range", "origin_m", "boundaries_m"];
/// Tables beyond which a campaign is taken for a mistake.
const MOST: usize = 1_000_000;

/// One combination: the value itself, and which of the listed ones it has taken, by key.
type Variant = (Value, BTreeMap<String, String>);

/// The manifest of a campaign file, and the profile files it needs by their SHA-256.
///
/// # Errors
/// When the file cannot be read, is no TOML, or one of its combinations is no recipe. A profile that cannot be read is
/// no error here: its tables are planned as broken.
pub fn expand(path: &Path) -> Result<(Manifest, BTreeMap<String, Vec<u8>>)> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
    let mut table: Table = toml::from_str(&text).map_err(|e| {
        let line = e.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
        Error::line(path, line, e.message().replace('\n', " "))
    })?;
    let slurm: Settings = match table.remove("slurm") {
        Some(settings) => settings
            .try_into()
            .map_err(|e: toml::de::Error| Error::field(path, "slurm", e.message().replace('\n', " ")))?,
        None => Settings::default(),
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut shelf = Shelf { folder, read: HashMap::new(), checked: HashMap::new() };
    let (mut entries, mut seen) = (Vec::new(), HashSet::new());
    for (value, varies) in variants(path, folder, "", &Value::Table(table))? {
        let planned = shelf.entry(path, value, varies)?;
        let key = match &planned {
            Planned::Table(entry) => entry.id.clone(),
            Planned::Broken { label, reason } => format!("{label}: {reason}"),
        };
        // Two spellings of one table, or a profile that is listed and globbed.
        if seen.insert(key) {
            entries.push(planned);
        }
    }
    let profiles = shelf.read.into_values().flatten().map(|bytes| (hex(&Sha256::digest(&bytes)), bytes)).collect();
    Ok((Manifest { entries, slurm }, profiles))
}

/// Expands a campaign into a folder: its manifest and profiles.
///
/// # Errors
/// As [`expand`], and when the folder cannot be written.
pub fn plan(path: &Path, folder: &Folder) -> Result<Manifest> {
    let (manifest, profiles) = expand(path)?;
    folder.create()?;
    for (hash, bytes) in &profiles {
        folder.put_profile(hash, bytes)?;
    }
    manifest.write(&folder.manifest())?;
    Ok(manifest)
}

/// All values that a value of a campaign file stands for; `at` is its dotted name.
fn variants(path: &Path, folder: &Path, at: &str, value: &Value) -> Result<Vec<Variant>> {
    let key = at.rsplit('.').next().unwrap_or_default();
    match value {
        Value::Table(table) => {
            let mut all: Vec<(Table, BTreeMap<String, String>)> = vec![Default::default()];
            for (key, value) in table {
                let at = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                let values = variants(path, folder, &at, value)?;
                if all.len() * values.len() > MOST {
                    return Err(Error::field(path, at, format!("the lists make more than {MOST} tables")));
                }
                let with = |(table, varies): &(Table, BTreeMap<String, String>), (value, more): &Variant| {
                    let (mut table, mut varies) = (table.clone(), varies.clone());
                    table.insert(key.clone(), value.clone());
                    varies.extend(more.clone());
                    (table, varies)
                };
                all = all.iter().flat_map(|one| values.iter().map(move |value| with(one, value))).collect();
            }
            Ok(all.into_iter().map(|(table, varies)| (Value::Table(table), varies)).collect())
        }
        Value::Array(list) if !PAIRS.contains(&key) || list.first().is_some_and(Value::is_array) => {
            if list.is_empty() {
                return Err(Error::field(path, at, "an empty list"));
            }
            let mut all = Vec::new();
            for (number, item) in list.iter().enumerate() {
                let values = if PAIRS.contains(&key) {
                    vec![(item.clone(), BTreeMap::new())]
                } else {
                    variants(path, folder, at, item)?
                };
                for (value, mut varies) in values {
                    let name = if value.is_table() { (number + 1).to_string() } else { words(&value) };
                    varies.insert(at.to_owned(), name);
                    all.push((value, varies));
                }
            }
            if all.len() == 1 {
                all[0].1.remove(at);
            }
            Ok(all)
        }
        Value::String(pattern) if key == "profile" && pattern.contains(['*', '?', '[']) => {
            let files = matching(path, folder, at, pattern)?;
            let single = files.len() == 1;
            let varies = |file: &String| if single { BTreeMap::new() } else { [(at.to_owned(), file.clone())].into() };
            Ok(files.iter().map(|file| (Value::String(file.clone()), varies(file))).collect())
        }
        _ => Ok(vec![(value.clone(), BTreeMap::new())]),
    }
}

/// A value as it is shown.
fn words(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Files that match a pattern, as paths from the campaign's folder, sorted.
fn matching(path: &Path, folder: &Path, at: &str, pattern: &str) -> Result<Vec<String>> {
    let wrong = |e: String| Error::field(path, at, format!("\"{pattern}\": {e}"));
    let base = glob::Pattern::escape(&folder.to_string_lossy());
    let full = if base.is_empty() { PathBuf::from(pattern) } else { Path::new(&base).join(pattern) };
    let mut files = Vec::new();
    for found in glob::glob(&full.to_string_lossy()).map_err(|e| wrong(e.to_string()))? {
        let found = found.map_err(|e| wrong(e.to_string()))?;
        if found.is_file() {
            files.push(found.strip_prefix(folder).unwrap_or(&found).to_string_lossy().into_owned());
        }
    }
    files.sort();
    if files.is_empty() { Err(wrong("matches no file".into())) } else { Ok(files) }
}

/// Profile files, each read and checked once.
struct Shelf<'a> {
    folder: &'a Path,
    /// By path: the contents, where they can be read.
    read: HashMap<String, Option<Vec<u8>>>,
    /// By path, kind and options: what is wrong with the profile.
    checked: HashMap<(String, ProfileKind, String), Option<String>>,
}

impl Shelf<'_> {
    /// The plan of one combination. Its recipe names profile files without their folders, so the same files give the
    /// same table wherever they lie.
    fn entry(&mut self, path: &Path, mut value: Value, varies: BTreeMap<String, String>) -> Result<Planned> {
        let mut files: BTreeMap<String, String> = BTreeMap::new();
        let mut clash = None;
        for (section, side) in [("wheel", None), ("rail", None), ("wheel", Some("left")), ("rail", Some("left"))] {
            let section = value.get_mut(section);
            let section = match side {
                Some(side) => section.and_then(|section| section.get_mut(side)),
                None => section,
            };
            let Some(Value::String(profile)) = section.and_then(|section| section.get_mut("profile")) else { continue };
            if !is_built_in(profile) {
                let name = Path::new(&*profile).file_name().map(|name| name.to_string_lossy().into_owned());
                let name = name.unwrap_or_else(|| profile.clone());
                match files.insert(name.clone(), profile.clone()) {
                    Some(other) if other != *profile => clash = Some(format!("{other} and {profile} have one name")),
                    _ => {}
                }
                *profile = name;
            }
        }
        let text = toml::to_string(&value).map_err(|e| Error::file(path, e.to_string()))?;
        let mut recipe = Recipe::parse(&text, path).map_err(|e| in_campaign(path, &text, &varies, e))?;
        let label = label(&recipe, &varies);
        let broken = |reason: String| Ok(Planned::Broken { label: label.clone(), reason });
        if let Some(clash) = clash {
            return broken(clash);
        }
        for (name, file) in &files {
            match self.read(file) {
                Ok(bytes) => _ = recipe.profiles.insert(name.clone(), bytes),
                Err(e) => return broken(e.to_string()),
            }
        }
        for (kind, spec, options) in recipe.named_profiles() {
            let file = files.get(spec).map_or(spec, String::as_str);
            if let Some(reason) = self.wrong(&recipe, spec, file, kind, &options) {
                return broken(reason);
            }
        }
        let hash = |(name, bytes): (&String, &Vec<u8>)| (name.clone(), hex(&Sha256::digest(bytes)));
        let profiles: BTreeMap<String, String> = recipe.profiles.iter().map(hash).collect();
        let id = identifier(&text, &profiles);
        let cost = super::slurm::cost(&recipe);
        let Recipe { wheel, rail, .. } = recipe;
        let (wheel, rail) = (wheel.profile, rail.profile);
        Ok(Planned::Table(Box::new(Entry { id, label, wheel, rail, varies, cost, profiles, recipe: text })))
    }

    fn read(&mut self, file: &str) -> Result<Vec<u8>> {
        if let Some(Some(bytes)) = self.read.get(file) {
            return Ok(bytes.clone());
        }
        let found = read_file(&self.folder.join(file));
        self.read.insert(file.to_owned(), found.as_ref().ok().cloned());
        found
    }

    /// What is wrong with a profile, if anything.
    fn wrong(
        &mut self,
        recipe: &Recipe,
        spec: &str,
        file: &str,
        kind: ProfileKind,
        options: &ReadOptions,
    ) -> Option<String> {
        let load = || {
            let found = recipe.load_profile(spec, kind, options);
            // Where the user has the file, whatever the recipe calls it.
            found.err().map(|mut e| {
                if e.path == Path::new(spec) {
                    e.path = self.folder.join(file);
                }
                e.to_string()
            })
        };
        self.checked.entry((file.to_owned(), kind, format!("{options:?}"))).or_insert_with(load).clone()
    }
}

/// A table's name for people.
fn label(recipe: &Recipe, varies: &BTreeMap<String, String>) -> String {
    let pair = format!("{} on {}", recipe.wheel.profile, recipe.rail.profile);
    match others(varies) {
        none if none.is_empty() => pair,
        others => format!("{pair}, {others}"),
    }
}

/// An error in one combination as an error in the campaign: its lines are not those of the campaign's file.
fn in_campaign(path: &Path, text: &str, varies: &BTreeMap<String, String>, error: Error) -> Error {
    use crate::error::Place;
    let which: Vec<String> = varies.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    let which = if which.is_empty() { String::new() } else { format!(" (with {})", which.join(", ")) };
    match error.place {
        Place::Line(number) => {
            let line = text.lines().nth(number - 1).unwrap_or_default();
            Error::field(path, format!("\"{line}\""), format!("{}{which}", error.message))
        }
        place => Error { path: path.into(), place, message: format!("{}{which}", error.message) },
    }
}
