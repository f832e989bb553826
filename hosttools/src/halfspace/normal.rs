//! The normal contact problem: where the surfaces meet and with what pressure.
//!
//! With w the undeformed overlap and u = K p the elastic displacement, both pressure and gap are nowhere negative and
//! nowhere both positive:
//!
//! ```text
//! p ≥ 0,   e = K p - w ≥ 0,   p e = 0
//! ```
//! Conjugate gradients with projection (Polonsky and Keer, Wear 231, 1999, 206-219; the problem and its variational
//! form: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, chapter 4). The rigid approach is given
//! here, so their steps that hold a given load fall away.

/// Largest share of the greatest overlap by which an element may miss the contact condition.
pub const TOLERANCE: f64 = 1e-5;

/// Steps after which the search ends at the latest.
const MOST_STEPS: usize = 400;

/// Solves for the pressure divided by E*, from a first guess in `pressure`, and returns the number of steps.
///
/// `apply` gives displacements from pressures divided by E*; `own` is what it gives an element under unit pressure alone.
/// An element without overlap takes no pressure: displacements are positive everywhere, so it cannot touch.
pub fn solve(mut apply: impl FnMut(&[f64], &mut [f64]), own: f64, overlap: &[f64], pressure: &mut [f64]) -> usize {
    let greatest = overlap.iter().copied().fold(0.0, f64::max);
    let mut gap = vec![0.0; overlap.len()];
    let mut direction = vec![0.0; overlap.len()];
    let mut moved = vec![0.0; overlap.len()];
    for (p, &w) in pressure.iter_mut().zip(overlap) {
        *p = if w > 0.0 { p.max(0.0) } else { 0.0 };
    }
    let below = |gap: &mut [f64]| gap.iter_mut().zip(overlap).for_each(|(e, w)| *e -= w);
    apply(pressure, &mut gap);
    below(&mut gap);
    let mut earlier = 0.0;
    for step in 0..MOST_STEPS {
        // Elements without pressure that overlap join, by their own stiffness alone.
        let mut changed = false;
        let (mut squares, mut worst) = (0.0, 0.0_f64);
        for ((p, e), w) in pressure.iter().zip(&gap).zip(overlap) {
            if *p > 0.0 {
                squares += e * e;
                worst = worst.max(e.abs());
            } else if *w > 0.0 {
                worst = worst.max(-e);
            }
        }
        if worst <= TOLERANCE * greatest {
            return step;
        }
        let beta = if earlier > 0.0 { squares / earlier } else { 0.0 };
        for ((t, p), e) in direction.iter_mut().zip(pressure.iter()).zip(&gap) {
            *t = if *p > 0.0 { e + beta * *t } else { 0.0 };
        }
        let (mut up, mut down) = (0.0, 0.0);
        if squares > 0.0 {
            // K t: what the gaps would be without overlap.
            apply(&direction, &mut moved);
            for ((e, t), r) in gap.iter().zip(&direction).zip(&moved) {
                up += e * t;
                down += r * t;
            }
        }
        let length = if down > 0.0 { up / down } else { 0.0 };
        for ((p, t), w) in pressure.iter_mut().zip(&direction).zip(overlap) {
            if *p > 0.0 && *w > 0.0 {
                *p -= length * t;
                if *p <= 0.0 {
                    *p = 0.0;
                    changed = true;
                }
            }
        }
        for (e, r) in gap.iter_mut().zip(&moved) {
            *e -= length * r;
        }
        let scale = if length > 0.0 { length } else { own.recip() };
        let mut joined = false;
        for ((p, e), w) in pressure.iter_mut().zip(&gap).zip(overlap) {
            if *p == 0.0 && *w > 0.0 && *e < 0.0 {
                *p = -scale * e;
                joined = true;
            }
        }
        if changed || joined {
            apply(pressure, &mut gap);
            below(&mut gap);
        }
        earlier = if joined { 0.0 } else { squares };
    }
    MOST_STEPS
}
