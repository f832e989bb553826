//! Search on uneven axes against brute force.

mod kernel_synthetic;

use flangeway::AxisName;
use flangeway_host::image::OwnedAxis;
use proptest::prelude::*;

/// Cell by looking at every node.
fn brute_force(nodes: &[f32], x: f64) -> usize {
    nodes[1..nodes.len() - 1].iter().filter(|node| x >= f64::from(**node)).count()
}

fn check(nodes: &[f32], x: f64) {
    let owned = OwnedAxis::new(AxisName::Lateral, nodes).unwrap();
    let place = owned.view().locate(x);
    assert_eq!(place.cell, brute_force(nodes, x), "{x} in {nodes:?}");
    let (lower, upper) = (f64::from(nodes[place.cell]), f64::from(nodes[place.cell + 1]));
    let (first, last) = (f64::from(nodes[0]), f64::from(nodes[nodes.len() - 1]));
    assert_eq!(place.clamped, x < first || x > last);
    let fraction = (x - lower) * (1.0 / (upper - lower));
    assert_eq!(place.fraction, fraction.clamp(0.0, 1.0));
    assert_eq!(place.unclamped, fraction.clamp(-1024.0, 1024.0));
}

/// Every node, and the numbers next to it on both sides.
fn check_nodes(nodes: &[f32]) {
    for node in nodes {
        let x = f64::from(*node);
        for x in [x.next_down(), x, x.next_up()] {
            check(nodes, x);
        }
    }
}

#[test]
fn nodes_and_their_neighbours() {
    for axis in kernel_synthetic::uneven_axes() {
        check_nodes(&axis);
    }
    for n in 2..300_u16 {
        let uniform: Vec<f32> = (0..n).map(|i| 0.024 * f32::from(i) / f32::from(n - 1) - 0.012).collect();
        check_nodes(&uniform);
    }
}

#[test]
fn uniform_axes_need_about_as_many_bins_as_cells() {
    for n in [2_u16, 9, 121, 241] {
        let uniform: Vec<f32> = (0..n).map(|i| 0.024 * f32::from(i) / f32::from(n - 1) - 0.012).collect();
        let owned = OwnedAxis::new(AxisName::Lateral, &uniform).unwrap();
        assert!(owned.bins() <= usize::from(n) + 1, "{n} nodes: {} bins", owned.bins());
    }
}

#[test]
fn nodes_too_close_for_the_map() {
    let message = OwnedAxis::new(AxisName::Lateral, &[0.0, 1e-6, 2e-6, 0.1]).unwrap_err().to_string();
    assert_eq!(message, "lateral axis: 4 nodes do not increase strictly or lie too close for 4096 bins");
    for bad in [&[0.1_f32, 0.0][..], &[0.0, f32::NAN, 0.1], &[0.0, f32::INFINITY], &[0.0, 5.0], &[], &[0.0]] {
        assert!(OwnedAxis::new(AxisName::Lateral, bad).is_err(), "{bad:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_axes(
        gaps in prop::collection::vec(1.0_f32..40.0, 1..60),
        positions in prop::collection::vec(-0.2_f64..1.2, 40),
    ) {
        let total: f32 = gaps.iter().sum();
        let mut nodes = vec![-0.012_f32];
        for gap in &gaps {
            nodes.push(nodes[nodes.len() - 1] + 0.024 * gap / total);
        }
        check_nodes(&nodes);
        for t in positions {
            check(&nodes, -0.012 + 0.024 * t);
        }
    }
}
