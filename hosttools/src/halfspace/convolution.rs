//! Displacements of a window of the grid from the pressures in it, by fast Fourier transform.
//!
//! The influence of one element on another depends on their distance alone, so the sum over elements is a convolution;
//! padding keeps it from wrapping around. The influence is even in both directions, so its transform is real.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::fourier::{Fourier, LANES, Lanes, smooth};
use super::influence::{Influence, influence_of};

/// Columns that are transformed at once: one in the real, one in the imaginary parts of each lane.
const BLOCK: usize = 2 * LANES;

thread_local! {
    static PLANS: RefCell<BTreeMap<usize, Arc<Fourier>>> = const { RefCell::new(BTreeMap::new()) };
}

fn plan(length: usize) -> Arc<Fourier> {
    PLANS.with_borrow_mut(|plans| plans.entry(length).or_insert_with(|| Arc::new(Fourier::new(length))).clone())
}

/// Part of a grid: a range of columns and one of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Window {
    /// Columns in it.
    pub(super) columns: Range<usize>,
    /// Rows in it.
    pub(super) rows: Range<usize>,
}

/// Convolution with the influence of unit pressure, elements as wide (across) as one and as long as `ratio`.
pub(super) struct Convolution {
    /// Along the rows, and across them.
    along: Arc<Fourier>,
    across: Arc<Fourier>,
    /// Transform of the influence: eight frequencies across in the lanes, those along in the order of `along`.
    spectrum: Vec<[f32; LANES]>,
    /// A block of columns, transformed across.
    block: Vec<Lanes>,
    /// All columns for eight frequencies across, and the same transformed along.
    between: Vec<Lanes>,
    row: Vec<Lanes>,
}

impl Convolution {
    /// For windows and distances between elements, in columns and rows, up to these, or up to [`Convolution::reach`].
    pub(super) fn new(extent: [usize; 2], reach: [usize; 2], ratio: f64) -> Self {
        let [along, across] = [0, 1].map(|n| plan(smooth(extent[n].max(2 * reach[n]))));
        let groups = (across.length() / 2 + 1).div_ceil(LANES);
        let columns = extent[0].max(along.length() / 2 + 1).next_multiple_of(BLOCK);
        let mut convolution = Self {
            spectrum: Vec::new(),
            block: vec![Lanes::ZERO; across.length()],
            between: vec![Lanes::ZERO; groups * columns],
            row: vec![Lanes::ZERO; along.length()],
            along,
            across,
        };
        let half = [convolution.along.length() / 2 + 1, convolution.across.length() / 2 + 1];
        influence_of(ratio, half, |influence| convolution.transform(influence));
        convolution
    }

    /// Largest distances between elements, in columns and rows.
    pub(super) fn reach(&self) -> [usize; 2] {
        [self.along.length() / 2, self.across.length() / 2]
    }

    fn transform(&mut self, influence: &Influence) {
        let (width, height) = (self.along.length(), self.across.length());
        let groups = (height / 2 + 1).div_ceil(LANES);
        let scale = 0.5 / (width * height) as f32;
        let mut columns = vec![[0.0; LANES]; groups * width];
        for first in (0..=width / 2).step_by(BLOCK) {
            for j in 0..=height / 2 {
                let row = &influence.row(j)[first..=width / 2];
                let mut lanes = Lanes::ZERO;
                let parts = lanes.re.iter_mut().chain(&mut lanes.im);
                parts.zip(row).for_each(|(to, from)| *to = *from);
                self.block[j] = lanes;
                self.block[(height - j) % height] = lanes;
            }
            self.across.forward(&mut self.block, height);
            for k in 0..=height / 2 {
                // Even columns have real transforms.
                let found = self.block[self.across.place(k)];
                let values = found.re.iter().chain(&found.im);
                for (i, value) in (first..=width / 2).zip(values) {
                    columns[k / LANES * width + i][k % LANES] = *value;
                    columns[k / LANES * width + (width - i) % width][k % LANES] = *value;
                }
            }
        }
        self.spectrum.clear();
        for columns in columns.chunks_exact(width) {
            self.row.iter_mut().zip(columns).for_each(|(to, re)| *to = Lanes { re: *re, im: [0.0; LANES] });
            self.along.forward(&mut self.row, width);
            self.spectrum.extend(self.row.iter().map(|value| value.re.map(|re| scale * re)));
        }
    }

