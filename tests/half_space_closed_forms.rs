//! The half-space solver against closed forms: Hertz's circle and ellipse, and the flat round punch.

use std::f64::consts::PI;

use flangeway_host::halfspace::{self, TOLERANCE};
use flangeway_host::hertz;

/// A square grid of elements, `edges` (m), that reaches `reach` (m) to each side.
struct Grid {
    columns: usize,
    rows: usize,
    edges: [f64; 2],
    overlap: Vec<f64>,
}

impl Grid {
    /// Elements of these edges over ±`reach`, moved by a share of an element so that symmetry does not help.
    fn new(reach: [f64; 2], edges: [f64; 2], overlap: impl Fn(f64, f64) -> f64) -> Self {
        let [columns, rows] = [0, 1].map(|k| (2.0 * reach[k] / edges[k]).ceil() as usize + 2);
        let at = |i: usize, count: usize, edge: f64| (i as f64 - 0.5 * count as f64 + 0.31) * edge;
        let place = |n: usize| (at(n % columns, columns, edges[0]), at(n / columns, rows, edges[1]));
        let overlap = (0..columns * rows).map(place).map(|(x, y)| overlap(x, y)).collect();
        Self { columns, rows, edges, overlap }
    }

    /// Force / E* (m²), greatest pressure / E*, area (m²), steps.
    fn solve(&self) -> (f64, f64, f64, usize) {
        let mut grid = halfspace::Grid::new(self.edges, [0, 0], self.columns, vec![0; self.rows], &self.overlap);
        let steps = grid.solve(&[], TOLERANCE);
        let pressure: Vec<f64> = grid.pressures().collect();
        let element = self.edges[0] * self.edges[1];
        let area = pressure.iter().filter(|p| **p > 0.0).count() as f64 * element;
        (pressure.iter().sum::<f64>() * element, pressure.iter().copied().fold(0.0, f64::max), area, steps)
    }
}

/// Errors of force and greatest pressure for Hertz's ellipse with half-curvatures A, B (1/m), indentation 20 µm, and so
/// many elements over each axis of the ellipse.
fn hertz_errors(half_a: f64, half_b: f64, elements: f64) -> [f64; 3] {
    let delta = 20e-6;
    let c = hertz::coefficients(half_a / half_b);
    let size = f64::sqrt(delta / (half_a + half_b));
    let (a, b) = (c.long * size, c.short * size);
    let force = c.normal * delta * size;
    let reach = [f64::sqrt(delta / half_a), f64::sqrt(delta / half_b)];
    let edges = [2.0 * a / elements, 2.0 * b / elements];
    let grid = Grid::new(reach, edges, |x, y| delta - half_a * x * x - half_b * y * y);
    let (found, pressure, area, steps) = grid.solve();
    let errors = [found / force - 1.0, pressure / (1.5 * force / (PI * a * b)) - 1.0, area / (PI * a * b) - 1.0];
    println!(
        "b/a {:.3}, {elements} elements: force {:+.3} %, pressure {:+.3} %, area {:+.2} %; {steps} steps",
        b / a,
        1e2 * errors[0],
        1e2 * errors[1],
        1e2 * errors[2]
    );
    errors
}

#[test]
fn hertz_circle_and_ellipse_within_half_a_percent() {
    // 1:5 is A / B = 0.0675.
    let target = 0.2;
    let (mut low, mut high) = (0.01, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let c = hertz::coefficients(middle);
        if c.short / c.long < target { low = middle } else { high = middle }
    }
    for ratio in [1.0, low] {
        for elements in [12.0, 16.0, 24.0, 32.0, 48.0] {
            let [force, pressure, area] = hertz_errors(2.0, 2.0 / ratio, elements);
            if elements >= 24.0 {
                assert!(force.abs() < 5e-3 && pressure.abs() < 5e-3 && area.abs() < 0.03);
            }
        }
    }
}

/// A flat round punch of radius a, pressed in by δ: N = 2 E* a δ (Johnson, section 3.4 d). The pressure is infinite at
/// the rim, so the error falls with the first power of the element.
#[test]
fn flat_punch_converges_to_its_closed_form() {
    let (a, delta) = (5e-3, 20e-6);
    let errors: Vec<f64> = [20.0, 40.0, 80.0]
        .iter()
        .map(|elements| {
            let edge = 2.0 * a / elements;
            let inside = |x: f64, y: f64| if x * x + y * y < a * a { delta } else { -1.0 };
            let (force, _, area, steps) = Grid::new([a, a], [edge, edge], inside).solve();
            // The steps of the rim change the area: compare with the punch of the grid's own area.
            let radius = (area / PI).sqrt();
            let error = force / (2.0 * radius * delta) - 1.0;
            println!("{elements} elements: force {:+.3} %; {steps} steps", 1e2 * error);
            error
        })
        .collect();
    assert!(errors[0].abs() < 0.03 && errors[1].abs() < 0.015 && errors[2].abs() < 0.0075, "{errors:?}");
}
