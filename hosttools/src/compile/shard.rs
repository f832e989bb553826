//! One table compiled in parts, on as many machines as there are: the axes are settled first and shared, every shard
//! solves its share of the lateral intervals, and the merge fits and quantises what they found.
//!
//! A single compilation goes through the same steps with one shard, so the bytes are the same by construction. Intervals
//! are dealt out by turns: the costly ones, where contacts change, lie side by side. What that doubles are the nodes
//! between two intervals of different shards, about a tenth of the work.
//!
//! Files hold all that the merge needs, the profiles too: `magic, CRC-32C of the rest, rest` with the rest as postcard.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use flangeway::Side;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::axes::{Axes, Uniform};
use super::checkpoint::Checkpoint;
use super::half_space;
use super::solved::Solved;
use super::{Assembled, Bound, CRC, Compiled, CompiledSide, Compiler, GENERATOR};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::pair::Pair;
use crate::recipe::Recipe;

const AXES_MAGIC: &[u8; 8] = b"FWAXES02";
const SHARD_MAGIC: &[u8; 8] = b"FWPART02";

/// Which shard of how many, as `i/n` from `1/n` to `n/n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// From 1.
    pub index: u32,
    /// Shards in all.
    pub count: u32,
}

impl std::str::FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if (1..=count).contains(&index) && count <= 65_536 => Ok(Self { index, count }),
            _ => Err(format!("\"{text}\" is not a shard i/n such as 1/3, from 1/n to n/n, n at most 65536")),
        }
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// A recipe with its profiles, and the axes of its table: what all shards of a table agree on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settled {
    /// Program and version; others may give other bytes.
    generator: String,
    recipe_path: PathBuf,
    recipe_text: String,
    /// Contents of the profile files by the names that the recipe gives them.
    profiles: BTreeMap<String, Vec<u8>>,
    /// Lateral, yaw, roll, vertical.
    axes: [Vec<f64>; 4],
    /// What ended their refinement.
    pub bound: Bound,
}

impl Settled {
    /// Settles the axes of a recipe's table; `uniform` overrides its node counts.
    ///
    /// # Errors
    /// As [`super::compile`].
    pub fn new(recipe: &Recipe, pair: &Pair, uniform: Option<Uniform>) -> Result<Self> {
        let preparing = half_space::preparing(pair);
        let (axes, bound) = Compiler::new(recipe, &preparing).settle(uniform)?;
        Ok(Self {
            generator: GENERATOR.into(),
            recipe_path: recipe.path.clone(),
            recipe_text: recipe.text.clone(),
            profiles: recipe.read_profiles()?,
            axes: [axes.lateral, axes.yaw, axes.roll, axes.vertical],
            bound,
        })
    }

    /// Reads settled axes.
    ///
    /// # Errors
    /// When the file is not whole, no such file, or of another version of the program.
    pub fn read(path: &Path) -> Result<Self> {
        let settled: Self = read(path, AXES_MAGIC, "a file of settled axes")?;
        settled.check(path)?;
        Ok(settled)
    }

    /// Writes settled axes.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write(path, AXES_MAGIC, self)
    }

    /// Refuses axes of another recipe or other profiles than this one.
    ///
    /// # Errors
    /// When they differ, with what differs.
    pub fn check_recipe(&self, path: &Path, recipe: &Recipe) -> Result<()> {
        let refuse = |what: &str| Err(Error::file(path, format!("the axes are of another {what}; settle them again")));
        if self.recipe_text != recipe.text {
            return refuse(&format!("recipe than {}", recipe.path.display()));
        }
        match recipe.read_profiles()?.iter().find(|(name, content)| self.profiles.get(*name) != Some(content)) {
            Some((name, _)) => refuse(&format!("version of the profile {name}")),
            None => Ok(()),
        }
    }

    /// Node counts: lateral, yaw, roll, vertical.
    pub fn counts(&self) -> [usize; 4] {
        self.axes.each_ref().map(Vec::len)
    }

    /// Compiles a table of these axes in one go.
    ///
    /// # Errors
    /// As [`super::compile`].
    pub fn compile(&self, recipe: &Recipe, pair: &Pair, checkpoint: &mut Checkpoint) -> Result<Compiled> {
        let (axes, preparing) = (self.axes(), half_space::preparing(pair));
        checkpoint.begin(&axes, self.bound)?;
        let table = Compiler::new(recipe, &preparing).table(pair, axes, checkpoint)?;
        super::finish(recipe, pair, table, self.bound)
    }

    fn axes(&self) -> Axes {
        let [lateral, yaw, roll, vertical] = self.axes.clone();
        Axes::new(lateral, yaw, roll, vertical)
    }

    fn check(&self, path: &Path) -> Result<()> {
        if self.generator != GENERATOR {
            return Err(Error::file(path, format!("written by {}, this is {GENERATOR}", self.generator)));
        }
        if self.axes.iter().any(|nodes| nodes.len() < 2) || !self.axes().searchable() {
            return Err(Error::file(path, "holds axes that no table can have"));
        }
        Ok(())
    }

    /// What must be the same in all shards of a table.
    pub(super) fn digest(&self) -> Result<[u8; 32]> {
        let bytes = postcard::to_allocvec(self).map_err(|e| Error::field("", "shard", e.to_string()))?;
        Ok(Sha256::digest(bytes).into())
    }
}

/// A part of a table: what the direct solver says of its share of the lateral intervals.
#[derive(Debug, Serialize, Deserialize)]
pub struct Shard {
    settled: Settled,
    /// Which part.
    pub part: Part,
    /// By side: intervals in rising order, each with its number.
    sides: Vec<Vec<(usize, Solved)>>,
}

