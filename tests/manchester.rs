//! The direct solver against the Manchester contact benchmark, case A-2.2 (yawed wheelset), as CONTACT solves it.

use crate::common::{self, MM};
use flangeway::{Pose, Side};
use flangeway_host::contacts::{ContactRow, solved};
use flangeway_host::pair::Pair;

/// One wheel at one pose, by CONTACT.
struct Row {
    side: Side,
    case: String,
    pose: Pose,
    x: f64,
    y: f64,
    angle: f64,
    force: f64,
    approach: f64,
}

impl Row {
    /// From a pose (y mm, yaw rad, roll rad, z mm) and an answer (x mm, y mm, angle rad, force N, approach mm).
    fn new(side: Side, case: &str, [lateral, yaw, roll, vertical]: [f64; 4], answer: [f64; 5]) -> Self {
        let [x, y, angle, force, approach] = answer;
        Self {
            side,
            case: case.into(),
            pose: Pose { lateral: lateral * MM, yaw, vertical: vertical * MM, roll },
            x: x * MM,
            y: y * MM,
            angle,
            force,
            approach: approach * MM,
        }
    }
}

/// How far the solver may be from CONTACT, and in how many rows it must be as near.
struct Tolerance {
    /// x (m), y (m), angle (rad), total force (share).
    within: [f64; 4],
    /// Least number of rows for each.
    rows: [usize; 4],
}

/// Five cases, both wheels, of the benchmark's 22 rows: tread, flange root, flange.
/// Source: Manchester contact benchmark, every second of its 21 poses, as solved by CONTACT (full, not Hertzian).
/// `y mm, yaw rad, roll rad, z mm`, then `x mm, y mm, angle rad, force N, approach mm`.
const GOLDEN: [(Side, &str, [f64; 4], [f64; 5]); 10] = [
    (Side::Left, "1", [0.0, 0.0, 0.0, 0.1981], [0.0, -751.8726, 0.0290, 9997.0, 1.596e-2]),
    (Side::Right, "1", [0.0, 0.0, 0.0, 0.1981], [0.0, 751.8726, -0.0290, 9997.0, 1.596e-2]),
    (Side::Left, "5", [2.0, 4.8e-3, -1.128e-4, 0.1530], [3.6112, -756.5056, 0.0134, 10040.0, 2.054e-2]),
    (Side::Right, "5", [2.0, 4.8e-3, -1.128e-4, 0.1529], [-3.3682, 740.9147, -0.0806, 9799.0, 2.480e-2]),
    (Side::Left, "9", [4.0, 9.6e-3, -2.557e-4, 0.0680], [7.2699, -757.6645, 0.0096, 10030.0, 2.185e-2]),
    (Side::Right, "9", [4.0, 9.6e-3, -2.557e-4, 0.0676], [-6.5746, 738.7381, -0.1078, 9745.0, 2.370e-2]),
    (Side::Left, "13", [6.0, 1.44e-2, -6.272e-4, -0.1957], [10.9471, -758.0210, 0.0084, 10020.0, 2.278e-2]),
    (Side::Right, "13", [6.0, 1.44e-2, -6.272e-4, -0.1961], [-7.3822, 725.1371, -0.4176, 9709.0, 2.728e-2]),
    (Side::Left, "21", [10.0, 2.4e-2, -1.126e-2, -8.2662], [18.2884, -757.0975, 0.0115, 10030.0, 2.511e-2]),
    (Side::Right, "21", [10.0, 2.4e-2, -1.126e-2, -8.2668], [-5.2821, 721.0880, -0.7992, 11440.0, 3.411e-2]),
];

/// Why a row misses: wheel and rail follow each other so closely there that the place of the contact is hardly defined.
fn reason(found: &ContactRow) -> String {
    let across: f64 = found.curvatures.iter().sum();
    let nearly = if across < 2.0 { "nearly conformal, " } else { "" };
    format!("{nearly}combined curvature across {across:.2} 1/m, remarks: {}", found.remarks)
}

