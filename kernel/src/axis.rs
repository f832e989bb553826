//! Axes with nodes at any spacing, searched in constant time.

use core::fmt;

use crate::error::TableError;
use crate::math::{Two, at_least, at_most, single};

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

/// A node in the image: its coordinate and the reciprocal of the distance to the next node (0 at the last), `f64`.
pub type NodeBytes = [[u8; 8]; 2];

/// Nodes for a cell that a checked axis does not have.
const NOTHING: &[NodeBytes; 2] = &[[[0; 8]; 2]; 2];

/// An axis, read in place: its nodes, and the map of uniform bins to cells by which a cell is found in constant time.
///
/// Bins divide first node to last node evenly, as many as it takes that none holds two inner nodes. `map[bin]` is the
/// number of inner nodes in the bins before, which is the cell at the bin's start; one comparison with the only node
/// the bin may hold does the rest. Both writer and reader find a node's bin by [`bin_of`]: it is monotonic in floating
/// point, so the search is exact however its products round. The cost is the same for every coordinate and spacing.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    nodes: &'a [NodeBytes],
    map: &'a [[u8; 2]],
    first: f64,
    last: f64,
    /// The largest number below `last`: a coordinate limited to it never lies beyond the last cell.
    below_last: f64,
    bins_per_unit: f64,
    last_bin: f64,
}

/// Bin of coordinate `x` on an axis that begins at `first`: floor((x - first) bins_per_unit), within 0..bins.
#[inline]
#[must_use]
pub fn bin_of(x: f64, first: f64, bins_per_unit: f64, bins: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast saturates, and a negative product is bin 0"
    )]
    let bin = ((x - first) * bins_per_unit) as usize;
    bin.min(bins.saturating_sub(1))
}

/// Bins per unit of an axis from `first` to `last`.
#[inline]
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "at most 4096 bins")]
pub fn bins_per_unit(first: f64, last: f64, bins: usize) -> f64 {
    bins as f64 / (last - first)
}

