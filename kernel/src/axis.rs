//! Axes with nodes at any spacing, searched in constant time.

use core::fmt;

use crate::error::TableError;
use crate::instructions::{Baseline, Instructions};
use crate::layout::{BIN, Strides};
use crate::math::{Mask, Two, at_least, at_most, single};

/// Most bins an axis can have.
pub const MAX_BINS: usize = 4096;

/// Largest distance outside its cell, in cell widths, that a coordinate is extrapolated over.
const EXTRAPOLATION_LIMIT: f64 = 1024.0;

/// The four axes of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AxisName {
    /// Lateral displacement u, m.
    Lateral,
    /// Magnitude of yaw, rad.
    Yaw,
    /// Roll less the rigid roll, rad.
    RollOffset,
    /// Vertical displacement less the rigid one, zeta, m.
    Vertical,
}

impl AxisName {
    /// All axes in the order of the image.
    pub const ALL: [Self; 4] = [Self::Lateral, Self::Yaw, Self::RollOffset, Self::Vertical];

    /// Position in [`AxisName::ALL`].
    #[inline]
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Least and largest plausible node, m or rad.
    #[must_use]
    pub const fn bounds(self) -> (f32, f32) {
        match self {
            Self::Lateral => (-1.0, 1.0),
            Self::Yaw => (0.0, 0.125),
            Self::RollOffset => (-0.125, 0.125),
            Self::Vertical => (-0.1, 0.1),
        }
    }
}

impl fmt::Display for AxisName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Lateral => "lateral",
            Self::Yaw => "yaw",
            Self::RollOffset => "roll offset",
            Self::Vertical => "vertical",
        })
    }
}

/// Where a coordinate lies on an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Cell: between node `cell` and node `cell + 1`.
    pub cell: usize,
    /// Position in the cell, 0 at its lower node, 1 at its upper; clamped to 0..=1.
    pub fraction: f64,
    /// The same for a coordinate outside the axis, not clamped (but to +-1024 cell widths).
    pub unclamped: f64,
    /// Whether the coordinate lies outside the axis.
    pub clamped: bool,
}

/// A node's coordinate in the image, `f64`.
pub type NodeBytes = [u8; 8];

/// A bin in the image, see [`Bin::to_bytes`].
pub type BinBytes = [u8; BIN];

/// What a bin says of the cell that it lies in: all that a lookup asks an axis for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// The cell's first bin.
    pub start: f32,
    /// The greatest number whose product with the cell's bins is not above one: no fraction is above one for it.
    pub reciprocal: f32,
    /// Bytes from the first record to that of the cell's lower node.
    pub records: u32,
    /// The same in the rigid map; 0 on the axes that it does not have.
    pub rigid: u32,
}

impl Bin {
    /// The bins of a cell that takes so many from `start` on.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "at most 4096 cells; a table's offsets are below 4 GiB")]
    pub fn new(cell: usize, start: usize, bins: usize, strides: Strides) -> Self {
        let bins = f32::from(count(bins));
        let nearest = 1.0 / bins;
        let above = f64::from(nearest) * f64::from(bins) > 1.0;
        Self {
            start: f32::from(count(start)),
            reciprocal: if above { nearest.next_down() } else { nearest },
            records: strides.records.wrapping_mul(cell as u32),
            rigid: strides.rigid.wrapping_mul(cell as u32),
        }
    }

    /// The bins of cells that begin at these bins and of which the last ends at the last of them, as an axis holds them: the
    /// very last one twice.
    pub fn of_cells(starts: &[usize], strides: Strides) -> impl Iterator<Item = Self> {
        starts.windows(2).enumerate().flat_map(move |(cell, ends)| {
            let (start, end) = (ends.first().copied().unwrap_or_default(), ends.last().copied().unwrap_or_default());
            let length = end.saturating_sub(start);
            let twice = usize::from(cell + 2 == starts.len());
            core::iter::repeat_n(Self::new(cell, start, length, strides), length + twice)
        })
    }

    /// The four numbers in their order, little-endian.
    #[must_use]
    pub fn to_bytes(&self) -> BinBytes {
        let mut bytes = [0; BIN];
        let words = [self.start.to_bits(), self.reciprocal.to_bits(), self.records, self.rigid];
        for (place, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
            *place = word.to_le_bytes();
        }
        bytes
    }

