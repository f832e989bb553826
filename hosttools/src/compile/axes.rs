//! The nodes of a table's axes.

use std::collections::BTreeSet;

use flangeway::layout::{BIN, NODE, RECORD, RIGID};
use flangeway::{AxisName, bin_start};

use crate::error::{Error, Result};
use crate::image::OwnedAxis;
use crate::recipe::{self, Nodes, Recipe};

/// Counts from which the refinement of `"auto"` axes starts. Few, so that nodes come where they are wanted: starting
/// from 33 lateral and 5 yaw nodes, 1 MiB ended at 1.6 % rms instead of 1.3 %.
const LATERAL: usize = 9;
const YAW: usize = 3;
const VERTICAL: usize = 3;
const ROLL: usize = 3;

/// Parts that the rigid map divides an interval of the records into: lateral, yaw.
pub(super) const REFINEMENT: [u8; 2] = [4, 2];

/// Room (bytes) for header and padding.
const OVERHEAD: usize = 2048;

/// Node counts from the command line, lateral x yaw x vertical x roll as the paper writes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uniform {
    /// Lateral, yaw, vertical, roll.
    pub counts: [usize; 4],
}

impl std::str::FromStr for Uniform {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let count = |n: &str| n.parse().map_err(|_| format!("\"{n}\" is not a node count"));
        let counts: Vec<usize> = text.split('x').map(count).collect::<std::result::Result<_, _>>()?;
        let counts: [usize; 4] = counts.try_into().map_err(|_| {
            format!("\"{text}\" is not four node counts, lateral x yaw x vertical x roll, such as 121x9x25x21")
        })?;
        match counts.iter().find(|n| !(2..=2048).contains(*n)) {
            Some(n) => Err(format!("{n} nodes: an axis has 2 to 2048 nodes")),
            None => Ok(Self { counts }),
        }
    }
}

/// Nodes of all axes, m or rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes {
    /// Lateral displacement of the tape-circle point.
    pub lateral: Vec<f64>,
    /// Yaw.
    pub yaw: Vec<f64>,
    /// Roll about the rigid one.
    pub roll: Vec<f64>,
    /// Height about the rigid one.
    pub vertical: Vec<f64>,
    /// Of the rigid map: lateral, yaw.
    rigid: [Vec<f64>; 2],
}

impl Axes {
    pub(super) fn new(lateral: Vec<f64>, yaw: Vec<f64>, roll: Vec<f64>, vertical: Vec<f64>) -> Self {
        let [l, y] = REFINEMENT;
        let rigid = [divided(&lateral, l), divided(&yaw, y)];
        Self { lateral, yaw, roll, vertical, rigid }
    }

    /// What a part of a table is solved on: the nodes around these lateral intervals, of the records and of the rigid
    /// map.
    pub(super) fn around(&self, lateral: &[usize]) -> Self {
        let parts = usize::from(REFINEMENT[0]);
        let taken = |nodes: &[f64], parts: usize| {
            let wanted: BTreeSet<usize> = lateral.iter().flat_map(|&cell| parts * cell..=parts * (cell + 1)).collect();
            wanted.into_iter().map(|i| nodes[i]).collect::<Vec<f64>>()
        };
        let [rigid, yaw] = &self.rigid;
        Self { lateral: taken(&self.lateral, 1), rigid: [taken(rigid, parts), yaw.clone()], ..self.clone() }
    }

    /// Evenly spaced axes by counts.
    pub(super) fn uniform(recipe: &Recipe, Uniform { counts: [lateral, yaw, vertical, roll] }: Uniform) -> Self {
        let grid = &recipe.grid;
        Self::new(
            evenly(grid.lateral_m.range, lateral),
            evenly(grid.yaw_rad.range, yaw),
            evenly(grid.roll_rad.range, roll),
            evenly(grid.vertical_m.range, vertical),
        )
    }

    /// The axes from which refinement starts: the recipe's counts, and few nodes where it says `"auto"`. The vertical
    /// axis has a node where contact begins.
    ///
    /// # Errors
    /// When even these do not fit the byte budget.
    pub(super) fn coarsest(recipe: &Recipe, sides: usize) -> Result<Self> {
        let grid = &recipe.grid;
        let count = |axis: &recipe::Axis, auto: usize| match axis.nodes {
            Nodes::Count(n) => n,
            Nodes::Auto => auto,
        };
        let [low, high] = grid.vertical_m.range;
        let vertical = match grid.vertical_m.nodes {
            Nodes::Auto if low < 0.0 && high > 0.0 => vec![single(below_zero(low, high)), 0.0, single(high)],
            _ => evenly(grid.vertical_m.range, count(&grid.vertical_m, VERTICAL)),
        };
        let axes = Self::new(
            evenly(grid.lateral_m.range, count(&grid.lateral_m, LATERAL)),
            evenly(grid.yaw_rad.range, count(&grid.yaw_rad, YAW)),
            evenly(grid.roll_rad.range, count(&grid.roll_rad, ROLL)),
            vertical,
        );
        let any_auto =
            [grid.lateral_m, grid.yaw_rad, grid.roll_rad, grid.vertical_m].iter().any(|a| a.nodes == Nodes::Auto);
        if any_auto && axes.bytes(sides) as u64 > grid.max_bytes {
            let message = format!("{} is too little: the coarsest table takes {}", grid.max_bytes, axes.bytes(sides));
            return Err(Error::field(&recipe.path, "grid.max_bytes", message));
        }
        Ok(axes)
    }

