//! Creep-force laws beside each other, paired in one process: `cargo bench --bench creep`. Ratios to Polach's law.

use std::hint::black_box;
use std::time::Instant;

use flangeway::creep::{
    CreepForces, Creepages, Elasticity, Patch, fastsim, kalker_linear, polach, shen_hedrick_elkins,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

type Law = fn(&Patch, &Elasticity, &Creepages, f32) -> CreepForces;

const ROUNDS: usize = 41;

/// Time of a law over all cases, ns a contact.
fn time(law: Law, cases: &[(Patch, Creepages)]) -> f64 {
    let start = Instant::now();
    for (patch, creepages) in cases {
        black_box(law(black_box(patch), &Elasticity::STEEL, black_box(creepages), 0.3));
    }
    start.elapsed().as_secs_f64() * 1e9 / cases.len() as f64
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn main() {
    let mut stream = Pcg64::seed_from_u64(1);
    let mut between = |low: f32, high: f32| stream.random_range(low..high);
    let cases: Vec<(Patch, Creepages)> = (0..400)
        .map(|_| {
            let semi_axes = [between(2e-3, 9e-3), between(2e-3, 9e-3)];
            let patch = Patch { semi_axes, normal_force: between(5e3, 1.2e5) };
            let (longitudinal, lateral) = (between(-5e-3, 5e-3), between(-5e-3, 5e-3));
            (patch, Creepages { longitudinal, lateral, spin: between(-2.0, 2.0) })
        })
        .collect();
    let laws: [(&str, Law); 6] = [
        ("Polach", polach),
        ("Kalker, linear", |patch, elasticity, creepages, _| kalker_linear(patch, elasticity, creepages)),
        ("Shen-Hedrick-Elkins", shen_hedrick_elkins),
        ("FASTSIM 10 x 10", fastsim::<10, 10>),
        ("FASTSIM 20 x 20", fastsim::<20, 20>),
        ("FASTSIM 50 x 50", fastsim::<50, 50>),
    ];
    // Each round times all laws, so that what slows the machine slows them alike.
    let rounds: Vec<Vec<f64>> = (0..ROUNDS).map(|_| laws.iter().map(|(_, law)| time(*law, &cases)).collect()).collect();
    for (i, (name, _)) in laws.iter().enumerate() {
        let ratio = median(rounds.iter().map(|round| round[i] / round[0]).collect());
        let ns = median(rounds.iter().map(|round| round[i]).collect());
        println!("{name:20} {ratio:7.2} times Polach, {ns:8.1} ns a contact");
    }
}
