//! `flangeway creep`: forces of a file of cases, and clean errors.

use crate::common::{Csv, Folder};

const HEADER: &str =
    "semi_axis_x_m,semi_axis_y_m,normal_force_n,longitudinal_creepage,lateral_creepage,spin_creepage_per_m";

#[test]
fn four_laws_on_one_file() {
    let folder = Folder::new();
    // The second case is CONTACT's examples/fastsim.inp, in which the full solution is FY = -0.6074 μN; the third slides.
    let cases = "6e-3,4e-3,50000,1e-6,0,0\n8e-3,4e-3,82000,0,-6.25e-4,0.625\n5e-3,5e-3,80000,-0.1,0,0\n";
    folder.write("cases.csv", format!("{HEADER}\n{cases}"));
    let mut slopes = Vec::new();
    for law in ["kalker", "shen-hedrick-elkins", "polach", "fastsim", "fastsim --grid 10x10"] {
        folder.run_well(&format!("creep cases.csv --law {law} -o forces.csv"));
        let forces = Csv::read(&folder, "forces.csv");
        assert_eq!(forces.len(), 3);
        slopes.push(forces.number(0, "longitudinal_force_n"));
        if law != "kalker" {
            assert!((forces.number(1, "lateral_force_n") / (0.3 * 82e3) + 0.6074).abs() < 0.08, "{law}");
            assert!((forces.number(2, "longitudinal_force_n") / 24e3 - 1.0).abs() < 1e-3, "{law}");
            assert!((forces.number(2, "wear_index_n") / 2400.0 - 1.0).abs() < 1e-3, "{law}");
            assert!(forces.number(2, "force_over_bound") <= 1.000_001, "{law}");
        }
    }
    assert!(slopes.iter().all(|slope| *slope < 0.0 && (slope / slopes[0] - 1.0).abs() < 1e-3), "{slopes:?}");
}

#[test]
fn friction_of_a_case_comes_first() {
    let folder = Folder::new();
    folder.write("cases.csv", format!("friction,{HEADER}\n0.5,5e-3,5e-3,10000,0.2,0,0\n"));
    folder.run_well("creep cases.csv --friction 0.1 -o forces.csv");
    let force = Csv::read(&folder, "forces.csv").number(0, "longitudinal_force_n");
    assert!((force + 5000.0).abs() < 1.0, "{force}");
}

#[test]
fn bad_cases_are_named() {
    let good = "5e-3,5e-3,10000,0.2,0,0";
    for (header, row, says) in [
        (HEADER.replace("semi_axis_x_m", "a"), good.to_owned(), "column semi_axis_x_m is missing"),
        (format!("{HEADER},mu"), format!("{good},0.3"), "column \"mu\" is not one of"),
        (HEADER.to_owned(), good.replace("10000", "-1"), "cases.csv:2: normal_force_n: \"-1\" is not"),
        (HEADER.to_owned(), good.replace("0.2", "nan"), "cases.csv:2: longitudinal_creepage: \"nan\" is not"),
        (format!("{HEADER},friction"), format!("{good},0"), "cases.csv:2: friction: \"0\" is not"),
        (HEADER.to_owned(), String::new(), "cases.csv: no cases"),
    ] {
        let folder = Folder::new();
        folder.write("cases.csv", format!("{header}\n{row}\n"));
        let output = folder.run("creep cases.csv -o forces.csv");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.lines().count() == 1 && said.contains(says), "{said}");
        assert!(!folder.path("forces.csv").exists());
    }
}
