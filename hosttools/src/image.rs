//! Writes table images: the counterpart of the kernel's reader, byte for byte as `tables/FORMAT.md` says.

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;

use flangeway::layout::{
    CHECKSUM_AT, HEADER_AT, HEADER_LENGTH_AT, LENGTH_AT, MAGIC, MAGIC_AT, RECORD, RIGID, Sections, SideSections,
    Strides, VERSION, VERSION_AT, checksum, refined, rigid_strides, stored,
};
use flangeway::{
    Axis, AxisCounts, AxisName, Bin, BinBytes, ContactTable, Header, LANES, MAX_BINS, NodeBytes, RigidMap, Scale,
    bin_start,
};

use crate::error::{Error, Result};

/// Everything a table image is made of.
#[derive(Debug, Clone, Copy)]
pub struct ImageParts<'a> {
    /// The header, with the rigid map's refinement; its axis counts are filled in by [`write_image`].
    pub header: Header<'a>,
    /// Nodes of the four axes in the order of [`AxisName::ALL`], m or rad; see [`OwnedAxis::new`].
    pub axes: [&'a [f64]; 4],
    /// Data of the right side.
    pub right: SideParts<'a>,
    /// Data of the left side, where the header has one.
    pub left: Option<SideParts<'a>>,
}

/// Data of one side.
#[derive(Debug, Clone, Copy)]
pub struct SideParts<'a> {
    /// Rigid contacts, `[lateral][yaw]` over the refined axes: roll, rad, and the coefficients h0, h1, h2 of the height, m,
    /// m/rad, m/rad².
    pub rigid: &'a [[f32; 4]],
    /// Records, `[lateral][yaw][roll offset][vertical]` over the axes, each in the channels' order ([`Channel::lane`]).
    ///
    /// [`Channel::lane`]: flangeway::Channel::lane
    pub records: &'a [[i16; LANES]],
}

/// An axis in the image's form, for whoever needs the kernel's interpolation before there is an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnedAxis {
    name: AxisName,
    nodes: Vec<NodeBytes>,
    /// Where cells begin and the last one ends, in bins.
    starts: Vec<usize>,
    bins: Vec<BinBytes>,
    strides: Strides,
}

impl OwnedAxis {
    /// An axis with these nodes (m or rad) and the fewest bins at whose beginnings they lie: every node a whole number of
    /// bins from the first. `f32` cannot say so exactly; the axis has the exact places, a few units in the last place away.
    /// It leads to no records, see [`OwnedAxis::leading`].
    ///
    /// # Errors
    /// Fewer than two nodes, nodes that do not increase strictly or are not plausible, or do not lie so with 4096 bins.
    pub fn new(name: AxisName, nodes: &[f64]) -> Result<Self> {
        let refused = |message: String| Error::field("", format!("{name} axis"), message);
        let starts = cell_starts(nodes).ok_or_else(|| {
            let what = "do not increase strictly or lie on no even lattice of";
            refused(format!("{} nodes {what} up to {MAX_BINS} intervals", nodes.len()))
        })?;
        let axis =
            Self { name, nodes: node_bytes(nodes, &starts), starts, bins: Vec::new(), strides: Strides::default() };
        let axis = axis.leading(Strides::default());
        axis.try_view().map_err(|e| refused(e.to_string()))?;
        Ok(axis)
    }

    /// The axis of a table with these strides.
    #[must_use]
    pub fn leading(mut self, strides: Strides) -> Self {
        let bins = Bin::of_cells(&self.starts, strides).map(|bin| bin.to_bytes()).collect();
        (self.bins, self.strides) = (bins, strides);
        self
    }

    fn try_view(&self) -> std::result::Result<Axis<'_>, flangeway::TableError> {
        Axis::new(self.name, &self.nodes, &self.bins, self.strides)
    }

    /// The kernel's view of this axis.
    ///
    /// # Panics
    /// Never: the constructor has made the same view.
    #[must_use]
    pub fn view(&self) -> Axis<'_> {
        self.try_view().expect("checked by the constructor")
    }

    /// Number of its bins.
    #[must_use]
    pub fn bins(&self) -> usize {
        self.bins.len() - 1
    }

    fn counts(&self) -> AxisCounts {
        let count = |n: usize| u16::try_from(n).unwrap_or(u16::MAX);
        AxisCounts { nodes: count(self.nodes.len()), bins: count(self.bins()) }
    }
}

