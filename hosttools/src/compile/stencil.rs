//! Which nodes a place in a table blends, and how, in double precision: the kernel's interpolation for whoever needs it
//! before there are integers.

use flangeway::SLOTS;

use super::axes::Axes;

/// A place in the table.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(super) struct Place {
    /// Cell: lateral, yaw, roll, vertical.
    cell: [u16; 4],
    /// Position in the cell, 0 to 1: lateral, yaw, roll.
    fractions: [f32; 3],
    /// Position between the vertical nodes, beyond 0 to 1 outside the axis.
    vertical: f32,
}

impl Place {
    /// Whether the place lies in a table of these axes.
    pub(super) fn is_in(&self, axes: &Axes) -> bool {
        let nodes = [&axes.lateral, &axes.yaw, &axes.roll, &axes.vertical];
        self.cell.iter().zip(nodes).all(|(&cell, nodes)| usize::from(cell) + 1 < nodes.len())
    }

    /// Where coordinates lie on the records' axes (lateral, yaw, roll offset, vertical).
    pub(super) fn new(places: &[flangeway::Place; 4]) -> Self {
        let [u, yaw, roll, vertical] = places;
        Self {
            cell: places.map(|place| place.cell as u16),
            fractions: [u, yaw, roll].map(|place| place.fraction as f32),
            vertical: vertical.unclamped as f32,
        }
    }
}

/// How the vertical fraction is taken outside the axis: as the kernel does for indentations, or for all else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Beyond {
    Extrapolated,
    Clamped,
}

/// The grid of the records.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stencil {
    lateral: usize,
    yaw: usize,
    roll: usize,
    nodes: usize,
}

impl Stencil {
    pub(super) fn new(axes: &Axes) -> Self {
        let roll = axes.vertical.len();
        let yaw = roll * axes.roll.len();
        Self { lateral: yaw * axes.yaw.len(), yaw, roll, nodes: axes.nodes() }
    }

    /// Number of nodes.
    pub(super) fn nodes(&self) -> usize {
        self.nodes
    }

    /// The sixteen nodes around a place with their weights.
    pub(super) fn corners(&self, place: &Place, beyond: Beyond) -> [(usize, f64); 16] {
        let [u, p, r] = place.fractions.map(f64::from);
        let z = match beyond {
            Beyond::Extrapolated => f64::from(place.vertical),
            Beyond::Clamped => f64::from(place.vertical).clamp(0.0, 1.0),
        };
        let base = self.lateral * place.cell[0] as usize
            + self.yaw * place.cell[1] as usize
            + self.roll * place.cell[2] as usize
            + place.cell[3] as usize;
        let side = |t: f64, upper: usize| if upper == 1 { t } else { 1.0 - t };
        std::array::from_fn(|corner| {
            let [i, j, k, l] = [corner >> 3 & 1, corner >> 2 & 1, corner >> 1 & 1, corner & 1];
            let node = base + i * self.lateral + j * self.yaw + k * self.roll + l;
            (node, side(u, i) * side(p, j) * side(r, k) * side(z, l))
        })
    }

    /// Blended values of the slots at a place.
    pub(super) fn blend(&self, place: &Place, values: &[[f64; SLOTS]], beyond: Beyond) -> [f64; SLOTS] {
        blend(&self.corners(place, beyond), values)
    }
}

/// Weighted sum of the slots' values.
pub(super) fn blend(corners: &[(usize, f64); 16], values: &[[f64; SLOTS]]) -> [f64; SLOTS] {
    let mut sum = [0.0; SLOTS];
    for &(node, w) in corners {
        for (sum, value) in sum.iter_mut().zip(&values[node]) {
            *sum += w * value;
        }
    }
    sum
}
