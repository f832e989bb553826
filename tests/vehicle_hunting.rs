//! Hunting of a conical wheelset at small amplitude against Klingel's wavelength.

use std::f64::consts::TAU;
use std::path::Path;

use flangeway::Side;
use flangeway::creep::{Elasticity, Friction};
use flangeway_host::dynamics::body::{FrameTurn, LATERAL, PITCH, VERTICAL, Vector5, YAW};
use flangeway_host::dynamics::source::Source;
use flangeway_host::dynamics::track::GRAVITY;
use flangeway_host::dynamics::wheel_rail::{Law, WheelRail};
use flangeway_host::dynamics::wheelset::{Inputs, Parameters, Wheelset};
use flangeway_host::pair::Pair;
use flangeway_host::recipe::Recipe;
use flangeway_host::rigid::two_wheels;

const RADIUS: f64 = 0.46;
const RAIL_RADIUS: f64 = 0.3;

fn recipe(conicity: &str) -> Recipe {
    let text = format!(
        r#"
[wheel]
profile = "cone:{conicity}"
nominal_radius_m = {RADIUS}
flange_back_spacing_m = 1.36
flange_back_position_m = -0.07
[rail]
profile = "circular_rail:{RAIL_RADIUS}"
gauge_m = 1.435
gauge_height_m = 0.003
[material]
youngs_modulus_pa = 2.1e11
poisson_ratio = 0.28
[grid]
lateral_m = {{ range = [-0.01, 0.01], nodes = 3 }}
yaw_rad = {{ range = [0.0, 0.02], nodes = 3 }}
vertical_m = {{ range = [-5.0e-5, 1.5e-4], nodes = 3 }}
roll_rad = {{ range = [-1.0e-3, 1.0e-3], nodes = 3 }}
"#
    );
    Recipe::parse(&text, Path::new("cone.toml")).unwrap()
}

/// Wavelength (m) of the free wheelset's hunting, from the crossings of its lateral displacement with the middle.
fn wavelength(pair: &Pair, speed: f64) -> f64 {
    let contact = WheelRail {
        source: Source::Direct(pair),
        law: Law::Kalker,
        friction: Friction::constant(0.3),
        elasticity: Elasticity::STEEL,
        damping: 2.5,
    };
    // Light, so that inertia leaves the rolling alone: Klingel's wheelset has none.
    let parameters = Parameters { mass_kg: 600.0, roll_yaw_inertia_kgm2: 400.0, spin_inertia_kgm2: 120.0 };
    let load = 80e3 - parameters.mass_kg * GRAVITY;
    let inputs = Inputs { speed, loads: Vector5::new(0.0, load, 0.0, 0.0, 0.0), ..Inputs::default() };
    let rest = two_wheels(pair, 0.0, 0.0).unwrap();
    let mut wheelset = Wheelset::default();
    wheelset.body.position[LATERAL] = 0.5e-3;
    wheelset.body.position[VERTICAL] = rest.vertical + 60e-6;
    wheelset.body.velocity[PITCH] = speed / rest.right.wheel.radius;
    let step = 1e-4;
    let mut crossings = Vec::new();
    for i in 0..(45.0 / speed / step) as usize {
        let before = wheelset.body.position[LATERAL];
        wheelset.step(step, FrameTurn::default(), &inputs, &parameters, &contact);
        let after = wheelset.body.position[LATERAL];
        if before * after < 0.0 {
            crossings.push((i as f64 + before / (before - after)) * step * speed);
        }
    }
    assert!(crossings.len() >= 3, "{crossings:?}");
    assert!(wheelset.body.position[YAW].abs() < 1e-2);
    2.0 * (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}

/// A cone shifts on a round rail: where it touches moves by the rail's radius R times the roll. With the roll γ y / (b -
/// r0 γ) of a wheelset that is displaced by y, the radii differ by more than γ y and the wheelset sways by less than its
/// yaw, and of both together there remains, to first order in the amplitude (as Wickens' formula for conicity):
///
/// ```text
/// Δr = γ y (b + R γ) / (b - r0 γ),   y' = ψ (b - r0 γ) / b,   so L = 2π √(r0 b / γ) / √(1 + R γ / b)
/// ```
#[test]
fn hunting_wavelength_is_klingels() {
    for (conicity, number) in [("1/40", 0.025), ("1/20", 0.05), ("1/8", 0.125)] {
        let pair = Pair::build(&recipe(conicity)).unwrap();
        let rest = two_wheels(&pair, 0.0, 0.0).unwrap();
        // Radius and half of the distance where the wheels touch.
        let geometry = pair.body(Side::Right).wheel().geometry();
        let (r0, b) = (rest.right.wheel.radius, geometry.lateral_position + rest.right.wheel.s);
        // L = 2π √(r0 b / γ)
        let klingel = TAU * (r0 * b / number).sqrt();
        let on_round_rails = klingel / (1.0 + RAIL_RADIUS * number / b).sqrt();
        let found = wavelength(&pair, 10.0);
        let [plain, round] = [klingel, on_round_rails].map(|l| 1e2 * (found / l - 1.0));
        println!("cone {conicity}: {found:.3} m, Klingel {klingel:.3} m, {plain:+.2} %; on round rails {round:+.3} %");
        assert!(plain.abs() < 2.0 || number > 0.1);
        assert!(round.abs() < 0.2);
    }
}
