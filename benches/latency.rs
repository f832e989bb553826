//! How long single steps take, for one wheel and for eight: records in the cache (warm), records nowhere in it (cold), the
//! caches full of something else (polluted: 64 MiB walked before every step), and cold but asked for ahead
//! (`ContactTable::contacts_many`; for one wheel `prefetch` a step before). Beside them the time of reading the cold
//! records alone, a byte of each and all at once: what memory asks for, whatever is done with them. With two tables: one of
//! a usual size, its records flushed from all caches before each cold step, and one of 64 MiB in which no pose comes twice,
//! so that the pages' addresses are in no cache either, which a rig that locks a usual table in memory does not meet.
//!
//! `--svg FILE` draws the histograms, `--json FILE` writes their quantiles and the paired ratios of cold wheels to warm
//! ones. On a shared machine the tails are the machine's, and so is how many records can be asked for at a time.

mod common;
#[path = "../tests/kernel_synthetic/mod.rs"]
mod kernel_synthetic;

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use common::{aligned, quartiles, random_poses};
use flangeway::{AxisName, ContactTable, Contacts, Pose, Side};
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

/// A made-up table with so many roll offsets, and its records. Its rigid map, which nothing can ask for ahead, is as small
/// as a real one's.
fn made_up(roll_offsets: u16) -> (ContactTable<'static>, &'static [u8]) {
    let roll = nodes(-0.002, 0.003, roll_offsets);
    let axes = [nodes(-0.012, 0.0112, 65), nodes(0.0, 0.04, 9), roll, nodes(-1e-4, 3e-4, 7)];
    let image = aligned(&Synthetic::new(axes, 1).image());
    // The records of the one side are the image's last part.
    let (_, records) = image.split_at(image.len() - 65 * 9 * usize::from(roll_offsets) * 7 * LINE);
    (ContactTable::new(image).expect("a table"), records)
}

/// Bytes of a record, a cache line.
const LINE: usize = 64;

/// Flushes lines from all caches. Elsewhere than on x86-64 nothing can be flushed, and cold is warm.
fn flush(lines: &[u8]) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 processor has the instructions; they change nothing that the program can see.
    #[expect(unsafe_code, reason = "there is no other way to flush a line")]
    unsafe {
        use std::arch::x86_64::{_mm_clflush, _mm_mfence};
        lines.chunks(LINE).for_each(|line| _mm_clflush(line.as_ptr()));
        _mm_mfence();
    }
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

/// Where the sixteen records of a pose begin.
fn corners(table: &ContactTable<'_>, pose: &Pose) -> [usize; 16] {
    let at = table.coordinates(Side::Right, pose);
    let x = [at.lateral, at.yaw, at.roll_offset, at.vertical];
    let axes = AxisName::ALL.map(|name| table.axis(name));
    let cell: [usize; 4] = std::array::from_fn(|i| axes[i].locate(x[i]).cell);
    std::array::from_fn(|corner| {
        let node = |i: usize| cell[i] + (corner >> (3 - i) & 1);
        LINE * (0..4).fold(0, |index, i| index * axes[i].len() + node(i))
    })
}

