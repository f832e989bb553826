//! Profiles against published files and formulas.
//!
//! The published files lie in a `shared` folder beside the repository. Where it is absent the tests that need it say
//! so and pass; golden rows copied from those files keep the check.
#![allow(clippy::disallowed_methods, reason = "no table is made of these numbers")]

use std::path::{Path, PathBuf};

use flangeway_host::curve::Curve;
use flangeway_host::profile::{
    BUILT_INS, Profile, ProfileKind, ReadOptions, rail_54e1, rail_60e1, s1002_height, s1002_slope,
};

const MM: f64 = 1e-3;

/// `line, y (mm), z (mm)` of MBench_S1002_v3.prw (CONTACT repository, Apache-2.0); there y = -S.
const S1002_ROWS: [(usize, f64, f64); 13] = [
    (44, 6.9612628e+01, 1.3485642e+01),
    (77, 5.6829353e+01, 2.7859742e+01),
    (110, 4.4046077e+01, 2.2596996e+01),
    (143, 4.0800804e+01, 1.8036576e+01),
    (176, 3.6460811e+01, 8.4500950e+00),
    (209, 2.8049121e+01, 3.2843633e+00),
    (242, 1.6969459e+01, 1.1891820e+00),
    (275, 3.7938977e+00, 1.5151454e-01),
    (308, -1.0720527e+01, -2.1622827e-01),
    (341, -2.4543246e+01, -4.1171602e-01),
    (374, -3.6292835e+01, -1.0551987e+00),
    (407, -4.7797783e+01, -1.8221952e+00),
    (440, -5.9302730e+01, -2.5891917e+00),
];

/// `line, y (mm), z (mm)` of MBench_UIC60_v3.prr (the same source): canted 1:40, origin at the highest point.
const UIC60_ROWS: [(usize, f64, f64); 10] = [
    (136, -4.3121819e+01, 1.5168459e+01),
    (174, -4.0302652e+01, 7.4813404e+00),
    (212, -3.4098086e+01, 3.1942568e+00),
    (250, -2.3514400e+01, 1.0653605e+00),
    (288, -8.1900282e+00, 1.1197778e-01),
    (307, 2.3126776e-01, 8.4530419e-05),
    (326, 7.5166786e+00, 1.8731651e-01),
    (364, 1.8559752e+01, 1.6998989e+00),
    (402, 2.5275136e+01, 5.4273478e+00),
    (440, 2.8665728e+01, 1.2018798e+01),
];

fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/profiles").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

fn load(spec: &str) -> Profile {
    Profile::load(spec, Path::new(""), None, &ReadOptions::default()).unwrap()
}

fn load_file(path: &Path) -> Profile {
    load(path.to_str().unwrap())
}

/// Distance from a point to a polyline.
fn distance(p: [f64; 2], contour: &[[f64; 2]]) -> f64 {
    let to_segment = |a: [f64; 2], b: [f64; 2]| {
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let share = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (e[0] - share * d[0]).hypot(e[1] - share * d[1])
    };
    contour.windows(2).map(|w| to_segment(w[0], w[1])).fold(f64::MAX, f64::min)
}

/// The 60E1 tilted 1:40 to the track centre, its highest point at the origin.
fn canted_60e1() -> Vec<[f64; 2]> {
    let (sin, cos) = (1.0_f64 / 40.0).atan().sin_cos();
    let tilt = |p: [f64; 2]| [p[0] * cos + p[1] * sin, p[1] * cos - p[0] * sin];
    // the highest point lies on the R300, straight above its centre
    let centre = tilt([0.0, 0.3]);
    let top = [centre[0], centre[1] - 0.3];
    load("60e1").points.iter().map(|&p| tilt(p)).map(|p| [p[0] - top[0], p[1] - top[1]]).collect()
}

#[test]
fn s1002_formula_gives_the_golden_rows() {
    for (line, y, z) in S1002_ROWS {
        let error = s1002_height(-y * MM) / MM - z;
        assert!(error.abs() < 1e-5, "line {line}: {error} mm");
    }
    assert!(s1002_height(0.061).is_nan() && s1002_height(f64::NAN).is_nan());
    assert!((s1002_slope(-0.039) + 70_f64.to_radians().tan()).abs() < 1e-6);
}

#[test]
fn s1002_formula_gives_the_benchmark_file() {
    let Some(path) = shared("MBench_S1002_v3.prw") else { return };
    let profile = load_file(&path);
    assert_eq!(profile.points.len(), 399);
    assert!(profile.points[0][0] < 0.0 && profile.points[0][1] > 0.01, "flange first: {:?}", profile.points[0]);
    let error = |p: &[f64; 2]| (s1002_height(p[0]) - p[1]).abs() / MM;
    let worst = profile.points.iter().map(error).fold(0.0, f64::max);
    println!("S1002 formula against MBench_S1002_v3.prw: {worst:.2e} mm at worst of {} points", profile.points.len());
    assert!(worst < 1e-5, "{worst}");
}