    fn from_bytes(bytes: &BinBytes) -> Self {
        let word = |i: usize| u32::from_le_bytes(bytes.as_chunks().0.get(i).copied().unwrap_or_default());
        let number = |i: usize| f32::from_bits(word(i));
        Self { start: number(0), reciprocal: number(1), records: word(2), rigid: word(3) }
    }
}

impl fmt::Display for Bin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { start, reciprocal, records, rigid } = self;
        write!(f, "(start {start}, reciprocal {reciprocal}, records {records}, rigid map {rigid})")
    }
}

/// Least width of a bin in units of the axis' largest magnitude, 2⁻²²: a node's coordinate, rounded to `f64`, is then
/// within 2⁻³¹ bins of where its bin begins, which is less than the weights can tell.
const LEAST_BIN: f64 = 1.0 / 4_194_304.0;

/// An axis, read in place: its nodes, and uniform bins by which a cell is found in constant time.
///
/// Bins divide first node to last node evenly, and every node lies where a bin begins, so a bin lies in one cell and says
/// all of it that a lookup needs. The cost is the same for every coordinate and spacing.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    nodes: &'a [NodeBytes],
    /// The last one twice.
    bins: &'a [BinBytes],
    strides: Strides,
    first: f64,
    last: f64,
    bins_per_unit: f64,
}

/// Where a bin begins on an axis from `first` to `last`: first + bin ((last - first) / bins). Inner nodes are such numbers.
#[inline]
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "at most 4096 bins")]
pub fn bin_start(first: f64, last: f64, bins: usize, bin: usize) -> f64 {
    first + bin as f64 * ((last - first) / bins as f64)
}

