//! Node values fitted to the direct solver between the nodes.
//!
//! A value sampled at a node is exact there and errs to one side between: with second derivative f″ and spacing h,
//! linear interpolation is off by h² f″ t (1 - t) / 2, at most h² f″ / 8 and √(1/120) h² f″ in the mean square. The
//! least-squares values are off by √(1/720) h² f″, 2.4 times less, and cost neither bytes nor time in a lookup. Where
//! a contact appears or moves on, inside a cell, they share the error out instead of leaving it to one side.
//!
//! The fit minimises the relative error of the force, which is what `verify` measures:
//!
//! ```text
//! first δ:   Σ_poses Σ_slots [3/2 C √δ (δ_table - δ) / N]²
//! then C:    Σ_poses [Σ_slots (C_table δ_table^1.5 - N_slot) / N]² + q² Σ_slots [(C_table δ_table^1.5 - N_slot) / N]²
//! then each other channel, by the share of the force its slot carries
//! ```
//! A slot whose contact has crossed into the next one leaves C blended with zero between the nodes; the sum over the
//! slots lets the next one make up for it. Poses with a large error count less in a second round (Cauchy's weights),
//! so that the smooth parts are not bent for the sake of a kink that no node value can follow. A small ridge holds on
//! to the sampled values where the poses say nothing.

mod least_squares;
mod points;

use flangeway::{CHANNELS, Channel, SLOTS};
use indicatif::ParallelProgressIterator as _;
use rayon::prelude::*;

use super::axes::Axes;
use super::quantise::{self, WIDEST_GAP};
use super::stencil::{Beyond, Place, Stencil};
use crate::contact::SlotState;
use crate::hertz::normal_force;
use crate::progress;
use crate::verify::LOADS;
use least_squares::{Gain, Objective, Values, fit as least_squares};
use points::Point;
pub(super) use points::{Drawing, Points};

/// Rounds of fitting δ and C, each weighing the poses by the errors of the one before.
const ROUNDS: usize = 3;
/// Relative force error at which a pose counts 1/√2 as much.
const TOLERATED: f64 = 0.01;
/// q: how much the force of each slot counts beside the total.
const EACH_SLOT: f64 = 0.1;
/// Indentation (m) below which a lighter contact counts no less: 3 µm is about half a kilonewton.
const LEAST_DEPTH: f64 = 3e-6;
/// Gap (m) from which on the exact indentation of a slot does not matter.
const OUT_OF_REACH: f64 = 0.2e-3;

/// The poses that the node values in the cells of these lateral intervals are fitted to, by interval; the samples at
/// those cells' nodes must be there.
pub(super) fn draw(
    drawing: &Drawing<'_>,
    axes: &Axes,
    samples: &[[SlotState; SLOTS]],
    lateral: &[usize],
) -> Vec<Points> {
    let sampled = Fit { stencil: Stencil::new(axes), nodes: Nodes::of(samples) };
    drawing.points(lateral, |place, point| sampled.error(place, point).abs())
}

/// Replaces the sampled node values of a side by ones fitted to the poses of all its cells.
pub(super) fn fit(Points { places, points }: &Points, axes: &Axes, samples: &mut [[SlotState; SLOTS]]) {
    let mut fit = Fit { stencil: Stencil::new(axes), nodes: Nodes::of(samples) };
    let bar = progress::bar((2 * ROUNDS + GEOMETRY.len()) as u64, "fitting nodes");
    for round in 0..ROUNDS {
        let weight = |(place, point): (&Place, &Point)| {
            let error = fit.error(place, point) / TOLERATED;
            let robust = if round == 0 { 1.0 } else { 1.0 / (1.0 + error * error).sqrt() };
            f64::from(point.weight) * robust / point.force().max(LOADS[0])
        };
        // The weight of a newton.
        let weights: Vec<f64> = places.par_iter().zip(points).map(weight).collect();
        fit.indentations(places, points, &weights);
        bar.inc(1);
        fit.stiffnesses(places, points, &weights);
        bar.inc(1);
    }
    let geometry = |&channel: &Channel| fit.geometry(places, points, channel);
    let changes: Vec<Values> = GEOMETRY.par_iter().map(geometry).progress_with(bar.clone()).collect();
    bar.finish_and_clear();
    for (&channel, change) in GEOMETRY.iter().zip(&changes) {
        fit.nodes.add_within(channel, change);
    }
    fit.nodes.store(samples);
}

/// The channels that are not part of the force.
const GEOMETRY: &[Channel] = Channel::ALL.split_at(2).1;

/// Node values: `[channel][node][slot]`.
struct Nodes([Values; CHANNELS]);

impl Nodes {
    fn of(samples: &[[SlotState; SLOTS]]) -> Self {
        let value = |states: &[SlotState; SLOTS], channel: usize| states.map(|state| quantise::values(&state)[channel]);
        Self(std::array::from_fn(|channel| samples.iter().map(|states| value(states, channel)).collect()))
    }

    fn of_channel(&self, channel: Channel) -> &Values {
        &self.0[channel.index()]
    }

