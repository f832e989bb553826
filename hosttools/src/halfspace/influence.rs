//! How a half-space's surface sinks under a uniformly loaded rectangle (Boussinesq; Love 1929; Johnson, Contact
//! Mechanics, 1985, eq. 3.25).

use std::cell::RefCell;
use std::f64::consts::PI;

/// The corner function of Love's solution, odd in both arguments:
///
/// ```text
/// F(x, y) = x asinh(y / x) + y asinh(x / y)
/// ```
fn corner(x: f64, y: f64) -> f64 {
    let r = (x * x + y * y).sqrt();
    x * libm::log((y + r) / x) + y * libm::log((x + r) / y)
}

/// Displacement (m/Pa times E*) at the middle of an element from unit pressure on the element `i` columns and `j` rows
/// away, for all `i < columns`, `j < rows`; edges `[along x, across]` (m). Row by row.
///
/// ```text
/// π E* u / p = F(x + a, y + b) - F(x - a, y + b) - F(x + a, y - b) + F(x - a, y - b)
/// ```
/// with half edges a, b, and 1 / E* the sum of (1 - ν²) / E of both bodies.
pub fn influence(columns: usize, rows: usize, [along, across]: [f64; 2]) -> Vec<f64> {
    let f = |i: usize, j: usize| corner((i as f64 + 0.5) * along, (j as f64 + 0.5) * across);
    let corners: Vec<f64> = (0..rows).flat_map(|j| (0..columns).map(move |i| f(i, j))).collect();
    let mut found = Vec::with_capacity(columns * rows);
    for j in 0..rows {
        for i in 0..columns {
            // F is odd: the corner before the first is the first with the sign turned.
            let at = |i: usize, j: usize| corners[j * columns + i];
            let before = |i: usize, j: usize| if i == 0 { -at(0, j) } else { at(i - 1, j) };
            let row = |j: usize| at(i, j) - before(i, j);
            let below = if j == 0 { -row(0) } else { row(j - 1) };
            found.push((row(j) - below) / PI);
        }
    }
    found
}

/// Displacements times E* over an element's width, of elements as wide as one and as long as a ratio.
#[derive(Debug)]
pub(super) struct Influence {
    ratio: f64,
    columns: usize,
    rows: usize,
    values: Vec<f32>,
}

impl Influence {
    /// The influence on elements `j` rows away.
    pub(super) fn row(&self, j: usize) -> &[f32] {
        &self.values[j * self.columns..][..self.columns]
    }
}

thread_local! {
    static KEPT: RefCell<Influence> =
        const { RefCell::new(Influence { ratio: 0.0, columns: 0, rows: 0, values: Vec::new() }) };
}

/// Shows the influence over at least so many columns and rows. All grids but the finest and smallest have elements of one
/// ratio, and F is of the first degree in both edges, so what was computed last is kept.
pub(super) fn influence_of(ratio: f64, [columns, rows]: [usize; 2], show: impl FnOnce(&Influence)) {
    KEPT.with_borrow_mut(|kept| {
        if kept.ratio != ratio {
            *kept = Influence { ratio, columns: 0, rows: 0, values: Vec::new() };
        }
        if kept.columns < columns || kept.rows < rows {
            let (columns, rows) = (columns.max(kept.columns), rows.max(kept.rows));
            let values = influence(columns, rows, [ratio, 1.0]).into_iter().map(|value| value as f32).collect();
            *kept = Influence { ratio, columns, rows, values };
        }
        show(kept);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_square_and_a_point_far_away() {
        let h = 2e-4;
        let found = influence(60, 50, [h, h]);
        // A square of edge h under unit pressure sinks by 4 h ln(1 + √2) / (π E*) in its middle (Johnson, section 3.3).
        assert!((found[0] / (4.0 * h * libm::log(1.0 + 2.0_f64.sqrt()) / PI) - 1.0).abs() < 1e-12);
        // Far away the load is a point's: h² / (π r).
        let (i, j) = (58, 40);
        let r = h * libm::hypot(i as f64, j as f64);
        assert!((found[j * 60 + i] / (h * h / (PI * r)) - 1.0).abs() < 1e-4);
    }
}