#[test]
fn the_sampled_s1002_follows_its_formula() {
    let profile = load("s1002");
    let curve = Curve::fit(&profile, 0.0).unwrap();
    let (mut worst, mut worst_in_c) = (0.0_f64, 0.0_f64);
    for i in 1..40_000 {
        let p = curve.at(curve.length() * f64::from(i) / 40_000.0);
        // normal distance: vertical distance times the cosine of the slope
        let error = (s1002_height(p.y) - p.z).abs() * p.tangent[0].abs() / MM;
        if (-0.035..-0.026).contains(&p.y) { worst_in_c = worst_in_c.max(error) } else { worst = worst.max(error) }
    }
    println!("S1002 spline against formula: {worst:.2e} mm; {worst_in_c:.2e} mm in zone C, which is made continuous");
    assert!(worst < 1e-5 && worst_in_c < 1.2e-4, "{worst} {worst_in_c}");
}

/// Curvatures just beside the S1002's zone borders: those of its circles, and no artefact of the steps in value.
#[test]
fn the_sampled_s1002_has_the_curvatures_of_its_zones() {
    let profile = load("s1002");
    let curve = Curve::fit(&profile, 0.0).unwrap();
    let expected = [(20.5, 12.0), (12.0, 20.0), (20.0, f64::INFINITY), (f64::INFINITY, -13.0)];
    for (t, (before, after)) in curve.joints().iter().zip(expected) {
        for (at, radius_mm) in [(t - 1e-6, before), (t + 1e-6, after)] {
            let curvature = curve.at(at).curvature;
            let error = curvature - 1e3 / radius_mm;
            assert!(error.abs() < 0.1, "at {at}: {curvature} for a radius of {radius_mm} mm");
        }
    }
    let &[_, _, _, _, d_to_c, c_to_b, _] = curve.joints() else { panic!("{:?}", curve.joints()) };
    for t in [d_to_c, c_to_b] {
        let (before, after) = (curve.at(t - 1e-6).curvature, curve.at(t + 1e-6).curvature);
        assert!((before - after).abs() < 1.0, "{before} {after}");
    }
}

#[test]
fn rail_60e1_follows_the_fitted_circles() {
    // circles fitted to the benchmark file, rounded to 1e-4 mm
    let r300 = |y: f64| 300.0 - (300.0_f64.powi(2) - y * y).sqrt();
    let r80 = |y: f64| 80.1348 - (80.0_f64.powi(2) - (y - 7.7).powi(2)).sqrt();
    let r13 = |y: f64| 14.9089 - (13.0_f64.powi(2) - (y - 23.0162).powi(2)).sqrt();
    let rows = [
        (0.0, 0.0),
        (6.0, r300(6.0)),
        (10.5, r300(10.5)),
        (15.0, r80(15.0)),
        (25.0, r80(25.0)),
        (25.988, r80(25.988)),
        (30.0, r13(30.0)),
        (34.0, r13(34.0)),
    ];
    for (y, z) in rows {
        for side in [-1.0, 1.0] {
            let error = rail_60e1().height(side * y * MM) / MM - z;
            assert!(error.abs() < 2e-4, "y {y}: {error} mm");
        }
    }
}

#[test]
fn rails_are_tangent_continuous_and_as_wide_as_they_should_be() {
    for (name, head) in [("60e1", rail_60e1()), ("54e1", rail_54e1())] {
        let profile = load(name);
        for joint in &profile.joints {
            let (Some(before), Some(after)) = (joint.tangent_before, joint.tangent_after) else { panic!() };
            let turn = before[0] * after[1] - before[1] * after[0];
            assert!(turn.abs() < 1e-12, "{name}: {turn}");
        }
        let corner_end = profile.points[profile.joints[5].index];
        assert!((corner_end[0] - head.half_width).abs() < 1e-15, "{name}: {corner_end:?}");
        let top = profile.points.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
        assert!(top.abs() < 1e-7, "{name}: {top}");
    }
}

#[test]
fn rail_60e1_canted_gives_the_golden_rows() {
    let canted = canted_60e1();
    for (line, y, z) in UIC60_ROWS {
        let error = distance([y * MM, z * MM], &canted) / MM;
        assert!(error < 1e-2, "line {line}: {error} mm");
    }
}

