//! `flangeway verify`: a table against the direct solver over random poses.

use std::path::{Path, PathBuf};

use flangeway::{ContactTable, Side};

use super::quickstart::make;
use super::{Outcome, print_json, read_table, view_table};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::naive::{self, Beside, Factor, Naive};
use crate::pair::Pair;
use crate::recipe::Recipe;
use crate::report::verify::{Content, html};
use crate::verify::{Findings, Report, Sample, findings, measure};

/// Arguments of `flangeway verify`.
#[derive(Debug, Clone, clap::Args)]
pub struct VerifyArgs {
    /// Table
    #[arg(value_name = "T.fwt")]
    pub table: PathBuf,
    /// The recipe it was compiled from
    #[arg(long)]
    pub recipe: PathBuf,
    /// Random poses
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub samples: u32,
    /// Random lines for the continuity figure
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub lines: u32,
    /// Seed of the random poses and lines
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Fail (exit status 1) when the 95 % quantile of the relative force error is above this
    #[arg(long, value_name = "SHARE")]
    pub limit_p95: Option<f64>,
    /// Write every sample with both forces as CSV
    #[arg(short, long, value_name = "SAMPLES.csv")]
    pub output: Option<PathBuf>,
    /// Write verify.html (pictures, worst poses, largest changes) and verify.json to a folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Compare with naive tables (the paper's coordinates and storage) of the same bytes on the same poses
    #[arg(long)]
    pub naive: bool,
    /// Print the figures as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// What `--json` and `--report` write.
#[derive(serde::Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: Report,
    #[serde(flatten)]
    findings: Option<&'a Findings>,
    #[serde(skip_serializing_if = "Option::is_none")]
    naive: Option<Naive>,
    #[serde(skip_serializing_if = "Option::is_none")]
    factor: Option<Factor>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    naive_on_fewer_poses: &'a [Beside],
}

/// Measures the table and prints the figures.
///
/// # Errors
/// On a bad table or recipe, or when the table is of other profiles than the recipe's.
pub fn run(args: &VerifyArgs) -> Result<Outcome> {
    let image = read_table(&args.table)?;
    let table = view_table(&args.table, &image)?;
    let recipe = Recipe::load(&args.recipe)?;
    let pair = Pair::build(&recipe)?;
    same_profiles(&args.table, &table, &pair)?;
    if let Some(folder) = &args.report {
        make(folder)?;
    }
    let measured = measure(&table, image.len(), &pair, args.samples as usize, args.lines as usize, args.seed);
    let report = measured.report;
    print(&report);
    let findings = args.report.as_ref().map(|_| findings(&table, &pair, &measured));
    let naive = if args.naive { naive::compare(&pair, &measured.samples, image.len()) } else { Vec::new() };
    let document = Document {
        report,
        findings: findings.as_ref(),
        naive: naive.first().map(|all| all.naive),
        factor: naive.first().map(|all| all.factor),
        naive_on_fewer_poses: naive.get(1..).unwrap_or_default(),
    };
    let json = serde_json::to_value(&document).map_err(|e| Error::file(&args.table, e.to_string()))?;
    if let (Some(folder), Some(findings)) = (&args.report, &findings) {
        let table_name = args.table.file_name().unwrap_or_default().to_string_lossy();
        let content = Content {
            pair: &pair,
            table: &table,
            table_name: &table_name,
            measured: &measured,
            findings,
            naive: &naive,
        };
        write_atomically(folder.join("verify.html"), html(&content)?.as_bytes())?;
        write_atomically(folder.join("verify.json"), format!("{json:#}\n").as_bytes())?;
        print_findings(findings);
        eprintln!("{}: pictures, worst poses, largest changes", folder.join("verify.html").display());
    }
    naive.iter().for_each(print_naive);
    if args.json {
        print_json(&json)?;
    }
    if let Some(output) = &args.output {
        write_samples(output, &measured.samples)?;
    }
    match args.limit_p95 {
        Some(limit) if report.normal_force.p95 > limit => {
            eprintln!("force error p95 {:.4} is above the limit {limit}", report.normal_force.p95);
            Ok(Outcome::CheckFailed)
        }
        _ => Ok(Outcome::Done),
    }
}

