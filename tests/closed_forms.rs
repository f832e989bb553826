//! The direct solver where the answer is known in closed form: a sphere on a plane, a cone on a cylinder.

use crate::common::{self, MM};
use flangeway::{Pose, Side};
use flangeway_host::contact::{SLOTS, SlotState};
use flangeway_host::contacts::track_position;
use flangeway_host::hertz;
use flangeway_host::pair::Pair;

/// Lateral place of both tape circles in these tests (m).
const B: f64 = 0.75;

/// A pair of built-in profiles, the rail's origin at y = 0.75 m, the material of the CONTACT test bank (G = 82 GPa).
fn pair(wheel: &str, radius: f64, rail: &str, cant: f64) -> Pair {
    let text = format!(
        r#"
        wheel = {{ profile = "{wheel}", nominal_radius_m = {radius}, flange_back_spacing_m = 1.36, flange_back_position_m = -0.07 }}
        rail = {{ profile = "{rail}", origin_m = [{B}, 0.0], cant_rad = {cant} }}
        material = {{ youngs_modulus_pa = 2.0992e11, poisson_ratio = 0.28 }}
        [grid]
        lateral_m = {{ range = [-0.005, 0.005] }}
        yaw_rad = {{ range = [0.0, 0.04] }}
        vertical_m = {{ range = [-5e-5, 1.5e-4] }}
        roll_rad = {{ range = [-1e-3, 1e-3] }}
        "#
    );
    Pair::build(&common::recipe(&text)).unwrap()
}

/// The one slot that is in contact; the test fails where there are others.
fn only(slots: &[SlotState; SLOTS]) -> SlotState {
    let carrying: Vec<&SlotState> = slots.iter().filter(|s| s.normal_force() > 0.0).collect();
    assert_eq!(carrying.len(), 1, "{slots:?}");
    *carrying[0]
}

/// The deepest slot's indentation at a height.
fn indentation(pair: &Pair, pose: &Pose) -> f64 {
    pair.solve(Side::Right, pose).iter().map(|s| s.indentation).fold(f64::MIN, f64::max)
}

/// The height (m) at which the wheel is indented by `delta` (m), by bisection.
fn height_for(pair: &Pair, pose: Pose, delta: f64) -> f64 {
    let (touching, _) = pair.column(Side::Right, &pose).touching(None).unwrap();
    let (mut low, mut high) = (touching - 1e-4, touching + 1e-4);
    for _ in 0..60 {
        let vertical = 0.5 * (low + high);
        if indentation(pair, &Pose { vertical, ..pose }) < delta { low = vertical } else { high = vertical }
    }
    0.5 * (low + high)
}

/// CONTACT test bank: wheel circ_r100 (a sphere of 100 mm), rail flat_plane at y = 750 mm rolled by -0.0997 rad, yaw
/// 2 degrees: x = -26.1746 mm, contact angle -0.0997, FN 10050 N (Hertz 10063 N) at an approach of 0.03528 mm.
#[test]
fn the_printed_yaw_case() {
    let pair = pair("circular_wheel:0.1", 0.1, "flat_rail", 0.0997);
    let yaw = 2.0_f64.to_radians();
    // The rail's plane is 0.75 (1 - cos yaw) farther out than the wheel, well inside its width.
    let mut pose = Pose { yaw, ..Pose::default() };
    pose.vertical = height_for(&pair, pose, 0.03528 * MM);
    let state = only(&pair.solve(Side::Right, &pose));
    let [x, y, z] = track_position(&pair, Side::Right, &pose, &state);
    println!(
        "x {:.4} mm (printed -26.1746), angle {:.4} (-0.0997), indentation {:.5} mm (0.03528), force {:.0} N (10050, \
         Hertz 10063); y {:.3} mm, z {:.3} mm",
        x / MM,
        state.angle,
        state.indentation / MM,
        state.normal_force(),
        y / MM,
        z / MM
    );
    assert!((state.indentation / MM - 0.03528).abs() < 1e-9);
    assert!((x / MM + 26.1746).abs() < 1e-4);
    assert!((state.angle + 0.0997).abs() < 1e-9);
    assert!((state.normal_force() / 10050.0 - 1.0).abs() < 0.005);
    assert!((state.normal_force() / 10063.0 - 1.0).abs() < 1e-4, "Hertz's own figure, printed to five digits");
}