    /// Number of records a side.
    pub fn nodes(&self) -> usize {
        self.lateral.len() * self.yaw.len() * self.roll.len() * self.vertical.len()
    }

    /// Upper bound of the bytes of a table with these axes.
    pub(super) fn bytes(&self, sides: usize) -> usize {
        let nodes: usize = self.all().iter().map(|nodes| nodes.len()).sum();
        let axes = NODE * nodes + BIN * (self.bins().unwrap_or(BINS_A_NODE * nodes) + AxisName::ALL.len());
        OVERHEAD + axes + self.bytes_at_nodes(sides)
    }

    /// Bytes of what stands at the nodes: records and rigid map.
    pub(super) fn bytes_at_nodes(&self, sides: usize) -> usize {
        let [lateral, yaw] = self.rigid.each_ref().map(Vec::len);
        sides * (RIGID * lateral * yaw + RECORD * self.nodes())
    }

    /// Whether the kernel's constant-time search takes these axes: bins that part all nodes, and not too many.
    pub(super) fn searchable(&self) -> bool {
        self.bins().is_some()
    }

    /// Bins of all axes; none if there are none that part all nodes, or too many.
    fn bins(&self) -> Option<usize> {
        let axes = AxisName::ALL.into_iter().zip(self.all());
        let bins = axes.map(|(name, nodes)| {
            let bins = OwnedAxis::new(name, nodes).ok()?.bins();
            (bins <= BINS_A_NODE * nodes.len()).then_some(bins)
        });
        bins.sum()
    }

    /// Nodes of the rigid map: lateral, yaw, every interval of the records' axes divided by [`REFINEMENT`]. The image does
    /// not hold them.
    pub(super) fn rigid(&self) -> [&[f64]; 2] {
        let [lateral, yaw] = &self.rigid;
        [lateral, yaw]
    }

    /// All axes in the order of the image.
    pub(super) fn all(&self) -> [&[f64]; 4] {
        [&self.lateral, &self.yaw, &self.roll, &self.vertical]
    }
}

/// Most bins for each node that refinement may ask for.
pub(super) const BINS_A_NODE: usize = 16;

/// Each interval divided into `parts`.
fn divided(nodes: &[f64], parts: u8) -> Vec<f64> {
    let inner = |w: &[f64]| {
        let (a, b) = (w[0], w[1]);
        (0..parts).map(move |k| a + (b - a) * f64::from(k) / f64::from(parts)).collect::<Vec<_>>()
    };
    nodes.windows(2).flat_map(inner).chain(nodes.last().copied()).collect()
}

/// The low end of an axis with a node at zero: `low`, or as little below it as makes it a whole number of `high`'s eighths
/// or larger parts. The kernel's search wants nodes on an even lattice, and not too fine a one.
fn below_zero(low: f64, high: f64) -> f64 {
    let end = |parts: i32| {
        let part = high / f64::from(parts);
        -part * (-low / part - 1e-6).ceil()
    };
    (1..=8).map(end).fold(f64::NEG_INFINITY, |best, end| if end > best + 1e-9 * high { end } else { best })
}

/// Nodes where bins begin, as the image has them.
fn evenly(range: [f64; 2], count: usize) -> Vec<f64> {
    let [first, last] = range.map(single);
    (0..count - 1).map(|i| bin_start(first, last, count - 1, i)).chain([last]).collect()
}

/// An end of an axis: a number that `f32` holds, as the kernel wants it.
fn single(end: f64) -> f64 {
    f64::from(end as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_as_the_paper_writes_them() {
        assert_eq!("121x9x25x21".parse(), Ok(Uniform { counts: [121, 9, 25, 21] }));
        for bad in ["121x9x25", "121x9x25x1", "0x9x25x21", "121x9x25x21x3", "ax9x25x21", ""] {
            assert!(bad.parse::<Uniform>().is_err(), "{bad}");
        }
    }

    #[test]
    fn zero_lies_on_the_lattice() {
        assert_eq!(below_zero(-5e-5, 1.5e-4) as f32, -5e-5);
        assert!((below_zero(-3.7e-5, 2.31e-4) + 2.31e-4 / 6.0).abs() < 1e-12);
        assert!((below_zero(-1e-4, 1e-5) + 1e-4).abs() < 1e-12);
    }

    #[test]
    fn evenly_spaced_nodes_keep_the_ends_and_divide() {
        assert_eq!(evenly([-0.5, 1.0], 4), [-0.5, 0.0, 0.5, 1.0]);
        assert_eq!(divided(&[0.0, 1.0, 3.0], 2), [0.0, 0.5, 1.0, 2.0, 3.0]);
    }
}
