//! The commands on good input: what they print and write, and that they agree with each other.

use std::sync::LazyLock;

use crate::common::{self, Csv, Folder, POSES, RECIPE};
use serde_json::Value;

/// Columns that every file of contacts has.
const CONTACTS: [&str; 11] = [
    "pose",
    "side",
    "slot",
    "x_m",
    "y_m",
    "z_m",
    "angle_rad",
    "indentation_m",
    "normal_force_n",
    "semi_axis_x_m",
    "semi_axis_y_m",
];

const SOLVE: &str = "solve --recipe recipe.toml --poses poses.csv -o solved.csv";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

fn number(value: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(value, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?} is {found}"))
}

/// A row of contacts looks like one of a wheel on 60E1 at 1.435 m gauge.
fn assert_plausible(contacts: &Csv, row: usize) {
    for column in CONTACTS {
        assert!(!contacts.text(row, column).is_empty(), "{column}");
    }
    let value = |column| contacts.number(row, column);
    let sign = match contacts.text(row, "side") {
        "right" => 1.0,
        "left" => -1.0,
        other => panic!("side {other}"),
    };
    assert!(["tread", "flange_root", "flange"].contains(&contacts.text(row, "slot")));
    assert!(value("x_m").abs() < 0.05 && (0.71..0.79).contains(&(sign * value("y_m"))));
    assert!(value("z_m").abs() < 0.02 && (-1.3..0.1).contains(&(sign * value("angle_rad"))));
    assert!((1e-7..3e-4).contains(&value("indentation_m")) && (1.0..5e5).contains(&value("normal_force_n")));
    assert!((1e-4..0.03).contains(&value("semi_axis_x_m")) && (1e-4..0.03).contains(&value("semi_axis_y_m")));
}

#[test]
fn solve_finds_the_contacts_of_both_wheels() {
    let folder = Folder::new();
    folder.run_well(SOLVE);
    let contacts = Csv::read(&folder, "solved.csv");
    println!("{}", folder.read("solved.csv"));
    (0..contacts.len()).for_each(|row| assert_plausible(&contacts, row));
    // The third pose hangs above the rails: no row. The first is symmetric.
    let rows = |pose: &str, side: &str| {
        let matches = |row: &usize| contacts.text(*row, "pose") == pose && contacts.text(*row, "side") == side;
        (0..contacts.len()).filter(matches).collect::<Vec<_>>()
    };
    for side in ["right", "left"] {
        assert_eq!((rows("0", side).len(), rows("2", side).len()), (1, 0));
        assert!(!rows("1", side).is_empty());
    }
    let (right, left) = (rows("0", "right")[0], rows("0", "left")[0]);
    for (column, sign) in [("x_m", 1.0), ("y_m", -1.0), ("z_m", 1.0), ("angle_rad", -1.0), ("normal_force_n", 1.0)] {
        assert_eq!(contacts.number(right, column), sign * contacts.number(left, column), "{column}");
    }
}

#[test]
fn side_picks_a_wheel() {
    let folder = Folder::with_table();
    for command in [SOLVE, "lookup table.fwt --poses poses.csv -o solved.csv"] {
        folder.run_well(command);
        let both = Csv::read(&folder, "solved.csv");
        for side in ["right", "left"] {
            folder.run_well(&format!("{command} --side {side}"));
            let one = Csv::read(&folder, "solved.csv");
            let of_side: Vec<usize> = (0..both.len()).filter(|&row| both.text(row, "side") == side).collect();
            assert!(!of_side.is_empty() && of_side.len() == one.len() && one.len() < both.len());
            for (row, &of_both) in of_side.iter().enumerate() {
                for column in CONTACTS {
                    assert_eq!(one.text(row, column), both.text(of_both, column));
                }
            }
        }
    }
}

#[test]
fn sweep_finds_the_same() {
    let folder = Folder::new();
    folder.run_well(SOLVE);
    let locus = Csv::read(&folder, "solved.csv");
    folder.run_well(&format!("{SOLVE} --method sweep"));
    let sweep = Csv::read(&folder, "solved.csv");
    assert_eq!(locus.len(), sweep.len());
    for row in 0..locus.len() {
        for column in ["pose", "side", "slot"] {
            assert_eq!(locus.text(row, column), sweep.text(row, column));
        }
        for (column, within) in [("x_m", 5e-5), ("indentation_m", 2e-7), ("angle_rad", 2e-3)] {
            let (a, b) = (locus.number(row, column), sweep.number(row, column));
            assert!((a - b).abs() < within, "row {row}, {column}: {a} {b}");
        }
    }
}

