//! Creepages and wrenches of the wheelset against closed forms, rotation matrices, and CONTACT's printed cases.

use flangeway::creep::{CreepForces, Creepages, Elasticity, Patch, polach, power};
use flangeway::wheelset::{Motion, Rates, WheelLoads, Wrench, contact_wrench, creepages, nadal_limit};
use flangeway::{Contact, Pose, Side, Slot, WheelGeometry};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

const WHEEL: WheelGeometry = WheelGeometry { nominal_radius: 0.46, lateral_position: 0.75 };

/// A contact at a place of the track frame with a contact angle.
fn contact(x: f64, y: f64, z: f64, angle: f64) -> Contact {
    Contact {
        normal_force: 50e3,
        indentation: 5e-5,
        position: Vector3::new(x as f32, y as f32, z as f32),
        angle: angle as f32,
        rolling_radius: 0.46,
        wheel_coordinate: 0.0,
        semi_axes: [6e-3, 4e-3],
        wheel_curvature: 0.0,
        rail_curvature: 3.0,
        slot: Slot::Tread,
    }
}

/// Both wheels' contacts at a height z under the tape circles.
fn treads(z: f64) -> [Contact; 2] {
    Side::ALL.map(|side| contact(0.0, side.sign() * 0.75, z, 0.0))
}

/// Free rolling at 20 m/s on the nominal radius.
fn rolling() -> Motion {
    Motion { speed: 20.0, spin: 20.0 / 0.46, ..Motion::default() }
}

fn assert_near(got: Creepages, want: [f64; 3], tolerance: f64) {
    let got = [got.longitudinal, got.lateral, got.spin].map(f64::from);
    for (got, want) in got.into_iter().zip(want) {
        assert!((got - want).abs() <= tolerance, "{got:e}, not {want:e}");
    }
}

#[test]
fn free_on_the_rolling_line_there_is_none() {
    for contact in treads(0.0) {
        assert_near(creepages(&WHEEL, &rolling(), &contact), [0.0; 3], 1e-9);
    }
}

#[test]
fn pure_yaw_is_lateral_creepage() {
    for yaw in [0.01, -0.02] {
        let motion = Motion { pose: Pose { yaw, ..Pose::default() }, ..rolling() };
        for contact in treads(0.0) {
            // The wheel's bottom runs back along its own plane: 1 - cos ψ and -sin ψ against the rail.
            assert_near(creepages(&WHEEL, &motion, &contact), [1.0 - yaw.cos(), -yaw.sin(), 0.0], 1e-9);
        }
    }
}

#[test]
fn greater_radius_slips_back() {
    // A wheel that touches Δr lower runs on a greater radius: ξ = -Δr / r0.
    for (height, want) in [(1e-3, -1e-3 / 0.46), (-5e-4, 5e-4 / 0.46)] {
        let [right, left] = treads(height);
        for contact in [right, left] {
            assert_near(creepages(&WHEEL, &rolling(), &contact), [want, 0.0, 0.0], 1e-9);
        }
    }
}

#[test]
fn spin_is_the_sine_of_the_contact_angle_over_the_radius() {
    // The axle's rotation points to the left; the normal of a right flange leans out.
    for (side, angle) in [(Side::Right, -0.05), (Side::Right, -1.2), (Side::Left, 0.05), (Side::Left, 1.2)] {
        let contact = contact(0.0, side.sign() * 0.75, 0.0, angle);
        assert_near(creepages(&WHEEL, &rolling(), &contact), [0.0, 0.0, angle.sin() / 0.46], 1e-6);
    }
}