/// A sphere whose centre lies on the axle at b, on a plane inclined by γ through (0.75, 0):
///
/// ```text
/// centre = (-b cos φ sin ψ, y + b cos φ cos ψ, z - r0 + b sin φ),   n = (0, sin γ, cos γ) into the rail
/// δ = (centre - (0, 0.75, 0)) · n + R,   contact at centre + R n,   N = 4/3 E* √R δ^1.5
/// ```
#[test]
fn a_sphere_on_a_plane() {
    let mut worst = [0.0_f64; 3];
    for (radius, cant) in [(0.1, 0.0997), (0.1, 0.0), (0.3, 0.025)] {
        let pair = pair(&format!("circular_wheel:{radius}"), radius, "flat_rail", cant);
        // cant turns the rail towards the track's centre: its slope is negative
        let (n, modulus) = ([f64::sin(cant), f64::cos(cant)], 0.5 * 2.0992e11 / (1.0 - 0.28 * 0.28));
        for yaw in [0.0, 1e-6, 0.004, 0.02, 0.04, 0.1] {
            for (roll, lateral) in [(0.0, 0.0), (0.002, -0.006), (-0.011, 0.009), (0.02, 0.003)] {
                let centre = |z: f64| {
                    let (sr, cr) = f64::sin_cos(roll);
                    let (sy, cy) = f64::sin_cos(yaw);
                    [-B * cr * sy, lateral + B * cr * cy, z - radius + B * sr]
                };
                let depth = |z: f64| {
                    let c = centre(z);
                    (c[1] - B) * n[0] + c[2] * n[1] + radius
                };
                for delta in [3e-6, 3e-5, 1.2e-4] {
                    let vertical = (delta - depth(0.0)) / n[1];
                    let pose = Pose { lateral, yaw, vertical, roll };
                    let state = only(&pair.solve(Side::Right, &pose));
                    let c = centre(vertical);
                    let expected = [c[0], c[1] + radius * n[0], c[2] + radius * n[1]];
                    let found = track_position(&pair, Side::Right, &pose, &state);
                    let apart = (0..3).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
                    let force = 4.0 / 3.0 * modulus * radius.sqrt() * delta.powf(1.5);
                    worst[0] = worst[0].max(apart);
                    worst[1] = worst[1].max((state.indentation - delta).abs());
                    worst[2] = worst[2].max((state.normal_force() / force - 1.0).abs());
                    assert!((state.angle + cant).abs() < 1e-9, "{}", state.angle);
                }
            }
        }
    }
    let [position, indentation, force] = worst;
    println!("sphere on plane: position within {position:.1e} m, indentation {indentation:.1e} m, force {force:.1e}");
    assert!(position < 1e-6 && indentation < 1e-11 && force < 1e-4);
}

/// A cone (conicity tan θ, no yaw) on a rail head of radius R_r whose crown is at (0.75, 0). With the roll φ its
/// generator is a straight line at the angle α = φ - θ, so the contact lies where the rail has that angle:
///
/// ```text
/// p0 = (y + b cos φ - r0 sin φ, z - r0 + b sin φ + r0 cos φ)     tape-circle point
/// t = (cos α, sin α),  n = (-sin α, cos α),  c = (0.75, R_r)      rail's centre
/// δ = R_r - (c - p0) · n,   contact at p0 + ((c - p0) · t) t,   r = r0 - sin θ (c - p0) · t
/// A = cos θ / (2 r),  B = 1 / (2 R_r)                             half curvatures
/// ```
#[test]
fn a_cone_on_a_circular_rail() {
    let mut worst = [0.0_f64; 3];
    for (conicity, r0, rail_radius) in [(0.05, 0.46, 0.3), (0.1, 0.46, 0.08), (0.05, 0.15, 0.46)] {
        let pair = pair(&format!("cone:{conicity}"), r0, &format!("circular_rail:{rail_radius}"), 0.0);
        let theta = f64::atan(conicity);
        let modulus = 0.5 * 2.0992e11 / (1.0 - 0.28 * 0.28);
        for (roll, lateral) in [(0.0, 0.0), (0.002, -0.006), (-0.011, 0.009), (0.02, 0.003)] {
            let (sr, cr) = f64::sin_cos(roll);
            let (sa, ca) = f64::sin_cos(roll - theta);
            // From the tape-circle point to the rail's centre.
            let gap = |z: f64| [B - (lateral + B * cr - r0 * sr), rail_radius - (z - r0 + B * sr + r0 * cr)];
            let depth = |z: f64| rail_radius - (ca * gap(z)[1] - sa * gap(z)[0]);
            for delta in [3e-6, 3e-5, 1.2e-4] {
                let vertical = (delta - depth(0.0)) / ca;
                let pose = Pose { lateral, yaw: 0.0, vertical, roll };
                let state = only(&pair.solve(Side::Right, &pose));
                let along = ca * gap(vertical)[0] + sa * gap(vertical)[1];
                let expected = [0.0, B - gap(vertical)[0] + along * ca, rail_radius - gap(vertical)[1] + along * sa];
                let found = track_position(&pair, Side::Right, &pose, &state);
                let radius = r0 - theta.sin() * along;
                let (a, b) = (0.5 * theta.cos() / radius, 0.5 / rail_radius);
                let c = hertz::coefficients(a.min(b) / a.max(b));
                let force = c.normal * modulus * delta.powf(1.5) / (a + b).sqrt();
                let semi_axis_x = if a < b { c.long } else { c.short } * (delta / (a + b)).sqrt();
                let apart = (0..3).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
                worst[0] = worst[0].max(apart);
                worst[1] = worst[1].max((state.indentation - delta).abs());
                worst[2] = worst[2].max((state.normal_force() / force - 1.0).abs());
                assert!((state.angle - (roll - theta)).abs() < 1e-9);
                assert!((state.semi_axis_x * delta.sqrt() / semi_axis_x - 1.0).abs() < 1e-4);
                assert!((state.radius_offset - (radius - r0)).abs() < 1e-6);
            }
        }
    }
    let [position, indentation, force] = worst;
    println!("cone on circle: position within {position:.1e} m, indentation {indentation:.1e} m, force {force:.1e}");
    assert!(position < 1e-6 && indentation < 1e-11 && force < 1e-4);
}
