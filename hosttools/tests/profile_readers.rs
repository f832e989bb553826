//! What the profile readers recognise and what they refuse. No input makes them panic, and what they accept is a
//! contour that the curve can be fitted to.
#![allow(clippy::disallowed_methods, reason = "no table is made of these numbers")]

use std::path::Path;

use flangeway_host::curve::Curve;
use flangeway_host::profile::{LengthUnit, Profile, ProfileKind, ReadOptions, s1002_height};
use proptest::prelude::*;

const MM: f64 = 1e-3;

fn parse(name: &str, content: &str, kind: Option<ProfileKind>) -> Result<Profile, String> {
    Profile::parse(Path::new(name), content.as_bytes(), kind, &ReadOptions::default()).map_err(|e| e.to_string())
}

fn built_in(name: &str) -> Profile {
    Profile::load(name, Path::new(""), None, &ReadOptions::default()).unwrap()
}

/// An S1002 of 61 points as text in the given unit, mirrored by the signs of y and z.
fn s1002_text(separator: &str, units_per_metre: f64, sign: [f64; 2]) -> String {
    let row = |i: i32| {
        let s = -0.068 + 0.128 * f64::from(i) / 60.0;
        let (y, z) = (sign[0] * s * units_per_metre, sign[1] * s1002_height(s) * units_per_metre);
        format!("{y:.9}{separator}{z:.9}\n")
    };
    (0..=60).map(row).collect()
}

#[test]
fn text_is_read_in_its_dialects() {
    let wheel = Some(ProfileKind::Wheel);
    let plain = s1002_text(" ", 1.0, [1.0, 1.0]);
    let reference = parse("a.txt", &plain, wheel).unwrap();
    let with_header = format!("# my wheel\ny_mm;z_mm\n{}", s1002_text(";", 1e3, [1.0, 1.0]));
    let inches = s1002_text("\t", 1.0 / 0.0254, [1.0, 1.0]);
    for (name, content, part) in [
        ("millimetres", s1002_text(",", 1e3, [1.0, 1.0]), "lengths taken as millimetres"),
        ("header", with_header, "header line \"y_mm;z_mm\""),
        ("inches", format!("y (inch)\tz (inch)\n{inches}"), "inches by the header"),
        ("decimal commas", s1002_text(";", 1e3, [1.0, 1.0]).replace('.', ","), "decimal commas"),
        ("y to the flange", s1002_text("  ", 1.0, [-1.0, 1.0]), "flange was on the field side"),
        ("z up", s1002_text("\t", 1.0, [1.0, -1.0]), "z points up"),
        ("Windows lines", plain.replace('\n', "\r\n"), "lengths taken as metres"),
    ] {
        let profile = parse("a.csv", &content, wheel).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(profile.recognised.iter().any(|s| s.contains(part)), "{name}: {:?}", profile.recognised);
        assert_eq!(profile.points.len(), reference.points.len(), "{name}");
        for (p, q) in profile.points.iter().zip(&reference.points) {
            assert!((p[0] - q[0]).abs() < 1e-8 && (p[1] - q[1]).abs() < 1e-8, "{name}: {p:?} {q:?}");
        }
    }
    let options = ReadOptions { length_unit: Some(LengthUnit::Inch), ..ReadOptions::default() };
    let profile = Profile::parse(Path::new("a.txt"), inches.as_bytes(), wheel, &options).unwrap();
    assert!((profile.points[60][0] - 0.060).abs() < 1e-9);
}

#[test]
fn simpack_modifications_are_applied() {
    let rail = |settings: &str| {
        let rows: String = (-36..=36).map(|y| format!("{y} {}\n", f64::from(y * y) / 100.0)).collect();
        let content = format!(
            "! a comment\nheader.begin\n version = 1\n type = 0 ! rail\nheader.end\nspline.begin\n units.len.f = 1000\n\
             {settings}\n point.begin\n{rows}!37 13.69\n point.end\nspline.end\n"
        );
        parse("test.prr", &content, None).unwrap_or_else(|e| panic!("{settings}: {e}"))
    };
    assert!(rail("").recognised.iter().any(|s| s == "1 point commented out in the file"));
    let first = |settings: &str| rail(settings).points[0].map(|x| (x / MM * 1e6).round() / 1e6);
    assert_eq!(first(""), [-36.0, 12.96]);
    assert_eq!(first("shift.y = 1.5\n shift.z = -2"), [-34.5, 10.96]);
    assert_eq!(first("shift.y = 1\n mirror.y = 1"), [-37.0, 12.96]);
    assert_eq!(first("bound.y.min = -20.5\n bound.y.max = 30"), [-20.0, 4.0]);
    assert_eq!(first("bound.y.min = 1.0\n bound.y.max = 0.0"), [-36.0, 12.96]);
    assert_eq!(first("bound.z.min = 0\n bound.z.max = 9"), [-36.0, 9.0]);
    // neighbours are 1.0 to 1.23 mm apart
    assert_eq!(rail("point.dist.min = 1.5").points.len(), 37);
    assert!((rail("approx.smooth = 0.25\n inversion = 1").smoothing - 0.25).abs() < 1e-15);
    // a rotation of 0.1 rad, in milliradians
    let turned = rail("rotate = 100\n units.ang.f = 1000").points[0].map(|x| x / MM);
    let (sin, cos) = 0.1_f64.sin_cos();
    let expected = [-36.0 * cos - 12.96 * sin, -36.0 * sin + 12.96 * cos];
    assert!((turned[0] - expected[0]).abs() < 1e-9 && (turned[1] - expected[1]).abs() < 1e-9, "{turned:?}");
}

