//! A grid over patches, solved from grids twice, four times, ... as coarse.
//!
//! Numbers are those of single precision near one: overlaps over the greatest, pressures times 1/E* and an element's width
//! over the same.

use super::normal;

/// Elements of a grid up to which the first guess is a formula, and what coarser grids are solved to.
const COARSEST: usize = 400;
const COARSE_TOLERANCE: f64 = 1e-2;

/// Elements in rows and columns.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Length of an element over its width.
    pub(super) ratio: f64,
    /// Numbers of the first column and row: the even ones make up the coarser grid.
    pub(super) first: [i64; 2],
    pub(super) columns: usize,
    /// Zone of each row.
    pub(super) zones: Vec<usize>,
    pub(super) overlap: Vec<f32>,
    pub(super) pressure: Vec<f32>,
    /// Overlap (m) that stands as one, and its quotient with the elements' width.
    unit: [f64; 2],
}

impl Grid {
    /// Over elements with these edges `[along x, across]` and overlaps (m), row by row; the first has this column's and
    /// row's number. `zones` says which zone each row belongs to.
    pub fn new(edges: [f64; 2], first: [i64; 2], columns: usize, zones: Vec<usize>, overlap: &[f64]) -> Self {
        let deepest = overlap.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        // Rounded, so that elements whose size alone differs have the same.
        let ratio = f64::from((edges[0] / edges[1]) as f32);
        let overlap: Vec<f32> = overlap.iter().map(|w| (w / deepest).max(-1.0) as f32).collect();
        let pressure = vec![0.0; overlap.len()];
        Self { ratio, first, columns, zones, overlap, pressure, unit: [deepest, deepest / edges[1]] }
    }

    /// Pressures over E*.
    pub fn pressures(&self) -> impl Iterator<Item = f64> + '_ {
        self.pressure.iter().map(|&p| self.unit[1] * f64::from(p))
    }

    /// Solves for the pressures from those on a grid twice as coarse; `links` say how much each zone and the next act on
    /// each other. Returns how many displacements of this grid were computed.
    pub fn solve(&mut self, links: &[f64], tolerance: f64) -> usize {
        if self.overlap.len() > COARSEST && self.columns.min(self.zones.len()) > 3 {
            let mut coarse = self.halved();
            coarse.solve(links, COARSE_TOLERANCE);
            self.prolong(&coarse);
        } else {
            self.guess();
        }
        normal::solve(self, links, tolerance)
    }

    /// A smooth guess of about the right size: it falls to nothing at half of the greatest overlap.
    fn guess(&mut self) {
        let deepest = self.overlap.iter().copied().fold(0.0, f32::max);
        let extent = (self.overlap.iter().filter(|w| **w > 0.0).count() as f32 * self.ratio as f32).sqrt();
        for (p, w) in self.pressure.iter_mut().zip(&self.overlap) {
            *p = (deepest * (2.0 * w - deepest).max(0.0)).sqrt() / extent;
        }
    }

    /// The elements of even row and column: a grid twice as coarse over the same surfaces.
    fn halved(&self) -> Self {
        let first = self.first.map(|number| (number + 1).div_euclid(2));
        let [column, row] = [0, 1].map(|n| (2 * first[n] - self.first[n]) as usize);
        let even = self.overlap.chunks_exact(self.columns).skip(row).step_by(2);
        let overlap: Vec<f32> = even.flat_map(|row| row[column..].iter().copied().step_by(2)).collect();
        Self {
            ratio: self.ratio,
            first,
            columns: (self.columns - column).div_ceil(2),
            zones: self.zones.iter().copied().skip(row).step_by(2).collect(),
            pressure: vec![0.0; overlap.len()],
            overlap,
            unit: [self.unit[0], 0.5 * self.unit[1]],
        }
    }

    /// Takes the pressures of a grid twice as coarse, linearly between its elements.
    fn prolong(&mut self, coarse: &Self) {
        let places = |n: usize, count: usize, of: usize| -> Vec<[usize; 2]> {
            let place = |number: i64| {
                [number.div_euclid(2), (number + 1).div_euclid(2)]
                    .map(|at| (at - coarse.first[n]).clamp(0, of as i64 - 1) as usize)
            };
            (0..count).map(|i| place(self.first[n] + i as i64)).collect()
        };
        let columns = places(0, self.columns, coarse.columns);
        let rows = places(1, self.zones.len(), coarse.zones.len());
        for (rows, pressure) in rows.into_iter().zip(self.pressure.chunks_exact_mut(self.columns)) {
            let rows = rows.map(|j| &coarse.pressure[j * coarse.columns..][..coarse.columns]);
            for (p, &[left, right]) in pressure.iter_mut().zip(&columns) {
                // A quarter for four, and half for the elements' width.
                *p = 0.125 * rows.iter().map(|row| row[left] + row[right]).sum::<f32>();
            }
        }
    }
}
