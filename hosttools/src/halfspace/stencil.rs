//! A cheap, rough inverse of the influence, with which conjugate gradients need half as many steps.
//!
//! The half-space's own inverse falls off with the third power of the distance, so an element and its near neighbours
//! have most of it: what is to be pressed so that, of a square of elements, the middle one alone sinks. The numbers
//! stand for a convolution, and where the middle outweighs all others together that is positive whatever elements take
//! part.

use super::influence::influence;

/// Neighbours to each side.
const REACH: usize = 2;
const WIDTH: usize = 2 * REACH + 1;
const COUNT: usize = WIDTH * WIDTH;

/// Pressures times 1 / E* (1/m) of an element's neighbourhood, row by row, that move its middle by a unit.
#[derive(Debug, Clone)]
pub struct Stencil {
    values: [f64; COUNT],
}

impl Stencil {
    /// For elements with these edges `[along x, across]` (m).
    pub fn new(edges: [f64; 2]) -> Self {
        let influence = influence(WIDTH, WIDTH, edges);
        let of =
            |n: usize, m: usize| influence[(n / WIDTH).abs_diff(m / WIDTH) * WIDTH + (n % WIDTH).abs_diff(m % WIDTH)];
        // Conjugate gradients on the small full matrix.
        let mut values = [0.0; COUNT];
        let mut left = [0.0; COUNT];
        left[COUNT / 2] = 1.0;
        let (mut direction, mut squares) = (left, 1.0);
        for _ in 0..COUNT {
            let moved: [f64; COUNT] = std::array::from_fn(|n| (0..COUNT).map(|m| of(n, m) * direction[m]).sum());
            let length = squares / dot(&direction, &moved);
            for (value, t) in values.iter_mut().zip(&direction) {
                *value += length * t;
            }
            for (left, m) in left.iter_mut().zip(&moved) {
                *left -= length * m;
            }
            let earlier = std::mem::replace(&mut squares, dot(&left, &left));
            if squares < 1e-12 {
                break;
            }
            for (direction, left) in direction.iter_mut().zip(&left) {
                *direction = left + squares / earlier * *direction;
            }
        }
        Self { values }
    }

    /// What roughly moves every element of a grid with so many columns by `gap`, into `found`.
    pub fn apply(&self, columns: usize, gap: &[f64], found: &mut [f64]) {
        let rows = gap.len() / columns;
        for (j, found) in found.chunks_exact_mut(columns).enumerate() {
            found.fill(0.0);
            for (from, values) in
                (j.saturating_sub(REACH)..).zip(self.values.chunks_exact(WIDTH).skip(REACH.saturating_sub(j)))
            {
                if from >= rows {
                    break;
                }
                let row = &gap[from * columns..][..columns];
                for (i, &value) in values.iter().enumerate() {
                    let (to, from) = (REACH.saturating_sub(i).min(columns), i.saturating_sub(REACH).min(columns));
                    found[to..].iter_mut().zip(&row[from..]).for_each(|(z, r)| *z += value * r);
                }
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_outweighs_all_others() {
        for ratio in [0.1, 0.5, 1.0, 2.0, 10.0] {
            let Stencil { values } = Stencil::new([2e-4, 2e-4 * ratio]);
            let others: f64 = values.iter().map(|v| v.abs()).sum::<f64>() - values[COUNT / 2];
            assert!(others < values[COUNT / 2], "{ratio}: {values:?}");
        }
    }

    #[test]
    fn a_single_element_gives_the_stencil() {
        let stencil = Stencil::new([3e-4, 2e-4]);
        let (columns, rows) = (7, 6);
        let mut gap = vec![0.0; columns * rows];
        gap[3 * columns + 4] = 1.0;
        let mut found = vec![0.0; gap.len()];
        stencil.apply(columns, &gap, &mut found);
        for (n, found) in found.iter().enumerate() {
            let (i, j) = ((n % columns).abs_diff(4), (n / columns).abs_diff(3));
            let expected = if i > REACH || j > REACH { 0.0 } else { stencil.values[(REACH + j) * WIDTH + REACH + i] };
            assert!((found - expected).abs() < 1e-9 * stencil.values[COUNT / 2]);
        }
    }
}
