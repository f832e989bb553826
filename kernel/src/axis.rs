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

/// A node for a cell that a checked axis does not have.
const NOTHING: &NodeBytes = &[[0; 8]; 2];

/// Least width of a bin in units of the axis' largest magnitude, 2⁻²²: rounding then moves a coordinate by less than 2⁻²⁸
/// of its cell, which is less than the weights can tell.
const LEAST_BIN: f64 = 1.0 / 4_194_304.0;

/// An axis, read in place: its nodes, and the map of uniform bins to cells by which a cell is found in constant time.
///
/// Bins divide first node to last node evenly, and every node lies where a bin begins, so a bin lies in one cell:
/// `map[bin]` is that cell. The cost is the same for every coordinate and spacing.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    nodes: &'a [NodeBytes],
    map: &'a [[u8; 2]],
    first: f64,
    last: f64,
    bins_per_unit: f64,
    last_bin: f64,
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
    pub(crate) const EMPTY: Self =
        Self { nodes: &[], map: &[], first: 0.0, last: 0.0, bins_per_unit: 0.0, last_bin: 0.0 };

    /// An axis over little-endian nodes and `u16` bins.
    ///
    /// # Errors
    /// Fewer than two nodes, no bins, too many or too narrow ones, nodes that do not increase strictly within
    /// [`AxisName::bounds`], reciprocals or bins that do not fit the nodes.
    pub fn new(name: AxisName, nodes: &'a [NodeBytes], map: &'a [[u8; 2]]) -> Result<Self, TableError> {
        let counts = TableError::AxisCount { axis: name, nodes: count(nodes.len()), bins: count(map.len()) };
        if nodes.len() < 2 || nodes.len() > MAX_BINS + 1 || map.is_empty() || map.len() > MAX_BINS {
            return Err(counts);
        }
        let (least, largest) = name.bounds();
        let mut before = f64::NEG_INFINITY;
        for (index, bytes) in nodes.iter().enumerate() {
            let value = coordinate(bytes);
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
        for (index, at) in nodes.iter().enumerate() {
            let needed = nodes.get(index + 1).map_or(0.0, |next| 1.0 / (coordinate(next) - coordinate(at)));
            check_reciprocal(name, index, at, needed)?;
        }
        let mut axis = Self { nodes, map, ..Self::EMPTY };
        axis.first = axis.node(0);
        axis.last = axis.node(nodes.len() - 1);
        let bins = f64::from(count(map.len()));
        let length = axis.last - axis.first;
        if length < bins * LEAST_BIN * axis.first.abs().max(axis.last.abs()) {
            return Err(counts);
        }
        axis.bins_per_unit = bins / length;
        axis.last_bin = bins - 1.0;
        axis.check_bins(name)?;
        Ok(axis)
    }

    /// Every inner node lies where a bin begins, and every bin leads to its cell.
    fn check_bins(&self, name: AxisName) -> Result<(), TableError> {
        let inner_end = self.nodes.len() - 1;
        let mut cell = 0;
        for (index, bytes) in self.map.iter().enumerate() {
            let found = u16::from_le_bytes(*bytes);
            let start = bin_start(self.first, self.last, self.map.len(), index);
            cell += usize::from(cell + 1 < inner_end && self.node(cell + 1).to_bits() == start.to_bits());
            let missed = index + 1 == self.map.len() && cell + 1 < inner_end;
            if usize::from(found) != cell || missed {
                return Err(TableError::AxisBin { axis: name, index, found });
            }
        }
        Ok(())
    }

    /// Cell of a bin; the cell's lower node and the reciprocal of its width.
    #[inline(always)]
    fn cell(&self, bin: usize) -> (u32, Two) {
        let cell = u32::from(u16::from_le_bytes(self.map.get(bin).copied().unwrap_or_default()));
        let node = self.nodes.get(cell as usize).unwrap_or(NOTHING);
        (cell, Two::new(node.map(f64::from_le_bytes)))
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
        let places = AxisPair::new([*self; 2]).locate(Two::all(x));
        let ([cell, _], [fraction, _]) = (places.cells, places.fraction.numbers());
        let [unclamped, _] = places.unclamped().numbers();
        Place {
            cell: cell as usize,
            fraction: at_most(at_least(fraction, 0.0), 1.0),
            unclamped,
            clamped: places.clamped != 0,
        }
    }
}

/// Where two coordinates lie on their axes, see [`Place`].
#[derive(Clone, Copy)]
pub(crate) struct Places {
    pub(crate) cells: [u32; 2],
    /// Clamped to 0..=1, but for rounding: within 2⁻²⁸ of it.
    pub(crate) fraction: Two,
    /// How far the coordinates lie outside their axes, in widths of the first or last cell.
    outside: Two,
    /// Bit i says whether coordinate i lies outside its axis.
    pub(crate) clamped: u8,
}

impl Places {
    /// The first cells, on no axis in particular.
    #[cfg(test)]
    pub(crate) fn first(fraction: [f64; 2]) -> Self {
        Self { cells: [0; 2], fraction: Two::new(fraction), outside: Two::all(0.0), clamped: 0 }
    }

    /// The fractions not clamped, but to +-[`EXTRAPOLATION_LIMIT`].
    #[inline(always)]
    pub(crate) fn unclamped(&self) -> Two {
        let limit = Two::all(EXTRAPOLATION_LIMIT);
        (self.fraction + self.outside).at_least(Two::all(-EXTRAPOLATION_LIMIT)).at_most(limit)
    }
}