/// Nodes as the image holds them: exactly where the cells' first bins begin, and the end.
fn node_bytes(nodes: &[f64], starts: &[usize]) -> Vec<NodeBytes> {
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let [starts @ .., bins] = starts else { return Vec::new() };
    let inner = starts.iter().map(|bin| bin_start(first, last, *bins, *bin));
    inner.chain([last]).map(f64::to_le_bytes).collect()
}

/// Rounding of nodes that were halved again and again, and of the ends, in units of the largest magnitude.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Where cells begin and the last one ends, in the fewest bins such that each inner node lies where one begins, but for
/// rounding; none if there are none.
fn cell_starts(nodes: &[f64]) -> Option<Vec<usize>> {
    let [first, inner @ .., last] = nodes else { return None };
    if nodes.len() > MAX_BINS + 1 || !nodes.is_sorted_by(|a, b| a < b) {
        return None;
    }
    let (first, last) = (*first, *last);
    let rounding = ROUNDING * first.abs().max(last.abs());
    let mut bins = (nodes.len() - 1..=MAX_BINS).take_while(|bins| (last - first) / *bins as f64 > 8.0 * rounding);
    bins.find_map(|bins| {
        let start = |x: &f64| {
            let bin = libm::rint((x - first) / (last - first) * bins as f64) as usize;
            ((bin_start(first, last, bins, bin) - *x).abs() <= rounding && bin < bins).then_some(bin)
        };
        let inner = inner.iter().map(start);
        let starts: Vec<usize> = [Some(0)].into_iter().chain(inner).chain([Some(bins)]).collect::<Option<_>>()?;
        starts.is_sorted_by(|a, b| a < b).then_some(starts)
    })
}

/// A rigid map in the image's form, for sampling with the kernel's own interpolation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnedRigidMap {
    axes: [OwnedAxis; 3],
    refinement: [u8; 2],
    nodes: Vec<[u8; RIGID]>,
}

impl OwnedRigidMap {
    /// A map over the records' axes (lateral, yaw, roll offset), the intervals of the first two divided into so many parts:
    /// nodes as in [`SideParts`].
    ///
    /// # Errors
    /// Bad axes, or nodes whose number does not fit them.
    pub fn new(axes: [&[f64]; 3], refinement: [u8; 2], nodes: &[[f32; 4]]) -> Result<Self> {
        let [lateral, yaw, roll_offset] = axes;
        let bytes = |node: &[f32; 4]| {
            let mut bytes = [0; RIGID];
            bytes.as_chunks_mut().0.copy_from_slice(&node.map(f32::to_le_bytes));
            bytes
        };
        let [l, y] = refinement;
        let [along, across] = rigid_strides(refinement, yaw.len())
            .ok_or_else(|| Error::field("", "rigid contacts", "the map would be larger than 4 GiB"))?;
        let axis = |name, nodes, rigid| Ok(OwnedAxis::new(name, nodes)?.leading(Strides { records: 0, rigid }));
        let map = Self {
            axes: [
                axis(AxisName::Lateral, lateral, along)?,
                axis(AxisName::Yaw, yaw, across)?,
                axis(AxisName::RollOffset, roll_offset, 0)?,
            ],
            refinement,
            nodes: nodes.iter().map(bytes).collect(),
        };
        match map.try_view() {
            Some(_) => Ok(map),
            None => Err(lengths("rigid contacts", nodes.len(), refined(lateral.len(), l) * refined(yaw.len(), y))),
        }
    }

