//! A measured wheel on a measured rail: what their noise does, and the table that smoothing makes of them.

use crate::common;
use flangeway::{ContactTable, Side};
use flangeway_host::compile::compile;
use flangeway_host::pair::Pair;
use flangeway_host::profile_noise;
use flangeway_host::recipe::Recipe;
use flangeway_host::{rigid, verify};

/// The scatter of both measurements, about (m).
const SMOOTHING: &str = "5e-5";

/// The wheel's file has its origin at the flange's back, so the tape circle is 70 mm from it. The track is ours: the
/// files do not say what they were measured on.
const RECIPE: &str = r#"
[wheel]
profile = "Car7216_0001r.whl"
nominal_radius_m = 0.460
flange_back_spacing_m = 1.360
flange_back_position_m = 0.0
tape_circle_position_m = 0.070
smoothing_m = SMOOTHING

[rail]
profile = "avg_low2.ban"
gauge_m = 1.435
smoothing_m = SMOOTHING

[material]
youngs_modulus_pa = 2.1e11
poisson_ratio = 0.28

[grid]
lateral_m = { range = [-0.008, 0.008], nodes = "auto" }
yaw_rad = { range = [0.0, 0.012], nodes = "auto" }
vertical_m = { range = [-5.0e-5, 1.5e-4], nodes = "auto" }
roll_rad = { range = [-1.0e-3, 1.0e-3], nodes = "auto" }
max_bytes = 524_288
"#;

/// The recipe with a smoothing (m), where the profile files are there.
fn recipe(smoothing: &str) -> Option<Recipe> {
    let folder = common::shared("profiles")?;
    Some(Recipe::parse(&RECIPE.replace("SMOOTHING", smoothing), &folder.join("worn.toml")).unwrap())
}

#[test]
fn unsmoothed_curvature_is_reported_as_noise() {
    let Some(raw) = recipe("0.0") else { return };
    let said = profile_noise::warnings(&raw, &Pair::build(&raw).unwrap()).unwrap();
    println!("{said:#?}");
    assert_eq!(said.len(), 2);
    for (sentence, start) in said.iter().zip(["Car7216_0001r.whl: the wheel", "avg_low2.ban: the rail"]) {
        assert!(sentence.starts_with(start) && sentence.contains("set smoothing_m"), "{sentence}");
    }
    let smooth = recipe(SMOOTHING).unwrap();
    assert_eq!(profile_noise::warnings(&smooth, &Pair::build(&smooth).unwrap()).unwrap(), [] as [String; 0]);
    // The benchmark's own files have clean points.
    let clean = common::manchester_files().unwrap();
    assert_eq!(profile_noise::warnings(&clean, &Pair::build(&clean).unwrap()).unwrap(), [] as [String; 0]);
}

#[test]
fn smoothed_curvature_is_sane_where_the_wheel_runs() {
    let Some(smooth) = recipe(SMOOTHING) else { return };
    let pair = Pair::build(&smooth).unwrap();
    let body = pair.body(Side::Right);
    let (wheel, rail) = (body.wheel().curve(), body.rail().curve());
    println!("points moved by {:.1} and {:.1} um rms", 1e6 * wheel.residual(), 1e6 * rail.residual());
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for i in -30..=30 {
        let point = rigid::at_displacement(&pair, Side::Right, 1e-4 * f64::from(i), 0.0).unwrap().right;
        for (range, curvature) in range.iter_mut().zip([wheel.at(point.wheel.t), rail.at(point.foot.t)]) {
            *range = [range[0].min(curvature.curvature), range[1].max(curvature.curvature)];
        }
    }
    println!("curvature within 3 mm of the centre: wheel {:.1?}, rail {:.1?} 1/m", range[0], range[1]);
    // A hollow wheel of 50 mm radius and a rail of as little are the sharpest that wear leaves on a tread.
    assert!(range.iter().flatten().all(|curvature| curvature.abs() < 20.0), "{range:?}");
}

#[test]
fn the_table_of_the_worn_pair_reports_its_errors() {
    if cfg!(debug_assertions) {
        println!("skipped: takes minutes without --release");
        return;
    }
    let Some(recipe) = recipe(SMOOTHING) else { return };
    let start = std::time::Instant::now();
    let pair = Pair::build(&recipe).unwrap();
    let compiled = compile(&recipe, &pair, None).unwrap();
    let table = ContactTable::new(&compiled.image).unwrap();
    let errors = table.header().errors;
    println!("{} bytes in {:.1} s: {errors:?}", compiled.image.len(), start.elapsed().as_secs_f64());
    // Other poses than the header's find the same errors.
    let samples = verify::sample(&table, &pair, Side::Right, 4000, 77);
    let mut again: Vec<f64> = samples.iter().map(verify::Sample::force_error).collect();
    again.sort_by(f64::total_cmp);
    for (name, said, q) in [("median", errors.force_median, 0.5), ("p95", errors.force_p95, 0.95)] {
        let (said, found) = (f64::from(said), verify::quantile(&again, q));
        println!("{name}: the header says {:.3} %, other poses {:.3} %", 1e2 * said, 1e2 * found);
        assert!(found < 1.5 * said && said < 1.5 * found, "{name}");
    }
    assert!(errors.samples > 3900 && errors.force_median < 0.03 && errors.force_p95 < 0.3, "{errors:?}");
}