/// Two axes that are searched together. Aligned, so that an operation may take its operand from memory.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct AxisPair<'a> {
    first: [f64; 2],
    last: [f64; 2],
    bins_per_unit: [f64; 2],
    last_bin: [f64; 2],
    axes: [Axis<'a>; 2],
}

impl<'a> AxisPair<'a> {
    /// None yet.
    pub(crate) const EMPTY: Self =
        Self { axes: [Axis::EMPTY; 2], first: [0.0; 2], last: [0.0; 2], bins_per_unit: [0.0; 2], last_bin: [0.0; 2] };

    pub(crate) fn new(axes: [Axis<'a>; 2]) -> Self {
        Self {
            axes,
            first: axes.map(|axis| axis.first),
            last: axes.map(|axis| axis.last),
            bins_per_unit: axes.map(|axis| axis.bins_per_unit),
            last_bin: axes.map(|axis| axis.last_bin),
        }
    }

    /// ```text
    /// x'       = x, first at least, last at most
    /// cell     = map[min(floor((x' - first) bins_per_unit), bins - 1)]
    /// fraction = (x' - node[cell]) / (node[cell + 1] - node[cell])
    /// ```
    #[inline(always)]
    pub(crate) fn locate(&self, x: Two) -> Places {
        let first = Two::new(self.first);
        let inside = x.at_least(first).at_most(Two::new(self.last));
        let position = (inside - first) * Two::new(self.bins_per_unit);
        let [bin_a, bin_b] = position.at_most(Two::new(self.last_bin)).truncate();
        let [a, b] = &self.axes;
        let ((cell_a, node_a), (cell_b, node_b)) = (a.cell(bin_a), b.cell(bin_b));
        let [lower, per_unit] = Two::transpose([node_a, node_b]);
        Places {
            cells: [cell_a, cell_b],
            fraction: (inside - lower) * per_unit,
            outside: (x - inside) * per_unit,
            clamped: inside.differs(x),
        }
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

    fn bytes(nodes: &[f64], map: &[u16]) -> (Vec<NodeBytes>, Vec<[u8; 2]>) {
        let reciprocal = |i: usize| nodes.get(i + 1).map_or(0.0, |next| 1.0 / (*next - nodes[i]));
        let node = |(i, x): (usize, &f64)| [*x, reciprocal(i)].map(f64::to_le_bytes);
        (nodes.iter().enumerate().map(node).collect(), map.iter().map(|x| x.to_le_bytes()).collect())
    }

    #[test]
    fn finds_cells_between_uneven_nodes() {
        // Range 1/16 in 8 bins.
        let (nodes, map) = bytes(&[0.0, 1.0, 3.0, 8.0].map(|k| k / 128.0), &[0, 1, 1, 2, 2, 2, 2, 2]);
        let axis = Axis::new(AxisName::Yaw, &nodes, &map).unwrap();
        for (x, cell) in [(0.0, 0), (0.99, 0), (1.01, 1), (2.99, 1), (3.01, 2), (8.0, 2), (99.0, 2), (-1.0, 0)] {
            let x = x / 128.0;
            assert_eq!(axis.locate(x).cell, cell, "{x}");
        }
        let end = axis.locate(axis.node(3));
        assert!((end.fraction - 1.0).abs() < 1e-15 && !end.clamped);
        let node = axis.locate(axis.node(2));
        assert_eq!((node.cell, node.fraction), (2, 0.0));
        let outside = axis.locate(13.0 / 128.0);
        assert!(outside.clamped && outside.fraction == 1.0 && (outside.unclamped - 2.0).abs() < 1e-6);
    }

    #[test]
    fn refuses_bad_nodes_and_bins() {
        let check = |nodes: &[f64], map: &[u16]| {
            let (nodes, map) = bytes(nodes, map);
            Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err()
        };
        assert!(matches!(check(&[0.0], &[0]), TableError::AxisCount { nodes: 1, bins: 1, .. }));
        assert!(matches!(check(&[0.0, 0.125], &[]), TableError::AxisCount { .. }));
        assert!(matches!(check(&[0.0, 0.0], &[0]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[0.0, f64::NAN], &[0]), TableError::AxisNode { index: 1, .. }));
        assert!(matches!(check(&[-0.1, 0.125], &[0]), TableError::AxisNode { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.5], &[0]), TableError::AxisNode { index: 1, .. }));
        let (mut nodes, map) = bytes(&[0.0, 0.125], &[0]);
        nodes[0][1] = 9.9_f64.to_le_bytes();
        let refused = Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err();
        assert!(matches!(refused, TableError::AxisReciprocal { index: 0, found: 9.9, .. }));
        nodes[0] = [1e-300_f64, 10.0].map(f64::to_le_bytes);
        let refused = Axis::new(AxisName::Yaw, &nodes, &map).map(|_| ()).unwrap_err();
        assert!(matches!(refused, TableError::AxisNode { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.0625, 0.125], &[1]), TableError::AxisBin { index: 0, .. }));
        assert!(matches!(check(&[0.0, 0.0625, 0.125], &[0, 0]), TableError::AxisBin { index: 1, .. }));
        // A node inside a bin.
        assert!(matches!(check(&[0.0, 0.062, 0.125], &[0, 1]), TableError::AxisBin { index: 1, .. }));
        assert!(matches!(check(&[0.0, 0.0625, 0.125], &[0]), TableError::AxisBin { index: 0, .. }));
        // Bins so narrow that rounding tells.
        let neighbour = f64::from(0.125_f32.next_down());
        assert!(matches!(check(&[neighbour, 0.125], &[0]), TableError::AxisCount { .. }));
    }
}
