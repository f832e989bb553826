//! Faster fixed-point iterations.

use super::eliminate;

/// Earlier rounds that are remembered.
const DEPTH: usize = 3;
/// Growth of |f| at which they are forgotten: strips have come in or dropped out, and the model is of another function.
const FORGET: f64 = 1.5;
/// Largest step.
const LARGEST: f64 = 1.0;

/// Anderson's mixing (J. ACM 12, 1965, 547-560): of x = g(x), the next x is where a linear model through the last rounds
/// says that nothing changes any more.
///
/// ```text
/// f = g(x) - x,   γ = arg min |f - Σ γ_i Δf_i|,   x' = g(x) - Σ γ_i Δg_i
/// ```
#[derive(Default)]
pub(super) struct Mixing {
    /// f and g of the last round.
    last: Option<[Vec<f64>; 2]>,
    /// Changes of f and g, the latest last.
    changes: Vec<[Vec<f64>; 2]>,
    /// |f| of the last round.
    size: f64,
}

impl Mixing {
    /// Replaces `x` by the next; `weights` say what counts in |f|. Returns |f|, the root of the weighted mean square.
    pub(super) fn advance(&mut self, x: &mut [f64], g: Vec<f64>, weights: &[f64]) -> f64 {
        let f: Vec<f64> = g.iter().zip(&*x).map(|(g, x)| g - x).collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(weights).map(|((a, b), w)| w * a * b).sum::<f64>();
        let size = (product(&f, &f) / weights.iter().sum::<f64>()).sqrt();
        if size > FORGET * self.size {
            self.changes.clear();
            self.last = None;
        }
        self.size = size;
        if let Some(last) = &self.last {
            let less = |now: &[f64], then: &[f64]| now.iter().zip(then).map(|(a, b)| a - b).collect::<Vec<f64>>();
            self.changes.push([less(&f, &last[0]), less(&g, &last[1])]);
            if self.changes.len() > DEPTH {
                self.changes.remove(0);
            }
        }
        let m = self.changes.len();
        let mut matrix = vec![0.0; m * m];
        for (i, [a, _]) in self.changes.iter().enumerate() {
            for (j, [b, _]) in self.changes.iter().enumerate() {
                matrix[i * m + j] = product(a, b);
            }
            matrix[i * m + i] *= 1.0 + 1e-10;
        }
        let mut shares: Vec<f64> = self.changes.iter().map(|[change, _]| product(change, &f)).collect();
        eliminate(&mut matrix, &mut shares, m);
        let mut next = g.clone();
        if shares.iter().all(|share| share.is_finite()) {
            for (share, [_, change]) in shares.iter().zip(&self.changes) {
                next.iter_mut().zip(change).for_each(|(x, c)| *x -= share * c);
            }
        }
        for (x, next) in x.iter_mut().zip(next) {
            *x += (next - *x).clamp(-LARGEST, LARGEST);
        }
        self.last = Some([f, g]);
        size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spiral_is_solved_in_a_few_rounds() {
        // Its own rounds shrink the error by 7 % each.
        let g = |x: &[f64]| vec![0.4 * x[0] - 0.84 * x[1] + 0.1, 0.84 * x[0] + 0.4 * x[1] + 0.2, 0.9 * x[2] + 0.03];
        let mut x = vec![0.0; 3];
        let mut mixing = Mixing::default();
        let sizes: Vec<f64> = (0..9)
            .map(|_| {
                let next = g(&x);
                mixing.advance(&mut x, next, &[1.0, 1.0, 1.0])
            })
            .collect();
        assert!(sizes[8] < 1e-6, "{sizes:?}");
    }
}