    /// Adds a change, not going below `least`.
    fn add(&mut self, channel: Channel, change: &Values, least: f64) {
        let values = self.0[channel.index()].as_flattened_mut();
        for (value, change) in values.iter_mut().zip(change.as_flattened()) {
            *value = (*value + change).max(least);
        }
    }

    /// Adds a change, not leaving the range of the slot's values.
    fn add_within(&mut self, channel: Channel, change: &Values) {
        let values = &mut self.0[channel.index()];
        for slot in 0..SLOTS {
            let slot_values = || values.iter().map(|slots| slots[slot]);
            let (least, most) =
                (slot_values().fold(f64::INFINITY, f64::min), slot_values().fold(f64::NEG_INFINITY, f64::max));
            for (value, change) in values.iter_mut().zip(change) {
                value[slot] = (value[slot] + change[slot]).clamp(least, most);
            }
        }
    }

    fn store(&self, samples: &mut [[SlotState; SLOTS]]) {
        for (node, states) in samples.iter_mut().enumerate() {
            for (slot, state) in states.iter_mut().enumerate() {
                quantise::set_values(state, self.0.each_ref().map(|values| values[node][slot]));
            }
        }
    }
}

/// A fit under way.
struct Fit {
    stencil: Stencil,
    nodes: Nodes,
}

impl Fit {
    /// Slots' forces by the table (N).
    fn forces(&self, place: &Place) -> [f64; SLOTS] {
        let deltas = self.stencil.blend(place, self.nodes.of_channel(Channel::Indentation), Beyond::Extrapolated);
        let stiffnesses = self.stencil.blend(place, self.nodes.of_channel(Channel::Stiffness), Beyond::Clamped);
        std::array::from_fn(|slot| stiffnesses[slot] * power_1_5(deltas[slot]))
    }

    /// (N_table - N) / max(N, 5 kN)
    fn error(&self, place: &Place, point: &Point) -> f64 {
        (self.forces(place).iter().sum::<f64>() - point.force()) / point.force().max(LOADS[0])
    }

    fn indentations(&mut self, places: &[Place], points: &[Point], weights: &[f64]) {
        let channel = Channel::Indentation;
        let gains = |((place, point), weight): ((&Place, &Point), &f64)| {
            let now = self.stencil.blend(place, self.nodes.of_channel(channel), Beyond::Extrapolated);
            std::array::from_fn(|slot| match point.slots[slot] {
                Some([delta, stiffness, ..]) if f64::from(delta) > -OUT_OF_REACH => {
                    let (delta, stiffness) = (f64::from(delta), f64::from(stiffness));
                    // dN = 3/2 C √δ dδ
                    let gain = weight * 1.5 * stiffness * delta.abs().max(LEAST_DEPTH).sqrt();
                    Gain { gain, target: gain * (delta - now[slot]) }
                }
                _ => Gain::NONE,
            })
        };
        let gains: Vec<[Gain; SLOTS]> = places.par_iter().zip(points).zip(weights).map(gains).collect();
        let change =
            least_squares(&self.stencil, places, &gains, Objective { total: 0.0, each: 1.0 }, Beyond::Extrapolated);
        self.nodes.add(channel, &change, -WIDEST_GAP);
    }

    fn stiffnesses(&mut self, places: &[Place], points: &[Point], weights: &[f64]) {
        let gains = |((place, point), weight): ((&Place, &Point), &f64)| {
            let now = self.forces(place);
            let deltas = self.stencil.blend(place, self.nodes.of_channel(Channel::Indentation), Beyond::Extrapolated);
            // dN = δ^1.5 dC
            std::array::from_fn(|slot| Gain {
                gain: weight * power_1_5(deltas[slot]),
                target: weight * (point.slot_force(slot) - now[slot]),
            })
        };
        let gains: Vec<[Gain; SLOTS]> = places.par_iter().zip(points).zip(weights).map(gains).collect();
        let change =
            least_squares(&self.stencil, places, &gains, Objective { total: 1.0, each: EACH_SLOT }, Beyond::Clamped);
        self.nodes.add(Channel::Stiffness, &change, 0.0);
    }

    /// Changes of another channel, by the share of the force that its slot carries.
    fn geometry(&self, places: &[Place], points: &[Point], channel: Channel) -> Values {
        let gains = |(place, point): (&Place, &Point)| {
            let now = self.stencil.blend(place, self.nodes.of_channel(channel), Beyond::Clamped);
            std::array::from_fn(|slot| match point.slots[slot] {
                Some(values) if point.slot_force(slot) > 0.0 => {
                    let gain = f64::from(point.weight) * point.slot_force(slot) / point.force();
                    Gain { gain, target: gain * (f64::from(values[channel.index()]) - now[slot]) }
                }
                _ => Gain::NONE,
            })
        };
        let gains: Vec<[Gain; SLOTS]> = places.par_iter().zip(points).map(gains).collect();
        least_squares(&self.stencil, places, &gains, Objective { total: 0.0, each: 1.0 }, Beyond::Clamped)
    }
}

/// δ^1.5 of an indentation, 0 of a gap.
fn power_1_5(delta: f64) -> f64 {
    normal_force(1.0, delta)
}
