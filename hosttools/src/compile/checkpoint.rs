//! Half-space solutions on disk while a table is being compiled, so that an interrupted run goes on where it was.
//!
//! ```text
//! 32 bytes  SHA-256 of what the table depends on
//! blocks    length of the payload (u32), CRC-32C of those 32 bytes and it (u32), payload
//! ```
//! The first block holds what ended the refinement of the axes and the axes themselves, each other one a side and the
//! nodes of some columns. A block that was cut off or does not match its checksum ends the file; what stands before it
//! is used. All numbers are little-endian.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use flangeway::{CHANNELS, SLOTS, Side};
use sha2::{Digest as _, Sha256};

use super::adaptive::Bound;
use super::axes::{Axes, Uniform};
use super::quantise;
use super::shard::Settled;
use super::{CRC, GENERATOR};
use crate::contact::{Normal, SlotState};
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::recipe::Recipe;

const KEY: usize = 32;
/// What may have ended the refinement of the axes, by its number in the file.
const BOUNDS: [Bound; 4] = [Bound::Counts, Bound::Bytes, Bound::Error, Bound::Resolved];
/// Bytes of a slot: its channels and two flags.
const SLOT_BYTES: usize = 8 * CHANNELS + 2;

/// Where a compilation stands, and the file that remembers it.
#[derive(Default)]
pub struct Checkpoint {
    path: Option<PathBuf>,
    key: [u8; KEY],
    blocks: Vec<Vec<u8>>,
    /// Bytes of the whole blocks in the file.
    length: usize,
    /// Open from the first block that is written.
    file: Option<File>,
}

impl Checkpoint {
    /// No file: nothing is kept.
    pub fn none() -> Self {
        Self::default()
    }

    /// That of a table: `T.fwt.partial` beside `T.fwt`, while the table is compiled. Only half-space tables have one,
    /// others are done in seconds. Two processes at the same table write the same blocks to the same places, so it needs
    /// no lock.
    ///
    /// # Errors
    /// When the file is there and cannot be read.
    pub fn of_table(
        output: &Path,
        recipe: &Recipe,
        pair: &Pair,
        uniform: Option<Uniform>,
        settled: Option<&Settled>,
    ) -> Result<Self> {
        if pair.body(Side::Right).settings().normal != Normal::HalfSpace {
            return Ok(Self::none());
        }
        let mut name = output.as_os_str().to_owned();
        name.push(".partial");
        Self::open(Path::new(&name), key(recipe, pair, uniform, settled)?)
    }

    /// What a file holds, if there is one. One of another recipe, profile or version of the program counts for nothing.
    fn open(path: &Path, key: [u8; KEY]) -> Result<Self> {
        let bytes = match std::fs::read(path) {
            Err(e) if e.kind() != ErrorKind::NotFound => return Err(Error::file(path, e.to_string())),
            read => read.unwrap_or_default(),
        };
        let (blocks, length) = bytes.strip_prefix(&key).map(|rest| read_blocks(rest, &key)).unwrap_or_default();
        Ok(Self { path: Some(path.into()), key, blocks, length, file: None })
    }

    /// The file, where one is kept.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Whether there is something to go on from.
    pub fn resumes(&self) -> bool {
        !self.blocks.is_empty()
    }

    /// Removes the file: the table stands. Another process at the same table may have done so.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn finish(self) -> Result<()> {
        let Some(path) = self.path else { return Ok(()) };
        drop(self.file);
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(Error::file(path, e.to_string())),
            _ => Ok(()),
        }
    }

    fn append(&mut self, payload: &[u8]) -> Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        let mut block = Vec::with_capacity(8 + payload.len());
        block.extend((payload.len() as u32).to_le_bytes());
        block.extend(checksum(&self.key, payload).to_le_bytes());
        block.extend(payload);
        let mut write = || {
            let file = match &mut self.file {
                Some(file) => file,
                none => none.insert(begun(path, &self.key, self.length)?),
            };
            file.write_all(&block).and_then(|()| file.sync_data())
        };
        write().map_err(|e| Error::file(path, e.to_string()))
    }

    /// The axes that an earlier run settled on, and what ended their refinement.
    pub(super) fn found(&self) -> Option<(Axes, Bound)> {
        let (&bound, mut rest) = self.blocks.first()?.split_first()?;
        let bound = *BOUNDS.get(usize::from(bound))?;
        let mut axis = || {
            let count = u32::from_le_bytes(*rest.split_off(..4)?.first_chunk()?) as usize;
            let bytes = rest.split_off(..8 * count)?;
            Some(bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect::<Vec<f64>>())
        };
        let (lateral, yaw, roll, vertical) = (axis()?, axis()?, axis()?, axis()?);
        Some((Axes::new(lateral, yaw, roll, vertical), bound))
    }

    /// Remembers the axes, unless they are from here.
    pub(super) fn begin(&mut self, axes: &Axes, bound: Bound) -> Result<()> {
        if self.resumes() {
            return Ok(());
        }
        let mut payload = vec![BOUNDS.iter().position(|b| *b == bound).unwrap_or_default() as u8];
        for axis in [&axes.lateral, &axes.yaw, &axes.roll, &axes.vertical] {
            payload.extend((axis.len() as u32).to_le_bytes());
            payload.extend(axis.iter().flat_map(|v| v.to_le_bytes()));
        }
        self.append(&payload)
    }

    /// The first nodes of a side, whole columns of `heights` nodes.
    pub(super) fn solved(&self, side: Side, heights: usize) -> Vec<[SlotState; SLOTS]> {
        let of_side = self.blocks.iter().skip(1).filter(|block| block.first() == Some(&(side as u8)));
        let slots = of_side.flat_map(|block| block[1..].as_chunks::<SLOT_BYTES>().0.iter().map(decode));
        let slots: Vec<SlotState> = slots.collect();
        let mut nodes: Vec<[SlotState; SLOTS]> = slots.as_chunks().0.to_vec();
        nodes.truncate(nodes.len() / heights * heights);
        nodes
    }

    /// Remembers the next nodes of a side.
    pub(super) fn add(&mut self, side: Side, nodes: &[[SlotState; SLOTS]]) -> Result<()> {
        let mut payload = vec![side as u8];
        payload.extend(nodes.iter().flatten().flat_map(encode));
        self.append(&payload)
    }
}