#[test]
fn rail_60e1_canted_is_the_benchmark_file() {
    let Some(path) = shared("MBench_UIC60_v3.prr") else { return };
    let profile = load_file(&path);
    assert!(profile.points[0][0] < -0.04, "gauge face first: {:?}", profile.points[0]);
    let canted = canted_60e1();
    let head: Vec<_> = profile.points.iter().filter(|p| p[1] < 0.028).collect();
    let worst_above = |depth: f64| {
        let above = head.iter().filter(|p| p[1] < depth);
        above.map(|p| distance(**p, &canted) / MM).fold(0.0, f64::max)
    };
    let (arcs, worst) = (worst_above(0.0125), worst_above(f64::MAX));
    println!(
        "60E1 canted 1:40 against MBench_UIC60_v3.prr: {arcs:.2e} mm at worst on the arcs, {worst:.2e} mm with the \
         sides, {} points",
        head.len()
    );
    assert!(head.len() > 300 && worst < 1e-2, "{} points, {worst}", head.len());
}

#[test]
fn the_same_rail_in_both_formats_is_the_same() {
    let (Some(prr), Some(ban)) = (shared("MBench_UIC60_v3.prr"), shared("MBench_UIC60_v3.ban")) else { return };
    let (prr, ban) = (load_file(&prr), load_file(&ban));
    let worst = ban.points.iter().map(|p| distance(*p, &prr.points) / MM).fold(0.0, f64::max);
    println!("MBench_UIC60_v3.ban against .prr: {worst:.2e} mm at worst of {} points", ban.points.len());
    assert!(worst < 1e-6, "{worst}");
}

#[test]
fn measured_files_are_placed() {
    if let Some(path) = shared("Car7216_0001r.whl") {
        let wheel = load_file(&path);
        assert_eq!(wheel.kind, ProfileKind::Wheel);
        let tip = wheel.points.iter().fold([0.0; 2], |tip, &p| if p[1] > tip[1] { p } else { tip });
        assert!((tip[0] - 0.016).abs() < 0.001 && (tip[1] - 0.0278).abs() < 1e-4, "{tip:?}");
        assert!(wheel.recognised.iter().any(|s| s.contains("#MINIWHEELPROF")), "{:?}", wheel.recognised);
        assert!(wheel.joints.is_empty(), "{:?}", wheel.joints);
    }
    if let Some(path) = shared("avg_low2.ban") {
        let rail = load_file(&path);
        let crown = rail.points.iter().fold([0.0, 1.0], |top, &p| if p[1] < top[1] { p } else { top });
        assert!((crown[1] - 0.00022).abs() < 1e-9, "{crown:?}");
        let first = rail.points[0].map(|x| x / MM);
        assert!((first[0] + 25.591).abs() < 1e-9 && (first[1] - 33.8).abs() < 1e-9, "{first:?}");
        let said = rail.recognised.join("\n");
        for part in
            ["z mirrored", "y mirrored", "order reversed", "zig-zag pattern", "1 kink kept as a joint, on line 577"]
        {
            assert!(said.contains(part), "{part} in {said}");
        }
    }
}

#[test]
fn every_built_in_has_even_steps_and_exact_tangents() {
    for name in BUILT_INS {
        let profile = load(name);
        for w in profile.points.windows(2) {
            let step = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
            assert!(w[1][0] > w[0][0] && (1e-5..=0.501e-3).contains(&step), "{name}: {step}");
        }
        for joint in &profile.joints {
            let [a, b, c] = [0, 1, 2].map(|k| profile.points[joint.index - 1 + k]);
            let along = |p: [f64; 2], q: [f64; 2], d: [f64; 2]| {
                ((q[0] - p[0]) * d[0] + (q[1] - p[1]) * d[1]) / (q[0] - p[0]).hypot(q[1] - p[1])
            };
            assert!(along(a, b, joint.tangent_before.unwrap()) > 0.9999, "{name} {}", joint.index);
            assert!(along(b, c, joint.tangent_after.unwrap()) > 0.9999, "{name} {}", joint.index);
        }
    }
    let wheel = load("two_line");
    let corner = wheel.points[wheel.joints[0].index];
    assert!((corner[0] + 0.034691).abs() < 1e-6 && (corner[1] + corner[0] / 20.0).abs() < 1e-15, "{corner:?}");
    assert_eq!(load("cone:1/20").points, load("cone:0.05").points);
}

#[test]
fn built_ins_refuse_what_makes_no_sense() {
    for (spec, kind, part) in [
        ("cone", None, "needs its conicity"),
        ("cone:fast", None, "\"fast\" is not a conicity"),
        ("circular_rail:-1", None, "\"-1\" is not a radius"),
        ("circular_rail:nan", None, "\"nan\" is not a radius"),
        ("cone:1/0", None, "\"1/0\" is not a conicity"),
        ("s1002:2", None, "takes no parameter"),
        ("s1002", Some(ProfileKind::Rail), "is a wheel profile where a rail profile is wanted"),
        ("s1003", None, "the built-in profiles are s1002"),
    ] {
        let error = Profile::load(spec, Path::new("nowhere"), kind, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(part), "{spec}: {error}");
    }
}