impl Shard {
    /// Solves a part of the table.
    ///
    /// # Errors
    /// As [`super::compile`].
    pub fn new(recipe: &Recipe, pair: &Pair, settled: Settled, part: Part) -> Result<Self> {
        let axes = settled.axes();
        let own: Vec<usize> = part.intervals(&axes).collect();
        let preparing = half_space::preparing(pair);
        let mut sides = Vec::new();
        for sampler in &mut Compiler::new(recipe, &preparing).samplers {
            let solved = Solved::intervals(sampler, [&preparing, pair], &axes, recipe.grid.node_values, &own)?;
            sides.push(own.iter().copied().zip(solved).collect());
        }
        Ok(Self { settled, part, sides })
    }

    /// Writes the shard.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write(path, SHARD_MAGIC, self)
    }

    /// Reads a shard.
    ///
    /// # Errors
    /// When the file is not whole, no shard, or of another version of the program.
    pub fn read(path: &Path) -> Result<Self> {
        let shard: Self = read(path, SHARD_MAGIC, "a shard")?;
        shard.settled.check(path)?;
        let axes = shard.settled.axes();
        let whole = |side: &Vec<(usize, Solved)>| side.iter().map(|(i, _)| *i).eq(shard.part.intervals(&axes));
        if shard.part.index == 0 || shard.part.count == 0 || !shard.sides.iter().all(whole) {
            return Err(Error::file(path, format!("does not hold the intervals of shard {}", shard.part)));
        }
        Ok(shard)
    }
}

impl Part {
    /// The lateral intervals of this part.
    fn intervals(self, axes: &Axes) -> impl Iterator<Item = usize> {
        ((self.index as usize).saturating_sub(1)..axes.lateral.len() - 1).step_by((self.count as usize).max(1))
    }
}

/// Merges the shards of a table: the bytes are those of a compilation in one go. Gives the pair, too.
///
/// # Errors
/// A shard that is damaged, of another table, there twice or missing.
pub fn merge(paths: &[PathBuf]) -> Result<(Pair, Compiled)> {
    let mut found: BTreeMap<u32, &Path> = BTreeMap::new();
    let mut first: Option<(Settled, [u8; 32], u32)> = None;
    let mut sides: Vec<BTreeMap<usize, Solved>> = Vec::new();
    for path in paths {
        let Shard { settled, part, sides: solved } = Shard::read(path)?;
        let (_, digest, count) = match &first {
            Some(first) => first,
            None => {
                sides.resize_with(solved.len(), BTreeMap::new);
                let digest = settled.digest()?;
                first.insert((settled.clone(), digest, part.count))
            }
        };
        if settled.digest()? != *digest || solved.len() != sides.len() {
            let of = format!("a shard of another table than {}", paths[0].display());
            return Err(Error::file(path, format!("{of}: recipe, profiles or axes differ")));
        }
        if part.count != *count {
            return Err(Error::file(path, format!("is shard {part}, but {} is one of {count}", paths[0].display())));
        }
        if let Some(before) = found.insert(part.index, path) {
            return Err(Error::file(path, format!("is shard {part}, and so is {}", before.display())));
        }
        sides.iter_mut().zip(solved).for_each(|(side, solved)| side.extend(solved));
    }
    let Some((settled, _, count)) = first else { return Err(Error::field("", "SHARD", "no shards to merge")) };
    if let Some(missing) = (1..=count).find(|index| !found.contains_key(index)) {
        let there = format!("{} of {count} shards are there", found.len());
        return Err(Error::file(&paths[0], format!("shard {missing}/{count} is missing: {there}")));
    }
    let mut recipe = Recipe::parse(&settled.recipe_text, &settled.recipe_path)?;
    let axes = settled.axes();
    recipe.profiles = settled.profiles;
    let pair = Pair::build(&recipe)?;
    let mut compiled = Vec::new();
    for (side, parts) in Side::ALL.into_iter().zip(sides) {
        let mut whole = Solved::default();
        parts.into_values().for_each(|next| whole.append(next));
        if !whole.fits(&axes) {
            return Err(Error::file(&paths[0], "the shards do not make up a table of their axes"));
        }
        compiled.push(CompiledSide::new(&pair, side, &axes, recipe.grid.node_values, whole));
    }
    if compiled.len() != pair.sides() {
        return Err(Error::file(&paths[0], "the shards have another number of sides than their recipe"));
    }
    let table = Assembled::new(&recipe, &pair, axes, compiled)?;
    let compiled = super::finish(&recipe, &pair, table, settled.bound)?;
    Ok((pair, compiled))
}

fn write<T: Serialize>(path: &Path, magic: &[u8; 8], value: &T) -> Result<()> {
    let mut bytes = magic.to_vec();
    bytes.extend([0; 4]);
    let mut bytes = postcard::to_extend(value, bytes).map_err(|e| Error::file(path, e.to_string()))?;
    let crc = CRC.checksum(&bytes[12..]);
    bytes[8..12].copy_from_slice(&crc.to_le_bytes());
    write_atomically(path, &bytes)
}

fn read<T: DeserializeOwned>(path: &Path, magic: &[u8; 8], what: &str) -> Result<T> {
    let bytes = std::fs::read(path).map_err(|e| Error::file(path, e.to_string()))?;
    let Some((head, rest)) = bytes.split_first_chunk::<12>().filter(|(head, _)| head.starts_with(magic)) else {
        return Err(Error::file(path, format!("is not {what}")));
    };
    if head[8..] != CRC.checksum(rest).to_le_bytes() {
        return Err(Error::file(path, "is damaged: its CRC does not fit"));
    }
    postcard::from_bytes(rest).map_err(|e| Error::file(path, format!("cannot be read: {e}")))
}
