//! Least squares over the node values of a table: conjugate gradients on the normal equations, never formed.
//!
//! Sums run in the order of the poses on one thread, so the result does not depend on the number of threads.

use flangeway::SLOTS;

use crate::compile::stencil::{Beyond, Place, Stencil, blend};

/// Node values of one channel, all slots.
pub(super) type Values = Vec<[f64; SLOTS]>;

/// What a pose says of one slot: gain * change should be the target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gain {
    pub(super) gain: f64,
    pub(super) target: f64,
}

impl Gain {
    /// A pose that says nothing.
    pub(super) const NONE: Self = Self { gain: 0.0, target: 0.0 };
}

/// The sum of squares to minimise, with r_slot = gain * change - target:
///
/// ```text
/// total² (Σ_slots r_slot)² + each² Σ_slots r_slot²
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct Objective {
    pub(super) total: f64,
    pub(super) each: f64,
}

/// Steps of the conjugate gradients: the error of tables of 0.5 to 1 MB is the same after 15, 30 and 200.
const STEPS: usize = 15;
/// Weight of the sampled value, in mean weights of a pose.
const RIDGE: f64 = 1e-2;

/// The change of node values that minimises the objective over the places.
pub(super) fn fit(
    stencil: &Stencil,
    places: &[Place],
    gains: &[[Gain; SLOTS]],
    objective: Objective,
    beyond: Beyond,
) -> Values {
    let (total2, each2) = (objective.total.powi(2), objective.each.powi(2));
    let said = || places.iter().zip(gains).filter(|(_, gains)| gains.iter().any(|g| g.gain != 0.0));
    // Right-hand side, diagonal of the normal equations, and the mean weight of a pose.
    let mut residual = vec![[0.0; SLOTS]; stencil.nodes()];
    let mut diagonal = vec![[0.0; SLOTS]; stencil.nodes()];
    let (mut weights, mut counts) = ([0.0; SLOTS], [0.0_f64; SLOTS]);
    for (place, gains) in said() {
        let sum: f64 = gains.iter().map(|g| g.target).sum();
        for (node, w) in stencil.corners(place, beyond) {
            for (slot, g) in gains.iter().enumerate() {
                residual[node][slot] += w * g.gain * (total2 * sum + each2 * g.target);
                diagonal[node][slot] += w * w * g.gain * g.gain * (total2 + each2);
            }
        }
        for (slot, g) in gains.iter().enumerate().filter(|(_, g)| g.gain != 0.0) {
            weights[slot] += g.gain * g.gain * (total2 + each2);
            counts[slot] += 1.0;
        }
    }
    let ridge: [f64; SLOTS] =
        std::array::from_fn(|slot| if weights[slot] > 0.0 { RIDGE * weights[slot] / counts[slot] } else { 1.0 });
    for d in &mut diagonal {
        (0..SLOTS).for_each(|slot| d[slot] += ridge[slot]);
    }
    let apply = |x: &[[f64; SLOTS]]| {
        let mut out: Values = x.iter().map(|x| std::array::from_fn(|slot| ridge[slot] * x[slot])).collect();
        for (place, gains) in said() {
            let corners = stencil.corners(place, beyond);
            let change = blend(&corners, x);
            let moved: [f64; SLOTS] = std::array::from_fn(|slot| gains[slot].gain * change[slot]);
            let sum: f64 = moved.iter().sum();
            for (node, w) in corners {
                for (slot, g) in gains.iter().enumerate() {
                    out[node][slot] += w * g.gain * (total2 * sum + each2 * moved[slot]);
                }
            }
        }
        out
    };
    conjugate_gradients(residual, &diagonal, apply)
}

