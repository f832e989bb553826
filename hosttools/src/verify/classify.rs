//! What lies in the cell of a sample: a joint of the profiles, a change of contacts, or neither.

use flangeway::{AxisName, Channel, Channels, ContactTable, Coordinates, SLOTS, Side, Slot};
use rayon::prelude::*;

use super::joints::{Joint, joints};
use super::{CARRYING, Sample};
use crate::contact::SlotState;
use crate::contacts::track_position;
use crate::pair::Pair;

/// A lesser share than this of a peak's own force counts as merging.
const WHOLE: f64 = 1.0 - 1e-6;

/// What the cell of a sample holds. Every sample is of exactly one class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// A joint of the wheel's or the rail's curvature passes through a contact inside the cell.
    Joint,
    /// A slot carries at some corners of the cell only, or two peaks of one zone share their force.
    Contacts,
    /// Both.
    Both,
    /// Neither.
    Rest,
}

impl Class {
    /// All classes.
    pub const ALL: [Self; 4] = [Self::Joint, Self::Contacts, Self::Both, Self::Rest];

    /// What the class is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Joint => "a curvature joint only",
            Self::Contacts => "a change of contacts only",
            Self::Both => "a joint and a change of contacts",
            Self::Rest => "neither",
        }
    }
}

/// The surroundings of a sample in the table, and what the direct solver says about its peaks.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings {
    /// The class of the cell.
    pub class: Class,
    /// Slots whose indentation changes its sign between the cell's corners at the sample's height.
    pub onset: [bool; SLOTS],
    /// Slots with indentation and stiffness at some corners, and with indentation but none at others.
    pub leaning: [bool; SLOTS],
    /// Least share of its own force that a loaded peak keeps; 1 where none shares.
    pub least_share: f64,
    /// Loaded peaks.
    pub peaks: usize,
    /// Lateral width of the cell (m).
    pub lateral_width: f64,
    /// Joint of the wheel nearest to the strongest contact, and its distance (m).
    pub wheel_joint: Option<(Joint, f64)>,
    /// Joint of the rail nearest to the strongest contact, and its distance (m).
    pub rail_joint: Option<(Joint, f64)>,
    /// Whether the height is above the table's last vertical node.
    pub beyond: bool,
}

/// Joints of a side's wheel and rail.
struct Joints {
    wheel: Vec<Joint>,
    rail: Vec<Joint>,
}

/// The surroundings of every sample.
pub fn surroundings(table: &ContactTable<'_>, pair: &Pair, samples: &[Sample]) -> Vec<Surroundings> {
    let of_side = |side: Side| {
        let body = pair.body(side);
        Joints { wheel: joints(body.wheel().curve()), rail: joints(body.rail().curve()) }
    };
    let [right, left] = [of_side(Side::Right), of_side(Side::Left)];
    let joints = |side: Side| if side == Side::Left { &left } else { &right };
    samples.par_iter().map(|sample| around(table, pair, joints(sample.side), sample)).collect()
}

/// An edge of the cell at the height of the sample: its coordinates and channels.
struct Edge {
    at: Coordinates,
    channels: Channels,
    /// Slots with stiffness at one end of the edge only.
    broken: [bool; SLOTS],
}

impl Edge {
    fn value(&self, slot: Slot, channel: Channel) -> f64 {
        f64::from(self.channels.get(slot, channel))
    }

    fn indented(&self, slot: Slot) -> bool {
        self.value(slot, Channel::Indentation) > 0.0
    }

    fn stiff(&self, slot: Slot) -> bool {
        self.value(slot, Channel::Stiffness) > 0.0
    }
}

/// The eight edges of a cell along its vertical axis.
fn edges(table: &ContactTable<'_>, side: Side, at: &Coordinates) -> Vec<Edge> {
    let bounds = |name: AxisName, x: f64| {
        let (axis, cell) = (table.axis(name), table.axis(name).locate(x).cell);
        [axis.node(cell), axis.node(cell + 1)]
    };
    let vertical = bounds(AxisName::Vertical, at.vertical);
    let mut edges = Vec::with_capacity(8);
    for lateral in bounds(AxisName::Lateral, at.lateral) {
        for yaw in bounds(AxisName::Yaw, at.yaw) {
            for roll_offset in bounds(AxisName::RollOffset, at.roll_offset) {
                let at = Coordinates { lateral, yaw, roll_offset, vertical: at.vertical };
                let stiff = vertical.map(|vertical| {
                    let channels = table.channels(side, &Coordinates { vertical, ..at });
                    Slot::ALL.map(|slot| channels.get(slot, Channel::Stiffness) > 0.0)
                });
                let broken = std::array::from_fn(|slot| stiff[0][slot] != stiff[1][slot]);
                edges.push(Edge { at, channels: table.channels(side, &at), broken });
            }
        }
    }
    edges
}

