//! Made-up tables for the kernel's tests: every channel is a multilinear function of the table's coordinates, so the
//! lookup must reproduce it to the quantisation.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part of this")]

use flangeway::{
    AxisCounts, CHANNELS, CONFORMAL_LANE, Channel, Coordinates, ErrorFigures, Header, LANES, Material, SLOTS, Scales,
    SideHeader, Slot, WheelGeometry,
};
use flangeway_host::image::{ImageParts, SideParts, quantise, scale_over, scale_through_zero, write_image};

/// A table's parts, owned.
pub struct Synthetic {
    pub axes: [Vec<f64>; 4],
    /// Parts of an interval in the rigid map.
    pub refinement: [u8; 2],
    pub sides: Vec<SyntheticSide>,
}

/// A side's parts, owned.
pub struct SyntheticSide {
    pub geometry: WheelGeometry,
    pub scales: Scales,
    pub rigid: Vec<[f32; 4]>,
    pub records: Vec<[i16; LANES]>,
}

/// Uneven axes of moderate size.
pub fn uneven_axes() -> [Vec<f64>; 4] {
    [
        vec![-0.012, -0.007, -0.006, -0.0035, 0.0, 0.004, 0.0081, 0.0112],
        vec![0.0, 0.002, 0.01, 0.04],
        vec![-0.002, 0.0005, 0.003],
        vec![-0.0001, 0.00005, 0.0003],
    ]
    .map(|axis: Vec<f32>| axis.into_iter().map(f64::from).collect())
}

/// The smallest axes there are.
pub fn smallest_axes() -> [Vec<f64>; 4] {
    let pair = |a: f32, b: f32| vec![f64::from(a), f64::from(b)];
    [pair(-0.01, 0.01), pair(0.0, 0.03125), pair(-0.0025, 0.0025), pair(0.0, 0.00025)]
}

/// Nodes of an axis with each interval divided into parts.
pub fn divided(axis: &[f64], parts: u8) -> Vec<f64> {
    let inner = |w: &[f64]| {
        let (a, b) = (w[0], w[1]);
        (0..parts).map(move |k| a + (b - a) * f64::from(k) / f64::from(parts)).collect::<Vec<_>>()
    };
    axis.windows(2).flat_map(inner).chain(axis.last().copied()).collect()
}

/// Rigid roll, rad: bilinear.
pub fn rigid_roll(u: f64, yaw: f64) -> f64 {
    0.03 * u - 0.5 * u * yaw + 0.0001
}

/// Coefficients of the rigid height's parabola in the roll offset, m, m/rad, m/rad²: bilinear.
pub fn rigid_height(u: f64, yaw: f64) -> [f64; 3] {
    [0.05 * u + 0.01 * yaw + 0.7 * u * yaw, -0.1 - u + 3.0 * u * yaw, 0.4 + 10.0 * u - 2.0 * yaw + 50.0 * u * yaw]
}

/// Rigid vertical displacement, m.
pub fn rigid_vertical(u: f64, yaw: f64, roll: f64) -> f64 {
    let [h0, h1, h2] = rigid_height(u, yaw);
    h0 + h1 * roll + h2 * roll * roll
}

/// Centre and amplitude of a channel.
fn span(channel: Channel) -> (f64, f64) {
    match channel {
        Channel::Indentation => (3e-5, 4e-4),
        Channel::Stiffness => (9e10, 4e10),
        Channel::SemiAxisAlong => (0.5, 0.2),
        Channel::SemiAxisAcross => (0.3, 0.2),
        Channel::Longitudinal => (0.0, 0.03),
        Channel::WheelCoordinate => (-0.01, 0.03),
        Channel::RadiusOffset => (0.005, 0.01),
        Channel::Angle => (-0.4, 0.35),
        Channel::WheelCurvature => (10.0, 40.0),
        Channel::RailCurvature => (5.0, 20.0),
    }
}

/// Value of a channel at normalised coordinates (-1 to 1 over each axis), multilinear; `seed` tells sides apart.
pub fn value(slot: Slot, channel: Channel, n: [f64; 4], seed: f64) -> f64 {
    let (centre, amplitude) = span(channel);
    let k = 1.0 + slot.index() as f64 + 0.1 * channel.index() as f64 + seed;
    // Any irregular numbers in -1..1 will do.
    let wave = |i: f64| (k * i).sin();
    let [u, p, r, z] = n;
    let sum = wave(1.0) * u
        + wave(2.0) * p
        + wave(3.0) * r
        + 2.0 * z
        + wave(4.0) * u * p
        + wave(5.0) * r * z
        + wave(6.0) * u * p * r * z;
    centre + amplitude * sum / 8.0
}