/// Without yaw in the search the contact lies under the axle, which itself stands askew: x = -η sin ψ with η the
/// contact's distance from the wheelset's centre along the axle.
#[test]
fn two_dimensions_keep_the_contact_under_the_axle() {
    let folder = Folder::new();
    folder.run_well(&format!("{SOLVE} --dim 2d"));
    let flat = Csv::read(&folder, "solved.csv");
    folder.run_well(&format!("{SOLVE} --dim 3d"));
    let full = Csv::read(&folder, "solved.csv");
    let (lateral, yaw) = (0.002, 0.0048);
    let mut seen = 0;
    for row in (0..flat.len()).filter(|&row| flat.text(row, "pose") == "1") {
        let expected = -(flat.number(row, "y_m") - lateral) * libm::tan(yaw);
        assert!((flat.number(row, "x_m") - expected).abs() < 1e-6, "{} not {expected}", flat.number(row, "x_m"));
        seen += 1;
    }
    assert!(seen >= 2);
    // With yaw in the search the contact on the steeper flange root leads.
    let x = |contacts: &Csv| {
        let is = |row: &usize| contacts.text(*row, "pose") == "1" && contacts.text(*row, "side") == "right";
        contacts.number((0..contacts.len()).find(is).unwrap(), "x_m")
    };
    println!("right wheel at 4.8 mrad: x {:.3} mm in 2-D, {:.3} mm in 3-D", 1e3 * x(&flat), 1e3 * x(&full));
    assert!((x(&flat) - x(&full)).abs() > 1e-4);
}

#[test]
fn rigid_writes_a_regular_grid() {
    let folder = Folder::new();
    folder.run_well("rigid --recipe recipe.toml --nodes 9x3 -o rigid.csv");
    let map = Csv::read(&folder, "rigid.csv");
    assert_eq!(map.len(), 27);
    for row in 0..27 {
        let (i, j) = (row / 3, row % 3);
        assert!((map.number(row, "y_m") - (-0.010 + 0.0025 * i as f64)).abs() < 1e-12);
        assert!((map.number(row, "yaw_rad") - 0.012 * j as f64).abs() < 1e-12);
        // Mirrored in y: the same height, the opposite roll.
        let mirrored = 3 * (8 - i) + j;
        assert!((map.number(row, "z_m") - map.number(mirrored, "z_m")).abs() < 1e-11);
        assert!((map.number(row, "roll_rad") + map.number(mirrored, "roll_rad")).abs() < 1e-11);
        assert!(map.number(row, "z_m").abs() < 0.02 && map.number(row, "roll_rad").abs() < 0.03);
    }
    println!("centred: z {} m, roll {} rad", map.text(12, "z_m"), map.text(12, "roll_rad"));
    // CONTACT finds 0.1821 mm for the Manchester pair, which is the same.
    assert!((map.number(12, "z_m") - 0.1821e-3).abs() < 1e-6 && map.number(12, "roll_rad").abs() < 1e-12);
    folder.run_well("rigid --recipe recipe.toml -o rigid.csv");
    assert_eq!(Csv::read(&folder, "rigid.csv").len(), 121 * 9);
}

/// A finer table, compiled by the program: its folder and what `compile --json` printed.
fn compiled() -> &'static (Folder, Value) {
    static COMPILED: LazyLock<(Folder, Value)> = LazyLock::new(|| {
        let folder = Folder::new();
        let printed = json(&folder.run_well("compile recipe.toml -o table.fwt --uniform 121x7x3x3 --json"));
        (folder, printed)
    });
    &COMPILED
}

#[test]
fn compile_says_what_it_made() {
    let (folder, printed) = compiled();
    println!("{printed:#}");
    assert_eq!(number(printed, &["nodes"]), 121.0 * 7.0 * 9.0);
    assert_eq!(number(printed, &["bytes"]), std::fs::metadata(folder.path("table.fwt")).unwrap().len() as f64);
    assert!((0.001..600.0).contains(&number(printed, &["seconds"])));
    assert_eq!(printed["axes"], serde_json::json!({"lateral": 121, "yaw": 7, "vertical": 3, "roll": 3}));
    assert!((0.0..0.05).contains(&number(printed, &["force_error", "median"])));
    // The recipe's own counts, and any number of threads: the bytes of the library's compiler.
    let folder = Folder::new();
    for jobs in ["", "--jobs 1", "--jobs 3"] {
        folder.run_well(&format!("compile recipe.toml -o again.fwt {jobs}"));
        assert!(std::fs::read(folder.path("again.fwt")).unwrap() == common::table(), "{jobs}");
    }
}