/// Histograms of a number of wheels, by mode, and the steps' times of warm, cold, ahead and records alone.
struct Measured {
    histograms: [(&'static str, Histogram<u64>); 5],
    paired: Vec<[f64; 4]>,
}

fn measure(
    table: &ContactTable<'_>,
    records: &[u8],
    flushed: &[u8],
    count: usize,
    poses: &mut impl Iterator<Item = Pose>,
) -> Result<Measured, Box<dyn Error>> {
    let names = ["warm", "cold", "polluted", "cold, asked for ahead", "cold records alone"];
    let mut histograms: Vec<Histogram<u64>> = names.iter().map(|_| Histogram::new(3)).collect::<Result<_, _>>()?;
    let mut contacts = vec![Contacts::NONE; count];
    let mut fresh = || -> Vec<(Side, Pose)> { poses.by_ref().take(count).map(|pose| (Side::Right, pose)).collect() };
    let mut warm = fresh();
    let mut paired = Vec::new();
    for _ in 0..STEPS {
        if !flushed.is_empty() {
            warm = fresh();
        }
        // The same wheels where their records are flushed.
        let [cold, ahead, read] = [(); 3].map(|()| if flushed.is_empty() { fresh() } else { warm.clone() });
        let read: Vec<usize> = read.iter().flat_map(|(_, pose)| corners(table, pose)).collect();
        looked_up(table, &warm, &mut contacts);
        let of_warm = nanoseconds(|| looked_up(table, black_box(&warm), black_box(&mut contacts)));
        flush(flushed);
        let of_cold = nanoseconds(|| looked_up(table, black_box(&cold), black_box(&mut contacts)));
        flush(flushed);
        let other = fresh();
        if count == 1 {
            table.prefetch(ahead[0].0, &ahead[0].1);
            // The caller's other work.
            (0..200).for_each(|_| looked_up(table, black_box(&other), black_box(&mut contacts)));
        }
        let of_ahead = nanoseconds(|| match count {
            1 => looked_up(table, black_box(&ahead), black_box(&mut contacts)),
            _ => table.contacts_many(black_box(&ahead), black_box(&mut contacts)),
        });
        flush(flushed);
        let of_records = nanoseconds(|| {
            black_box(black_box(&read).iter().fold(0, |sum: u8, line| sum ^ records[*line]));
        });
        for (histogram, time) in [(0, of_warm), (1, of_cold), (3, of_ahead), (4, of_records)] {
            histograms[histogram].record(time)?;
        }
        paired.push([of_warm, of_cold, of_ahead, of_records].map(|time| time as f64));
    }
    let mut buffer = vec![0_u8; BUFFER];
    for _ in 0..POLLUTED_STEPS {
        buffer.iter_mut().step_by(64).for_each(|byte| *byte = byte.wrapping_add(1));
        black_box(&mut buffer);
        histograms[2].record(nanoseconds(|| looked_up(table, black_box(&warm), black_box(&mut contacts))))?;
    }
    let mut histograms = histograms.into_iter();
    let histograms = names.map(|name| (name, histograms.next().expect("five")));
    Ok(Measured { histograms, paired })
}

/// Shares of steps by time, on a logarithmic axis.
fn draw(path: &str, measured: &[(String, Measured)]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, (900, 1280)).into_drawing_area();
    area.fill(&WHITE)?;
    for ((caption, measured), part) in measured.iter().zip(area.split_evenly((measured.len(), 1))) {
        let mut chart = ChartBuilder::on(&part)
            .caption(caption, ("sans-serif", 18))
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
    let mut all = Vec::new();
    let mut json = serde_json::Map::new();
    for (name, key, roll_offsets) in [("records flushed", "flushed", 5), ("64 MiB, no pose twice", "unseen", 257)] {
        let (table, records) = made_up(roll_offsets);
        let flushed = if key == "flushed" { records } else { &[] };
        let mut poses = random_poses(&table, 4 * (STEPS + 1) * (WHEELS + 1), 5).into_iter();
        for count in [1, WHEELS] {
            let measured = measure(&table, records, flushed, count, &mut poses)?;
            let caption = format!("{count} wheel{}, {name}", if count == 1 { "" } else { "s" });
            println!("{caption}: p50, p99, p99.9, largest, ns");
            for (mode, histogram) in &measured.histograms {
                let [p50, p99, p999, max] = [0.5, 0.99, 0.999, 1.0].map(|q| histogram.value_at_quantile(q));
                println!("  {mode:22} {p50:7} {p99:7} {p999:7} {max:8}");
                let quantiles = serde_json::json!({ "p50": p50, "p99": p99, "p999": p999, "max": max });
                json.insert(format!("{mode} {count} {key}"), quantiles);
            }
            for (mode, way) in [("cold", 1), ("ahead", 2), ("records", 3)] {
                let ratios = measured.paired.iter().map(|round| round[way] / round[0]);
                let [low, median, high] = quartiles(ratios.collect());
                println!("  {mode} over warm, paired: {median:.2} ({low:.2} to {high:.2})");
                json.insert(format!("ratio_{key}_{mode}_{count}"), median.into());
            }
            all.push((caption, measured));
        }
    }
    if let Some(path) = common::option("--svg") {
        draw(&path, &all)?;
    }
    if let Some(path) = common::option("--json") {
        std::fs::write(path, serde_json::to_string_pretty(&json)?)?;
    }
    Ok(())
}
