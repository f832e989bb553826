//! The report of `verify`: complete in itself, every number a number, every sample in exactly one class.

use crate::common::{Folder, RECIPE};
use serde_json::Value;

const SAMPLES: u64 = 600;
const GRID: &str = "[grid]
lateral_m = { range = [-0.003, 0.008], nodes = 33 }
yaw_rad = { range = [0.0, 0.012], nodes = 3 }
vertical_m = { range = [-5e-5, 1.5e-4], nodes = 3 }
roll_rad = { range = [-1e-3, 1e-3], nodes = 3 }
";

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} is no number"))
}

#[test]
fn report_of_a_small_table() {
    let folder = Folder::new();
    let (pair, _) = RECIPE.split_once("[grid]").unwrap();
    folder.write("recipe.toml", format!("{pair}{GRID}"));
    folder.run_well("compile recipe.toml -o table.fwt");
    let verify = format!("verify table.fwt --recipe recipe.toml --samples {SAMPLES} --lines 24 --seed 5 --json");
    let printed: Value = serde_json::from_str(&folder.run_well(&format!("{verify} --report out --naive"))).unwrap();
    let text = folder.read("out/verify.json");
    let report: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report, printed);
    // serde_json writes what is not finite as null.
    assert!(!text.contains("NaN"));

    classes(&report);
    worst(&report);
    changes(&report);
    naive(&report);
    page(&folder.read("out/verify.html"));

    // Without the option nothing of it is there, and the figures are the same.
    let plain: Value = serde_json::from_str(&folder.run_well(&verify)).unwrap();
    assert_eq!(plain["normal_force"], report["normal_force"]);
    assert!(plain.get("naive").is_none() && plain.get("worst").is_none());
}

fn classes(report: &Value) {
    let classes = report["classes"].as_array().unwrap();
    assert_eq!(classes.len(), 4);
    let samples: f64 = classes.iter().map(|class| number(class, "/samples")).sum();
    assert_eq!(samples, SAMPLES as f64);
    assert_eq!(samples, number(report, "/samples"));
    let squares: f64 = classes.iter().map(|class| number(class, "/share_of_squares")).sum();
    assert!((squares - 1.0).abs() < 1e-9, "{squares}");
    // All squares together are the rms of all.
    let sum: f64 = classes.iter().map(|c| number(c, "/samples") * number(c, "/normal_force/rms").powi(2)).sum();
    assert!((sum / samples / number(report, "/normal_force/rms").powi(2) - 1.0).abs() < 1e-9);
    // Most cells of a tread are free of joints and changes; at the transition to the flange some are not.
    assert!(classes.iter().any(|c| c["class"] == "rest" && number(c, "/samples") > 0.3 * samples));
    assert!(classes.iter().any(|c| c["class"] == "contacts" && number(c, "/samples") > 0.0));
}

fn worst(report: &Value) {
    let worst = report["worst"].as_array().unwrap();
    assert_eq!(worst.len(), 20);
    assert_eq!(number(&worst[0], "/error"), number(report, "/normal_force/max"));
    for (pose, next) in worst.iter().zip(&worst[1..]) {
        assert!(number(pose, "/error") >= number(next, "/error"));
    }
    for pose in worst {
        let total = |key: &str| (0..3).map(|slot| number(pose, &format!("/{key}/{slot}"))).sum::<f64>();
        let (direct, table) = (total("direct_n"), total("table_n"));
        let error = (table - direct).abs() / direct.max(5e3);
        assert!((error / number(pose, "/error") - 1.0).abs() < 1e-3, "{pose}");
        let width = number(pose, "/lateral_width_m");
        assert!((width - 0.011 / 32.0).abs() < 1e-9, "{width}");
    }
}

fn changes(report: &Value) {
    for (list, figure) in [("table", "continuity"), ("direct", "continuity_direct")] {
        let changes = report["changes"][list].as_array().unwrap();
        assert!(!changes.is_empty() && changes.len() <= 20);
        assert_eq!(changes[0]["relative"], report[figure]);
    }
    assert!(number(report, "/changes/lines") <= 24.0 && number(report, "/changes/crossing") > 0.0);
}

fn naive(report: &Value) {
    for figure in ["rms", "median", "p95", "p99"] {
        let (naive, ours) = (format!("/naive/normal_force/{figure}"), format!("/normal_force/{figure}"));
        let factor = number(report, &naive) / number(report, &ours);
        assert!((factor / number(report, &format!("/factor/{figure}")) - 1.0).abs() < 1e-12);
        println!("{figure}: a naive table is worse by {factor:.1}");
        assert!(factor > 2.0, "{figure}: {factor}");
    }
    assert!(number(report, "/naive/bytes") <= number(report, "/table_bytes"));
    let nodes: f64 = (0..4).map(|axis| number(report, &format!("/naive/design/nodes/{axis}"))).product();
    assert_eq!(60.0 * nodes, number(report, "/naive/bytes"));
    assert!(number(report, "/naive_on_fewer_poses/0/factor/p95") > 1.0);
}

fn page(html: &str) {
    for mark in ["<svg", "</svg>", "<figcaption>"] {
        // Five of the table, four of the models of normal contact.
        assert_eq!(html.matches(mark).count(), 5 + 4, "{mark}");
    }
    for heading in ["Against a naive table", "The worst poses", "Continuity", "Three models against CONTACT"] {
        assert!(html.contains(heading), "{heading}");
    }
    assert!(html.ends_with("</html>\n"));
    assert!(!html.contains("NaN") && !html.contains("inf "));
    let own = html.replace("http://www.w3.org/2000/svg", "");
    for resource in ["http", "//", "src=", "href", "url(", "@import", "<script", "<link"] {
        assert!(!own.contains(resource), "{resource}");
    }
}
