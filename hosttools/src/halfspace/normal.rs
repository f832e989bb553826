//! The normal contact problem: where the surfaces meet and with what pressure.
//!
//! With w the undeformed overlap and u = K p the elastic displacement, both pressure and gap are nowhere negative and
//! nowhere both positive:
//!
//! ```text
//! p ≥ 0,   e = K p - w ≥ 0,   p e = 0
//! ```
//! (the problem and its variational form: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, chapter 4).
//! Active sets as in his NORM, but each only as well as it deserves: conjugate gradients, preconditioned by a stencil,
//! close the gaps of the elements that take part to a fifth; then those that pull leave, those that overlap join, and
//! the gaps are computed anew. One displacement of the grid a step, where conjugate gradients with a projection in each
//! step (Polonsky and Keer, Wear 231, 1999, 206-219) need two as long as the set changes. A preconditioner for bound-
//! constrained conjugate gradients: Vollebregt, J. Comput. Phys. 257, 2014, 333-351.

use super::Stencil;

/// Largest share of the greatest overlap by which an element may miss the contact condition.
pub const TOLERANCE: f64 = 1e-5;

/// Steps after which the search ends at the latest.
const MOST_STEPS: usize = 400;

/// What is left of the largest gap before the set of elements is looked at again.
const LEFT: f64 = 0.2;

/// Solves for the pressure divided by E*, from a first guess in `pressure`, and returns the number of steps: how many
/// displacements of the grid were computed.
///
/// `apply` gives displacements from pressures divided by E*, `stencil` is a rough inverse of it; `tolerance` as
/// [`TOLERANCE`]. An element without overlap takes no pressure: displacements are positive everywhere, so it cannot touch.
pub fn solve(
    mut apply: impl FnMut(&[f64], &mut [f64]),
    stencil: &Stencil,
    columns: usize,
    overlap: &[f64],
    pressure: &mut [f64],
    tolerance: f64,
) -> usize {
    let goal = tolerance * overlap.iter().copied().fold(0.0, f64::max);
    let zeros = || vec![0.0; overlap.len()];
    let (mut gap, mut left, mut towards, mut direction, mut moved) = (zeros(), zeros(), zeros(), zeros(), zeros());
    let mut steps = 0;
    while steps < MOST_STEPS {
        for (p, &w) in pressure.iter_mut().zip(overlap) {
            *p = if w > 0.0 { p.max(0.0) } else { 0.0 };
        }
        apply(pressure, &mut gap);
        steps += 1;
        // `left` is the gap of the elements that take part: those under pressure and those that overlap.
        let mut worst = 0.0_f64;
        for (((e, r), p), &w) in gap.iter_mut().zip(&mut left).zip(&*pressure).zip(overlap) {
            *e -= w;
            *r = if *p > 0.0 || (w > 0.0 && *e < 0.0) { *e } else { 0.0 };
            worst = worst.max(r.abs());
        }
        if worst <= goal {
            break;
        }
        let enough = (LEFT * worst).max(0.9 * goal);
        let taking_part = |r: f64, value: f64| if r == 0.0 { 0.0 } else { value };
        direction.fill(0.0);
        let mut earlier = f64::INFINITY;
        while worst > enough && steps < MOST_STEPS {
            stencil.apply(columns, &left, &mut towards);
            let product = dot(&left, &towards);
            for ((t, z), &r) in direction.iter_mut().zip(&towards).zip(&left) {
                *t = taking_part(r, z + product / earlier * *t);
            }
            earlier = product;
            apply(&direction, &mut moved);
            steps += 1;
            let length = product / dot(&direction, &moved);
            worst = 0.0;
            for (((p, r), t), m) in pressure.iter_mut().zip(&mut left).zip(&direction).zip(&moved) {
                *p -= length * t;
                *r = taking_part(*r, *r - length * m);
                worst = worst.max(r.abs());
            }
        }
    }
    steps
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