fn around(table: &ContactTable<'_>, pair: &Pair, joints: &Joints, sample: &Sample) -> Surroundings {
    let Sample { side, coordinates, pose, .. } = *sample;
    let edges = edges(table, side, &coordinates);
    let differs = |is: &dyn Fn(&Edge) -> bool| edges.iter().any(is) && !edges.iter().all(is);
    let onset = Slot::ALL.map(|slot| differs(&|e| e.indented(slot)) && edges.iter().any(|e| e.stiff(slot)));
    let leaning = Slot::ALL.map(|slot| {
        let indented = || edges.iter().filter(|e| e.indented(slot));
        let some = indented().any(|e| e.stiff(slot));
        some && indented().any(|e| !e.stiff(slot) || e.broken[slot.index()])
    });
    let peaks: Vec<_> = pair.column(side, &pose).peaks(pose.vertical);
    let loaded = || peaks.iter().filter(|p| p.state.indentation > 0.0);
    let least_share = loaded().map(|p| p.share).fold(1.0, f64::min);
    let places = Slot::ALL.into_iter().filter(|slot| carries(sample, *slot));
    let through = |slot: Slot| {
        let own = place(pair, sample, &sample.slots[slot.index()]);
        let corners = edges.iter().filter(|e| e.indented(slot) && e.stiff(slot));
        let corners = corners.map(|edge| corner(table, pair, side, edge, slot));
        let [wheel, rail] = spans(corners.chain([own]));
        let inside = |joints: &[Joint], [low, high]: [f64; 2]| joints.iter().any(|j| low <= j.t && j.t <= high);
        inside(&joints.wheel, wheel) || inside(&joints.rail, rail)
    };
    let joint = places.into_iter().any(through);
    let change = onset.contains(&true) || leaning.contains(&true) || least_share < WHOLE;
    let strongest = strongest(sample).map_or([None; 2], |state| place(pair, sample, state));
    let [low, high] = {
        let axis = table.axis(AxisName::Lateral);
        let cell = axis.locate(coordinates.lateral).cell;
        [axis.node(cell), axis.node(cell + 1)]
    };
    Surroundings {
        class: match (joint, change) {
            (true, false) => Class::Joint,
            (false, true) => Class::Contacts,
            (true, true) => Class::Both,
            (false, false) => Class::Rest,
        },
        onset,
        leaning,
        least_share,
        peaks: loaded().count(),
        lateral_width: high - low,
        wheel_joint: strongest[0].and_then(|t| Joint::nearest(&joints.wheel, t)),
        rail_joint: strongest[1].and_then(|t| Joint::nearest(&joints.rail, t)),
        beyond: coordinates.vertical > table.axis(AxisName::Vertical).range().1,
    }
}

fn carries(sample: &Sample, slot: Slot) -> bool {
    sample.slots[slot.index()].normal_force() > CARRYING * sample.direct
}

fn strongest(sample: &Sample) -> Option<&SlotState> {
    sample.slots.iter().max_by(|a, b| a.normal_force().total_cmp(&b.normal_force()))
}

/// Parameters (m) of a contact on wheel and rail.
type Place = [Option<f64>; 2];

/// Place of the direct solver's contact.
fn place(pair: &Pair, sample: &Sample, state: &SlotState) -> Place {
    parameters(pair, sample.side, &sample.pose, state)
}

/// Place of the table's contact at a corner.
fn corner(table: &ContactTable<'_>, pair: &Pair, side: Side, edge: &Edge, slot: Slot) -> Place {
    let pose = table.rigid(side).pose(pair.body(side).wheel().geometry(), &edge.at);
    let value = |channel| edge.value(slot, channel);
    let state = SlotState {
        longitudinal: value(Channel::Longitudinal),
        profile: value(Channel::WheelCoordinate),
        radius_offset: value(Channel::RadiusOffset),
        ..SlotState::ABSENT
    };
    parameters(pair, side, &pose, &state)
}

fn parameters(pair: &Pair, side: Side, pose: &flangeway::Pose, state: &SlotState) -> Place {
    let body = pair.body(side);
    let [_, y, z] = track_position(pair, side, pose, state);
    let rail = body.rail();
    let guess = rail.curve().parameter_at_lateral(y);
    let foot = guess.and_then(|guess| rail.foot([y, z], guess, 4)).map(|foot| foot.t);
    [body.wheel().curve().parameter_at_lateral(state.profile), foot]
}

/// Spans of the parameters on wheel and rail; empty without any.
fn spans(places: impl Iterator<Item = Place>) -> [[f64; 2]; 2] {
    let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for place in places {
        for (span, t) in spans.iter_mut().zip(place) {
            if let Some(t) = t {
                *span = [span[0].min(t), span[1].max(t)];
            }
        }
    }
    spans
}
