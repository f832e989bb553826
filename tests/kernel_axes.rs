//! Search on uneven axes against brute force.

use crate::kernel_synthetic;
use flangeway::AxisName;
use flangeway_host::image::OwnedAxis;
use proptest::prelude::*;

/// Error of a fraction: a cell's reciprocal is in single precision, rounded down.
const RECIPROCAL: f64 = f32::EPSILON as f64;

/// Cell by looking at every node.
fn brute_force(nodes: &[f64], x: f64) -> usize {
    nodes[1..nodes.len() - 1].iter().filter(|node| x >= **node).count()
}

fn check(owned: &OwnedAxis, x: f64) {
    let axis = owned.view();
    let nodes: Vec<f64> = axis.nodes().collect();
    let (place, cell) = (axis.locate(x), brute_force(&nodes, x));
    let (first, last) = axis.range();
    assert_eq!(place.clamped, x < first || x > last);
    // A number beside a node may go to the cell on its other side, where it lies just as well.
    let at_end = |cell: usize| (x - nodes[cell]) / (nodes[cell + 1] - nodes[cell]);
    assert!(
        place.cell == cell || (at_end(place.cell) - at_end(place.cell).round()).abs() < 1e-9,
        "{x} in cell {} of {nodes:?}",
        place.cell
    );
    let fraction = at_end(place.cell);
    assert!((place.fraction - fraction.clamp(0.0, 1.0)).abs() < RECIPROCAL && (0.0..=1.0).contains(&place.fraction));
    let unclamped = fraction.clamp(-1024.0, 1024.0);
    assert!((place.unclamped - unclamped).abs() < RECIPROCAL * unclamped.abs().max(1.0));
}

/// Every node, and the numbers next to it on both sides.
fn check_nodes(nodes: &[f64]) -> OwnedAxis {
    let owned = OwnedAxis::new(AxisName::Lateral, nodes).unwrap();
    let exact: Vec<f64> = owned.view().nodes().collect();
    assert_eq!((exact.len(), exact[0]), (nodes.len(), nodes[0]));
    for (x, given) in exact.into_iter().zip(nodes) {
        assert!((x - given).abs() < 4.1 * f64::from(f32::EPSILON) * 0.012, "{x} for {given}");
        for x in [x.next_down(), x, x.next_up()] {
            check(&owned, x);
        }
    }
    owned
}

/// Evenly spaced nodes in single precision.
fn uniform(n: u16) -> Vec<f64> {
    (0..n).map(|i| f64::from(0.024 * f32::from(i) / f32::from(n - 1) - 0.012)).collect()
}

#[test]
fn nodes_and_their_neighbours() {
    for axis in kernel_synthetic::uneven_axes() {
        check_nodes(&axis);
    }
    for n in 2..300_u16 {
        let uniform = uniform(n);
        check_nodes(&uniform);
    }
}

#[test]
fn uniform_axes_need_about_as_many_bins_as_cells() {
    for n in [2_u16, 9, 121, 241] {
        let uniform = uniform(n);
        let owned = OwnedAxis::new(AxisName::Lateral, &uniform).unwrap();
        assert!(owned.bins() <= usize::from(n) + 1, "{n} nodes: {} bins", owned.bins());
    }
}

#[test]
fn nodes_too_close_or_on_no_lattice() {
    let message = |nodes: &[f64]| OwnedAxis::new(AxisName::Lateral, nodes).unwrap_err().to_string();
    let lattice = "do not increase strictly or lie on no even lattice of up to 4096 intervals";
    assert_eq!(message(&[0.0, 1e-6, 2e-6, 0.125]), format!("lateral axis: 4 nodes {lattice}"));
    assert_eq!(message(&[0.0, 0.027_182_817, 0.057_721_566, 0.125]), format!("lateral axis: 4 nodes {lattice}"));
    for bad in [&[0.125, 0.0][..], &[0.0, f64::NAN, 0.125], &[0.0, f64::INFINITY], &[0.0, 5.0], &[], &[0.0]] {
        assert!(OwnedAxis::new(AxisName::Lateral, bad).is_err(), "{bad:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_axes(
        gaps in prop::collection::vec(1_u16..60, 1..60),
        positions in prop::collection::vec(-0.2_f64..1.2, 40),
    ) {
        let total: u16 = gaps.iter().sum();
        let mut parts = 0;
        let single = |x: f64| f64::from(x as f32);
        let mut nodes = vec![single(-0.012)];
        for gap in &gaps {
            parts += gap;
            nodes.push(single(-0.012 + 0.024 * f64::from(parts) / f64::from(total)));
        }
        let owned = check_nodes(&nodes);
        for t in positions {
            check(&owned, -0.012 + 0.024 * t);
        }
    }
}
