//! Displacements of the whole grid from the pressures of the whole grid, by fast Fourier transform.
//!
//! The influence of one element on another depends on their distance alone, so the sum over elements is a convolution;
//! zero padding to twice the size keeps it from wrapping around.

use std::cell::RefCell;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use super::influence::influence;

thread_local! {
    static PLANS: RefCell<(RealFftPlanner<f64>, FftPlanner<f64>)> =
        RefCell::new((RealFftPlanner::new(), FftPlanner::new()));
}

/// The smallest even number of at least `n` without prime factors beyond 5.
fn smooth(n: usize) -> usize {
    let is_smooth = |mut m: usize| {
        for p in [2, 3, 5] {
            while m.is_multiple_of(p) {
                m /= p;
            }
        }
        m == 1
    };
    (n..).find(|&m| m.is_multiple_of(2) && is_smooth(m)).unwrap_or(n)
}

/// Convolution with the influence of unit pressure on a grid of `columns` x `rows` elements.
pub struct Convolution {
    columns: usize,
    rows: usize,
    padded_columns: usize,
    padded_rows: usize,
    /// Transform of the influence, real because the influence is even; column after column.
    spectrum: Vec<f64>,
    rows_forward: Arc<dyn RealToComplex<f64>>,
    rows_back: Arc<dyn ComplexToReal<f64>>,
    columns_forward: Arc<dyn Fft<f64>>,
    columns_back: Arc<dyn Fft<f64>>,
    work: Vec<Complex64>,
    scratch: Vec<Complex64>,
    real: Vec<f64>,
    half: Vec<Complex64>,
}

impl Convolution {
    /// For elements with these edges `[along x, across]` (m).
    pub fn new(columns: usize, rows: usize, edges: [f64; 2]) -> Self {
        let (padded_columns, padded_rows) = (smooth(2 * columns - 1), smooth(2 * rows - 1));
        let (rows_forward, rows_back, columns_forward, columns_back) = PLANS.with_borrow_mut(|(real, complex)| {
            (
                real.plan_fft_forward(padded_columns),
                real.plan_fft_inverse(padded_columns),
                complex.plan_fft_forward(padded_rows),
                complex.plan_fft_inverse(padded_rows),
            )
        });
        let width = padded_columns / 2 + 1;
        let zero = Complex64::new(0.0, 0.0);
        let scratch = columns_forward.get_inplace_scratch_len().max(columns_back.get_inplace_scratch_len());
        let mut convolution = Self {
            columns,
            rows,
            padded_columns,
            padded_rows,
            spectrum: Vec::new(),
            rows_forward,
            rows_back,
            columns_forward,
            columns_back,
            work: vec![zero; width * padded_rows],
            scratch: vec![zero; scratch],
            real: vec![0.0; padded_columns],
            half: vec![zero; width],
        };
        convolution.transform_influence(&influence(columns, rows, edges));
        convolution
    }

    fn transform_influence(&mut self, influence: &[f64]) {
        let (width, height) = (self.half.len(), self.padded_rows);
        for j in 0..self.rows {
            let row = &influence[j * self.columns..][..self.columns];
            self.real.fill(0.0);
            self.real[..self.columns].copy_from_slice(row);
            for (place, value) in self.real.iter_mut().rev().zip(&row[1..]) {
                *place = *value;
            }
            self.forward_row(j);
            if j > 0 {
                for k in 0..width {
                    self.work[k * height + height - j] = self.work[k * height + j];
                }
            }
        }
        self.columns_forward.process_with_scratch(&mut self.work, &mut self.scratch);
        let scale = 1.0 / (self.padded_columns * self.padded_rows) as f64;
        self.spectrum = self.work.iter().map(|c| c.re * scale).collect();
    }

    /// Transforms the row that stands in `real` into row `j` of the transposed work space.
    fn forward_row(&mut self, j: usize) {
        let done = self.rows_forward.process(&mut self.real, &mut self.half);
        debug_assert!(done.is_ok(), "lengths are the plan's");
        for (k, value) in self.half.iter().enumerate() {
            self.work[k * self.padded_rows + j] = *value;
        }
    }

    /// Displacements times E* (m Pa) from pressures (Pa), row by row.
    pub fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.work.fill(Complex64::new(0.0, 0.0));
        for (j, row) in pressure.chunks_exact(self.columns).enumerate() {
            if row.iter().all(|&p| p == 0.0) {
                continue;
            }
            self.real.fill(0.0);
            self.real[..self.columns].copy_from_slice(row);
            self.forward_row(j);
        }
        self.columns_forward.process_with_scratch(&mut self.work, &mut self.scratch);
        for (value, factor) in self.work.iter_mut().zip(&self.spectrum) {
            *value *= factor;
        }
        self.columns_back.process_with_scratch(&mut self.work, &mut self.scratch);
        let last = self.half.len() - 1;
        for (j, row) in displacement.chunks_exact_mut(self.columns).enumerate() {
            for (k, value) in self.half.iter_mut().enumerate() {
                *value = self.work[k * self.padded_rows + j];
            }
            // Real input: what rounding leaves in these two is no information.
            self.half[0].im = 0.0;
            self.half[last].im = 0.0;
            let done = self.rows_back.process(&mut self.half, &mut self.real);
            debug_assert!(done.is_ok(), "lengths are the plan's");
            row.copy_from_slice(&self.real[..self.columns]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_as_the_sum_over_all_elements() {
        let (columns, rows, edges) = (13, 9, [2e-4, 3e-4]);
        let kernel = influence(columns, rows, edges);
        let pressure: Vec<f64> = (0..columns * rows).map(|i| libm::sin(i as f64) + 1.0).collect();
        let mut found = vec![0.0; pressure.len()];
        Convolution::new(columns, rows, edges).apply(&pressure, &mut found);
        for (n, &u) in found.iter().enumerate() {
            let (i, j) = (n % columns, n / columns);
            let part = |m: usize| kernel[j.abs_diff(m / columns) * columns + i.abs_diff(m % columns)] * pressure[m];
            let sum: f64 = (0..pressure.len()).map(part).sum();
            assert!((u / sum - 1.0).abs() < 1e-12, "{u} {sum}");
        }
    }
}
