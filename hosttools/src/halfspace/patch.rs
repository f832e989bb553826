//! The contact patches of one wheel: a grid over the zones of overlap, its pressures, and what they add up to.
//!
//! **Grid.** Rows lie at fixed places of the rail's profile, columns at fixed places along the track; only the size of
//! the elements follows the greatest overlap, which is continuous in the pose. So the total force is continuous too:
//! which elements are looked at never changes the answer, because one without overlap cannot touch. Distances across are
//! arc lengths of the rail's profile, and overlaps are measured along the rail's normal.
//!
//! **Zones** closer than 4 mm act on each other as parts of one half-space; from there to 8 mm their interaction fades
//! out, as in CONTACT, since a half-space is no model of what lies between tread and flange.

use super::{Grid, TOLERANCE};
use crate::contact::{Row, Surface};

/// Largest edges (m) of an element along the track and across: the default.
pub const EDGES: [f64; 2] = [0.4e-3, 0.2e-3];

/// Overlap (m) from which on elements have their largest size; below, they shrink with the patch, as its square root.
const FULL_SIZE: f64 = 20e-6;

/// Distances (m) between zones up to which they act on each other fully, and from which on not at all.
const TOGETHER: f64 = 4e-3;
const APART: f64 = 8e-3;

/// Zones that are solved together, on one grid.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Edges of the elements along the track and across (m).
    pub edges: [f64; 2],
    /// Number of the first column: its x is this times the edge (m, from the wheelset's centre).
    pub first_column: i64,
    /// Elements in a row.
    pub columns: usize,
    /// What lies in each row.
    pub rows: Vec<PatchRow>,
    /// Undeformed overlap (m), row by row; elements outside of the zones have -1.
    pub overlap: Vec<f64>,
    /// Pressure (Pa), row by row.
    pub pressure: Vec<f64>,
    /// Displacements of this grid, or of what takes part of it, that the solver computed.
    pub steps: usize,
}

/// A row of a patch.
#[derive(Debug, Clone, Copy)]
pub struct PatchRow {
    /// Number of the row: its rail parameter is this times the edge (m).
    pub number: i64,
    /// Zone it belongs to, counted in the patch.
    pub zone: usize,
    /// Wheel and rail there; `None` between zones.
    pub row: Option<Row>,
}

/// What one row, or one strip, carries.
#[derive(Debug, Clone, Copy)]
pub struct RowLoad {
    /// Wheel and rail there.
    pub row: Row,
    /// Width of the row (m).
    pub width: f64,
    /// Normal force (N).
    pub force: f64,
    /// Mean and mean square of x - x0 under the pressure (m, m²), x0 the row's own.
    pub moments: [f64; 2],
}

/// How much of the interaction of two zones remains at a distance (m) between them.
pub fn interaction(distance: f64) -> f64 {
    let share = ((APART - distance) / (APART - TOGETHER)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Solves all patches of a wheel whose greatest overlap is `deepest` (m).
pub fn patches(surface: &Surface<'_>, deepest: f64, contact_modulus: f64, edges: [f64; 2]) -> Vec<Patch> {
    let scale = (deepest / FULL_SIZE).sqrt().min(1.0);
    let edges = edges.map(|edge| edge * scale);
    let zones = surface.zones();
    let links: Vec<f64> = zones.windows(2).map(|w| interaction(w[1].ends[0] - w[0].ends[1])).collect();
    let mut found = Vec::new();
    let mut first = 0;
    for last in 0..zones.len() {
        if links.get(last).is_some_and(|&link| link > 0.0) {
            continue;
        }
        if let Some(mut patch) = Patch::new(surface, first..last + 1, edges) {
            patch.solve(&links[first..last]);
            patch.pressure.iter_mut().for_each(|p| *p *= contact_modulus);
            found.push(patch);
        }
        first = last + 1;
    }
    found
}

impl Patch {
    /// Rows and overlaps of neighbouring zones; `None` where no element lies in them.
    fn new(surface: &Surface<'_>, zones: std::ops::Range<usize>, edges: [f64; 2]) -> Option<Self> {
        let mut rows: Vec<PatchRow> = Vec::new();
        let mut elements: Vec<(usize, i64, f64)> = Vec::new();
        for (zone, place) in surface.zones()[zones].iter().enumerate() {
            let [from, to] = place.ends.map(|s| s / edges[1]);
            for number in from.ceil() as i64..=to.floor() as i64 {
                while let Some(previous) = rows.last()
                    && previous.number + 1 < number
                {
                    rows.push(PatchRow { number: previous.number + 1, zone, row: None });
                }
                let row = surface.row(place, number as f64 * edges[1], edges[1]);
                let index = rows.len();
                if let Some(row) = &row {
                    surface.along(row, edges[0], |column, overlap| elements.push((index, column, overlap)));
                }
                rows.push(PatchRow { number, zone, row });
            }
        }
        let first_column = elements.iter().map(|e| e.1).min()?;
        let columns = (elements.iter().map(|e| e.1).max()? - first_column + 1) as usize;
        let mut overlap = vec![-1.0; rows.len() * columns];
        for (row, column, value) in elements {
            overlap[row * columns + (column - first_column) as usize] = value;
        }
        let pressure = vec![0.0; overlap.len()];
        Some(Self { edges, first_column, columns, rows, overlap, pressure, steps: 0 })
    }

    /// Solves for the pressures divided by E*; `links` are the interactions of neighbouring zones.
    fn solve(&mut self, links: &[f64]) {
        let first = [self.first_column, self.rows.first().map_or(0, |row| row.number)];
        let zones = self.rows.iter().map(|row| row.zone).collect();
        let mut grid = Grid::new(self.edges, first, self.columns, zones, &self.overlap);
        self.steps = grid.solve(links, TOLERANCE);
        self.pressure = grid.pressures().collect();
    }

    /// Area under pressure (m²).
    pub fn area(&self) -> f64 {
        self.pressure.iter().filter(|p| **p > 0.0).count() as f64 * self.edges[0] * self.edges[1]
    }

    /// What each row carries.
    pub fn loads(&self) -> impl Iterator<Item = RowLoad> + '_ {
        let [along, width] = self.edges;
        self.rows.iter().zip(self.pressure.chunks_exact(self.columns)).filter_map(move |(place, pressure)| {
            let row = place.row?;
            let sum: f64 = pressure.iter().sum();
            if sum <= 0.0 {
                return None;
            }
            let x = |i: usize| (self.first_column + i as i64) as f64 * along - row.x;
            let moment = |power: i32| pressure.iter().enumerate().map(|(i, p)| p * x(i).powi(power)).sum::<f64>() / sum;
            // An element's own extent belongs to its second moment.
            let moments = [moment(1), moment(2) + along * along / 12.0];
            Some(RowLoad { row, width, force: sum * along * width, moments })
        })
    }
}