    fn try_view(&self) -> Option<RigidMap<'_>> {
        RigidMap::new(self.axes.each_ref().map(OwnedAxis::view), self.refinement, &self.nodes)
    }

    /// The kernel's view of this map.
    ///
    /// # Panics
    /// Never: the constructor has made the same view.
    #[must_use]
    pub fn view(&self) -> RigidMap<'_> {
        self.try_view().expect("checked by the constructor")
    }
}

fn lengths(field: &str, found: usize, needed: usize) -> Error {
    Error::field("", field, format!("{found} values, the axes need {needed}"))
}

/// The table image of these parts: the same bytes for the same parts, always. What it returns the kernel accepts.
///
/// # Errors
/// Bad axes, lengths that do not fit them, a header too long, an image beyond 4 GiB, and whatever else the kernel
/// refuses.
pub fn write_image(parts: &ImageParts<'_>) -> Result<Vec<u8>> {
    let mut header = parts.header;
    let mut axes = Vec::with_capacity(AxisName::ALL.len());
    for ((name, nodes), counts) in AxisName::ALL.into_iter().zip(parts.axes).zip(&mut header.axes) {
        let axis = OwnedAxis::new(name, nodes)?;
        *counts = axis.counts();
        axes.push(axis);
    }
    if header.left.is_some() != parts.left.is_some() {
        return Err(Error::field("", "left", "header and data disagree whether there is a left side"));
    }
    let header_bytes =
        postcard::to_allocvec(&header).map_err(|e| Error::field("", "header", format!("cannot be encoded: {e}")))?;
    let sections = Sections::new(header_bytes.len(), &header.axes, header.refinement, header.sides())
        .ok_or_else(|| Error::field("", "axes", "the table would be larger than 4 GiB"))?;
    let mut image = vec![0; sections.total];
    let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes();
    image[MAGIC_AT].copy_from_slice(&MAGIC);
    image[VERSION_AT].copy_from_slice(&VERSION.to_le_bytes());
    image[LENGTH_AT].copy_from_slice(&number(sections.total));
    image[HEADER_LENGTH_AT].copy_from_slice(&number(header_bytes.len()));
    image[HEADER_AT..HEADER_AT + header_bytes.len()].copy_from_slice(&header_bytes);
    let places = sections.nodes.iter().zip(&sections.bins).zip(sections.strides);
    for (axis, ((nodes, bins), strides)) in axes.into_iter().zip(places) {
        let axis = axis.leading(strides);
        image[nodes.clone()].copy_from_slice(axis.nodes.as_flattened());
        image[bins.clone()].copy_from_slice(axis.bins.as_flattened());
    }
    let [right, left] = &sections.sides;
    write_side(&mut image, right, &parts.right)?;
    if let Some(data) = &parts.left {
        write_side(&mut image, left, data)?;
    }
    let crc = checksum(&image);
    image[CHECKSUM_AT].copy_from_slice(&crc.to_le_bytes());
    ContactTable::new(&image).map_err(|e| Error::field("", "table", e.to_string()))?;
    Ok(image)
}

fn write_side(image: &mut [u8], sections: &SideSections, data: &SideParts<'_>) -> Result<()> {
    fill(image, &sections.rigid, "rigid contacts", data.rigid.as_flattened().iter().map(|x| x.to_le_bytes()))?;
    fill(image, &sections.records, "records", data.records.iter().map(record_bytes))
}

/// A record as the image holds it.
fn record_bytes(lanes: &[i16; LANES]) -> [u8; RECORD] {
    let mut bytes = [0; RECORD];
    for (lane, value) in lanes.iter().enumerate() {
        bytes.as_chunks_mut().0[stored(lane)] = value.to_le_bytes();
    }
    bytes
}

/// Fills a section with values that must be exactly as many as fit.
fn fill<const N: usize>(
    image: &mut [u8],
    section: &Range<usize>,
    name: &str,
    values: impl ExactSizeIterator<Item = [u8; N]>,
) -> Result<()> {
    if values.len() * N != section.len() {
        return Err(lengths(name, values.len(), section.len() / N));
    }
    for (place, value) in image[section.clone()].chunks_exact_mut(N).zip(values) {
        place.copy_from_slice(&value);
    }
    Ok(())
}

