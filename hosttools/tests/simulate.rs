//! `flangeway simulate` as a user runs it: a short run of each method, and scenarios that are wrong.

use crate::common::{Csv, Folder};

/// The committed bogie on the first metres of its curve.
fn short() -> String {
    flangeway_tables::BOGIE_R60
        .replace("length_m = 15.0", "length_m = 2.0")
        .replace("length_m = 25.0", "length_m = 4.0")
        .replace("length_m = 60.0", "length_m = 1.0")
        .replace("cant_rad = -0.10", "cant_rad = 0.0 ")
}

#[test]
fn a_scenario_runs_by_every_method() {
    let folder = Folder::new();
    folder.write("scenario.toml", short().replace("radius_m = -60.0", "radius_m = -300.0"));
    let mut displaced = Vec::new();
    for method in ["table", "direct-3d", "direct-2d", "rigid"] {
        folder.run_well(&format!("simulate scenario.toml -o {method}.csv --contact {method} --svg {method}.svg"));
        let rows = Csv::read(&folder, &format!("{method}.csv"));
        let last = rows.len() - 1;
        assert!((rows.number(last, "distance_m") - 7.0).abs() < 0.1);
        // Both rails carry the vehicle's weight.
        let load = |wheel: &str| rows.number(last, &format!("{wheel}_wheel_load_n"));
        let all = ["leading_right", "leading_left", "trailing_right", "trailing_left"].map(load).iter().sum::<f64>();
        assert!((all / (15_800.0 * 9.80665) - 1.0).abs() < 0.05, "{method}: {all}");
        displaced.push(rows.number(last, "leading_lateral_m"));
        assert!(folder.read(&format!("{method}.svg")).contains("normal force (kN)"));
    }
    let [table, full, ..] = displaced.as_slice() else { unreachable!() };
    assert!((table - full).abs() < 1e-4, "{displaced:?}");
    assert!(*table > 1e-4, "outwards in the curve: {displaced:?}");
}

#[test]
fn measured_and_generated_irregularities_move_the_wheelsets() {
    let folder = Folder::new();
    let series: String = (0..60)
        .map(|i| format!("{},{:e},{:e},0\n", 0.5 * f64::from(i), 3e-3 * f64::from(i % 7), 1e-3 * f64::from(i % 3)))
        .collect();
    folder.write("track.csv", format!("s_m,lateral_m,vertical_m,cross_level_rad\n{series}"));
    for (name, lines) in [
        ("plain", ""),
        ("measured", "[irregularity]\nfile = \"track.csv\"\n"),
        ("generated", "[irregularity]\nspectrum = \"ore-b176-high\"\nseed = 5\n"),
    ] {
        folder.write(&format!("{name}.toml"), short() + lines);
        folder.run_well(&format!("simulate {name}.toml -o {name}.csv --creep polach"));
    }
    let yaw = |name: &str| {
        let rows = Csv::read(&folder, &format!("{name}.csv"));
        (0..rows.len()).map(|row| rows.number(row, "trailing_lateral_m").abs()).fold(0.0, f64::max)
    };
    assert!(yaw("measured") > 1.2 * yaw("plain") && yaw("generated") != yaw("plain"));
}

#[test]
fn wrong_scenarios_are_named_in_one_line() {
    let folder = Folder::new();
    let good = short();
    let cases = [
        ("speed_m_per_s = 15.0", "speed_m_per_s = -3.0", "run.speed_m_per_s: -3 is not between"),
        ("friction = 0.3", "friktion = 0.3", "unknown field `friktion`"),
        ("recipe = \"urban_metre_gauge\"", "recipe = \"metre\"", "recipe: \"metre\" is neither a file nor one of"),
        ("model = \"bogie\"", "model = \"wheelset\"", "frame: a single wheelset has none"),
        ("radius_m = -60.0", "radius_m = -6.0", "track.radius_m: -6 of section 3"),
        ("kind = \"transition\"", "kind = \"curve\"", "track.radius_m: section 2: a curve has one"),
        ("output_interval_s = 2.0e-3", "output_interval_s = 2.5e-4", "no whole number of steps"),
        ("step_s = 1.0e-4 ", "step_s = 2.0e-3 ", "run: "),
        ("method = \"table\"", "method = \"table\"\ntable = \"none.fwt\"", "none.fwt"),
    ];
    for (from, to, message) in cases {
        assert!(good.contains(from), "{from}");
        folder.write("wrong.toml", good.replacen(from, to, 1));
        let output = folder.run("simulate wrong.toml -o out.csv");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{to}: {said}");
        assert!(said.contains(message) && said.lines().count() == 1, "{to}: {said}");
        assert!(!folder.path("out.csv").exists());
    }
}