fn dot(a: &[[f64; SLOTS]], b: &[[f64; SLOTS]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

/// Solves A x = b with the diagonal as preconditioner, from x = 0.
fn conjugate_gradients(b: Values, diagonal: &Values, apply: impl Fn(&[[f64; SLOTS]]) -> Values) -> Values {
    let preconditioned = |r: &Values| -> Values {
        r.iter().zip(diagonal).map(|(r, d)| std::array::from_fn(|slot| r[slot] / d[slot])).collect()
    };
    let add = |to: &mut Values, factor: f64, what: &Values| {
        for (to, what) in to.as_flattened_mut().iter_mut().zip(what.as_flattened()) {
            *to += factor * what;
        }
    };
    let mut x: Values = vec![[0.0; SLOTS]; b.len()];
    let mut residual = b;
    let mut z = preconditioned(&residual);
    let mut direction = z.clone();
    let mut product = dot(&residual, &z);
    let enough = 1e-12 * product;
    for _ in 0..STEPS {
        if product <= enough {
            break;
        }
        let image = apply(&direction);
        let step = product / dot(&direction, &image);
        add(&mut x, step, &direction);
        add(&mut residual, -step, &image);
        z = preconditioned(&residual);
        let next = dot(&residual, &z);
        let mut turned = z.clone();
        add(&mut turned, next / product, &direction);
        (direction, product) = (turned, next);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::axes::Axes;

    const INTERVALS: usize = 40;

    /// Places all along the lateral axis, in the middle of the other three, and the grid they are in.
    fn along_lateral() -> (Stencil, Vec<Place>, Vec<f64>) {
        let lateral: Vec<f64> = (0..=INTERVALS).map(|i| i as f64).collect();
        let ends = vec![0.0, 1.0];
        let stencil = Stencil::new(&Axes::new(lateral, ends.clone(), ends.clone(), ends));
        let place = |k: usize| {
            let x = (k as f64 + 0.5) / 100.0;
            let cell = x.floor();
            let at = |fraction: f64, cell: f64| flangeway::Place {
                cell: cell as usize,
                fraction,
                unclamped: fraction,
                clamped: false,
            };
            (Place::new(&[at(x - cell, cell), at(0.5, 0.0), at(0.5, 0.0), at(0.5, 0.0)]), x)
        };
        let (places, x) = (0..100 * INTERVALS).map(place).unzip();
        (stencil, places, x)
    }

    fn rms(errors: impl Iterator<Item = f64>) -> f64 {
        let errors: Vec<f64> = errors.collect();
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
    }

    #[test]
    fn a_parabola_is_fitted_as_well_as_theory_says() {
        let (stencil, places, x) = along_lateral();
        // f = x² / 2: f″ = 1 with h = 1. All three slots hold it.
        let f = |x: f64| [0.5 * x * x; SLOTS];
        let mut values: Values = (0..stencil.nodes()).map(|node| f((node / 8) as f64)).collect();
        let error = |values: &Values, beyond| {
            let off = |(place, x): (&Place, &f64)| stencil.blend(place, values, beyond)[1] - f(*x)[1];
            rms(places.iter().zip(&x).map(off))
        };
        let sampled = error(&values, Beyond::Clamped);
        assert!((sampled - f64::sqrt(1.0 / 120.0)).abs() < 1e-4, "{sampled}");
        let gains: Vec<[Gain; SLOTS]> = places
            .iter()
            .zip(&x)
            .map(|(place, x)| {
                let now = stencil.blend(place, &values, Beyond::Clamped);
                std::array::from_fn(|slot| Gain { gain: 2.0, target: 2.0 * (f(*x)[slot] - now[slot]) })
            })
            .collect();
        let change = fit(&stencil, &places, &gains, Objective { total: 0.0, each: 1.0 }, Beyond::Clamped);
        for (value, change) in values.as_flattened_mut().iter_mut().zip(change.as_flattened()) {
            *value += change;
        }
        let fitted = error(&values, Beyond::Clamped);
        // The end cells gain a little more than the inner ones.
        assert!((fitted / f64::sqrt(1.0 / 720.0) - 1.0).abs() < 0.03, "{}", fitted / f64::sqrt(1.0 / 720.0));
    }

    #[test]
    fn what_no_place_speaks_of_stays() {
        let (stencil, places, x) = along_lateral();
        // Only the first half of the axis, only the second slot.
        let gain = |x: &f64| if *x < 5.0 { Gain { gain: 1.0, target: 1.0 } } else { Gain::NONE };
        let gains: Vec<[Gain; SLOTS]> = x.iter().map(|x| [Gain::NONE, gain(x), Gain::NONE]).collect();
        let change = fit(&stencil, &places, &gains, Objective { total: 1.0, each: 0.1 }, Beyond::Clamped);
        for (node, [first, second, third]) in change.into_iter().enumerate() {
            assert_eq!([first, third], [0.0, 0.0]);
            match node / 8 {
                0..=4 => assert!((second - 1.0).abs() < 0.01, "node {node}: {second}"),
                6.. => assert_eq!(second, 0.0, "node {node}"),
                _ => {}
            }
        }
    }
}