#[test]
fn corners_are_kept_as_joints_and_radii_are_not() {
    let wheel = built_in("two_line");
    let corner = wheel.joints[0].index;
    for step in [1, 5, 12] {
        let rows = wheel.points.iter().enumerate().filter(|(i, _)| i % step == corner % step);
        let rows: String = rows.map(|(_, p)| format!("{} {}\n", p[0], p[1])).collect();
        let read = parse("two_line.txt", &rows, Some(ProfileKind::Wheel)).unwrap();
        assert_eq!(read.joints.len(), 1, "every {step}");
        assert!((read.points[read.joints[0].index][0] + 0.034691).abs() < 1e-6);
    }
    // sampled every 2 mm, the R13 corners turn by 9 degrees a point
    let rows: String = built_in("60e1").points.iter().step_by(10).map(|p| format!("{} {}\n", p[0], p[1])).collect();
    let read = parse("60e1.txt", &rows, Some(ProfileKind::Rail)).unwrap();
    assert!(read.joints.is_empty(), "{:?}", read.joints);
}

#[test]
fn errors_name_line_and_value() {
    let rail = Some(ProfileKind::Rail);
    let rows = |middle: &str| format!("-30 8\n-20 3\n-10 1\n{middle}\n10 1\n20 3\n30 8\n");
    let simpack = |body: &str| format!("header.begin\ntype = 0\nheader.end\nspline.begin\nunits.len.f = 1000\n{body}");
    for (name, content, kind, part) in [
        ("a.txt", rows("0 nan"), rail, "a.txt:4: z is \"nan\", not a finite number"),
        ("a.txt", rows("0 1e999"), rail, "a.txt:4: z is \"1e999\", not a finite number"),
        ("a.txt", rows("0 crown"), rail, "a.txt:4: z is \"crown\", not a number"),
        ("a.txt", rows("0 1 2"), rail, "a.txt:4: \"0 1 2\" has 3 columns"),
        ("a.txt", rows("0 0"), None, "does not say whether it is a wheel or a rail"),
        ("a.txt", rows("0 5e9"), rail, "a.txt:4: the point (0 m, 5000000 m) is too far out"),
        ("a.txt", "0 0\n1 1\n2 0\n3 1\n5 0\n".into(), rail, "is 5 units wide"),
        ("a.txt", "0 0\n10 1\n20 0\n30 1\n".into(), rail, "has 4 distinct points"),
        ("a.txt", String::new(), rail, "holds no points"),
        ("a.txt", rows("0 0\n5 0\n-8 0\n7 0"), rail, "a.txt:6: the contour runs back by"),
        ("a.txt", rows("0 0") + "25 9\n15 9\n5 9\n-5 9\n-28 9\n", rail, "a.txt:12: the points end 2.000 mm"),
        ("a.prr", simpack("point.begin\n0 0\n1 x\n"), None, "a.prr:8: z is \"x\", not a number"),
        ("a.prr", simpack("mirror.y = 2\n"), None, "a.prr:6: mirror.y is 2, not 0 or 1"),
        ("a.prr", simpack("point.begin\n0 0\n"), None, "a.prr:7: the file ends before its spline.end"),
        ("a.prr", simpack("point.end\n"), None, "a.prr:6: \"point.end\" does not belong here"),
        (
            "a.prw",
            simpack("point.begin\n0 0\npoint.end\nspline.end\n"),
            None,
            "a rail profile by the header and a wheel",
        ),
        ("a.ban", "ColumnDef=A,C\n".into(), None, "a.ban:1: ColumnDef \"A,C\" has no X and Y"),
        ("a.ban", "ColumnDef=X,Y\n\n1 2\n3\n".into(), None, "a.ban:4: Y is missing in \"3\""),
        ("a.whl", "\n1 2\nSide=L\n".into(), None, "a.whl:3: header line \"Side=L\" follows the points"),
    ] {
        let error = parse(name, &content, kind).expect_err(part);
        assert!(error.contains(part), "{part}\n{error}");
    }
}