impl<'a> Axis<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self = Self {
        nodes: &[],
        bins: &[],
        strides: Strides { records: 0, rigid: 0 },
        first: 0.0,
        last: 0.0,
        bins_per_unit: 0.0,
    };

    /// An axis over little-endian nodes and bins, the last bin twice, in a table with these strides from node to node.
    ///
    /// # Errors
    /// Fewer than two nodes, no bins, too many or too narrow ones, nodes that do not increase strictly within
    /// [`AxisName::bounds`], bins that do not fit nodes and strides.
    pub fn new(
        name: AxisName,
        nodes: &'a [NodeBytes],
        bins: &'a [BinBytes],
        strides: Strides,
    ) -> Result<Self, TableError> {
        let mut axis = Self { nodes, bins, strides, ..Self::EMPTY };
        let bins = axis.bins();
        let counts = TableError::AxisCount { axis: name, nodes: count(nodes.len()), bins: count(bins) };
        if nodes.len() < 2 || nodes.len() > MAX_BINS + 1 || bins == 0 || bins > MAX_BINS {
            return Err(counts);
        }
        let (least, largest) = name.bounds();
        let mut before = f64::NEG_INFINITY;
        for (index, bytes) in nodes.iter().enumerate() {
            let value = f64::from_le_bytes(*bytes);
            // A comparison with NaN is false. The ends are what an `f32` can hold, so the axis has a length.
            let inner = index > 0 && index + 1 < nodes.len();
            let good = value > before
                && value >= f64::from(least)
                && value <= f64::from(largest)
                && (inner || f64::from(single(value)) == value);
            if !good {
                return Err(TableError::AxisNode { axis: name, index, value: single(value) });
            }
            before = value;
        }
        axis.first = axis.node(0);
        axis.last = axis.node(nodes.len() - 1);
        let bins = f64::from(count(bins));
        let length = axis.last - axis.first;
        if length < bins * LEAST_BIN * axis.first.abs().max(axis.last.abs()) {
            return Err(counts);
        }
        axis.bins_per_unit = bins / length;
        axis.check_bins(name)?;
        Ok(axis)
    }

    /// Every inner node lies where a bin begins, and every bin says what its cell is.
    fn check_bins(&self, name: AxisName) -> Result<(), TableError> {
        let begins = |bin: usize, node: usize| {
            self.node(node).to_bits() == bin_start(self.first, self.last, self.bins(), bin).to_bits()
        };
        let (mut start, last_cell) = (0, self.nodes.len() - 2);
        for cell in 0..=last_cell {
            let ends = |bin: &usize| cell < last_cell && begins(*bin, cell + 1);
            let end = (start + 1..self.bins()).find(ends).unwrap_or(self.bins());
            // A cell without bins: the node before lies where none begins.
            if start >= end {
                return Err(TableError::AxisNode { axis: name, index: cell, value: single(self.node(cell)) });
            }
            let needed = Bin::new(cell, start, end - start, self.strides);
            let all = start..if cell < last_cell { end } else { self.bins.len() };
            for (index, bytes) in all.clone().zip(self.bins.get(all).unwrap_or_default()) {
                if *bytes != needed.to_bytes() {
                    return Err(TableError::AxisBin { axis: name, index, found: Bin::from_bytes(bytes), needed });
                }
            }
            start = end;
        }
        Ok(())
    }

    /// Number of bins.
    fn bins(&self) -> usize {
        self.bins.len().saturating_sub(1)
    }

    /// Bytes from one node to the next that its bins lead by.
    #[must_use]
    pub const fn strides(&self) -> Strides {
        self.strides
    }

    /// Number of nodes.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Always false: an axis has at least two nodes.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A node's coordinate, m or rad; 0 beyond the last.
    #[inline]
    #[must_use]
    pub fn node(&self, index: usize) -> f64 {
        self.nodes.get(index).copied().map_or(0.0, f64::from_le_bytes)
    }

    /// All nodes' coordinates, m or rad.
    pub fn nodes(&self) -> impl Iterator<Item = f64> + 'a {
        self.nodes.iter().copied().map(f64::from_le_bytes)
    }

    /// First and last node, m or rad.
    #[inline]
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.first, self.last)
    }

    /// Finds the cell of a coordinate and its place in it, as a lookup does, which has no need of the cell's number. `x`
    /// must be a number.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin's number")]
    pub fn locate(&self, x: f64) -> Place {
        let pair = AxisPair::new([*self; 2]);
        let places = pair.locate(Baseline, Two::all(x)).unwrap_or_else(|| Places::first([0.0; 2]));
        let start = pair.bins_of(Two::all(x)).map_or(0.0, |[bin, _]| Bin::from_bytes(bin).start);
        let [fraction, _] = places.fraction.numbers();
        let [unclamped, _] = places.unclamped().numbers();
        // Nodes lie where bins begin.
        let begin = bin_start(self.first, self.last, self.bins(), start as usize);
        Place {
            cell: self.nodes().skip(1).take_while(|node| *node <= begin).count(),
            fraction: at_most(at_least(fraction, 0.0), 1.0),
            unclamped,
            clamped: places.clamped.bits() != 0,
        }
    }
}

/// Where two coordinates lie on their axes, see [`Place`].
#[derive(Clone, Copy)]
pub(crate) struct Places {
    /// Bytes to the first record of their cells, the two axes together.
    pub(crate) records: u32,
    /// The same in the rigid map.
    pub(crate) rigid: u32,
    /// Clamped to 0..=1, but for rounding: within 2⁻²⁸ of it.
    pub(crate) fraction: Two,
    /// How far the coordinates lie outside their axes, in widths of the first or last cell.
    outside: Two,
    /// Which coordinates lie outside their axes.
    pub(crate) clamped: Mask,
}

impl Places {
    /// The first cells, on no axis in particular.
    pub(crate) fn first(fraction: [f64; 2]) -> Self {
        Self {
            records: 0,
            rigid: 0,
            fraction: Two::new(fraction),
            outside: Two::all(0.0),
            clamped: Two::all(0.0).differs(Two::all(0.0)),
        }
    }

    /// The fractions not clamped, but to +-[`EXTRAPOLATION_LIMIT`].
    #[inline(always)]
    pub(crate) fn unclamped(&self) -> Two {
        let limit = Two::all(EXTRAPOLATION_LIMIT);
        (self.fraction + self.outside).at_least(Two::all(-EXTRAPOLATION_LIMIT)).at_most(limit)
    }
}

/// What the bins of two axes say of their cells.
pub(crate) struct Cells {
    pub(crate) start: Two,
    pub(crate) reciprocal: Two,
    /// Bytes to their first record, the two axes together.
    pub(crate) records: u32,
    /// The same in the rigid map.
    pub(crate) rigid: u32,
}

