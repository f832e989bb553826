//! Bad input: the program ends with exit status 2 and one line on stderr that names the file, the place in it and the
//! value, and leaves nothing behind.

use std::process::{Output, Stdio};

use crate::common::{Folder, POSES, RECIPE, table};

/// What is wrong, the files that differ from the good ones, the command, and what its one line must contain.
struct Case<'a> {
    what: &'a str,
    files: Vec<(&'a str, Vec<u8>)>,
    command: &'a str,
    says: &'a [&'a str],
}

fn case<'a>(what: &'a str, files: Vec<(&'a str, Vec<u8>)>, command: &'a str, says: &'a [&'a str]) -> Case<'a> {
    Case { what, files, command, says }
}

const COMPILE: &str = "compile recipe.toml -o out.fwt";
const SOLVE: &str = "solve --recipe recipe.toml --poses poses.csv -o out.csv";
const LOOKUP: &str = "lookup table.fwt --poses poses.csv -o out.csv";
const VERIFY: &str = "verify table.fwt --recipe recipe.toml --samples 10 --lines 1 -o out.csv";

/// The good recipe with one piece of text replaced.
fn recipe(from: &str, to: &str) -> Vec<(&'static str, Vec<u8>)> {
    assert!(RECIPE.contains(from), "{from}");
    vec![("recipe.toml", RECIPE.replacen(from, to, 1).into())]
}

/// The good recipe with a wheel profile from a file.
fn wheel(name: &'static str, contents: &str) -> Vec<(&'static str, Vec<u8>)> {
    let mut files = recipe("\"s1002\"", &format!("\"{name}\""));
    files.push((name, contents.into()));
    files
}

fn poses(contents: impl Into<Vec<u8>>) -> Vec<(&'static str, Vec<u8>)> {
    vec![("poses.csv", contents.into())]
}

fn damaged(change: impl Fn(&mut Vec<u8>)) -> Vec<(&'static str, Vec<u8>)> {
    let mut image = table().to_vec();
    change(&mut image);
    vec![("table.fwt", image)]
}

/// One clean error: exit status 2, nothing on stdout, one line on stderr with all of these words.
fn assert_clean(what: &str, output: &Output, says: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    println!("{what}: {}", said.trim_end());
    assert_eq!(output.status.code(), Some(2), "{what}: {said}");
    assert!(output.stdout.is_empty(), "{what}: stdout");
    assert_eq!(said.lines().count(), 1, "{what}: {said}");
    assert!(said.starts_with("flangeway: ") && said.ends_with('\n'), "{what}: {said}");
    assert!(!said.contains("panicked"), "{what}: {said}");
    for word in says {
        assert!(said.contains(word), "{what}: {word:?} is not in {said}");
    }
}