#[test]
fn rates_divided_by_speed() {
    let [right, left] = treads(0.0);
    let with = |rates: Rates| Motion { rates, ..rolling() };
    let lateral = with(Rates { lateral: 0.1, ..Rates::default() });
    assert_near(creepages(&WHEEL, &lateral, &right), [0.0, 0.005, 0.0], 1e-9);
    // Yaw rate turns x towards y: the right wheel goes back, the left one forward.
    let yaw = with(Rates { yaw: 0.1, ..Rates::default() });
    assert_near(creepages(&WHEEL, &yaw, &right), [-0.1 * 0.75 / 20.0, 0.0, 0.005], 1e-9);
    assert_near(creepages(&WHEEL, &yaw, &left), [0.1 * 0.75 / 20.0, 0.0, 0.005], 1e-9);
    // Roll rate turns y towards z: the bottom goes left; on a flange its vertical part slides too.
    let roll = with(Rates { roll: 0.1, ..Rates::default() });
    assert_near(creepages(&WHEEL, &roll, &right), [0.0, -0.1 * 0.46 / 20.0, 0.0], 1e-9);
    let vertical = with(Rates { vertical: 0.1, ..Rates::default() });
    let flange = contact(0.0, 0.75, 0.0, -1.2);
    assert_near(creepages(&WHEEL, &vertical, &flange), [0.0, 0.005 * (-1.2_f64).sin(), (-1.2_f64).sin() / 0.46], 1e-6);
}

#[test]
fn a_curve_is_rolled_through_on_two_radii() {
    // Right-hand curve: the right wheel is the inner one, and its path is shorter by κ b.
    let (curvature, b, r0) = (1.0 / 500.0, 0.75, 0.46);
    let motion = Motion { track_curvature: curvature, ..rolling() };
    for side in Side::ALL {
        let y = side.sign() * b;
        let on_nominal = creepages(&WHEEL, &motion, &contact(0.0, y, 0.0, 0.0));
        assert_near(on_nominal, [-curvature * y, 0.0, curvature], 1e-9);
        // Radii r0 (1 - κ y) roll without longitudinal creepage.
        let on_own = creepages(&WHEEL, &motion, &contact(0.0, y, -r0 * curvature * y, 0.0));
        assert_near(on_own, [0.0, 0.0, curvature], 1e-9);
    }
}

#[test]
fn contact_ahead_of_the_axle_on_a_yawed_flange() {
    // At x ahead the wheel's material moves down by ω x: along the flange's tangent that is sin α x / r0.
    let (x, angle) = (0.02, -1.2_f64);
    let got = creepages(&WHEEL, &rolling(), &contact(x, 0.72, 0.01, angle));
    let expected = [-0.01 / 0.46, x / 0.46 * angle.sin(), angle.sin() / 0.46];
    assert_near(got, expected, 1e-6);
}

#[test]
fn contacts_printed_creepages() {
    // CONTACT, examples/mbench_a22_right.ref_out, revision 2447, cases 1 and 2: pose (y, z, roll, yaw in mm and rad),
    // pitch velocity, contact reference and approach (mm), CKSI, CETA, CPHI (1/mm). Its creepages are the rail's against
    // the wheel, so all signs turn. The contact reference lies on the rail; the wheel's undeformed surface, by which both
    // programs measure, lies by the approach below it.
    let cases = [
        ([0.0, 0.1981, 0.0, 0.0], 4.348_118_1, [0.0, 751.8726, 0.1252, -0.0290], 1.596e-2, [-5.665e-5, 0.0, 6.302e-5]),
        (
            [0.5, 0.1938, -2.304e-5, 1.2e-3],
            4.347_413_4,
            [-0.8614, 744.5026, 0.4289, -0.0568],
            1.948e-2,
            [4.948e-4, 1.202e-3, 1.233e-4],
        ),
    ];
    for ([y, z, roll, yaw], spin, [x, yc, zc, angle], approach, [xi, eta, phi]) in cases {
        let pose = Pose { lateral: y * 1e-3, vertical: z * 1e-3, roll, yaw };
        let motion = Motion { pose, speed: 2.0, spin, ..Motion::default() };
        let contact = contact(
            x * 1e-3,
            (yc - approach * f64::sin(angle)) * 1e-3,
            (zc + approach * f64::cos(angle)) * 1e-3,
            angle,
        );
        let got = creepages(&WHEEL, &motion, &contact);
        println!("{got:?} for {xi:e}, {eta:e}, {phi:e} turned");
        // Printed to 1e-4 mm and 1e-4 rad: 2e-7 of ξ, 2e-4 1/m of spin.
        assert!((f64::from(got.longitudinal) + xi).abs() < 1e-6, "{got:?}");
        assert!((f64::from(got.lateral) + eta).abs() < 3e-6, "{got:?}");
        assert!((f64::from(got.spin) + 1e3 * phi).abs() < 3e-4, "{got:?}");
    }
}