impl Cells {
    #[inline(always)]
    pub(crate) fn new(a: &BinBytes, b: &BinBytes) -> Self {
        let numbers = |bin: &BinBytes| Two::of_singles(bin.first_chunk().unwrap_or(&[0; 8]));
        let offset =
            |bin: &BinBytes, word: usize| u32::from_le_bytes(bin.as_chunks().0.get(word).copied().unwrap_or_default());
        let [start, reciprocal] = Two::transpose([numbers(a), numbers(b)]);
        Self {
            start,
            reciprocal,
            records: offset(a, 2).wrapping_add(offset(b, 2)),
            rigid: offset(a, 3).wrapping_add(offset(b, 3)),
        }
    }
}

/// Two axes that are searched together. Aligned, so that an operation may take its operand from memory.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct AxisPair<'a> {
    first: [f64; 2],
    last: [f64; 2],
    bins_per_unit: [f64; 2],
    bins: [&'a [BinBytes]; 2],
}

impl<'a> AxisPair<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self = Self { first: [0.0; 2], last: [0.0; 2], bins_per_unit: [0.0; 2], bins: [&[]; 2] };

    pub(crate) fn new(axes: [Axis<'a>; 2]) -> Self {
        Self {
            bins: axes.map(|axis| axis.bins),
            first: axes.map(|axis| axis.first),
            last: axes.map(|axis| axis.last),
            bins_per_unit: axes.map(|axis| axis.bins_per_unit),
        }
    }

    /// Coordinates that lie on the axes, by their distance from the first nodes in bins.
    #[inline(always)]
    fn position(&self, inside: Two) -> Two {
        (inside - Two::new(self.first)) * Two::new(self.bins_per_unit)
    }

    #[inline(always)]
    fn clamp(&self, x: Two) -> Two {
        x.at_least(Two::new(self.first)).at_most(Two::new(self.last))
    }

    /// Bins of a position, that after the last one at the axis' end. Every position on a checked axis has one.
    #[inline(always)]
    fn bins_at(&self, position: Two) -> Option<[&'a BinBytes; 2]> {
        let ([a, b], [bins_a, bins_b]) = (position.truncate(), self.bins);
        Some([bin_at(bins_a, a)?, bin_at(bins_b, b)?])
    }

    /// Bins that coordinates lie in.
    fn bins_of(&self, x: Two) -> Option<[&'a BinBytes; 2]> {
        self.bins_at(self.position(self.clamp(x)))
    }

    /// ```text
    /// x'       = x, first at least, last at most
    /// position = (x' - first) bins_per_unit
    /// bin      = floor(position)
    /// fraction = (position - start[bin]) reciprocal[bin]
    /// ```
    #[inline(always)]
    pub(crate) fn locate<I: Instructions>(&self, with: I, x: Two) -> Option<Places> {
        let inside = self.clamp(x);
        let position = self.position(inside);
        let [a, b] = self.bins_at(position)?;
        let Cells { start, reciprocal, records, rigid } = with.cells(a, b);
        Some(Places {
            records,
            rigid,
            fraction: (position - start) * reciprocal,
            outside: (x - inside) * Two::new(self.bins_per_unit) * reciprocal,
            clamped: inside.differs(x),
        })
    }
}

/// A bin; none that is not there. On ARM a selection of one of zeros, since what a branch keeps in registers costs 137
/// instructions a lookup there. On x86-64 the selection costs five.
#[inline(always)]
fn bin_at(bins: &[BinBytes], index: usize) -> Option<&BinBytes> {
    const NOTHING: &BinBytes = &[0; BIN];
    let bin = bins.get(index);
    if cfg!(target_arch = "arm") { bin.or(Some(NOTHING)) } else { bin }
}

impl fmt::Debug for Axis<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Axis({} nodes in {} bins from {} to {})", self.nodes.len(), self.bins(), self.first, self.last)
    }
}