impl<'a> Axis<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self =
        Self { nodes: &[], map: &[], first: 0.0, last: 0.0, below_last: 0.0, bins_per_unit: 0.0, last_bin: 0.0 };

    /// An axis over little-endian nodes and `u16` bins.
    ///
    /// # Errors
    /// Fewer than two nodes, no bins or too many, nodes that are not strictly increasing `f32` within
    /// [`AxisName::bounds`], reciprocals or bins that do not fit the nodes.
    pub fn new(name: AxisName, nodes: &'a [NodeBytes], map: &'a [[u8; 2]]) -> Result<Self, TableError> {
        let counts = TableError::AxisCount { axis: name, nodes: count(nodes.len()), bins: count(map.len()) };
        if nodes.len() < 2 || nodes.len() > MAX_BINS + 2 || map.is_empty() || map.len() > MAX_BINS {
            return Err(counts);
        }
        let (least, largest) = name.bounds();
        let mut before = f32::NEG_INFINITY;
        for (index, bytes) in nodes.iter().enumerate() {
            let (exact, value) = (coordinate(bytes), single(coordinate(bytes)));
            // A comparison with NaN is false.
            let good = value > before && value >= least && value <= largest && f64::from(value) == exact;
            if !good {
                return Err(TableError::AxisNode { axis: name, index, value });
            }
            before = value;
        }
        for (index, at) in nodes.iter().enumerate() {
            let needed = nodes.get(index + 1).map_or(0.0, |next| 1.0 / (coordinate(next) - coordinate(at)));
            check_reciprocal(name, index, at, needed)?;
        }
        let mut axis = Self { nodes, map, ..Self::EMPTY };
        axis.first = axis.node(0);
        axis.last = axis.node(nodes.len() - 1);
        axis.below_last = axis.last.next_down();
        axis.bins_per_unit = bins_per_unit(axis.first, axis.last, map.len());
        axis.last_bin = f64::from(count(map.len() - 1));
        axis.check_bins(name)?;
        Ok(axis)
    }

    /// Every bin leads to the cell at its start and holds at most one inner node.
    fn check_bins(&self, name: AxisName) -> Result<(), TableError> {
        let inner_end = self.nodes.len() - 1;
        let mut next = 1; // the first inner node not in the bins before
        for (index, bytes) in self.map.iter().enumerate() {
            let found = u16::from_le_bytes(*bytes);
            let mut inside = 0;
            let start = next;
            while next < inner_end && self.bin(self.node(next)) == index {
                next += 1;
                inside += 1;
            }
            if usize::from(found) != start - 1 || inside > 1 {
                return Err(TableError::AxisBin { axis: name, index, found });
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn bin(&self, x: f64) -> usize {
        bin_of(x, self.first, self.bins_per_unit, self.map.len())
    }

    /// Cell of a coordinate below the last node, from its bin; the cell's lower node and the reciprocal of its width.
    #[inline(always)]
    fn cell(&self, bin: usize, x: f64) -> (u32, Two) {
        let at_start = u32::from(u16::from_le_bytes(self.map.get(bin).copied().unwrap_or_default()));
        let index = at_start as usize;
        let pair @ [_, next] = self.nodes.get(index..index + 2).and_then(<[_]>::first_chunk).unwrap_or(NOTHING);
        let beyond = x >= coordinate(next);
        let node = pair.get(usize::from(beyond)).unwrap_or(next);
        (at_start + u32::from(beyond), Two::new(node.map(f64::from_le_bytes)))
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
        self.nodes.get(index).map_or(0.0, coordinate)
    }

    /// All nodes' coordinates, m or rad.
    pub fn nodes(&self) -> impl Iterator<Item = f64> + 'a {
        self.nodes.iter().map(coordinate)
    }

    /// First and last node, m or rad.
    #[inline]
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.first, self.last)
    }

    /// Finds the cell of a coordinate and its place in it. `x` must be a number.
    #[inline]
    #[must_use]
    pub fn locate(&self, x: f64) -> Place {
        // The bin as in `bin_of`, limited before it is truncated: the same bin, in fewer instructions.
        let position = at_most(at_least((x - self.first) * self.bins_per_unit, 0.0), self.last_bin);
        let [bin, _] = Two::all(position).truncate();
        let (cell, node) = self.cell(bin, at_most(x, self.below_last));
        let [lower, per_unit] = node.numbers();
        let unclamped = (x - lower) * per_unit;
        let fraction = at_most(at_least(unclamped, 0.0), 1.0);
        Place {
            cell: cell as usize,
            fraction,
            unclamped: at_most(at_least(unclamped, -EXTRAPOLATION_LIMIT), EXTRAPOLATION_LIMIT),
            clamped: (x < self.first) | (x > self.last),
        }
    }
}

/// A cell's number as `u32`.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "nodes are counted by u16")]
pub(crate) fn index(cell: usize) -> u32 {
    cell as u32
}

/// Where two coordinates lie on their axes, see [`Place`].
#[derive(Clone, Copy)]
pub(crate) struct Places {
    pub(crate) cells: [u32; 2],
    pub(crate) fraction: Two,
    /// Bit i says whether coordinate i lies outside its axis.
    pub(crate) clamped: u8,
}

/// Two axes that are searched together, as [`Axis::locate`] searches one.
#[derive(Clone, Copy)]
pub(crate) struct AxisPair<'a> {
    axes: [Axis<'a>; 2],
    first: [f64; 2],
    below_last: [f64; 2],
    bins_per_unit: [f64; 2],
    last_bin: [f64; 2],
}

impl<'a> AxisPair<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self = Self {
        axes: [Axis::EMPTY; 2],
        first: [0.0; 2],
        below_last: [0.0; 2],
        bins_per_unit: [0.0; 2],
        last_bin: [0.0; 2],
    };

    pub(crate) fn new(axes: [Axis<'a>; 2]) -> Self {
        Self {
            axes,
            first: axes.map(|axis| axis.first),
            below_last: axes.map(|axis| axis.below_last),
            bins_per_unit: axes.map(|axis| axis.bins_per_unit),
            last_bin: axes.map(|axis| axis.last_bin),
        }
    }

    #[inline(always)]
    pub(crate) fn locate(&self, x: Two) -> Places {
        let bins = ((x - Two::new(self.first)) * Two::new(self.bins_per_unit)).at_least(Two::all(0.0));
        let [bin_a, bin_b] = bins.at_most(Two::new(self.last_bin)).truncate();
        let [x_a, x_b] = x.at_most(Two::new(self.below_last)).numbers();
        let [a, b] = &self.axes;
        let ((cell_a, node_a), (cell_b, node_b)) = (a.cell(bin_a, x_a), b.cell(bin_b, x_b));
        let [lower, per_unit] = Two::transpose([node_a, node_b]);
        let unclamped = (x - lower) * per_unit;
        let fraction = unclamped.at_least(Two::all(0.0)).at_most(Two::all(1.0));
        Places { cells: [cell_a, cell_b], fraction, clamped: fraction.differs(unclamped).bits() }
    }
}