/// Runs every case in a folder of its own; nothing may be there afterwards that was not there before.
fn check(cases: Vec<Case<'_>>) {
    for Case { what, files, command, says } in cases {
        let folder = Folder::with_table();
        for (name, contents) in files {
            folder.write(name, contents);
        }
        let before = folder.contents();
        assert_clean(what, &folder.run(command), says);
        let names = |all: &[(String, Vec<u8>)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        let after = folder.contents();
        assert_eq!(names(&before), names(&after), "{what}: files left behind");
        assert!(before == after, "{what}: a file was changed");
    }
}

#[test]
fn recipes() {
    let missing = &["nothing.toml: ", "No such file"];
    check(vec![
        case("compile, missing recipe", vec![], "compile nothing.toml -o out.fwt", missing),
        case("solve, missing recipe", vec![], "solve --recipe nothing.toml --poses poses.csv -o out.csv", missing),
        case("rigid, missing recipe", vec![], "rigid --recipe nothing.toml -o out.csv", missing),
        case("verify, missing recipe", vec![], "verify table.fwt --recipe nothing.toml", missing),
        case("recipe is a folder", vec![], "compile . -o out.fwt", &[".: ", "directory"]),
        case("empty recipe", vec![("recipe.toml", vec![])], COMPILE, &["recipe.toml", "missing field `wheel`"]),
        case("no UTF-8", vec![("recipe.toml", vec![0xff, 0xfe, 0x00])], COMPILE, &["recipe.toml: ", "UTF-8"]),
        case("no TOML", recipe("[rail]", "[rail"), COMPILE, &["recipe.toml:7: "]),
        case(
            "unknown key",
            recipe("gauge_m = 1.435", "guage_m = 1.435"),
            COMPILE,
            &["recipe.toml:9: ", "unknown field `guage_m`"],
        ),
        case(
            "unknown section",
            vec![("recipe.toml", format!("{RECIPE}[grids]\n").into())],
            COMPILE,
            &["recipe.toml:22: ", "unknown field `grids`"],
        ),
        case(
            "missing key",
            recipe("nominal_radius_m = 0.460\n", ""),
            COMPILE,
            &["recipe.toml:1: ", "missing field `nominal_radius_m`"],
        ),
        case("a word for a number", recipe("0.28", "\"steel\""), COMPILE, &["recipe.toml:14: ", "\"steel\""]),
        case("no number", recipe("0.28", "nan"), COMPILE, &["recipe.toml: material.poisson_ratio: NaN"]),
        case(
            "negative radius",
            recipe("nominal_radius_m = 0.460", "nominal_radius_m = -0.460"),
            COMPILE,
            &["recipe.toml: wheel.nominal_radius_m: -0.46 "],
        ),
        case(
            "range reversed",
            recipe("[-0.010, 0.010]", "[0.010, -0.010]"),
            COMPILE,
            &["recipe.toml: grid.lateral_m.range: ", "[0.01, -0.01]"],
        ),
        case(
            "range without end",
            recipe("[-0.010, 0.010]", "[-0.010, inf]"),
            COMPILE,
            &["recipe.toml: grid.lateral_m.range: inf"],
        ),
        case(
            "negative yaw",
            recipe("[0.0, 0.024]", "[-0.024, 0.024]"),
            COMPILE,
            &["recipe.toml: grid.yaw_rad.range: -0.024"],
        ),
        case("zero nodes", recipe("nodes = 21", "nodes = 0"), COMPILE, &["recipe.toml:17: ", "nodes = 0"]),
        case("negative nodes", recipe("nodes = 21", "nodes = -3"), COMPILE, &["recipe.toml:17: ", "nodes = -3"]),
        case("too many nodes", recipe("nodes = 21", "nodes = 99999"), COMPILE, &["recipe.toml:17: ", "nodes = 99999"]),
        case(
            "nodes in words",
            recipe("nodes = 21", "nodes = \"many\""),
            COMPILE,
            &["recipe.toml:17: ", "nodes = \"many\""],
        ),
        case("half a node", recipe("nodes = 21", "nodes = 2.5"), COMPILE, &["recipe.toml:17: ", "nodes"]),
        case(
            "too few poses",
            recipe("error_poses = 500", "error_poses = 50"),
            COMPILE,
            &["recipe.toml: grid.error_poses: 50 is not between 100 "],
        ),
        case("neither gauge nor origin", recipe("gauge_m = 1.435\n", ""), COMPILE, &["recipe.toml: rail: ", "gauge_m"]),
        case(
            "profile that cannot reach the rail",
            recipe("gauge_m = 1.435", "gauge_m = 2.5"),
            COMPILE,
            &["recipe.toml: wheel.profile: ", "cannot reach the rail", "gauge"],
        ),
        case(
            "rigid map without nodes",
            vec![],
            "rigid --recipe recipe.toml --nodes 0x9 -o out.csv",
            &["--nodes", "0x9"],
        ),
    ]);
}

#[test]
fn profiles() {
    let contour: String = (0..20).map(|i| format!("{}, {}\n", 5 * i - 60, (i - 12) * (i - 12) / 4)).collect();
    let with = |line: &str| format!("y_mm, z_mm\n{}{line}\n{contour}", "-70.0, 30.0\n");
    check(vec![
        case(
            "missing profile",
            recipe("\"s1002\"", "\"nothing.prw\""),
            COMPILE,
            &["nothing.prw: ", "cannot be read", "No such file"],
        ),
        case("empty text profile", wheel("empty.csv", ""), COMPILE, &["empty.csv: ", "no points"]),
        case("empty Simpack profile", wheel("empty.prw", ""), COMPILE, &["empty.prw", "spline.end"]),
        case("empty MiniProf profile", wheel("empty.whl", ""), COMPILE, &["empty.whl"]),
        case("header and no points", wheel("bare.csv", "y_mm, z_mm\n"), COMPILE, &["bare.csv: ", "no points"]),
        case("two points", wheel("two.csv", "-60.0, 0.0\n60.0, 1.0\n"), COMPILE, &["two.csv: ", "2 distinct points"]),
        case("NaN", wheel("nan.csv", &with("-65.0, NaN")), COMPILE, &["nan.csv:3: ", "z is \"NaN\""]),
        case("infinite", wheel("inf.csv", &with("inf, 1.0")), COMPILE, &["inf.csv:3: ", "y is \"inf\""]),
        case("no number", wheel("words.csv", &with("-65.0, deep")), COMPILE, &["words.csv:3: ", "z is \"deep\""]),
        case("one column", wheel("one.csv", &with("-65.0")), COMPILE, &["one.csv:3: ", "\"-65.0\"", "1 columns"]),
        case("far out", wheel("far.csv", &with("-6e9, 1.0")), COMPILE, &["far.csv"]),
        case(
            "a rail for a wheel",
            recipe("\"s1002\"", "\"54e1\""),
            COMPILE,
            &["recipe.toml: ", "54e1", "rail profile where a wheel profile is wanted"],
        ),
        case(
            "a cone that is none",
            recipe("\"s1002\"", "\"cone:steep\""),
            COMPILE,
            &["recipe.toml: ", "cone:steep", "conicity"],
        ),
        case(
            "the same in profile",
            wheel("nan.csv", &with("-65.0, NaN")),
            "profile nan.csv --kind wheel",
            &["nan.csv:3: "],
        ),
        case("no kind", wheel("shape.csv", &contour), "profile shape.csv", &["shape.csv: ", "kind"]),
    ]);
}

#[test]
fn pose_files() {
    let line = |text: &str| poses(format!("{POSES}{text}\n"));
    for command in [SOLVE, LOOKUP] {
        check(vec![
            case("empty pose file", poses(""), command, &["poses.csv:1: ", "y_m"]),
            case("no poses", poses("y_m,yaw_rad,z_m,roll_rad\n"), command, &["poses.csv: ", "no poses"]),
            case("missing column", poses("y_m,yaw_rad,z_m\n0,0,0\n"), command, &["poses.csv:1: ", "roll_rad"]),
            case("other column", poses("y_m,yaw_rad,z_m,roll_rad,speed\n"), command, &["poses.csv:1: ", "\"speed\""]),
            case("no number", line("0.001,left,0,0"), command, &["poses.csv:5: ", "yaw_rad", "\"left\""]),
            case("NaN", line("0.001,0,NaN,0"), command, &["poses.csv:5: ", "z_m", "\"NaN\""]),
            case("infinite", line("0.001,0,0,-inf"), command, &["poses.csv:5: ", "roll_rad", "\"-inf\""]),
            case("empty field", line("0.001,,0,0"), command, &["poses.csv:5: ", "yaw_rad", "\"\""]),
            case("three fields", line("0.001,0,0"), command, &["poses.csv:5: "]),
            case("no UTF-8", poses([POSES.as_bytes(), b"\xff,0,0,0\n"].concat()), command, &["poses.csv:5: "]),
        ]);
    }
    check(vec![
        case(
            "missing pose file",
            vec![],
            "lookup table.fwt --poses nothing.csv -o out.csv",
            &["nothing.csv: ", "No such file"],
        ),
        case(
            "missing pose file",
            vec![],
            "solve --recipe recipe.toml --poses nothing.csv -o out.csv",
            &["nothing.csv: ", "No such file"],
        ),
    ]);
}

#[test]
fn tables() {
    for command in [LOOKUP, VERIFY, "inspect table.fwt --json"] {
        check(vec![
            case("empty table", damaged(Vec::clear), command, &["table.fwt: "]),
            case("truncated table", damaged(|t| t.truncate(t.len() - 1)), command, &["table.fwt: "]),
            case("one byte more", damaged(|t| t.push(0)), command, &["table.fwt: "]),
            case("one bit flipped", damaged(|t| t[5000] ^= 4), command, &["table.fwt: ", "checksum"]),
            case("no table", vec![("table.fwt", RECIPE.into())], command, &["table.fwt: ", "not a contact table"]),
            case("another version", damaged(|t| t[4] = 1), command, &["table.fwt: ", "format version 1,"]),
        ]);
    }
    check(vec![
        case("missing table", vec![], "inspect nothing.fwt", &["nothing.fwt: ", "No such file"]),
        case("table is a folder", vec![], "inspect .", &[".: ", "directory"]),
        case("another wheel's table", recipe("\"s1002\"", "\"cone:1/20\""), VERIFY, &["table.fwt: ", "wheel"]),
        case("another radius", recipe("0.460", "0.450"), VERIFY, &["table.fwt: ", "radius"]),
    ]);
}

/// Every command that writes a file, with `OUT` for its name.
const WRITERS: [&str; 6] = [
    "compile recipe.toml -o OUT",
    "solve --recipe recipe.toml --poses poses.csv -o OUT",
    "lookup table.fwt --poses poses.csv -o OUT",
    "rigid --recipe recipe.toml --nodes 3x2 -o OUT",
    "verify table.fwt --recipe recipe.toml --samples 10 --lines 1 -o OUT",
    "profile s1002 -o OUT",
];

#[test]
fn outputs_that_cannot_be_written() {
    for writer in WRITERS {
        let into = |name: &str| writer.replace("OUT", name);
        for (what, name, says) in [
            ("a folder that is missing", "missing/out", "missing does not exist"),
            ("a folder in its place", "taken", "cannot be put in place"),
        ] {
            let folder = Folder::with_table();
            std::fs::create_dir(folder.path("taken")).unwrap();
            let before = folder.contents();
            let output = folder.run(&into(name));
            let said = String::from_utf8_lossy(&output.stderr);
            println!("{writer}, {what}: {}", said.lines().last().unwrap_or_default());
            assert_eq!(output.status.code(), Some(2), "{writer}, {what}: {said}");
            // verify has printed its figures by then.
            let last = said.lines().last().unwrap();
            assert!(last.starts_with("flangeway: ") && last.contains(name) && last.contains(says), "{writer}: {said}");
            assert!(writer.starts_with("verify") || said.lines().count() == 1, "{writer}: {said}");
            assert!(!said.contains("panicked"), "{writer}: {said}");
            assert!(before == folder.contents(), "{writer}, {what}: something was left behind");
        }
    }
}

/// A device is written to, never replaced: `/dev/full` is the full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    use std::os::unix::fs::FileTypeExt as _;
    for writer in WRITERS {
        let folder = Folder::with_table();
        let before = folder.contents();
        // Through a symbolic link, so that a program that replaces its output harms the link and not the device.
        std::os::unix::fs::symlink("/dev/full", folder.path("full")).unwrap();
        let output = folder.run(&writer.replace("OUT", "full"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{writer}: {said}");
        let last = said.lines().last().unwrap();
        println!("{writer}: {last}");
        assert!(last.starts_with("flangeway: full: ") && last.contains("No space left on device"), "{writer}: {said}");
        let target = std::fs::metadata(folder.path("full")).unwrap().file_type();
        assert!(target.is_char_device(), "{writer}: the device was replaced");
        std::fs::remove_file(folder.path("full")).unwrap();
        assert!(before == folder.contents(), "{writer}: something was left behind");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_stdout() {
    for command in [
        "inspect table.fwt --json",
        "inspect table.fwt",
        "verify table.fwt --recipe recipe.toml --samples 10 --lines 1 --json",
        "profile s1002 --json",
        "compile recipe.toml -o out.fwt --json",
    ] {
        let folder = Folder::with_table();
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = folder.run_into(command, Stdio::from(full));
        let said = String::from_utf8_lossy(&output.stderr);
        println!("{command}: {}", said.lines().last().unwrap_or_default());
        assert!(!said.contains("panicked"), "{command}: {said}");
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert!(said.lines().last().unwrap().starts_with("flangeway: "), "{command}: {said}");
    }
}
