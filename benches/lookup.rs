//! A lookup against the same table read in other ways: `interpn` (27 scalar fields on a regular grid, each interpolated
//! by itself) and plain safe Rust (an array of records of `f32`, blended by a loop over the corners).
//!
//! Two jobs: from table coordinates to the channels, which is all that `interpn` does (`vector` and `interpn`, over
//! `ContactTable::channels`), and the whole lookup from pose to contacts, to which both others are given the kernel's
//! coordinates and a plain rebuilding (`vector_lookup` and `interpn_lookup`, over `ContactTable::contacts_into`).
//!
//! The same poses in turn in one process; what counts is the ratio, round by round. Each way's accuracy stands beside
//! its speed: the contacts' force against the same records blended in `f64`. `--json FILE` writes the ratios.

mod common;

use std::hint::black_box;

use common::{quartiles, random_poses, rounds, table, trajectory};
use flangeway::{AxisName, CHANNELS, Channel, ContactTable, Contacts, Pose, SLOTS, Side, Slot};
use interpn::MultilinearRegular;

/// Channels a slot that are interpolated by `interpn`: all but the rail's curvature, 27 fields.
const FIELDS: usize = CHANNELS - 1;
const ROUNDS: usize = 25;

/// A record as plain Rust would keep it.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Record([f32; 32]);

/// The table in plain Rust.
struct Plain<'a> {
    table: &'a ContactTable<'a>,
    records: Vec<Record>,
    first: [f32; 4],
    step: [f32; 4],
    counts: [usize; 4],
}

impl<'a> Plain<'a> {
    fn new(table: &'a ContactTable<'a>) -> Self {
        let counts = AxisName::ALL.map(|name| table.axis(name).len());
        let scales = table.header().right.scales;
        let record = |node: [usize; 4]| {
            let lanes = table.node_record(Side::Right, node).expect("a node");
            let mut record = Record([0.0; 32]);
            for slot in Slot::ALL {
                for channel in Channel::ALL {
                    let lane = channel.lane(slot);
                    record.0[lane] = scales[slot.index()][channel.index()].value(f32::from(lanes[lane]));
                }
            }
            record
        };
        let [a, b, c, d] = counts;
        let nodes = (0..a * b * c * d).map(|i| [i / (b * c * d), i / (c * d) % b, i / d % c, i % d]);
        let ends = AxisName::ALL.map(|name| table.axis(name).range());
        let step = std::array::from_fn(|i| ((ends[i].1 - ends[i].0) / (counts[i] - 1) as f64) as f32);
        Self { table, records: nodes.map(record).collect(), first: ends.map(|ends| ends.0 as f32), step, counts }
    }

    /// Coordinates on the records' axes, limited to them.
    fn coordinates(&self, pose: &Pose) -> [f32; 4] {
        let at = self.table.coordinates(Side::Right, pose);
        [at.lateral as f32, at.yaw as f32, at.roll_offset as f32, at.vertical as f32]
    }

    /// The record at coordinates: cell by division, sixteen corners, thirty lanes.
    fn blend(&self, x: [f32; 4]) -> Record {
        let mut cell = [0; 4];
        let mut t = [0.0; 4];
        for i in 0..4 {
            let position = ((x[i] - self.first[i]) / self.step[i]).clamp(0.0, (self.counts[i] - 1) as f32);
            cell[i] = (position as usize).min(self.counts[i] - 2);
            t[i] = position - cell[i] as f32;
        }
        let mut out = Record([0.0; 32]);
        for corner in 0..16_usize {
            let mut index = 0;
            let mut weight = 1.0;
            for i in 0..4 {
                let upper = corner >> (3 - i) & 1;
                index = index * self.counts[i] + cell[i] + upper;
                weight *= if upper == 1 { t[i] } else { 1.0 - t[i] };
            }
            for (sum, value) in out.0.iter_mut().zip(&self.records[index].0) {
                *sum += weight * value;
            }
        }
        out
    }

