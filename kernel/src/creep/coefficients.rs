//! Kalker's creep coefficients.

use crate::math::{Four, Number};

/// Kalker's creep coefficients C_ij of an elliptic contact.
///
/// Table of J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), appendix E, for a/b from 0.1 to 10
/// and ν from 0 to 0.5. Beyond that the edge holds.
///
/// **Interpolation**: the flexibilities 1/C are linear in ν between the printed columns (Kalker's rule), and linear in
/// the printed ratio, a/b up to one and b/a beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// C11, longitudinal force by longitudinal creepage.
    pub c11: f32,
    /// C22, lateral force by lateral creepage.
    pub c22: f32,
    /// C23 = -C32, lateral force by spin and spin moment by lateral creepage.
    pub c23: f32,
}

/// Rows of the table: a/b = 0.1, 0.2 to 1, then b/a = 0.9, 0.8 to 0.1.
const ROWS: usize = 19;

/// C11, C22, C23, each at ν = 0, 0.25 and 0.5.
#[expect(clippy::approx_constant, reason = "3.14 as printed is no π")]
const TABLE: [[[f32; 3]; 3]; ROWS] = [
    [[2.51, 3.31, 4.85], [2.51, 2.52, 2.53], [0.334, 0.473, 0.731]],
    [[2.59, 3.37, 4.81], [2.59, 2.63, 2.66], [0.483, 0.603, 0.809]],
    [[2.68, 3.44, 4.80], [2.68, 2.75, 2.81], [0.607, 0.715, 0.889]],
    [[2.78, 3.53, 4.82], [2.78, 2.88, 2.98], [0.720, 0.823, 0.977]],
    [[2.88, 3.62, 4.83], [2.88, 3.01, 3.14], [0.827, 0.929, 1.07]],
    [[2.98, 3.72, 4.91], [2.98, 3.14, 3.31], [0.930, 1.03, 1.18]],
    [[3.09, 3.81, 4.97], [3.09, 3.28, 3.48], [1.03, 1.14, 1.29]],
    [[3.19, 3.91, 5.05], [3.19, 3.41, 3.65], [1.13, 1.25, 1.40]],
    [[3.29, 4.01, 5.12], [3.29, 3.54, 3.82], [1.23, 1.36, 1.51]],
    [[3.40, 4.12, 5.20], [3.40, 3.67, 3.98], [1.33, 1.47, 1.63]],
    [[3.51, 4.22, 5.30], [3.51, 3.81, 4.16], [1.44, 1.59, 1.77]],
    [[3.65, 4.36, 5.42], [3.65, 3.99, 4.39], [1.58, 1.75, 1.94]],
    [[3.82, 4.54, 5.58], [3.82, 4.21, 4.67], [1.76, 1.95, 2.18]],
    [[4.06, 4.78, 5.80], [4.06, 4.50, 5.04], [2.01, 2.23, 2.50]],
    [[4.37, 5.10, 6.11], [4.37, 4.90, 5.56], [2.35, 2.62, 2.96]],
    [[4.84, 5.57, 6.57], [4.84, 5.48, 6.31], [2.88, 3.24, 3.70]],
    [[5.57, 6.34, 7.34], [5.57, 6.40, 7.51], [3.79, 4.32, 5.01]],
    [[6.96, 7.78, 8.82], [6.96, 8.14, 9.79], [5.72, 6.63, 7.89]],
    [[10.7, 11.7, 12.9], [10.7, 12.8, 16.0], [12.2, 14.6, 18.0]],
];

/// 1/C11, 1/C22, 1/C23 and none, at the rows and columns of the table.
static FLEXIBILITIES: [[[f32; 4]; 3]; ROWS] = flexibilities();

#[expect(clippy::indexing_slicing, reason = "at compile time")]
const fn flexibilities() -> [[[f32; 4]; 3]; ROWS] {
    let mut all = [[[0.0; 4]; 3]; ROWS];
    let mut i = 0;
    while i < 9 * ROWS {
        let (row, column, kind) = (i / 9, i / 3 % 3, i % 3);
        all[row][column][kind] = 1.0 / TABLE[row][kind][column];
        i += 1;
    }
    all
}

/// Place in the table's columns.
#[derive(Clone, Copy)]
pub(super) struct Column {
    first: usize,
    share: Four,
}

impl Column {
    #[inline(always)]
    pub(super) fn of(poisson_ratio: f32) -> Self {
        let (whole, share) = interval(4.0 * poisson_ratio, 1.0);
        Self { first: integer(whole).min(1), share: Four::all(share) }
    }