/// Velocity of the wheel's material at a point by moving the wheelset through ±dt, against the rail's.
fn moved(motion: &Motion, point: Vector3<f64>) -> Vector3<f64> {
    let at = |t: f64| {
        let (pose, rates) = (&motion.pose, &motion.rates);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), pose.yaw + t * rates.yaw)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), pose.roll + t * rates.roll)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -t * motion.spin);
        let centre = Vector3::new(
            0.0,
            pose.lateral + t * rates.lateral,
            pose.vertical + t * rates.vertical - WHEEL.nominal_radius,
        );
        (centre, turn)
    };
    let (centre, turn) = at(0.0);
    let body = turn.inverse() * (point - centre);
    let place = |t: f64| {
        let (centre, turn) = at(t);
        let track = Rotation3::from_axis_angle(&Vector3::z_axis(), t * motion.speed * motion.track_curvature);
        // The track frame itself moves forward and turns.
        Vector3::new(t * motion.speed, 0.0, 0.0) + track * (centre + turn * body)
    };
    let dt = 1e-6;
    (place(dt) - place(-dt)) / (2.0 * dt)
}

proptest! {
    #[test]
    fn any_motion_agrees_with_moving_the_wheelset(
        y in -0.01..0.01, z in -1e-3..1e-3, yaw in -0.05..0.05, roll in -0.05..0.05,
        rates in prop::array::uniform4(-0.5..0.5), speed in 1.0..60.0, slip in -0.05..0.05, curvature in -0.02..0.02,
        x in -0.05..0.05, angle in -1.3..1.3, right in any::<bool>(),
    ) {
        let [lateral, yaw_rate, vertical, roll_rate] = rates;
        let motion = Motion {
            pose: Pose { lateral: y, yaw, vertical: z, roll },
            rates: Rates { lateral, yaw: yaw_rate, vertical, roll: roll_rate },
            speed,
            spin: speed / 0.46 * (1.0 + slip),
            track_curvature: curvature,
        };
        let contact = contact(x, if right { 0.74 } else { -0.74 }, 0.003, angle);
        let velocity = moved(&motion, contact.position.cast());
        let got = creepages(&WHEEL, &motion, &contact);
        let angle = f64::from(contact.angle);
        let want = [velocity.x / speed, (velocity.y * angle.cos() + velocity.z * angle.sin()) / speed];
        prop_assert!((f64::from(got.longitudinal) - want[0]).abs() < 2e-7, "{} {}", got.longitudinal, want[0]);
        prop_assert!((f64::from(got.lateral) - want[1]).abs() < 2e-7, "{} {}", got.lateral, want[1]);
    }

    #[test]
    fn creep_forces_take_the_power_their_wrench_takes(
        yaw in -0.02..0.02, rates in prop::array::uniform3(-0.1..0.1), slip in -0.01..0.01, angle in -1.2..0.1,
        x in -0.02..0.02,
    ) {
        // F·v + M·Ω of the wheelset in the moving frame and of the rail's reaction is V (ξ Fx + η Fy + φ Mz): never fed in.
        let [lateral, yaw_rate, roll_rate] = rates;
        let motion = Motion {
            pose: Pose { yaw, ..Pose::default() },
            rates: Rates { lateral, yaw: yaw_rate, vertical: 0.0, roll: roll_rate },
            speed: 20.0,
            spin: 20.0 / 0.46 * (1.0 + slip),
            track_curvature: 0.0,
        };
        let contact = Contact { normal_force: 0.0, ..contact(x, 0.74, 0.002, angle) };
        let creep = creepages(&WHEEL, &motion, &contact);
        let patch = Patch { semi_axes: [6e-3, 4e-3], normal_force: 50e3 };
        let forces = polach(&patch, &Elasticity::STEEL, &creep, 0.3);
        let wrench = contact_wrench(&WHEEL, &motion.pose, &contact, &forces);
        let axle = Vector3::new(-yaw.sin(), yaw.cos(), 0.0);
        let turn = Vector3::new(roll_rate * yaw.cos(), roll_rate * yaw.sin(), yaw_rate) - axle * motion.spin;
        let fed = wrench.force.dot(&Vector3::new(20.0, lateral, 0.0)) + wrench.moment.dot(&turn);
        let by_creepages = power(20.0, &creep, &forces);
        prop_assert!(by_creepages <= 0.0);
        prop_assert!((fed - by_creepages).abs() < 1e-5 * (20.0 * 15e3), "{fed} {by_creepages}");
    }
}

