//! Scales and records: what the direct solver found, as 16-bit integers.

use flangeway::{CHANNELS, CONFORMAL_LANE, Channel, LANES, SLOTS, Scales, Slot};

use crate::contact::SlotState;
use crate::image::{quantise, scale_over, scale_through_zero};

/// Deepest gap (m) that is stored; contact is far from any pose with a wider one.
pub(super) const WIDEST_GAP: f64 = 0.3e-3;

/// A slot's channels.
pub(super) fn values(state: &SlotState) -> [f64; CHANNELS] {
    [
        state.indentation.max(-WIDEST_GAP),
        state.stiffness,
        state.semi_axis_x,
        state.semi_axis_y,
        state.longitudinal,
        state.profile,
        state.radius_offset,
        state.angle,
        state.wheel_curvature,
        state.rail_curvature,
    ]
}

/// Replaces a slot's channels.
pub(super) fn set_values(state: &mut SlotState, values: [f64; CHANNELS]) {
    [
        state.indentation,
        state.stiffness,
        state.semi_axis_x,
        state.semi_axis_y,
        state.longitudinal,
        state.profile,
        state.radius_offset,
        state.angle,
        state.wheel_curvature,
        state.rail_curvature,
    ] = values;
}

/// The scale of each slot's channels over all samples in which the slot is near the rail. The stiffness and the
/// longitudinal offset keep zero exact, so that a slot without contact carries no trace of force and a wheel
/// without yaw no trace of offset.
pub(super) fn scales(samples: &[[SlotState; SLOTS]], boundaries: [f64; 2]) -> Scales {
    Slot::ALL.map(|slot| {
        let mut low = [f64::INFINITY; CHANNELS];
        let mut high = [f64::NEG_INFINITY; CHANNELS];
        for state in samples.iter().map(|states| &states[slot.index()]).filter(|s| s.present) {
            for ((low, high), value) in low.iter_mut().zip(&mut high).zip(values(state)) {
                (*low, *high) = (low.min(value), high.max(value));
            }
        }
        Channel::ALL.map(|channel| {
            let (low, high) = (low[channel.index()], high[channel.index()]);
            match channel {
                _ if low > high => {
                    // Nothing of this slot is ever near the rail.
                    let rest = if channel == Channel::WheelCoordinate { boundaries[1] } else { 0.0 };
                    scale_over(rest, rest)
                }
                Channel::Indentation => scale_over(-WIDEST_GAP, high.max(0.0)),
                Channel::Stiffness | Channel::Longitudinal => scale_through_zero(low.abs().max(high.abs())),
                _ => scale_over(low, high),
            }
        })
    })
}

/// The record of one node. A slot that is not near the rail is a gap of the widest kind, with no stiffness and the
/// middle of every other channel.
pub(super) fn record(states: &[SlotState; SLOTS], scales: &Scales) -> [i16; LANES] {
    let mut lanes = [0; LANES];
    for (slot, (state, scales)) in Slot::ALL.into_iter().zip(states.iter().zip(scales)) {
        for (channel, value) in Channel::ALL.into_iter().zip(values(state)) {
            let scale = &scales[channel.index()];
            lanes[channel.lane(slot)] = match channel {
                Channel::Indentation | Channel::Stiffness => quantise(scale, value),
                _ if state.present => quantise(scale, value),
                _ => 0,
            };
        }
    }
    let conformal = states.iter().any(|state| state.present && state.conformal && state.stiffness > 0.0);
    lanes[CONFORMAL_LANE] = if conformal { i16::MAX } else { 0 };
    lanes
}
