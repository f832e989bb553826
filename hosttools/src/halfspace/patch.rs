//! The contact patches of one wheel: a grid over the zones of overlap, its pressures, and what they add up to.
//!
//! **Grid.** Rows lie at fixed places of the rail's profile, columns at fixed places along the track; only the size of
//! the elements follows the greatest overlap, which is continuous in the pose. So the total force is continuous too:
//! which elements are looked at never changes the answer, because one without overlap cannot touch. Distances across are
//! arc lengths of the rail's profile, and overlaps are measured along the rail's normal.
//!
//! **Zones** closer than 4 mm act on each other as parts of one half-space; from there to 8 mm their interaction fades
//! out, as in CONTACT, since a half-space is no model of what lies between tread and flange.

use super::{Convolution, Stencil, TOLERANCE, normal};
use crate::contact::{Row, Surface};

/// Largest edges (m) of an element along the track and across: the default.
pub const EDGES: [f64; 2] = [0.4e-3, 0.2e-3];

/// Overlap (m) from which on elements have their largest size; below, they shrink with the patch, as its square root.
const FULL_SIZE: f64 = 20e-6;

/// Distances (m) between zones up to which they act on each other fully, and from which on not at all.
const TOGETHER: f64 = 4e-3;
const APART: f64 = 8e-3;

/// Elements of a grid up to which the first guess is a formula, and what coarser grids are solved to.
const COARSEST: usize = 400;
const COARSE_TOLERANCE: f64 = 1e-2;

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
    /// Displacements of this grid that the solver computed.
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
            patch.solve(&links[first..last], TOLERANCE);
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
                let row = surface.row(place, number as f64 * edges[1]);
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

    /// Solves for the pressures divided by E*, from those on a grid twice as coarse; `links` are the interactions of
    /// neighbouring zones.
    fn solve(&mut self, links: &[f64], tolerance: f64) {
        if self.overlap.len() > COARSEST && self.columns.min(self.rows.len()) > 3 {
            let mut coarse = self.halved();
            coarse.solve(links, COARSE_TOLERANCE);
            self.prolong(&coarse);
        } else {
            self.guess();
        }
        let mut convolution = Convolution::new(self.columns, self.rows.len(), self.edges);
        let stencil = Stencil::new(self.edges);
        let Self { columns, rows, overlap, pressure, .. } = self;
        self.steps = if links.iter().all(|&link| link == 1.0) {
            normal::solve(|p, u| convolution.apply(p, u), &stencil, *columns, overlap, pressure, tolerance)
        } else {
            let faded = |p: &[f64], u: &mut [f64]| faded(&mut convolution, *columns, rows, links, p, u);
            normal::solve(faded, &stencil, *columns, overlap, pressure, tolerance)
        };
    }

    /// A smooth guess of about the right size: p / E* falls to nothing at half of the greatest overlap.
    fn guess(&mut self) {
        let deepest = self.overlap.iter().copied().fold(0.0, f64::max);
        let extent = (self.overlap.iter().filter(|w| **w > 0.0).count() as f64 * self.edges[0] * self.edges[1]).sqrt();
        for (p, w) in self.pressure.iter_mut().zip(&self.overlap) {
            *p = (deepest * (2.0 * w - deepest).max(0.0)).sqrt() / extent;
        }
    }

    /// The elements of even row and column: a grid twice as coarse over the same surfaces.
    fn halved(&self) -> Self {
        let first_column = (self.first_column + 1).div_euclid(2);
        let skipped = (2 * first_column - self.first_column) as usize;
        let columns = (self.columns - skipped).div_ceil(2);
        let even =
            || self.rows.iter().zip(self.overlap.chunks_exact(self.columns)).filter(|(row, _)| row.number % 2 == 0);
        let overlap: Vec<f64> = even().flat_map(|(_, row)| row[skipped..].iter().copied().step_by(2)).collect();
        Self {
            edges: self.edges.map(|edge| 2.0 * edge),
            first_column,
            columns,
            rows: even().map(|(row, _)| PatchRow { number: row.number / 2, ..*row }).collect(),
            pressure: vec![0.0; overlap.len()],
            overlap,
            steps: 0,
        }
    }

    /// Takes the pressures of a grid twice as coarse, linearly between its elements.
    fn prolong(&mut self, coarse: &Self) {
        let first_row = coarse.rows.first().map_or(0, |row| row.number);
        let place = |number: i64, first: i64, count: usize| {
            [number.div_euclid(2), (number + 1).div_euclid(2)]
                .map(|at| (at - first).clamp(0, count as i64 - 1) as usize)
        };
        let columns: Vec<[usize; 2]> = (0..self.columns)
            .map(|i| place(self.first_column + i as i64, coarse.first_column, coarse.columns))
            .collect();
        for (row, pressure) in self.rows.iter().zip(self.pressure.chunks_exact_mut(self.columns)) {
            let rows = place(row.number, first_row, coarse.rows.len()).map(|j| &coarse.pressure[j * coarse.columns..]);
            for (p, &[left, right]) in pressure.iter_mut().zip(&columns) {
                *p = 0.25 * rows.iter().map(|row| row[left] + row[right]).sum::<f64>();
            }
        }
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

/// Displacements where zones act on each other by less than fully: zone after zone, each weighed as it is felt.
fn faded(
    convolution: &mut Convolution,
    columns: usize,
    rows: &[PatchRow],
    links: &[f64],
    pressure: &[f64],
    displacement: &mut [f64],
) {
    displacement.fill(0.0);
    let mut own = vec![0.0; pressure.len()];
    let mut moved = vec![0.0; pressure.len()];
    for zone in 0..=links.len() {
        for (place, (own, p)) in rows.iter().zip(own.chunks_exact_mut(columns).zip(pressure.chunks_exact(columns))) {
            if place.zone == zone { own.copy_from_slice(p) } else { own.fill(0.0) }
        }
        convolution.apply(&own, &mut moved);
        for (place, (u, m)) in rows.iter().zip(displacement.chunks_exact_mut(columns).zip(moved.chunks_exact(columns)))
        {
            let felt: f64 = links[zone.min(place.zone)..zone.max(place.zone)].iter().product();
            for (u, m) in u.iter_mut().zip(m) {
                *u += felt * m;
            }
        }
    }
}
