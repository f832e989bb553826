//! How long single steps take, for one wheel and for eight: records in the cache (warm), records nowhere in it (cold: a
//! table of 64 MiB in which no pose comes twice), the caches full of something else (polluted: 64 MiB walked before
//! every step), and cold but asked for ahead (`ContactTable::contacts_many`; for one wheel `prefetch` a step before).
//!
//! `--svg FILE` draws the histograms, `--json FILE` writes their quantiles and the paired ratios of eight cold wheels to
//! eight warm ones. On a shared machine the tails are the machine's.

mod common;
#[path = "../tests/kernel_synthetic/mod.rs"]
mod kernel_synthetic;

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use common::{aligned, quartiles, random_poses};
use flangeway::{ContactTable, Contacts, Pose, Side};
use hdrhistogram::Histogram;
use kernel_synthetic::Synthetic;
use plotters::prelude::*;

const STEPS: usize = 4000;
const POLLUTED_STEPS: usize = 60;
const BUFFER: usize = 64 << 20;
const WHEELS: usize = 8;

/// Nodes from `first` to `last`.
fn nodes(first: f32, last: f32, count: u16) -> Vec<f64> {
    let (first, last) = (f64::from(first), f64::from(last));
    (0..count).map(|i| first + (last - first) * f64::from(i) / f64::from(count - 1)).collect()
}

/// A made-up table of a million records; its rigid map, which nothing can ask for ahead, is as small as a real one's.
fn big_table() -> ContactTable<'static> {
    let axes = [nodes(-0.012, 0.0112, 65), nodes(0.0, 0.04, 9), nodes(-0.002, 0.003, 257), nodes(-1e-4, 3e-4, 7)];
    let image = Synthetic::new(axes, 1).image();
    ContactTable::new(aligned(&image)).expect("a table")
}

fn looked_up(table: &ContactTable<'_>, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
    for ((side, pose), contacts) in wheels.iter().zip(contacts) {
        table.contacts_into(*side, pose, contacts);
    }
}

fn nanoseconds(work: impl FnOnce()) -> u64 {
    let start = Instant::now();
    work();
    u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX).max(1)
}

/// Histograms of a number of wheels, by mode, and the steps' times of warm, cold and ahead.
struct Measured {
    histograms: [(&'static str, Histogram<u64>); 4],
    paired: Vec<[f64; 3]>,
}

fn measure(
    table: &ContactTable<'_>,
    count: usize,
    poses: &mut impl Iterator<Item = Pose>,
) -> Result<Measured, Box<dyn Error>> {
    let names = ["warm", "cold", "polluted", "cold, asked for ahead"];
    let mut histograms: Vec<Histogram<u64>> = names.iter().map(|_| Histogram::new(3)).collect::<Result<_, _>>()?;
    let mut contacts = vec![Contacts::NONE; count];
    let mut fresh = || -> Vec<(Side, Pose)> { poses.by_ref().take(count).map(|pose| (Side::Right, pose)).collect() };
    let warm = fresh();
    let mut paired = Vec::new();
    for _ in 0..STEPS {
        let (cold, ahead) = (fresh(), fresh());
        looked_up(table, &warm, &mut contacts);
        let of_warm = nanoseconds(|| looked_up(table, black_box(&warm), black_box(&mut contacts)));
        let of_cold = nanoseconds(|| looked_up(table, black_box(&cold), black_box(&mut contacts)));
        if count == 1 {
            table.prefetch(ahead[0].0, &ahead[0].1);
            // The caller's other work.
            (0..200).for_each(|_| looked_up(table, black_box(&warm), black_box(&mut contacts)));
        }
        let of_ahead = nanoseconds(|| match count {
            1 => looked_up(table, black_box(&ahead), black_box(&mut contacts)),
            _ => table.contacts_many(black_box(&ahead), black_box(&mut contacts)),
        });
        for (histogram, time) in [(0, of_warm), (1, of_cold), (3, of_ahead)] {
            histograms[histogram].record(time)?;
        }
        paired.push([of_warm, of_cold, of_ahead].map(|time| time as f64));
    }
    let mut buffer = vec![0_u8; BUFFER];
    for _ in 0..POLLUTED_STEPS {
        buffer.iter_mut().step_by(64).for_each(|byte| *byte = byte.wrapping_add(1));
        black_box(&mut buffer);
        histograms[2].record(nanoseconds(|| looked_up(table, black_box(&warm), black_box(&mut contacts))))?;
    }
    let mut histograms = histograms.into_iter();
    let histograms = names.map(|name| (name, histograms.next().expect("four")));
    Ok(Measured { histograms, paired })
}

/// Shares of steps by time, on a logarithmic axis.
fn draw(path: &str, measured: &[(usize, Measured)]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, (900, 640)).into_drawing_area();
    area.fill(&WHITE)?;
    for ((wheels, measured), part) in measured.iter().zip(area.split_evenly((measured.len(), 1))) {
        let mut chart = ChartBuilder::on(&part)
            .caption(format!("{wheels} wheel{}", if *wheels == 1 { "" } else { "s" }), ("sans-serif", 18))
            .margin(12)
            .margin_right(32)
            .x_label_area_size(40)
            .y_label_area_size(56)
            .build_cartesian_2d((50_f64..100_000.0).log_scale(), 0.0..100.0)?;
        chart
            .configure_mesh()
            .x_desc("time of a step, ns")
            .y_desc("steps done, %")
            .x_label_formatter(&|x| format!("{x:.0}"))
            .draw()?;
        for (index, (name, histogram)) in measured.histograms.iter().enumerate() {
            let colour = Palette99::pick(index).to_rgba();
            let quantiles = (0..=1000).map(|i| f64::from(i) / 1000.0);
            let line = quantiles.map(|q| (histogram.value_at_quantile(q) as f64, 100.0 * q));
            chart
                .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .background_style(WHITE)
            .border_style(BLACK)
            .draw()?;
    }
    area.present()?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let table = big_table();
    let mut poses = random_poses(&table, 2 * STEPS * (WHEELS + 1) + 2 * WHEELS, 5).into_iter();
    let mut all = Vec::new();
    let mut json = serde_json::Map::new();
    for count in [1, WHEELS] {
        let measured = measure(&table, count, &mut poses)?;
        println!("{count} wheel{}: p50, p99, p99.9, largest, ns", if count == 1 { "" } else { "s" });
        for (name, histogram) in &measured.histograms {
            let [p50, p99, p999, max] = [0.5, 0.99, 0.999, 1.0].map(|q| histogram.value_at_quantile(q));
            println!("  {name:22} {p50:7} {p99:7} {p999:7} {max:8}");
            let key = format!("{name} {count}");
            json.insert(key, serde_json::json!({ "p50": p50, "p99": p99, "p999": p999, "max": max }));
        }
        for (name, way) in [("cold", 1), ("ahead", 2)] {
            let [low, median, high] = quartiles(measured.paired.iter().map(|round| round[way] / round[0]).collect());
            println!("  {name} over warm, paired: {median:.2} ({low:.2} to {high:.2})");
            json.insert(format!("ratio_{name}_{count}"), median.into());
        }
        all.push((count, measured));
    }
    if let Some(path) = common::option("--svg") {
        draw(&path, &all)?;
    }
    if let Some(path) = common::option("--json") {
        std::fs::write(path, serde_json::to_string_pretty(&json)?)?;
    }
    Ok(())
}