/// Refuses a table whose profiles, wheel geometry or number of sides are not the recipe's.
pub(super) fn same_profiles(path: &Path, table: &ContactTable<'_>, pair: &Pair) -> Result<()> {
    let header = table.header();
    let refuse = |what: &str| Err(Error::file(path, format!("the table is of another {what} than the recipe's")));
    if header.sides() != pair.sides() {
        return refuse("number of sides");
    }
    for side in Side::ALL.into_iter().take(pair.sides()) {
        let (found, source) = (header.side(side), pair.source(side));
        if found.wheel_sha256 != source.wheel.source_hash {
            return refuse("wheel profile");
        }
        if found.rail_sha256 != source.rail.source_hash {
            return refuse("rail profile");
        }
        if found.geometry != *pair.body(side).wheel().geometry() {
            return refuse("wheel radius or spacing");
        }
    }
    Ok(())
}

fn write_samples(path: &Path, samples: &[Sample]) -> Result<()> {
    let failed = |e: csv::Error| Error::file(path, e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let columns = [
        "lateral_m",
        "yaw_rad",
        "roll_offset_rad",
        "vertical_m",
        "y_m",
        "z_m",
        "roll_rad",
        "normal_force_direct_n",
        "normal_force_table_n",
        "tread_n",
        "flange_root_n",
        "flange_n",
        "error",
    ];
    writer.write_record(columns).map_err(failed)?;
    for s in samples {
        let [tread, root, flange] = s.slots.map(|slot| slot.normal_force());
        let values = [
            s.coordinates.lateral,
            s.coordinates.yaw,
            s.coordinates.roll_offset,
            s.coordinates.vertical,
            s.pose.lateral,
            s.pose.vertical,
            s.pose.roll,
            s.direct,
            s.table,
            tread,
            root,
            flange,
            s.force_error(),
        ];
        writer.write_record(values.map(|v| format!("{v:.9e}"))).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::file(path, e.to_string()))?;
    write_atomically(path, &bytes)
}

fn print(report: &Report) {
    eprintln!("{} samples, seed {}, table of {} bytes", report.samples, report.seed, report.table_bytes);
    eprintln!("{:>22} {:>10} {:>10} {:>10} {:>10} {:>10}", "", "rms", "median", "p95", "p99", "max");
    let rows = [
        ("normal force (%)", &report.normal_force, 1e2),
        ("position (mm)", &report.position_m, 1e3),
        ("contact angle (mrad)", &report.angle_rad, 1e3),
        ("semi-axes (%)", &report.semi_axes, 1e2),
    ];
    for (name, q, unit) in rows {
        let values = [q.rms, q.median, q.p95, q.p99, q.max].map(|v| format!("{:>10.4}", v * unit));
        eprintln!("{name:>22} {}", values.join(" "));
    }
    eprintln!("other number of contacts in {:.2} % of the poses", 1e2 * report.other_count);
    eprintln!(
        "largest change of force over 10 nm or 10 nrad: table {:.4} %, direct solver {:.4} %",
        1e2 * report.continuity,
        1e2 * report.continuity_direct
    );
}

fn print_findings(findings: &Findings) {
    eprintln!("force error (%) by what the cell of the table holds:");
    eprintln!("{:>34} {:>8} {:>10} {:>10} {:>10} {:>10}", "", "poses", "rms", "median", "p95", "p99");
    for row in &findings.classes {
        let q = &row.normal_force;
        let values = [q.rms, q.median, q.p95, q.p99].map(|v| format!("{:>10.4}", 1e2 * v));
        eprintln!("{:>34} {:>8} {}", row.class.words(), row.samples, values.join(" "));
    }
}

fn print_naive(Beside { poses, naive, factor, .. }: &Beside) {
    let (q, [y, yaw, z, roll]) = (&naive.normal_force, naive.design.nodes);
    let figures = [q.rms, q.median, q.p95, q.p99].map(|v| format!("{:.3}", 1e2 * v));
    let factors = [factor.rms, factor.median, factor.p95, factor.p99].map(|v| format!("{v:.1}"));
    eprintln!(
        "naive table, {} bytes, {y} x {yaw} x {z} x {roll} (y, yaw, z, roll), the best of {}; {poses}: \n    rms, median, \
         p95, p99 {} %; worse than this table by a factor of {}",
        naive.bytes,
        naive.trials,
        figures.join(", "),
        factors.join(", ")
    );
}
