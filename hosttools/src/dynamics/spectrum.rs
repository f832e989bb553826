//! Track irregularities by the spectra of ORE B176 (later ERRI), low and high, as random series with a seed.
//!
//! One-sided spectra over the angular wave number Ω (rad/m), variance σ² = ∫ S dΩ over Ω > 0 (ORE B176/3, "Bogies with
//! steered or steering wheelsets", 1989; also printed by Claus and Schiehlen, "Modeling and simulation of railway bogie
//! structural vibrations", Vehicle System Dynamics 29 S1, 1998). Lateral alignment and vertical profile in m², cross
//! level as an angle in rad², with b half of the distance between the running circles:
//!
//! ```text
//! S_lateral  = A_l Ωc² / ((Ω² + Ωr²) (Ω² + Ωc²))
//! S_vertical = A_v Ωc² / ((Ω² + Ωr²) (Ω² + Ωc²))
//! S_cross    = A_v / b² Ωc² Ω² / ((Ω² + Ωr²) (Ω² + Ωc²) (Ω² + Ωs²))
//! Ωc = 0.8246 rad/m,  Ωr = 0.0206 rad/m,  Ωs = 0.4380 rad/m
//! ```

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::irregularity::{Irregularity, Offsets};

const CUT: f64 = 0.8246;
const ROLL_OFF: f64 = 0.0206;
const CROSS: f64 = 0.4380;

/// Distance (m) between two samples of a generated series: a twelfth of the shortest wave.
const SPACING: f64 = 0.25;

/// How rough the track is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Roughness {
    /// ORE B176 low: well maintained.
    OreB176Low,
    /// ORE B176 high.
    OreB176High,
}

impl Roughness {
    /// A of lateral alignment and of vertical profile, m² rad/m.
    const fn amplitudes(self) -> [f64; 2] {
        match self {
            Self::OreB176Low => [2.119e-7, 4.032e-7],
            Self::OreB176High => [6.125e-7, 1.080e-6],
        }
    }

    /// Spectral densities at Ω (rad/m): lateral and vertical in m² / (rad/m), cross level in rad² / (rad/m) for a
    /// distance `2 half_base` (m) between the running circles.
    #[must_use]
    pub fn densities(self, wave_number: f64, half_base: f64) -> [f64; 3] {
        let [lateral, vertical] = self.amplitudes();
        let square = wave_number * wave_number;
        let shape = CUT * CUT / ((square + ROLL_OFF * ROLL_OFF) * (square + CUT * CUT));
        let cross = square / ((square + CROSS * CROSS) * half_base * half_base);
        [lateral * shape, vertical * shape, vertical * shape * cross]
    }

    /// A series over `length` (m) with waves between the two lengths (m), the same for the same seed: a sum of cosines
    /// with random phases (Shinozuka and Jan, Journal of Sound and Vibration 25, 1972).
    ///
    /// ```text
    /// x(s) = Σ √(2 S(Ωk) ΔΩ) cos(Ωk s + φk),   ΔΩ = 2π / length: it does not repeat
    /// ```
    #[must_use]
    pub fn series(self, length: f64, waves: [f64; 2], half_base: f64, seed: u64) -> Irregularity {
        let step = TAU / length;
        let [first, last] = [TAU / waves[1], TAU / waves[0]].map(|w| (w / step).round().max(1.0) as u64);
        let mut stream = Pcg64::seed_from_u64(seed);
        let lines: Vec<(f64, [[f64; 2]; 3])> = (first..=last)
            .map(|k| {
                let wave_number = step * k as f64;
                let line = self.densities(wave_number, half_base).map(|density| {
                    let phase = TAU * stream.random::<f64>();
                    let amplitude = (2.0 * density * step).sqrt();
                    [amplitude * libm::cos(phase), amplitude * libm::sin(phase)]
                });
                (wave_number, line)
            })
            .collect();
        let count = (length / SPACING).ceil() as usize + 1;
        let at = |i: usize| {
            let distance = SPACING * i as f64;
            let mut sum = [0.0; 3];
            for (wave_number, line) in &lines {
                let (sin, cos) = (libm::sin(wave_number * distance), libm::cos(wave_number * distance));
                for (sum, [c, s]) in sum.iter_mut().zip(line) {
                    *sum += c * cos - s * sin;
                }
            }
            (distance, Offsets { lateral: sum[0], vertical: sum[1], cross_level: sum[2] })
        };
        Irregularity::new((0..count).map(at).collect())
    }
}