/// A node's coordinate, m or rad.
#[inline(always)]
fn coordinate([coordinate, _]: &NodeBytes) -> f64 {
    f64::from_le_bytes(*coordinate)
}

fn check_reciprocal(axis: AxisName, index: usize, [_, reciprocal]: &NodeBytes, needed: f64) -> Result<(), TableError> {
    let found = f64::from_le_bytes(*reciprocal);
    if found.to_bits() == needed.to_bits() { Ok(()) } else { Err(TableError::AxisReciprocal { axis, index, found }) }
}

impl fmt::Debug for Axis<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Axis({} nodes in {} bins from {} to {})", self.nodes.len(), self.map.len(), self.first, self.last)
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

    fn bytes(nodes: &[f32], map: &[u16]) -> (Vec<NodeBytes>, Vec<[u8; 2]>) {
        let reciprocal = |i: usize| nodes.get(i + 1).map_or(0.0, |next| 1.0 / (f64::from(*next) - f64::from(nodes[i])));
        let node = |(i, x): (usize, &f32)| [f64::from(*x), reciprocal(i)].map(f64::to_le_bytes);
        (nodes.iter().enumerate().map(node).collect(), map.iter().map(|x| x.to_le_bytes()).collect())
    }

    #[test]
    fn finds_cells_between_uneven_nodes() {
        // Range 0.08 in 4 bins of 0.02: 0.01 lies in bin 0, 0.03 in bin 1.
        let (nodes, map) = bytes(&[0.0, 0.01, 0.03, 0.08], &[0, 1, 2, 2]);
        let axis = Axis::new(AxisName::Yaw, &nodes, &map).unwrap();
        for (x, cell) in [(0.0, 0), (0.009, 0), (0.0101, 1), (0.029, 1), (0.0301, 2), (0.08, 2), (1.0, 2), (-1.0, 0)] {
            assert_eq!(axis.locate(x).cell, cell, "{x}");
        }
        let end = axis.locate(axis.node(3));
        assert!((end.fraction - 1.0).abs() < 1e-15 && !end.clamped);
        let node = axis.locate(axis.node(2));
        assert_eq!((node.cell, node.fraction), (2, 0.0));
        let outside = axis.locate(0.13);
        assert!(outside.clamped && outside.fraction == 1.0 && (outside.unclamped - 2.0).abs() < 1e-6);
    }

    #[test]
    fn refuses_bad_nodes_and_bins() {
        let check = |nodes: &[f32], map: &[u16]| {
            let (nodes, map) = bytes(nodes, map);
            Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err()
        };
        assert!(matches!(check(&[0.0], &[0]), TableError::AxisCount { nodes: 1, bins: 1, .. }));
        assert!(matches!(check(&[0.0, 0.1], &[]), TableError::AxisCount { .. }));
        assert!(matches!(check(&[0.0, 0.0], &[0]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[0.0, f32::NAN], &[0]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[-0.1, 0.1], &[0]), TableError::AxisNode { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.5], &[0]), TableError::AxisNode { index: 1, .. }));
        let (mut nodes, map) = bytes(&[0.0, 0.1], &[0]);
        nodes[0][1] = 9.9_f64.to_le_bytes();
        let refused = Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err();
        assert!(matches!(refused, TableError::AxisReciprocal { index: 0, found: 9.9, .. }));
        nodes[0] = [1e-300_f64, 10.0].map(f64::to_le_bytes);
        let refused = Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err();
        assert!(matches!(refused, TableError::AxisNode { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.05, 0.1], &[1]), TableError::AxisBin { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.03, 0.06, 0.1], &[0]), TableError::AxisBin { index: 0, .. }));
    }
}