    /// Displacements from pressures, both over a grid with so many columns, in a window; others are not looked at.
    pub(super) fn apply(&mut self, window: &Window, columns: usize, pressure: &[f32], displacement: &mut [f32]) {
        let (width, height) = (self.along.length(), self.across.length());
        let groups = (height / 2 + 1).div_ceil(LANES);
        let stored = self.between.len() / groups;
        let count = window.columns.len();
        let rows = pressure.chunks_exact(columns).skip(window.rows.start).take(window.rows.len());
        let (mut filled, mut first_filled) = (0, count);
        for first in (0..count).step_by(BLOCK) {
            let range = window.columns.start + first..window.columns.end.min(window.columns.start + first + BLOCK);
            // Rows after the last one with pressure.
            let mut above = 0;
            for (j, row) in rows.clone().enumerate() {
                let row = &row[range.clone()];
                if row.iter().any(|&p| p != 0.0) {
                    above = j + 1;
                }
                self.block[j] = loaded(row);
            }
            if above == 0 {
                continue;
            }
            first_filled = first_filled.min(first);
            for group in self.between.chunks_exact_mut(stored) {
                group[filled.max(first_filled)..first].fill(Lanes::ZERO);
            }
            filled = count.min(first + BLOCK);
            self.across.forward(&mut self.block, above);
            self.part(first, stored);
        }
        if filled == 0 {
            window.rows.clone().for_each(|j| displacement[j * columns..][window.columns.clone()].fill(0.0));
            return;
        }
        for (group, spectrum) in self.between.chunks_exact_mut(stored).zip(self.spectrum.chunks_exact(width)) {
            self.row[..first_filled].fill(Lanes::ZERO);
            self.row[first_filled..filled].copy_from_slice(&group[first_filled..filled]);
            self.along.forward(&mut self.row, filled);
            for (value, factor) in self.row.iter_mut().zip(spectrum) {
                value.re.iter_mut().zip(factor).for_each(|(re, factor)| *re *= factor);
                value.im.iter_mut().zip(factor).for_each(|(im, factor)| *im *= factor);
            }
            self.along.backward(&mut self.row, count);
            group[..count].copy_from_slice(&self.row[..count]);
        }
        for first in (0..count).step_by(BLOCK) {
            self.join(first, stored);
            self.across.backward(&mut self.block, window.rows.len());
            let range = window.columns.start + first..window.columns.end.min(window.columns.start + first + BLOCK);
            let rows = displacement.chunks_exact_mut(columns).skip(window.rows.start).take(window.rows.len());
            for (row, lanes) in rows.zip(&self.block) {
                let row = &mut row[range.clone()];
                let (re, im) = row.split_at_mut(row.len().min(LANES));
                re.iter_mut().zip(&lanes.re).for_each(|(u, value)| *u = *value);
                im.iter_mut().zip(&lanes.im).for_each(|(u, value)| *u = *value);
            }
        }
    }

    /// Two real columns from one complex one, A + i B, by their transforms' symmetry; both twice as large:
    ///
    /// ```text
    /// 2 A_k = Z_k + Z*_(n - k),   2 i B_k = Z_k - Z*_(n - k)
    /// ```
    fn part(&mut self, first: usize, stored: usize) {
        let height = self.across.length();
        for k in 0..=height / 2 {
            let [z, y] = [k, (height - k) % height].map(|k| &self.block[self.across.place(k)]);
            let lane = k % LANES;
            let group: &mut [Lanes] = &mut self.between[k / LANES * stored + first..][..BLOCK];
            let (a, b) = group.split_at_mut(LANES);
            for (l, (a, b)) in a.iter_mut().zip(b).enumerate() {
                a.re[lane] = z.re[l] + y.re[l];
                a.im[lane] = z.im[l] - y.im[l];
                b.re[lane] = z.im[l] + y.im[l];
                b.im[lane] = y.re[l] - z.re[l];
            }
        }
    }