    /// Contacts from a blended record, as the kernel rebuilds them, in plain code.
    fn rebuild(&self, pose: &Pose, record: &Record) -> heapless::Vec<flangeway::Contact, SLOTS> {
        let mut list = heapless::Vec::new();
        let geometry = &self.table.header().right.geometry;
        let (r0, b) = (geometry.nominal_radius as f32, geometry.lateral_position as f32);
        let (sin_psi, cos_psi) = (pose.yaw as f32).sin_cos();
        let (sin_phi, cos_phi) = (pose.roll as f32).sin_cos();
        for slot in Slot::ALL {
            let at = |channel: Channel| record.0[channel.lane(slot)];
            let depth = at(Channel::Indentation).max(0.0);
            let normal_force = at(Channel::Stiffness).max(0.0) * depth * depth.sqrt();
            if normal_force > 0.0 {
                let (e, s) = (at(Channel::Longitudinal), b + at(Channel::WheelCoordinate));
                let radius = r0 + at(Channel::RadiusOffset);
                let down = (radius * radius - e * e).sqrt();
                let across = s * cos_phi - down * sin_phi;
                let position = [
                    e * cos_psi - across * sin_psi,
                    e * sin_psi + across * cos_psi + pose.lateral as f32,
                    s * sin_phi + down * cos_phi + pose.vertical as f32 - r0,
                ];
                let contact = flangeway::Contact {
                    normal_force,
                    indentation: at(Channel::Indentation),
                    position: position.into(),
                    angle: at(Channel::Angle),
                    rolling_radius: radius,
                    wheel_coordinate: at(Channel::WheelCoordinate),
                    semi_axes: [Channel::SemiAxisAlong, Channel::SemiAxisAcross]
                        .map(|channel| at(channel).max(0.0) * depth.sqrt()),
                    wheel_curvature: at(Channel::WheelCurvature),
                    rail_curvature: at(Channel::RailCurvature),
                    slot,
                };
                let _ = list.push(contact);
            }
        }
        list
    }

    /// All of it.
    fn contacts(&self, pose: &Pose) -> heapless::Vec<flangeway::Contact, SLOTS> {
        self.rebuild(pose, &self.blend(self.coordinates(pose)))
    }

    /// One field of all nodes.
    fn field(&self, lane: usize) -> Vec<f32> {
        self.records.iter().map(|record| record.0[lane]).collect()
    }

    /// Total force with the records blended in `f64`.
    fn exact_force(&self, pose: &Pose) -> f64 {
        let at = self.table.coordinates(Side::Right, pose);
        let x = [at.lateral, at.yaw, at.roll_offset, at.vertical];
        let places: [_; 4] = std::array::from_fn(|i| self.table.axis(AxisName::ALL[i]).locate(x[i]));
        let scales = self.table.header().right.scales;
        let mut lanes = [0.0_f64; 32];
        for corner in 0..16_usize {
            let upper: [usize; 4] = std::array::from_fn(|i| corner >> (3 - i) & 1);
            let node = std::array::from_fn(|i| places[i].cell + upper[i]);
            let part = |i: usize| if upper[i] == 1 { places[i].fraction } else { 1.0 - places[i].fraction };
            let weight: f64 = (0..4).map(part).product();
            let record = self.table.node_record(Side::Right, node).expect("a node");
            lanes.iter_mut().zip(record).for_each(|(sum, q)| *sum += weight * f64::from(q));
        }
        let value = |slot: Slot, channel: Channel| {
            let scale = scales[slot.index()][channel.index()];
            f64::from(scale.offset) + f64::from(scale.step) * lanes[channel.lane(slot)]
        };
        let force =
            |slot| value(slot, Channel::Stiffness).max(0.0) * value(slot, Channel::Indentation).max(0.0).powf(1.5);
        Slot::ALL.into_iter().map(force).sum()
    }
}

/// Largest and rms relative error of forces above 5 kN.
fn accuracy(exact: &[f64], found: impl Iterator<Item = f64>) -> [f64; 2] {
    let errors: Vec<f64> = exact
        .iter()
        .zip(found)
        .filter(|(force, _)| **force > 5e3)
        .map(|(force, found)| (found / force - 1.0).abs())
        .collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    [errors.iter().copied().fold(0.0, f64::max), (squares / errors.len() as f64).sqrt()]
}

fn show([largest, rms]: [f64; 2]) -> String {
    format!("{largest:.1e} and {rms:.1e}")
}