/// A coordinate normalised to -1..1 over an axis.
pub fn normalised(axis: &[f64], x: f64) -> f64 {
    let (a, b) = (axis[0], axis[axis.len() - 1]);
    2.0 * (x - a) / (b - a) - 1.0
}

impl Synthetic {
    /// A table over these axes with one or two sides, the rigid map on the same axes.
    pub fn new(axes: [Vec<f64>; 4], sides: usize) -> Self {
        Self::refined(axes, [1; 2], sides)
    }

    /// The same with a rigid map of so many parts in an interval.
    pub fn refined(axes: [Vec<f64>; 4], refinement: [u8; 2], sides: usize) -> Self {
        let sides = (0..sides).map(|side| SyntheticSide::new(&axes, refinement, 0.37 * side as f64)).collect();
        Self { axes, refinement, sides }
    }

    /// A mirrored table with uneven axes.
    pub fn uneven() -> Self {
        Self::refined(uneven_axes(), [4, 2], 1)
    }

    /// Normalised coordinates of table coordinates.
    pub fn normalised(&self, at: &Coordinates) -> [f64; 4] {
        let x = [at.lateral, at.yaw, at.roll_offset, at.vertical];
        std::array::from_fn(|i| normalised(&self.axes[i], x[i]))
    }

    /// The header, its axis counts not yet filled in.
    pub fn header(&self) -> Header<'static> {
        Header {
            generator: "flangeway tests",
            solver: "none",
            recipe_sha256: [7; 32],
            gauge: 1.435,
            material: Material { young_modulus: 2.1e11, poisson_ratio: 0.28 },
            axes: [AxisCounts::default(); 4],
            refinement: self.refinement,
            errors: ErrorFigures::default(),
            right: self.sides[0].header(),
            left: self.sides.get(1).map(SyntheticSide::header),
        }
    }

    /// The image.
    pub fn image(&self) -> Vec<u8> {
        write_image(&self.parts()).unwrap()
    }

    /// The writer's input.
    pub fn parts(&self) -> ImageParts<'_> {
        ImageParts {
            header: self.header(),
            axes: std::array::from_fn(|i| self.axes[i].as_slice()),
            right: self.sides[0].parts(),
            left: self.sides.get(1).map(SyntheticSide::parts),
        }
    }
}

impl SyntheticSide {
    fn new(axes: &[Vec<f64>; 4], refinement: [u8; 2], seed: f64) -> Self {
        let mut scales: Scales = [[scale_over(0.0, 1.0); CHANNELS]; SLOTS];
        for slot in Slot::ALL {
            for channel in Channel::ALL {
                let (centre, amplitude) = span(channel);
                scales[slot.index()][channel.index()] = match channel {
                    Channel::Stiffness => scale_through_zero(centre + amplitude),
                    _ => scale_over(centre - amplitude, centre + amplitude),
                };
            }
        }
        let mut records = Vec::new();
        for u in &axes[0] {
            for p in &axes[1] {
                for r in &axes[2] {
                    for z in &axes[3] {
                        let x = [u, p, r, z].map(|x| *x);
                        let n = std::array::from_fn(|i| normalised(&axes[i], x[i]));
                        let mut record = [0; LANES];
                        for slot in Slot::ALL {
                            for channel in Channel::ALL {
                                let scale = &scales[slot.index()][channel.index()];
                                record[channel.lane(slot)] = quantise(scale, value(slot, channel, n, seed));
                            }
                        }
                        record[CONFORMAL_LANE] = if n[0] > 0.9 { 32767 } else { 0 };
                        records.push(record);
                    }
                }
            }
        }
        let [lateral, yaw] = std::array::from_fn(|i| divided(&axes[i], refinement[i]));
        let node = |u: f64, p: f64| {
            let [h0, h1, h2] = rigid_height(u, p);
            [rigid_roll(u, p), h0, h1, h2].map(|x| x as f32)
        };
        let rigid = lateral.iter().flat_map(|&u| yaw.iter().map(move |&p| node(u, p))).collect();
        Self {
            geometry: WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 + 0.001 * seed },
            scales,
            rigid,
            records,
        }
    }

    fn header(&self) -> SideHeader<'static> {
        SideHeader {
            wheel: "made-up wheel",
            rail: "made-up rail",
            wheel_sha256: [1; 32],
            rail_sha256: [2; 32],
            geometry: self.geometry,
            slot_boundaries: [-0.02, -0.035],
            scales: self.scales,
        }
    }

    fn parts(&self) -> SideParts<'_> {
        SideParts { rigid: &self.rigid, records: &self.records }
    }
}