#[test]
fn inspect_prints_the_header() {
    let (folder, _) = compiled();
    let shown = json(&folder.run_well("inspect table.fwt --json"));
    assert_eq!(number(&shown, &["axes", "lateral", "nodes"]), 121.0);
    assert_eq!(number(&shown, &["bytes"]), std::fs::metadata(folder.path("table.fwt")).unwrap().len() as f64);
    assert_eq!((number(&shown, &["gauge_m"]), number(&shown, &["youngs_modulus_pa"])), (1.435, 2.1e11));
    assert_eq!(
        (&shown["sides"]["right"]["wheel"], &shown["sides"]["right"]["rail"]),
        (&"s1002".into(), &"60e1".into())
    );
    assert!(number(&shown, &["errors", "samples"]) > 0.0);
    assert!(shown["sides"]["right"]["scales"]["tread"]["indentation"]["step"].as_f64().unwrap() < 1e-6);
    let words = folder.run_well("inspect table.fwt");
    assert!(words.contains("s1002") && words.contains("youngs_modulus_pa: 210000000000"), "{words}");
}

#[test]
fn verify_measures_the_table() {
    let (folder, compiled) = compiled();
    let verify = "verify table.fwt --recipe recipe.toml --samples 2000 --lines 50 --seed 3 --json";
    let report = json(&folder.run_well(&format!("{verify} -o samples.csv")));
    println!("{report:#}");
    assert_eq!(number(&report, &["samples"]), 2000.0);
    assert_eq!(number(&report, &["table_bytes"]), number(compiled, &["bytes"]));
    let force = ["median", "rms", "p95", "p99", "max"].map(|key| number(&report, &["normal_force", key]));
    let [median, rms, p95, p99, max] = force;
    assert!(0.0 < median && median < p95 && p95 < p99 && p99 < max && rms < max, "{force:?}");
    assert!(median < 0.02 && p95 < 0.3, "{force:?}");
    assert!((0.0..1.0).contains(&number(&report, &["continuity"])));
    assert_eq!(Csv::read(folder, "samples.csv").len(), 2000);
    // The same seed gives the same figures; a limit below them is a check that fails, not bad input.
    assert_eq!(json(&folder.run_well(verify)), report);
    let failed = folder.run("verify table.fwt --recipe recipe.toml --samples 500 --lines 1 --limit-p95 1e-9");
    assert_eq!(failed.status.code(), Some(1));
}

#[test]
fn lookup_agrees_with_solve() {
    let (folder, _) = compiled();
    // Poses inside the table on a path from tread to flange root, and one in the air.
    let mut poses = POSES.to_owned();
    for i in 0..40 {
        let y = 1e-4 * f64::from(i - 20);
        poses += &format!("{y},{},{},{}\n", 1.5e-4 * f64::from(i), 2.2e-4 - 12.0 * y * y, -0.05 * y);
    }
    folder.write("poses.csv", poses);
    folder.run_well(SOLVE);
    folder.run_well("lookup table.fwt --poses poses.csv -o looked.csv");
    let (solved, looked) = (Csv::read(folder, "solved.csv"), Csv::read(folder, "looked.csv"));
    (0..looked.len()).for_each(|row| assert_plausible(&looked, row));
    let total = |contacts: &Csv, pose: usize, side: &str| {
        let pose = pose.to_string();
        let of = |row: &usize| contacts.text(*row, "pose") == pose && contacts.text(*row, "side") == side;
        (0..contacts.len()).filter(of).map(|row| contacts.number(row, "normal_force_n")).sum::<f64>()
    };
    let (mut errors, mut empty) = (Vec::new(), 0);
    for pose in 0..43 {
        for side in ["right", "left"] {
            let (a, b) = (total(&solved, pose, side), total(&looked, pose, side));
            empty += usize::from(a == 0.0 && b == 0.0);
            errors.push((b - a).abs() / a.max(5e3));
        }
    }
    errors.sort_by(f64::total_cmp);
    println!(
        "{} wheels, {empty} in the air: force error median {:.3} %, largest {:.2} %",
        errors.len(),
        1e2 * errors[errors.len() / 2],
        1e2 * errors[errors.len() - 1]
    );
    assert!((2..20).contains(&empty));
    assert!(errors[errors.len() / 2] < 0.02 && errors[errors.len() * 9 / 10] < 0.05);
}

#[test]
fn the_recipe_says_two_dimensions() {
    let folder = Folder::new();
    folder.write("recipe.toml", format!("{RECIPE}\n[solver]\nnormal = \"hertz\"\ndimension = \"2d\"\n"));
    folder.run_well(SOLVE);
    let by_recipe = folder.read("solved.csv");
    folder.write("recipe.toml", RECIPE);
    folder.run_well(&format!("{SOLVE} --dim 2d"));
    assert_eq!(folder.read("solved.csv"), by_recipe);
}