/// A count for an error message, saturated.
fn count(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const STRIDES: Strides = Strides { records: 128, rigid: 32 };

    /// Nodes, and bins of cells of these lengths.
    fn bytes(nodes: &[f64], lengths: &[usize]) -> (Vec<NodeBytes>, Vec<BinBytes>) {
        let starts: Vec<usize> = (0..=lengths.len()).map(|cells| lengths[..cells].iter().sum()).collect();
        let bins = Bin::of_cells(&starts, STRIDES).map(|bin| bin.to_bytes()).collect();
        (nodes.iter().map(|x| x.to_le_bytes()).collect(), bins)
    }

    #[test]
    fn finds_cells_between_uneven_nodes() {
        // Range 1/16 in 8 bins.
        let (nodes, bins) = bytes(&[0.0, 1.0, 3.0, 8.0].map(|k| k / 128.0), &[1, 2, 5]);
        let axis = Axis::new(AxisName::Yaw, &nodes, &bins, STRIDES).unwrap();
        for (x, cell) in [(0.0, 0), (0.99, 0), (1.01, 1), (2.99, 1), (3.01, 2), (8.0, 2), (99.0, 2), (-1.0, 0)] {
            let x = x / 128.0;
            assert_eq!(axis.locate(x).cell, cell, "{x}");
            let places = AxisPair::new([axis; 2]).locate(Baseline, Two::all(x)).unwrap();
            let offsets = [places.records / 256, places.rigid / 64].map(|cell| usize::try_from(cell).unwrap());
            assert_eq!(offsets, [cell; 2]);
        }
        // The greatest number by which five bins are at most one.
        let end = axis.locate(axis.node(3));
        assert!(end.fraction <= 1.0 && end.fraction > 1.0 - 1.2e-7 && !end.clamped);
        let below = axis.locate(axis.node(2).next_down());
        assert!(below.fraction <= 1.0 && below.fraction > 1.0 - 1e-15);
        let node = axis.locate(axis.node(2));
        assert_eq!((node.cell, node.fraction), (2, 0.0));
        let outside = axis.locate(13.0 / 128.0);
        assert!(outside.clamped && outside.fraction > 1.0 - 1.2e-7 && (outside.unclamped - 2.0).abs() < 1e-6);
    }

    #[test]
    fn reciprocals_are_the_greatest_whose_product_is_at_most_one() {
        for length in 1..=MAX_BINS {
            let (bins, reciprocal) = (f64::from(count(length)), Bin::new(0, 0, length, STRIDES).reciprocal);
            assert!(f64::from(reciprocal) * bins <= 1.0 && f64::from(reciprocal.next_up()) * bins > 1.0, "{length}");
        }
    }

    #[test]
    fn refuses_bad_nodes_and_bins() {
        let refused = |nodes: &[NodeBytes], bins: &[BinBytes]| {
            Axis::new(AxisName::Yaw, nodes, bins, STRIDES).map(|_| ()).unwrap_err()
        };
        let check = |nodes: &[f64], lengths: &[usize]| {
            let (nodes, bins) = bytes(nodes, lengths);
            refused(&nodes, &bins)
        };
        assert!(matches!(check(&[0.0], &[1]), TableError::AxisCount { nodes: 1, bins: 1, .. }));
        assert!(matches!(check(&[0.0, 0.125], &[]), TableError::AxisCount { .. }));
        assert!(matches!(check(&[0.0, 0.0], &[1]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[0.0, f64::NAN], &[1]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[-0.1, 0.125], &[1]), TableError::AxisNode { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.5], &[1]), TableError::AxisNode { index: 1, .. }));
        // A cell of two bins that says one, cells without bins, and a node inside a bin.
        assert!(matches!(check(&[0.0, 0.125], &[1, 1]), TableError::AxisBin { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.0625, 0.125], &[1]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[0.0, 0.0625, 0.125], &[2]), TableError::AxisBin { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.062, 0.125], &[1, 1]), TableError::AxisBin { index: 0, .. }));
        // Each of a bin's numbers.
        let (nodes, good) = bytes(&[0.0, 0.0625, 0.125], &[1, 1]);
        for (at, bad) in [(0, 1), (4, 1), (8, 1), (12, 1), (0, 2)] {
            let mut bins = good.clone();
            bins[bad][at] ^= 1;
            assert!(matches!(refused(&nodes, &bins), TableError::AxisBin { index, .. } if index == bad));
        }
        // Bins so narrow that rounding tells.
        let neighbour = f64::from(0.125_f32.next_down());
        assert!(matches!(check(&[neighbour, 0.125], &[1]), TableError::AxisCount { .. }));
    }
}