    /// The complex column of two real ones.
    ///
    /// ```text
    /// Z_k = A_k + i B_k,   Z_(n - k) = A*_k + i B*_k
    /// ```
    fn join(&mut self, first: usize, stored: usize) {
        let height = self.across.length();
        for k in 0..=height / 2 {
            let lane = k % LANES;
            let group = &self.between[k / LANES * stored + first..][..BLOCK];
            let (a, b) = group.split_at(LANES);
            let (mut z, mut y) = (Lanes::ZERO, Lanes::ZERO);
            for (l, (a, b)) in a.iter().zip(b).enumerate() {
                z.re[l] = a.re[lane] - b.im[lane];
                z.im[l] = a.im[lane] + b.re[lane];
                y.re[l] = a.re[lane] + b.im[lane];
                y.im[l] = b.re[lane] - a.im[lane];
            }
            self.block[self.across.place((height - k) % height)] = y;
            self.block[self.across.place(k)] = z;
        }
    }
}

/// Sixteen numbers of a row, or what there is of them.
#[inline(always)]
fn loaded(row: &[f32]) -> Lanes {
    let mut lanes = Lanes::ZERO;
    if row.len() == BLOCK {
        lanes.re.copy_from_slice(&row[..LANES]);
        lanes.im.copy_from_slice(&row[LANES..]);
    } else {
        lanes.re.iter_mut().chain(&mut lanes.im).zip(row).for_each(|(to, from)| *to = *from);
    }
    lanes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::influence;

    #[test]
    fn the_same_as_the_sum_over_all_elements() {
        let (columns, rows, ratio) = (53, 29, 0.7);
        let kernel = influence(columns, rows, [ratio, 1.0]);
        for (window, source) in [
            (Window { columns: 0..53, rows: 0..29 }, Window { columns: 0..53, rows: 0..29 }),
            (Window { columns: 0..53, rows: 0..29 }, Window { columns: 18..41, rows: 3..25 }),
            (Window { columns: 0..53, rows: 0..29 }, Window { columns: 35..36, rows: 20..21 }),
            (Window { columns: 5..46, rows: 7..28 }, Window { columns: 5..46, rows: 7..28 }),
            (Window { columns: 3..4, rows: 7..8 }, Window { columns: 3..4, rows: 7..8 }),
        ] {
            let inside = |n: usize| source.columns.contains(&(n % columns)) && source.rows.contains(&(n / columns));
            let value = |n: usize| if inside(n) { (libm::sin(n as f64) + 1.0) as f32 } else { 0.0 };
            let pressure: Vec<f32> = (0..columns * rows).map(value).collect();
            let mut found = vec![7.0; pressure.len()];
            let reach = |window: &Range<usize>, source: &Range<usize>| {
                (window.end - 1 - source.start).max(source.end - 1 - window.start)
            };
            let reach = [reach(&window.columns, &source.columns), reach(&window.rows, &source.rows)];
            let mut convolution = Convolution::new([window.columns.len(), window.rows.len()], reach, ratio);
            for _ in 0..2 {
                convolution.apply(&window, columns, &pressure, &mut found);
            }
            let sum = |n: usize| -> f64 {
                let of = |m: usize| {
                    kernel[(n / columns).abs_diff(m / columns) * columns + (n % columns).abs_diff(m % columns)]
                };
                (0..pressure.len()).map(|m| of(m) * f64::from(pressure[m])).sum()
            };
            let sums: Vec<f64> = (0..pressure.len()).map(sum).collect();
            let largest = sums.iter().copied().fold(0.0, f64::max);
            for (n, &u) in found.iter().enumerate() {
                if window.columns.contains(&(n % columns)) && window.rows.contains(&(n / columns)) {
                    assert!(
                        (f64::from(u) - sums[n]).abs() < 1e-6 * largest,
                        "{window:?} {source:?} {n} {u} {}",
                        sums[n]
                    );
                } else {
                    assert_eq!(u, 7.0);
                }
            }
        }
    }
}