/// Solves every row, prints it beside CONTACT's, and counts the rows within the tolerance.
fn compare(name: &str, pair: &Pair, rows: &[Row], tolerance: &Tolerance) {
    println!("{name}: solver / CONTACT; x mm, y mm, angle mrad, total force N, indentation um; * misses");
    let mut hits = [0; 4];
    let mut worst = [0.0_f64; 4];
    for row in rows {
        let found = solved(pair, 0, row.side, &row.pose);
        let total: f64 = found.iter().map(|c| c.normal_force).sum();
        let strongest = found.iter().max_by(|a, b| a.normal_force.total_cmp(&b.normal_force));
        let Some(strongest) = strongest else {
            println!("{:>5} {:>2}: no contact *", row.side, row.case);
            continue;
        };
        let ContactRow { position: [x, y, _], angle, indentation, .. } = strongest;
        let apart = [x - row.x, y - row.y, angle - row.angle, total / row.force - 1.0].map(f64::abs);
        let mut mark = [""; 4];
        for i in 0..4 {
            if apart[i] <= tolerance.within[i] {
                hits[i] += 1;
                worst[i] = worst[i].max(apart[i]);
            } else {
                mark[i] = "*";
            }
        }
        println!(
            "{:>5} {:>2}: {:8.3} /{:8.3}{:1} {:9.3} /{:9.3}{:1} {:8.2} /{:8.2}{:1} {:6.0} /{:6.0}{:1} {:6.2} /{:6.2} {} {}",
            row.side,
            row.case,
            x / MM,
            row.x / MM,
            mark[0],
            y / MM,
            row.y / MM,
            mark[1],
            angle / MM,
            row.angle / MM,
            mark[2],
            total,
            row.force,
            mark[3],
            1e3 * indentation / MM,
            1e3 * row.approach / MM,
            if found.len() > 1 { format!("{} contacts", found.len()) } else { String::new() },
            if mark.concat().is_empty() { String::new() } else { reason(strongest) },
        );
    }
    println!(
        "{name}: of {} rows x {}, y {}, angle {}, force {}; worst of those x {:.3} mm, y {:.3} mm, {:.2} mrad, {:.1} %",
        rows.len(),
        hits[0],
        hits[1],
        hits[2],
        hits[3],
        worst[0] / MM,
        worst[1] / MM,
        worst[2] / MM,
        1e2 * worst[3]
    );
    for (i, quantity) in ["x", "y", "angle", "force"].into_iter().enumerate() {
        assert!(hits[i] >= tolerance.rows[i], "{quantity}: {} of {} rows", hits[i], rows.len());
    }
}

#[test]
fn all_rows_of_the_benchmark_with_its_own_profiles() {
    let (Some(recipe), Some(path)) = (common::manchester_files(), common::shared("reference/manchester_a22.csv"))
    else {
        return;
    };
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<Row> = reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let text = |name: &str| record.get(header.iter().position(|h| h == name).unwrap()).unwrap();
            let number = |name: &str| text(name).parse::<f64>().unwrap();
            let side = if text("side") == "left" { Side::Left } else { Side::Right };
            let pose = ["y_ws_mm", "yaw_rad", "roll_rad", "z_ws_mm"].map(number);
            let answer = ["xcp_tr", "ycp_tr", "delta_tr_rad", "FN_N", "approach_mm"].map(number);
            Row::new(side, text("case"), pose, answer)
        })
        .collect();
    assert_eq!(rows.len(), 22);
    let tolerance = Tolerance { within: [0.15 * MM, 0.6 * MM, 10e-3, 0.2], rows: [21, 20, 21, 20] };
    compare("A-2.2", &Pair::build(&recipe).unwrap(), &rows, &tolerance);
}

/// The built-in profiles are the benchmark's to 1e-5 mm (wheel) and 0.01 mm (rail), so the answers are nearly the same.
/// Measured with them: x within 0.065 mm, y 0.18 mm save for the nearly conformal contact of case 1 (0.30 mm), angle
/// 6.9 mrad, force 4.8 % save for case 1 (5.5 %).
#[test]
fn golden_rows_with_the_built_in_profiles() {
    let rows: Vec<Row> =
        GOLDEN.into_iter().map(|(side, case, pose, answer)| Row::new(side, case, pose, answer)).collect();
    let tolerance = Tolerance { within: [0.1 * MM, 0.4 * MM, 8e-3, 0.1], rows: [10; 4] };
    compare("A-2.2, built-in profiles", &Pair::build(&common::manchester_built_in()).unwrap(), &rows, &tolerance);
}
