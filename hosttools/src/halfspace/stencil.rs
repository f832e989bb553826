//! A cheap, rough inverse of the influence, with which conjugate gradients need half as many steps.
//!
//! The half-space's own inverse falls off with the third power of the distance, so an element and its near neighbours
//! have most of it: what is to be pressed so that, of a square of elements, the middle one alone sinks. The numbers
//! stand for a convolution, and where the middle outweighs all others together that is positive whatever elements take
//! part.

use super::convolution::Window;
use super::influence::influence;

/// Neighbours to each side.
const REACH: usize = 2;
const WIDTH: usize = 2 * REACH + 1;
const COUNT: usize = WIDTH * WIDTH;

/// Pressures of an element's neighbourhood that move its middle by a unit: of the element, of its neighbours one and two
/// columns away, and the same one and two rows away. Elements are as wide (across) as one and as long as a ratio.
#[derive(Debug, Clone)]
pub(super) struct Stencil {
    values: [[f32; REACH + 1]; REACH + 1],
}

impl Stencil {
    pub(super) fn new(ratio: f64) -> Self {
        let influence = influence(WIDTH, WIDTH, [ratio, 1.0]);
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
        let value = |j: usize, i: usize| values[(REACH + j) * WIDTH + REACH + i] as f32;
        Self { values: std::array::from_fn(|j| std::array::from_fn(|i| value(j, i))) }
    }

    /// What roughly moves every element of a window by `gap`, into `found`; `gap` is nothing outside of the window.
    pub(super) fn apply(&self, window: &Window, columns: usize, gap: &[f32], found: &mut [f32]) {
        let width = window.columns.len();
        // Sums of the rows at each distance, with so many columns of nothing to each side.
        let mut sums = [(); REACH + 1].map(|()| vec![0.0_f32; width + 2 * REACH]);
        let row = |j: usize| &gap[j * columns..][window.columns.clone()];
        for j in window.rows.clone() {
            for (away, sums) in sums.iter_mut().enumerate() {
                let sums = &mut sums[REACH..][..width];
                let (above, below) = (j.checked_sub(away), j + away);
                let above = above.filter(|j| *j >= window.rows.start);
                match (above, below < window.rows.end) {
                    (Some(above), _) if away == 0 => sums.copy_from_slice(row(above)),
                    (Some(above), true) => {
                        sums.iter_mut().zip(row(above)).zip(row(below)).for_each(|((s, a), b)| *s = a + b);
                    }
                    (Some(one), false) => sums.copy_from_slice(row(one)),
                    (None, true) => sums.copy_from_slice(row(below)),
                    (None, false) => sums.fill(0.0),
                }
            }
            let found = &mut found[j * columns..][window.columns.clone()];
            found.fill(0.0);
            for (sums, [own, next, far]) in sums.iter().zip(&self.values) {
                let at = |i: usize| &sums[i..][..width];
                let near = at(1).iter().zip(at(3));
                for (((z, s), (a, b)), (c, d)) in found.iter_mut().zip(at(2)).zip(near).zip(at(0).iter().zip(at(4))) {
                    *z += own * s + next * (a + b) + far * (c + d);
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
            let Stencil { values } = Stencil::new(ratio);
            let count = |n: usize| if n == 0 { 1.0 } else { 2.0 };
            let all: f32 = (0..COUNT)
                .filter(|n| n % WIDTH <= REACH && n / WIDTH <= REACH)
                .map(|n| (n / WIDTH, n % WIDTH))
                .map(|(j, i)| count(j) * count(i) * values[j][i].abs())
                .sum();
            assert!(all < 2.0 * values[0][0], "{ratio}: {values:?}");
        }
    }

    #[test]
    fn a_single_element_gives_the_stencil() {
        let stencil = Stencil::new(1.5);
        let (columns, rows) = (9, 8);
        let window = Window { columns: 1..8, rows: 1..7 };
        let mut gap = vec![0.0; columns * rows];
        gap[3 * columns + 5] = 1.0;
        let mut found = vec![0.0; gap.len()];
        stencil.apply(&window, columns, &gap, &mut found);
        for (n, found) in found.iter().enumerate() {
            let inside = window.columns.contains(&(n % columns)) && window.rows.contains(&(n / columns));
            let (i, j) = ((n % columns).abs_diff(5), (n / columns).abs_diff(3));
            let expected = if i > REACH || j > REACH || !inside { 0.0 } else { stencil.values[j][i] };
            assert!((found - expected).abs() < 1e-6 * stencil.values[0][0]);
        }
    }
}