#[test]
fn normal_forces_alone_push_up_and_inwards() {
    let angle = 0.4_f64;
    let wrenches = Side::ALL.map(|side| {
        let contact = contact(0.0, side.sign() * 0.75, 0.0, -side.sign() * angle);
        contact_wrench(&WHEEL, &Pose::default(), &contact, &CreepForces::NONE)
    });
    let [right, left] = wrenches;
    assert!((right.force - 50e3 * Vector3::new(0.0, -angle.sin(), -angle.cos())).norm() < 0.01);
    let total: Wrench = wrenches.into_iter().sum();
    assert!((total.force - Vector3::new(0.0, 0.0, -1e5 * angle.cos())).norm() < 0.01);
    assert!(total.moment.norm() < 0.01);
    // Mirror: x components of the moment are opposite, b N cos α - r0 N sin α at the left wheel.
    assert!((left.moment.x - 50e3 * (0.75 * angle.cos() - 0.46 * angle.sin())).abs() < 0.01);
    for (side, wrench) in [(Side::Right, right), (Side::Left, left)] {
        let loads = WheelLoads::new(side, &wrench);
        assert!((loads.guiding_force - 50e3 * angle.sin()).abs() < 0.01);
        assert!((loads.wheel_load - 50e3 * angle.cos()).abs() < 0.01);
        assert!((loads.ratio() - angle.tan()).abs() < 1e-7);
    }
    assert_eq!(WheelLoads::default().ratio(), 0.0);
}

#[test]
fn spin_moment_turns_about_the_normal() {
    let forces = CreepForces { spin_moment: 10.0, ..CreepForces::NONE };
    let flange = Contact { normal_force: 0.0, ..contact(0.0, 0.75, 0.0, -1.2) };
    let wrench = contact_wrench(&WHEEL, &Pose::default(), &flange, &forces);
    assert!((wrench.moment + 10.0 * flange.normal().cast::<f64>()).norm() < 1e-5 && wrench.force.norm() == 0.0);
}

#[test]
fn nadals_limit() {
    // 70 degrees and μ = 0.36 (EN 14363 takes Y/Q 1.2 for it).
    assert!((nadal_limit(70_f64.to_radians(), 0.36) - 1.2).abs() < 0.01);
    assert_eq!(nadal_limit(-1.2, 0.3), nadal_limit(1.2, 0.3));
    // Without friction the tangent, and at the angle of friction nothing holds.
    assert!((nadal_limit(1.0, 0.0) - 1_f64.tan()).abs() < 1e-12);
    assert!(nadal_limit(0.3_f64.atan(), 0.3).abs() < 1e-12);
}

#[test]
fn numbers_that_are_none_and_a_wheelset_at_rest() {
    let [right, _] = treads(0.0);
    let none = Creepages::default();
    assert_eq!(creepages(&WHEEL, &Motion::default(), &right), none);
    for bad in [f64::NAN, f64::INFINITY, -1e300] {
        let base = rolling();
        let rates = Rates { roll: bad, ..Rates::default() };
        for motion in [
            Motion { speed: bad, ..base },
            Motion { spin: bad, ..base },
            Motion { track_curvature: bad, ..base },
            Motion { rates, ..base },
            Motion { pose: Pose { yaw: bad, ..Pose::default() }, ..base },
        ] {
            assert_eq!(creepages(&WHEEL, &motion, &right), none);
        }
        let broken = Contact { angle: bad as f32, ..right };
        assert_eq!(creepages(&WHEEL, &rolling(), &broken), none);
        let broken = Contact { position: Vector3::new(0.0, bad as f32, 0.0), ..right };
        assert_eq!(creepages(&WHEEL, &rolling(), &broken), none);
    }
}
