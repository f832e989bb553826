//! Rigid contact of the wheelset: both wheels touch, neither is indented, and the mirror images agree.

use crate::common;
use flangeway::{Pose, Side};
use flangeway_host::pair::Pair;
use flangeway_host::rigid::two_wheels;

fn pairs() -> Vec<(&'static str, Pair)> {
    let built_in = ("s1002 on 60e1", common::built_in());
    let files = common::manchester_files().map(|recipe| ("Manchester files", recipe));
    [Some(built_in), files].into_iter().flatten().map(|(name, r)| (name, Pair::build(&r).unwrap())).collect()
}

#[test]
fn both_wheels_touch_and_neither_is_indented() {
    for (name, pair) in pairs() {
        let mut draws = common::Draws::new(2);
        let (mut least, mut most) = (f64::MAX, f64::MIN);
        for i in 0..600 {
            let (y, yaw) = match i {
                0 => (0.0, 0.0),
                _ => (draws.within(-0.012, 0.012), draws.within(-0.04, 0.04)),
            };
            let rigid = two_wheels(&pair, y, yaw).unwrap_or_else(|| panic!("no rigid contact at y {y}, yaw {yaw}"));
            for side in Side::ALL {
                let pose = Pose { lateral: y, yaw, vertical: rigid.vertical, roll: rigid.roll }.canonical(side).pose;
                let depth = pair.column(side, &pose).deepest(pose.vertical).unwrap().depth();
                (least, most) = (least.min(depth), most.max(depth));
                assert!(depth.abs() < 1e-9, "{name}: y {y}, yaw {yaw}, {side}: overlap {depth:e}");
                assert!(pair.solve(side, &common::on_side(side, &pose)).iter().all(|slot| slot.indentation < 1e-9));
            }
        }
        println!("{name}: greatest overlap of a wheel {least:.1e} to {most:.1e} m");
    }
}

#[test]
fn centred_without_roll_and_mirrored() {
    for (name, pair) in pairs() {
        let centred = two_wheels(&pair, 0.0, 0.0).unwrap();
        println!("{name}: centred, roll {:e} rad, height {:.6} mm", centred.roll, 1e3 * centred.vertical);
        assert!(centred.roll.abs() < 1e-12);
        let mut draws = common::Draws::new(3);
        let mut worst = 0.0_f64;
        for _ in 0..200 {
            let (y, yaw) = (draws.within(0.0, 0.012), draws.within(0.0, 0.04));
            let one = two_wheels(&pair, y, yaw).unwrap();
            // Mirrored at y = 0: lateral, yaw and roll change sign. Mirrored at x = 0: yaw alone.
            for (y, yaw, sign) in [(-y, -yaw, -1.0), (y, -yaw, 1.0), (-y, yaw, -1.0)] {
                let other = two_wheels(&pair, y, yaw).unwrap();
                let apart = (one.vertical - other.vertical).abs().max((one.roll - sign * other.roll).abs());
                worst = worst.max(apart);
                assert!(apart < 1e-11, "{name}: y {y}, yaw {yaw}: {apart:e}");
            }
        }
        println!("{name}: mirror images agree within {worst:.1e} m or rad");
    }
}

/// Two cones (conicity k = tan θ) on two circular rail heads of radius R whose centres are at (±c, R).
///
/// In the wheelset's frame the generators shifted outwards by R are r = H - k |η| with H = r0 + k b + R / cos θ, and
/// both rail centres lie on them: 2 c apart, on a line at the angle -φ. With d and s half their difference and half
/// their sum in |η|:
///
/// ```text
/// s = c cos φ,  k d = c sin φ
/// y = -[d cos φ - (H - k s) sin φ] = sin φ [H - c (k + 1 / k) cos φ]
/// z = r0 + R - [d sin φ + (H - k s) cos φ]
/// ```
/// For small y the roll is y / (H - c (k + 1 / k)), about -k y / c.
#[test]
fn cones_on_circular_rails() {
    let (r0, b, c) = (0.46, 0.75, 0.752);
    for (k, radius) in [(0.05, 0.3), (0.1, 0.2), (0.025, 0.5)] {
        let recipe = common::recipe(&format!(
            r#"
            wheel = {{ profile = "cone:{k}", nominal_radius_m = {r0}, flange_back_spacing_m = 1.36, flange_back_position_m = -0.07 }}
            rail = {{ profile = "circular_rail:{radius}", origin_m = [{c}, 0.0] }}
            material = {{ youngs_modulus_pa = 2.1e11, poisson_ratio = 0.28 }}
            [grid]
            lateral_m = {{ range = [-0.005, 0.005] }}
            yaw_rad = {{ range = [0.0, 0.02] }}
            vertical_m = {{ range = [-5e-5, 1.5e-4] }}
            roll_rad = {{ range = [-1e-3, 1e-3] }}
            "#
        ));
        let pair = Pair::build(&recipe).unwrap();
        let h = r0 + k * b + radius / f64::atan(k).cos();
        let mut worst = 0.0_f64;
        for i in -20..=20 {
            // about a millimetre of lateral position a step
            let roll = f64::from(i) * 1e-3 * k / c;
            let (sin, cos) = roll.sin_cos();
            let y = sin * (h - c * (k + 1.0 / k) * cos);
            let z = r0 + radius - (c * sin / k * sin + (h - k * c * cos) * cos);
            let found = two_wheels(&pair, y, 0.0).unwrap();
            worst = worst.max((found.roll - roll).abs()).max((found.vertical - z).abs());
            assert!((found.roll - roll).abs() < 1e-9, "conicity {k}, y {y}: roll {} not {roll}", found.roll);
            assert!((found.vertical - z).abs() < 1e-9, "conicity {k}, y {y}: height {} not {z}", found.vertical);
        }
        println!("conicity {k} on radius {radius} m: roll and height within {worst:.1e} rad or m");
    }
}