    /// 1/C11, 1/C22, 1/C23 and none at an interval of rows and the place in it:
    ///
    /// ```text
    /// 1/C = Σ w_ij / C_ij
    /// ```
    #[inline(always)]
    pub(super) fn flexibilities(self, (whole, share): (f32, f32)) -> Four {
        let row = integer(whole).min(ROWS - 2);
        let at = |i: usize, j: usize| {
            Four::load(FLEXIBILITIES.get(row + i).and_then(|row| row.get(self.first + j)).unwrap_or(&[1.0; 4]))
        };
        let between = |left: Four, right: Four, share: Four| left + share * (right - left);
        let (left, right) = (between(at(0, 0), at(0, 1), self.share), between(at(1, 0), at(1, 1), self.share));
        between(left, right, Four::all(share))
    }
}

/// Interval of the table's rows, and the place in it, by a/b and b/a: in steps of the rows 10 a/b - 1, and 19 - 10 b/a
/// beyond one.
#[inline(always)]
pub(super) fn along<N: Number>(ratio: N, inverse: N) -> (N, N) {
    let ten = |x: N| N::all(10.0) * x.no_more(N::all(1.0));
    interval((ten(ratio) - ten(inverse)) + N::all(9.0), 17.0)
}

/// 2^23: the least number above which `f32` are whole.
const WHOLE: f32 = 8_388_608.0;

/// The interval of a uniform axis, at most the last one and as [`integer`] takes it, and the place in it from 0 to 1. Between
/// two intervals either will do.
#[inline(always)]
fn interval<N: Number>(x: N, last: f32) -> (N, N) {
    let all = N::all;
    let x = x.no_less(all(0.0)).no_more(all(last + 1.0));
    let whole = (x - all(0.5)).no_less(all(0.0)).no_more(all(last)) + all(WHOLE);
    (whole, x - (whole - all(WHOLE)))
}

/// The whole number of an interval: the last bits of the sum with [`WHOLE`].
#[inline(always)]
fn integer(whole: f32) -> usize {
    (whole.to_bits() & 31) as usize
}

impl Coefficients {
    /// Coefficients at the ratio a/b of the semi-axes and at Poisson's ratio.
    #[inline]
    #[must_use]
    pub fn of(ratio: f32, poisson_ratio: f32) -> Self {
        let along = along(ratio, 1.0 / ratio);
        let [c11, c22, c23, _] = (Four::all(1.0) / Column::of(poisson_ratio).flexibilities(along)).numbers();
        Self { c11, c22, c23 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a/b of a row.
    #[expect(clippy::cast_precision_loss, reason = "0 to 18")]
    fn ratio(row: usize) -> f32 {
        let step = 0.1 * (row as f32 + 1.0);
        if row < 10 { step } else { 1.0 / (2.0 - step) }
    }

    #[test]
    fn the_printed_rows_and_columns_come_back() {
        for (row, printed) in TABLE.iter().enumerate() {
            for (column, poisson_ratio) in [0.0, 0.25, 0.5].into_iter().enumerate() {
                let c = Coefficients::of(ratio(row), poisson_ratio);
                for (interpolated, printed) in [c.c11, c.c22, c.c23].into_iter().zip(printed.map(|c| c[column])) {
                    assert!((interpolated / printed - 1.0).abs() < 1e-5, "row {row}: {interpolated}, {printed}");
                }
            }
        }
    }

    #[test]
    fn growing_with_the_ratio_and_held_at_the_edges() {
        let mut last = Coefficients::of(0.1, 0.28);
        for i in 1_u16..=2000 {
            // Logarithmic from 0.1 to 10.
            let next = Coefficients::of(0.1 * libm::powf(100.0, f32::from(i) / 2000.0), 0.28);
            assert!(next.c11 >= last.c11 && next.c22 >= last.c22 && next.c23 >= last.c23);
            last = next;
        }
        assert_eq!(Coefficients::of(0.01, 0.28), Coefficients::of(0.1, 0.28));
        assert_eq!(Coefficients::of(1000.0, -1.0).c22, Coefficients::of(10.0, 0.0).c22);
        assert_eq!(Coefficients::of(1.0, 0.7), Coefficients::of(1.0, 0.5));
    }

    #[test]
    fn a_row_left_out_is_met_from_its_neighbours() {
        // Interpolation over twice the table's step errs about four times as much as over one.
        let mut worst = [[0.0_f32; 3]; 2];
        for row in 1..ROWS - 1 {
            // Rows from a/b = 0.2 to 5 with both their neighbours, and the rest.
            let rest = usize::from(!(2..=ROWS - 3).contains(&row));
            for (kind, worst) in worst[rest].iter_mut().enumerate() {
                let [before, left_out, after] = [row - 1, row, row + 1].map(|row| TABLE[row][kind]);
                for ((before, left_out), after) in before.into_iter().zip(left_out).zip(after) {
                    let met = 2.0 / (1.0 / before + 1.0 / after);
                    *worst = worst.max((met / left_out - 1.0).abs());
                }
            }
        }
        std::println!("left-out rows, a/b = 0.2 to 5 and the ends: {worst:.3?}");
        assert!(worst[0].iter().all(|w| *w < 0.05) && worst[1].iter().all(|w| *w < 0.11));
    }
}