fn main() {
    let table = table();
    let plain = Plain::new(&table);
    // The lanes of the fields, slot by slot.
    let field_lanes: Vec<usize> =
        Slot::ALL.iter().flat_map(|slot| Channel::ALL[..FIELDS].iter().map(|channel| channel.lane(*slot))).collect();
    let fields: Vec<Vec<f32>> = field_lanes.iter().map(|lane| plain.field(*lane)).collect();
    let fields: Vec<MultilinearRegular<'_, f32, 4>> = fields
        .iter()
        .map(|values| MultilinearRegular::new(plain.counts, plain.first, plain.step, values).expect("a grid"))
        .collect();
    let interpn =
        |x: [f32; 4]| -> [f32; SLOTS * FIELDS] { std::array::from_fn(|i| fields[i].interp_one(x).unwrap_or(0.0)) };
    let interpn_force = |x: [f32; 4]| -> f64 {
        let fields = interpn(x);
        let force = |slot: &[f32]| f64::from(slot[1].max(0.0)) * f64::from(slot[0].max(0.0)).powf(1.5);
        fields.chunks(FIELDS).map(force).sum()
    };
    let many = random_poses(&table, 20_000, 1);
    let exact: Vec<f64> = many.iter().map(|pose| plain.exact_force(pose)).collect();
    let ours =
        accuracy(&exact, many.iter().map(|pose| f64::from(table.contacts(Side::Right, pose).total_normal_force())));
    let vector = accuracy(
        &exact,
        many.iter().map(|pose| plain.contacts(pose).iter().map(|contact| f64::from(contact.normal_force)).sum()),
    );
    let scalar = accuracy(&exact, many.iter().map(|pose| interpn_force(plain.coordinates(pose))));
    let mut json = serde_json::Map::new();
    let patterns = [
        ("hot", random_poses(&table, 16, 2), 500),
        ("trajectory", trajectory(&table, 8192), 1),
        ("random", random_poses(&table, 65_536, 3), 1),
    ];
    println!(
        "force error against f64, largest and rms: lookup {}, plain Rust {}, interpn {}",
        show(ours),
        show(vector),
        show(scalar)
    );
    println!("time over ours: from table coordinates to channels; and, as _lookup, from pose to contacts");
    for (name, poses, repeats) in patterns {
        let coordinates: Vec<[f32; 4]> = poses.iter().map(|pose| plain.coordinates(pose)).collect();
        let at: Vec<_> = poses.iter().map(|pose| table.coordinates(Side::Right, pose)).collect();
        let mut by_lookup = || {
            let mut contacts = Contacts::NONE;
            for pose in (0..repeats).flat_map(|_| &poses) {
                table.contacts_into(Side::Right, black_box(pose), &mut contacts);
                black_box(&contacts);
            }
        };
        let mut by_plain = || {
            for pose in (0..repeats).flat_map(|_| &poses) {
                black_box(&plain.contacts(black_box(pose)));
            }
        };
        let mut by_blend = || {
            for x in (0..repeats).flat_map(|_| &coordinates) {
                black_box(&plain.blend(black_box(*x)));
            }
        };
        let mut by_interpn = || {
            for pose in (0..repeats).flat_map(|_| &poses) {
                let fields = interpn(plain.coordinates(black_box(pose)));
                let mut record = Record([0.0; 32]);
                for (lane, value) in field_lanes.iter().zip(fields) {
                    record.0[*lane] = value;
                }
                black_box(&plain.rebuild(pose, &record));
            }
        };
        let mut by_fields = || {
            for x in (0..repeats).flat_map(|_| &coordinates) {
                black_box(&interpn(black_box(*x)));
            }
        };
        let mut by_channels = || {
            for at in (0..repeats).flat_map(|_| &at) {
                black_box(&table.channels(Side::Right, black_box(at)));
            }
        };
        let mut ways: [&mut dyn FnMut(); 6] =
            [&mut by_lookup, &mut by_plain, &mut by_interpn, &mut by_channels, &mut by_blend, &mut by_fields];
        let times = rounds(ROUNDS, poses.len() * repeats, &mut ways);
        let mut put = |key: &str, way: usize, of: usize| {
            let [low, median, high] = quartiles(times.iter().map(|round| round[way] / round[of]).collect());
            json.insert(format!("ratio_{key}_{name}"), median.into());
            println!("  {key:15} {median:6.2} ({low:.2} to {high:.2})");
        };
        println!("{name}, {} poses", poses.len());
        put("vector", 4, 3);
        put("interpn", 5, 3);
        put("vector_lookup", 1, 0);
        put("interpn_lookup", 2, 0);
        for (key, way) in [("lookup", 0), ("channels", 3)] {
            let [_, ns, _] = quartiles(times.iter().map(|round| round[way]).collect());
            println!("  {key:15} {ns:6.0} ns");
            json.insert(format!("{key}_ns_{name}"), ns.into());
        }
    }
    for (key, [largest, rms]) in [("lookup", ours), ("vector", vector), ("interpn", scalar)] {
        json.insert(format!("force_error_max_{key}"), largest.into());
        json.insert(format!("force_error_rms_{key}"), rms.into());
    }
    if let Some(path) = common::option("--json") {
        let text = serde_json::to_string_pretty(&json).expect("numbers");
        std::fs::write(&path, text).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
}