/// What a table depends on: recipe, profiles and program, what the command line puts in their place, and axes settled
/// before.
fn key(recipe: &Recipe, pair: &Pair, uniform: Option<Uniform>, settled: Option<&Settled>) -> Result<[u8; KEY]> {
    let mut hash = Sha256::new();
    hash.update(GENERATOR);
    hash.update(&recipe.text);
    hash.update(format!("{uniform:?} {}", recipe.grid.max_bytes));
    for side in Side::ALL.into_iter().take(pair.sides()) {
        hash.update(pair.source(side).wheel.source_hash);
        hash.update(pair.source(side).rail.source_hash);
    }
    if let Some(settled) = settled {
        hash.update(settled.digest()?);
    }
    Ok(hash.finalize().into())
}

/// The file, cut to its whole blocks, ready for the next one.
fn begun(path: &Path, key: &[u8; KEY], length: usize) -> std::io::Result<File> {
    let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
    file.set_len((KEY + length) as u64)?;
    file.write_all(key)?;
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}

fn checksum(key: &[u8; KEY], payload: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(key);
    digest.update(payload);
    digest.finalize()
}

/// Whole blocks from the start, and how many bytes they take.
fn read_blocks(bytes: &[u8], key: &[u8; KEY]) -> (Vec<Vec<u8>>, usize) {
    let (mut blocks, mut rest) = (Vec::new(), bytes);
    while let Some((head, tail)) = rest.split_first_chunk::<8>() {
        let number = |n: usize| u32::from_le_bytes([head[n], head[n + 1], head[n + 2], head[n + 3]]);
        let Some((payload, after)) = tail.split_at_checked(number(0) as usize) else { break };
        if checksum(key, payload) != number(4) {
            break;
        }
        blocks.push(payload.to_vec());
        rest = after;
    }
    (blocks, bytes.len() - rest.len())
}

fn encode(state: &SlotState) -> Vec<u8> {
    let mut bytes: Vec<u8> = quantise::values(state).iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([u8::from(state.conformal), u8::from(state.present)]);
    bytes
}

fn decode(bytes: &[u8; SLOT_BYTES]) -> SlotState {
    let (numbers, flags) = bytes.split_at(8 * CHANNELS);
    let mut values = [0.0; CHANNELS];
    for (value, bytes) in values.iter_mut().zip(numbers.as_chunks().0) {
        *value = f64::from_le_bytes(*bytes);
    }
    let mut state = SlotState { conformal: flags[0] != 0, present: flags[1] != 0, ..SlotState::ABSENT };
    quantise::set_values(&mut state, values);
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_before_damage_is_used() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.partial");
        let axes = Axes::new(vec![0.0, 1.0], vec![0.0, 0.5], vec![-1.0, 1.0], vec![0.0, 2.0]);
        let node =
            |n: f64| [SlotState { indentation: n, stiffness: 2.0 * n, present: true, ..SlotState::ABSENT }; SLOTS];
        let mut checkpoint = Checkpoint::open(&path, [7; KEY]).unwrap();
        checkpoint.begin(&axes, Bound::Bytes).unwrap();
        checkpoint.add(Side::Right, &[node(1.0), node(2.0)]).unwrap();
        checkpoint.add(Side::Left, &[node(3.0), node(4.0)]).unwrap();
        checkpoint.add(Side::Right, &[node(5.0), node(6.0)]).unwrap();
        drop(checkpoint);
        let whole = std::fs::read(&path).unwrap();
        let nodes_of = |bytes: &[u8], key: [u8; KEY]| {
            std::fs::write(&path, bytes).unwrap();
            let checkpoint = Checkpoint::open(&path, key).unwrap();
            let found = checkpoint.found().map(|(axes, bound)| (axes.lateral, axes.vertical, bound));
            let expected = checkpoint.resumes().then(|| (vec![0.0, 1.0], vec![0.0, 2.0], Bound::Bytes));
            assert_eq!(found, expected);
            checkpoint.solved(Side::Right, 2)
        };
        assert_eq!(nodes_of(&whole, [7; KEY]), [node(1.0), node(2.0), node(5.0), node(6.0)]);
        assert_eq!(nodes_of(&whole[..whole.len() - 1], [7; KEY]), [node(1.0), node(2.0)]);
        let mut damaged = whole.clone();
        damaged[whole.len() - 3] ^= 1;
        assert_eq!(nodes_of(&damaged, [7; KEY]), [node(1.0), node(2.0)]);
        assert!(nodes_of(&whole, [8; KEY]).is_empty());
        assert!(nodes_of(&whole[..20], [7; KEY]).is_empty());
    }
}
