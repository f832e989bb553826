//! Generated track irregularities against the spectra they are to have.

use std::f64::consts::TAU;

use flangeway_host::dynamics::irregularity::Irregularity;
use flangeway_host::dynamics::spectrum::Roughness;

const LENGTH: f64 = 1000.0;
const WAVES: [f64; 2] = [3.0, 100.0];
const HALF_BASE: f64 = 0.75;

fn channels(series: &Irregularity) -> [Vec<f64>; 3] {
    // One period: the last sample is the first again.
    let samples = &series.samples()[..series.samples().len() - 1];
    [0, 1, 2].map(|k| samples.iter().map(|(_, o)| [o.lateral, o.vertical, o.cross_level][k]).collect())
}

/// One-sided periodogram at k waves in the length, by the definition of Fourier's coefficients: variance per rad/m.
fn periodogram(values: &[f64], k: usize) -> f64 {
    let n = values.len() as f64;
    let phase = |i: usize| TAU * (k as f64) * (i as f64) / n;
    let cosine: f64 = values.iter().enumerate().map(|(i, x)| x * phase(i).cos()).sum();
    let sine: f64 = values.iter().enumerate().map(|(i, x)| x * phase(i).sin()).sum();
    2.0 * (cosine * cosine + sine * sine) / (n * n) / (TAU / LENGTH)
}

#[test]
fn spectra_are_those_of_the_formulas() {
    for roughness in [Roughness::OreB176Low, Roughness::OreB176High] {
        let series = roughness.series(LENGTH, WAVES, HALF_BASE, 7);
        let channels = channels(&series);
        for k in [12, 40, 100, 200, 320] {
            let wave_number = TAU * k as f64 / LENGTH;
            let formula = roughness.densities(wave_number, HALF_BASE);
            for (values, density) in channels.iter().zip(formula) {
                let found = periodogram(values, k);
                assert!((found / density - 1.0).abs() < 1e-6, "{roughness:?} {k}: {found:e} against {density:e}");
            }
        }
        // Outside its band of waves there is nothing.
        assert!(periodogram(&channels[1], 5) < 1e-6 * periodogram(&channels[1], 12));
    }
}

#[test]
fn variance_is_the_integral_of_the_spectrum() {
    // ∫ A Ωc² / ((Ω² + Ωr²)(Ω² + Ωc²)) dΩ = A Ωc² / (Ωc² - Ωr²) [atan(Ω/Ωr)/Ωr - atan(Ω/Ωc)/Ωc]
    let (cut, off): (f64, f64) = (0.8246, 0.0206);
    let primitive = |w: f64| ((w / off).atan() / off - (w / cut).atan() / cut) * cut * cut / (cut * cut - off * off);
    let band = primitive(TAU / WAVES[0]) - primitive(TAU / WAVES[1]);
    for (roughness, [lateral, vertical]) in
        [(Roughness::OreB176Low, [2.119e-7, 4.032e-7]), (Roughness::OreB176High, [6.125e-7, 1.080e-6])]
    {
        let channels = channels(&roughness.series(LENGTH, WAVES, HALF_BASE, 3));
        for (values, amplitude) in channels.iter().zip([lateral, vertical]) {
            let variance = values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
            println!(
                "{roughness:?}: {:.3} mm rms, formula {:.3}",
                1e3 * variance.sqrt(),
                1e3 * (amplitude * band).sqrt()
            );
            // The sum over lines 2π/1000 rad/m apart against the integral.
            assert!((variance / (amplitude * band) - 1.0).abs() < 0.06);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_track_and_another_seed_another() {
    let series = |seed| Roughness::OreB176Low.series(200.0, WAVES, HALF_BASE, seed);
    assert_eq!(series(1), series(1));
    assert_ne!(series(1), series(2));
}
