//! Fitted node values against sampled ones of the same grid, on poses that neither has seen.

use crate::common;
use flangeway::{Channel, ContactTable, Side, Slot};
use flangeway_host::compile::{Uniform, compile};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::NodeValues;
use flangeway_host::verify::{Quantiles, sample};

#[test]
fn fitted_nodes_err_less_than_sampled_ones() {
    let mut recipe = common::built_in();
    recipe.grid.error_poses = Some(500); // other poses are sampled below
    let pair = Pair::build(&recipe).unwrap();
    let counts: Uniform = "61x7x5x3".parse().unwrap();
    let [sampled, fitted] = [NodeValues::Sampled, NodeValues::Fitted].map(|values| {
        recipe.grid.node_values = values;
        compile(&recipe, &pair, Some(counts)).unwrap().image
    });
    assert_eq!(sampled.len(), fitted.len());
    let errors = |image: &[u8]| {
        let table = ContactTable::new(image).unwrap();
        let samples = sample(&table, &pair, Side::Right, 3000, 20_261_123);
        let of = |value: fn(&flangeway_host::verify::Sample) -> f64| Quantiles::of(samples.iter().map(value).collect());
        (of(|s| s.force_error()), of(|s| s.position))
    };
    let ((force, position), (fitted_force, fitted_position)) = (errors(&sampled), errors(&fitted));
    println!("force, sampled: {force:?}");
    println!("force, fitted:  {fitted_force:?}");
    println!("position (m), sampled: {position:?}");
    println!("position (m), fitted:  {fitted_position:?}");
    for (before, after) in [
        (force.rms, fitted_force.rms),
        (force.median, fitted_force.median),
        (force.p95, fitted_force.p95),
        (force.p99, fitted_force.p99),
    ] {
        assert!(after < 0.7 * before, "{before} became {after}");
    }
    assert!(fitted_position.median < 0.8 * position.median && fitted_position.p95 < 0.8 * position.p95);
}

#[test]
fn fitted_nodes_stay_physical() {
    let recipe = common::built_in();
    let pair = Pair::build(&recipe).unwrap();
    let compiled = compile(&recipe, &pair, Some("41x5x3x3".parse().unwrap())).unwrap();
    let table = ContactTable::new(&compiled.image).unwrap();
    let scales = table.header().right.scales;
    for (lateral, yaw) in (0..41).flat_map(|u| (0..5).map(move |yaw| (u, yaw))) {
        for (roll, vertical) in (0..3).flat_map(|roll| (0..3).map(move |z| (roll, z))) {
            let record = table.node_record(Side::Right, [lateral, yaw, roll, vertical]).unwrap();
            for slot in Slot::ALL {
                let value = |channel: Channel| {
                    let scale = scales[slot.index()][channel.index()];
                    scale.offset + scale.step * f32::from(record[channel.lane(slot)])
                };
                assert!(value(Channel::Stiffness) >= 0.0);
                assert!(value(Channel::SemiAxisAlong) >= 0.0 && value(Channel::SemiAxisAcross) >= 0.0);
            }
        }
    }
    // The parts of the error: the integers cost what their steps say, and next to nothing of the whole.
    let budget = &compiled.budget;
    println!("{budget:#?}");
    assert!((budget.quantisation.rms / budget.quantisation_predicted_rms - 1.0).abs() < 0.2);
    assert!(budget.quantisation.rms < 0.02 * budget.grid.rms && budget.arithmetic.rms < 0.1 * budget.quantisation.rms);
    for channel in &budget.channels {
        // A channel that is nearly constant is rounded the same everywhere, not at random.
        assert!((0.5..1.5).contains(&(channel.measured_rms / channel.predicted_rms)), "{channel:?}");
    }
}

#[test]
fn an_axis_that_ends_without_contact_leaves_its_samples() {
    let mut recipe = common::built_in();
    let pair = Pair::build(&recipe).unwrap();
    recipe.grid.vertical_m.range = [-1e-4, 0.0];
    recipe.grid.error_poses = Some(100);
    let [sampled, fitted] = [NodeValues::Sampled, NodeValues::Fitted].map(|values| {
        recipe.grid.node_values = values;
        compile(&recipe, &pair, Some("5x2x2x2".parse().unwrap())).unwrap().image
    });
    let [sampled, fitted] = [&sampled, &fitted].map(|image| ContactTable::new(image).unwrap());
    for node in (0..5).flat_map(|u| (0..2).map(move |vertical| [u, 1, 0, vertical])) {
        assert_eq!(sampled.node_record(Side::Right, node), fitted.node_record(Side::Right, node));
    }
}
