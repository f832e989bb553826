//! The half-space and the semi-Hertzian solver against CONTACT's full solution of the Manchester benchmark, A-2.2.

use std::f64::consts::PI;

use crate::common::{self, MM};
use flangeway::{Pose, Side};
use flangeway_host::contact::{Normal, Settings, SlotState};
use flangeway_host::pair::Pair;

/// One wheel at one pose, by CONTACT: force (N), approach (m), area (m²), greatest pressure (Pa).
struct Row {
    side: Side,
    case: String,
    pose: Pose,
    force: f64,
    approach: f64,
    area: f64,
    pressure: f64,
}

fn rows() -> Option<Vec<Row>> {
    let mut reader = csv::Reader::from_path(common::shared("reference/manchester_a22.csv")?).unwrap();
    let header = reader.headers().unwrap().clone();
    let row = |record: csv::StringRecord| {
        let text = |name: &str| record.get(header.iter().position(|h| h == name).unwrap()).unwrap();
        let number = |name: &str| text(name).parse::<f64>().unwrap();
        Row {
            side: if text("side") == "left" { Side::Left } else { Side::Right },
            case: text("case").into(),
            pose: Pose {
                lateral: number("y_ws_mm") * MM,
                yaw: number("yaw_rad"),
                vertical: number("z_ws_mm") * MM,
                roll: number("roll_rad"),
            },
            force: number("FN_N"),
            approach: number("approach_mm") * MM,
            area: number("area_mm2") * MM * MM,
            pressure: number("pmax_MPa") * 1e6,
        }
    };
    Some(reader.records().map(|record| row(record.unwrap())).collect())
}

fn solver(pair: &Pair, normal: Normal) -> Pair {
    pair.with_settings(Settings { normal, ..*pair.body(Side::Right).settings() })
}

fn force(pair: &Pair, side: Side, pose: &Pose) -> f64 {
    pair.solve(side, pose).iter().map(SlotState::normal_force).sum()
}

/// The height at which the greatest overlap is the printed approach: z is printed too coarsely.
fn at_approach(pair: &Pair, row: &Row) -> Pose {
    let canonical = row.pose.canonical(row.side).pose;
    let mut column = pair.column(row.side, &canonical);
    let mut vertical = row.pose.vertical;
    for _ in 0..8 {
        let deepest = column.deepest(vertical).unwrap();
        vertical += (row.approach - deepest.depth()) / deepest.foot.tangent[0];
    }
    Pose { vertical, ..row.pose }
}

#[test]
fn forces_and_areas() {
    let (Some(rows), Some(recipe)) = (rows(), common::manchester_files()) else { return };
    let pair = Pair::build(&recipe).unwrap();
    let models = [Normal::Hertz, Normal::SemiHertzian, Normal::HalfSpace].map(|normal| solver(&pair, normal));
    let mut within = [0; 4];
    println!("force / CONTACT - 1 in %: Hertz, semi-Hertzian, half-space; area of half-space, ellipse; pressure");
    for row in &rows {
        let pose = at_approach(&pair, row);
        let [hertz, semi, half] = models.each_ref().map(|pair| 1e2 * (force(pair, row.side, &pose) / row.force - 1.0));
        let canonical = pose.canonical(row.side).pose;
        let patches = models[2].column(row.side, &canonical).patches(canonical.vertical);
        let area = 1e2 * (patches.iter().map(|p| p.area()).sum::<f64>() / row.area - 1.0);
        let greatest = patches.iter().flat_map(|p| &p.pressure).copied().fold(0.0, f64::max);
        let ellipse = |s: &SlotState| {
            if s.normal_force() > 0.0 { PI * s.semi_axis_x * s.semi_axis_y * s.indentation } else { 0.0 }
        };
        let ellipses: f64 = models[2].solve(row.side, &pose).iter().map(ellipse).sum();
        println!(
            "{:>5} {:>2}: {hertz:6.2} {semi:6.2} {half:6.2}; {area:6.1} {:6.1}; {:6.1}; {} patches, {} steps",
            row.side,
            row.case,
            1e2 * (ellipses / row.area - 1.0),
            1e2 * (greatest / row.pressure - 1.0),
            patches.len(),
            patches.iter().map(|p| p.steps).max().unwrap_or(0),
        );
        let hits = [half.abs() < 3.0, semi.abs() < 7.0, area.abs() < 10.0, semi.abs() < 3.0];
        hits.iter().zip(&mut within).for_each(|(hit, count)| *count += usize::from(*hit));
    }
    println!(
        "half-space within 3 %: {}, semi-Hertzian within 7 %: {}, 3 %: {}, area within 10 %: {}",
        within[0], within[1], within[3], within[2]
    );
    assert!(within[0] >= 20 && within[1] >= 18 && within[2] >= 18);
}