/// The scale that spans `least` to `largest` with i16's steps; a constant channel gets steps far below its value.
#[must_use]
pub fn scale_over(least: f64, largest: f64) -> Scale {
    let offset = 0.5 * (least + largest);
    let half = (0.5 * (largest - least)).max(offset.abs() * 1e-6).max(1e-12);
    Scale { offset: offset as f32, step: (half / 32_766.0) as f32 }
}

/// The scale of values up to a magnitude that keeps zero exactly zero. The stiffness needs it, so that a slot without
/// contact carries no trace of force, and the longitudinal offset, so that it vanishes with the yaw.
#[must_use]
pub fn scale_through_zero(largest_magnitude: f64) -> Scale {
    Scale { offset: 0.0, step: (largest_magnitude.max(1e-12) / 32_766.0) as f32 }
}

/// The integer nearest to a value on a scale, saturated.
#[must_use]
pub fn quantise(scale: &Scale, value: f64) -> i16 {
    let q = libm::rint((value - f64::from(scale.offset)) / f64::from(scale.step));
    q.clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16
}

/// The folder that a file is to be written to.
///
/// # Errors
/// When it does not exist.
pub fn folder_of(path: &Path) -> Result<&Path> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if folder.is_dir() {
        Ok(folder)
    } else {
        Err(Error::file(path, format!("folder {} does not exist", folder.display())))
    }
}

/// Writes a file whole or not at all: to a temporary file in the same folder, then renamed.
///
/// # Errors
/// A missing folder, a full disk, no permission: the message says which file and why, and nothing is left behind.
pub fn write_atomically(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    let failed = |what: &str, e: &std::io::Error| Error::file(path, format!("{what}: {e}"));
    // A device or a pipe (/dev/stdout) is written to; a rename would replace it.
    if std::fs::metadata(path).is_ok_and(|existing| !existing.is_file() && !existing.is_dir()) {
        let mut device =
            std::fs::OpenOptions::new().write(true).open(path).map_err(|e| failed("cannot be opened", &e))?;
        return device.write_all(bytes).map_err(|e| failed("cannot be written", &e));
    }
    let folder = folder_of(path)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".flangeway-").suffix(".tmp");
    // Temporary files are private by default; this one becomes an ordinary file, subject to the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(|e| failed("cannot be created", &e))?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(|e| failed("cannot be written", &e))?;
    file.persist(path).map_err(|e| failed("cannot be put in place", &e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_whole_files_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.fwt");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
        let missing = folder.path().join("missing").join("t.fwt");
        let message = write_atomically(&missing, b"three").unwrap_err().to_string();
        assert!(message.ends_with("missing does not exist"), "{message}");
        // A folder in the file's place: nothing is replaced, nothing left behind.
        let taken = folder.path().join("taken");
        std::fs::create_dir_all(taken.join("inside")).unwrap();
        assert!(write_atomically(&taken, b"four").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_is_an_error() {
        // A folder that takes no files at all stands for the full disk.
        let message = write_atomically("/proc/t.fwt", b"x").unwrap_err().to_string();
        assert!(message.starts_with("/proc/t.fwt: cannot be created"), "{message}");
    }

    #[test]
    fn scales_and_integers() {
        let scale = scale_over(-2.0, 4.0);
        for value in [-2.0, 0.0, 1.0, 4.0] {
            let back = f64::from(scale.value(f32::from(quantise(&scale, value))));
            assert!((back - value).abs() < 0.51 * f64::from(scale.step));
        }
        assert_eq!((quantise(&scale, -100.0), quantise(&scale, 100.0)), (i16::MIN, i16::MAX));
        let constant = scale_over(0.46, 0.46);
        assert_eq!((constant.value(f32::from(quantise(&constant, 0.46))), constant.step > 0.0), (0.46, true));
        let stiffness = scale_through_zero(2e11);
        assert_eq!(stiffness.value(f32::from(quantise(&stiffness, 0.0))), 0.0);
    }
}