#[test]
fn a_contour_that_crosses_itself_is_refused() {
    let line = |from: [i32; 2], to: [i32; 2]| {
        (0..20).map(move |i| {
            let at = |k: usize| f64::from(from[k]) + f64::from(to[k] - from[k]) * f64::from(i) / 20.0;
            format!("{} {}\n", at(0), at(1))
        })
    };
    let corners = [[-30, 0], [0, 0], [-6, 9], [3, 9], [-7, -9], [30, -9]];
    let rows: String = corners.windows(2).flat_map(|w| line(w[0], w[1])).collect();
    let error = parse("a.txt", &rows, Some(ProfileKind::Rail)).unwrap_err();
    assert!(error.contains("the contour crosses itself, its part from line 24"), "{error}");
}

/// One small file of each format.
fn samples() -> [(&'static str, String); 4] {
    let rows: String = (-12..=12).map(|i| format!("{} {}\n", 3 * i, f64::from(i * i) / 9.0)).collect();
    let simpack = format!(
        "header.begin\ntype = 0\nheader.end\nspline.begin\nunits.len.f = 1000\nshift.y = 1\nrotate = 0.01\n\
         bound.y.min = -30\nbound.y.max = 33\npoint.begin\n{rows}point.end\nspline.end\n"
    );
    let rail = format!("Filename=x\nXYPoints=25\nXOffset=0.5\nColumnDef=X,Y,A\n\n{}", rows.replace('\n', " 0.1\n"));
    let wheel = format!("#MINIWHEELPROF\nStock..:\n\" 1 2 3\n\n{rows}");
    [("a.prr", simpack), ("a.ban", rail), ("a.whl", wheel), ("a.txt", format!("y z\n{}", rows.replace(' ', ",")))]
}

fn options() -> impl Strategy<Value = ReadOptions> {
    let flag = || prop::option::of(any::<bool>());
    let unit = prop::option::of(prop::sample::select(vec![LengthUnit::M, LengthUnit::Mm, LengthUnit::Inch]));
    (flag(), flag(), unit).prop_map(|(mirror_y, mirror_z, length_unit)| ReadOptions { mirror_y, mirror_z, length_unit })
}

fn kind() -> impl Strategy<Value = Option<ProfileKind>> {
    prop::option::of(prop::sample::select(vec![ProfileKind::Wheel, ProfileKind::Rail]))
}

fn check(name: &str, bytes: &[u8], kind: Option<ProfileKind>, options: &ReadOptions) {
    let Ok(profile) = Profile::parse(Path::new(name), bytes, kind, options) else { return };
    let points = &profile.points;
    assert!(points.len() >= 5 && points.iter().flatten().all(|x| x.is_finite() && x.abs() <= 10.0));
    assert!(points[0][0] < points[points.len() - 1][0]);
    assert!(points.windows(2).all(|w| w[0] != w[1]));
    assert!(profile.joints.windows(2).all(|w| w[0].index < w[1].index));
    assert!(profile.joints.iter().all(|j| j.index > 0 && j.index + 1 < points.len()));
    let curve = Curve::fit(&profile, 0.0).unwrap();
    assert!((0..=50).all(|i| curve.at(curve.length() * f64::from(i) / 50.0).z.is_finite()));
}

#[test]
fn the_samples_are_accepted() {
    for (name, content) in samples() {
        let kind = (name == "a.txt").then_some(ProfileKind::Rail);
        let read = Profile::parse(Path::new(name), content.as_bytes(), kind, &ReadOptions::default());
        assert!(read.is_ok(), "{read:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), kind in kind(), options in options()) {
        for (name, _) in samples() {
            check(name, &bytes, kind, &options);
        }
    }

    #[test]
    fn random_points(
        rows in prop::collection::vec((-80_i32..80, -40_i32..40), 0..20),
        sorted in any::<bool>(),
        kind in kind(),
        options in options(),
    ) {
        let mut rows = rows;
        if sorted {
            rows.sort_unstable();
        }
        let text: String = rows.iter().map(|(y, z)| format!("{y} {z}\n")).collect();
        check("a.txt", text.as_bytes(), kind, &options);
    }

    #[test]
    fn mutated_files(
        file in 0_usize..4,
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0_usize..12, "[-0-9.eE\"!=, \t\nXYna]{0,6}"),
            1..6,
        ),
        kind in kind(),
        options in options(),
    ) {
        let (name, content) = &samples()[file];
        let mut bytes = content.clone().into_bytes();
        for (at, length, text) in &edits {
            let start = at.index(bytes.len() + 1);
            let end = (start + length).min(bytes.len());
            bytes.splice(start..end, text.bytes());
        }
        check(name, &bytes, kind, &options);
    }
}
