//! Where a table's error comes from: its grid, its 16-bit integers, the kernel's arithmetic.
//!
//! The same poses are looked up three times: in double precision from the node values before quantisation, in double
//! precision from the integers, and by the kernel. What the integers should cost follows from their steps q alone: an
//! error uniform in ±q/2 at each of the sixteen corners with weights w gives
//!
//! ```text
//! σ_channel = q / √12 · √(Σ w²)
//! σ_N / N   = √(Σ_slots (N_slot / N)² [(3/2 σ_δ / δ)² + (σ_C / C)²])
//! ```

use flangeway::{AxisName, CHANNELS, Channel, ContactTable, SLOTS, Scale, Side, Slot};
use rayon::prelude::*;

use super::quantise;
use super::stencil::{Beyond, Place, Stencil};
use super::{Assembled, CompiledSide};
use crate::hertz;
use crate::verify::{self, LOADS, Quantiles};

/// The parts of the relative force error, and what each channel's integers cost.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Budget {
    /// Node values in double precision against the direct solver.
    pub grid: Quantiles,
    /// Integers in double precision against node values in double precision.
    pub quantisation: Quantiles,
    /// What the steps let expect of that (root mean square).
    pub quantisation_predicted_rms: f64,
    /// The kernel against integers in double precision.
    pub arithmetic: Quantiles,
    /// By channel, over contacts that carry force.
    pub channels: Vec<ChannelBudget>,
}

/// Error of one channel by its integers, in the channel's unit.
#[derive(Debug, Clone, serde::Serialize)]
pub struct ChannelBudget {
    /// The channel's name.
    pub channel: String,
    /// Largest quantisation step of the three slots.
    pub step: f64,
    /// Expected root mean square error.
    pub predicted_rms: f64,
    /// Measured root mean square error.
    pub measured_rms: f64,
}

/// One pose.
#[derive(Default)]
struct Parts {
    grid: f64,
    quantisation: f64,
    /// Square of the expected relative error.
    predicted: f64,
    arithmetic: f64,
    /// By channel: squares of measured and expected errors summed over carrying contacts.
    channels: [[f64; 2]; CHANNELS],
    contacts: usize,
}

/// The budget of a table over samples of it; `view` is the kernel's of its image.
pub(super) fn measure(table: &Assembled, view: &ContactTable<'_>, samples: &[verify::Sample]) -> Budget {
    let stencil = Stencil::new(&table.axes);
    let (right, left) = (table.sides.first(), table.sides.last());
    let part = |sample: &verify::Sample| {
        let side = if sample.side == Side::Left { left } else { right };
        side.map(|side| parts(view, side, &stencil, sample))
    };
    let parts: Vec<Parts> = samples.par_iter().filter_map(part).collect();
    let of = |value: fn(&Parts) -> f64| Quantiles::of(parts.iter().map(value).collect());
    let contacts = parts.iter().map(|p| p.contacts).sum::<usize>().max(1) as f64;
    let channels = Channel::ALL.map(|channel| {
        let rms = |k: usize| (parts.iter().map(|p| p.channels[channel.index()][k]).sum::<f64>() / contacts).sqrt();
        let steps = table.sides.iter().flat_map(|side| side.scales).map(|scales| scales[channel.index()].step);
        ChannelBudget {
            channel: channel.to_string(),
            step: f64::from(steps.fold(0.0, f32::max)),
            predicted_rms: rms(1),
            measured_rms: rms(0),
        }
    });
    let predicted = parts.iter().map(|p| p.predicted).sum::<f64>() / parts.len().max(1) as f64;
    Budget {
        grid: of(|p| p.grid),
        quantisation: of(|p| p.quantisation),
        quantisation_predicted_rms: predicted.sqrt(),
        arithmetic: of(|p| p.arithmetic),
        channels: channels.into(),
    }
}

fn parts(image: &ContactTable<'_>, data: &CompiledSide, stencil: &Stencil, sample: &verify::Sample) -> Parts {
    let at = &sample.coordinates;
    let places = [
        image.axis(AxisName::Lateral).locate(at.lateral),
        image.axis(AxisName::Yaw).locate(at.yaw),
        image.axis(AxisName::RollOffset).locate(at.roll_offset),
        image.axis(AxisName::Vertical).locate(at.vertical),
    ];
    let place = Place::new(&places);
    let (mut exact, mut rounded) = ([[0.0; CHANNELS]; SLOTS], [[0.0; CHANNELS]; SLOTS]);
    let mut spread = [0.0; CHANNELS];
    for channel in Channel::ALL {
        let beyond = if channel == Channel::Indentation { Beyond::Extrapolated } else { Beyond::Clamped };
        let corners = stencil.corners(&place, beyond);
        spread[channel.index()] = (corners.iter().map(|(_, w)| w * w).sum::<f64>() / 12.0).sqrt();
        for (node, weight) in corners {
            for slot in Slot::ALL {
                let scale = &data.scales[slot.index()][channel.index()];
                let lane = data.records[node][channel.lane(slot)];
                let slot = slot.index();
                let value = quantise::values(&data.nodes[node][slot])[channel.index()];
                exact[slot][channel.index()] += weight * value;
                rounded[slot][channel.index()] += weight * dequantised(scale, lane);
            }
        }
    }
    let total = |slots: &[[f64; CHANNELS]; SLOTS]| slots.iter().map(force).sum::<f64>();
    let scale = sample.direct.max(LOADS[0]);
    let (by_nodes, by_integers) = (total(&exact), total(&rounded));
    let mut parts = Parts {
        grid: (by_nodes - sample.direct).abs() / scale,
        quantisation: (by_integers - by_nodes).abs() / scale,
        arithmetic: (sample.table - by_integers).abs() / scale,
        ..Parts::default()
    };
    for slot in 0..SLOTS {
        let carried = force(&exact[slot]);
        if carried <= verify::CARRYING * by_nodes {
            continue;
        }
        parts.contacts += 1;
        let sigma = |channel: usize| spread[channel] * f64::from(data.scales[slot][channel].step);
        let relative = (1.5 * sigma(0) / exact[slot][0]).powi(2) + (sigma(1) / exact[slot][1]).powi(2);
        parts.predicted += (carried / scale).powi(2) * relative;
        for (channel, [measured, predicted]) in parts.channels.iter_mut().enumerate() {
            *measured += (rounded[slot][channel] - exact[slot][channel]).powi(2);
            *predicted += sigma(channel).powi(2);
        }
    }
    parts
}

fn dequantised(scale: &Scale, lane: i16) -> f64 {
    f64::from(scale.offset) + f64::from(scale.step) * f64::from(lane)
}

/// N = C δ^1.5 (N)
fn force(channels: &[f64; CHANNELS]) -> f64 {
    hertz::normal_force(channels[1].max(0.0), channels[0])
}
