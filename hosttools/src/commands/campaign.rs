//! `flangeway campaign`: tables for every combination of wheels, rails and settings.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::{Outcome, print_json};
use crate::campaign::{Entry, Folder, Manifest, Record, State, plan, read_records, run as compile, slurm, summaries};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::report::campaign::html;

/// Arguments of `flangeway campaign`.
#[derive(Debug, Clone, clap::Args)]
pub struct CampaignArgs {
    #[command(subcommand)]
    step: Step,
}

#[derive(Debug, Clone, clap::Subcommand)]
enum Step {
    /// Expand a campaign file into a folder: its manifest and profiles
    Plan(Planning),
    /// Plan, then compile on this machine what is missing or damaged
    Run {
        #[command(flatten)]
        planning: Planning,
        #[command(flatten)]
        jobs: Jobs,
    },
    /// Plan, then submit what is missing or damaged to Slurm
    Slurm {
        #[command(flatten)]
        planning: Planning,
        /// Write the job script and the list of tasks, submit nothing
        #[arg(long)]
        dry_run: bool,
    },
    /// Compile what is missing or damaged
    Resume {
        /// Folder of the campaign
        folder: PathBuf,
        /// Submit to Slurm instead of compiling on this machine
        #[arg(long)]
        slurm: bool,
        #[command(flatten)]
        jobs: Jobs,
    },
    /// Say what is there, damaged, missing, failed and broken
    Status {
        /// Folder of the campaign
        folder: PathBuf,
        /// Print counts, times and reasons as JSON to stdout
        #[arg(long)]
        json: bool,
    },
    /// Write report.html: the grid of pairs with accuracy, contacts and equivalent conicity
    Report {
        /// Folder of the campaign
        folder: PathBuf,
    },
    /// Compile some tables, as a task of a job does
    Task {
        /// Folder of the campaign
        folder: PathBuf,
        /// Identifiers of tables
        ids: Vec<String>,
        /// List of tasks
        #[arg(long, value_name = "TASKS.jsonl", requires = "task")]
        list: Option<PathBuf>,
        /// Number of the task in the list, from 0
        #[arg(long, value_name = "N", requires = "list")]
        task: Option<usize>,
        #[command(flatten)]
        jobs: Jobs,
    },
}

#[derive(Debug, Clone, clap::Args)]
struct Planning {
    /// Campaign (TOML): a recipe in which values may be lists
    campaign: PathBuf,
    /// Folder of the campaign
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(Debug, Clone, Copy, clap::Args)]
struct Jobs {
    /// Tables to compile at once; as many as there are cores by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
}

impl Jobs {
    fn count(self) -> usize {
        self.jobs.map_or_else(rayon::current_num_threads, usize::from)
    }
}

/// Runs a step.
///
/// # Errors
/// On a bad campaign file or folder, or when something cannot be written. A broken profile is no error: its tables are
/// listed, the others compiled, and the outcome is that not all holds.
pub fn run(args: &CampaignArgs) -> Result<Outcome> {
    match &args.step {
        Step::Plan(planning) => {
            let (folder, manifest) = planned(planning)?;
            eprintln!("{}: {} tables", folder.manifest().display(), manifest.tables().count());
            Ok(list_broken(&manifest))
        }
        Step::Run { planning, jobs } => {
            let (folder, manifest) = planned(planning)?;
            local(&folder, &manifest, jobs.count())
        }
        Step::Slurm { planning, dry_run } => {
            let (folder, manifest) = planned(planning)?;
            submit(&folder, &manifest, *dry_run)
        }
        Step::Resume { folder, slurm, jobs } => {
            let (folder, manifest) = opened(folder)?;
            folder.sweep();
            if *slurm { submit(&folder, &manifest, false) } else { local(&folder, &manifest, jobs.count()) }
        }
        Step::Status { folder, json } => status(folder, *json),
        Step::Report { folder } => report(folder),
        Step::Task { folder, ids, list, task, jobs } => {
            let (folder, manifest) = opened(folder)?;
            let ids = match (list, task) {
                (Some(list), Some(task)) => slurm::task(list, *task)?,
                _ => ids.clone(),
            };
            let by_id: BTreeMap<&str, &Entry> = manifest.tables().map(|entry| (entry.id.as_str(), entry)).collect();
            let find = |id: &String| {
                let missing = || Error::file(folder.manifest(), format!("has no table {id}"));
                by_id.get(id.as_str()).copied().ok_or_else(missing)
            };
            let entries: Vec<&Entry> = ids.iter().map(find).collect::<Result<_>>()?;
            finish(compile(&folder, &entries, jobs.count())?)
        }
    }
}

fn planned(planning: &Planning) -> Result<(Folder, Manifest)> {
    let folder = Folder::new(&planning.output);
    let manifest = plan(&planning.campaign, &folder)?;
    Ok((folder, manifest))
}

fn opened(folder: &Path) -> Result<(Folder, Manifest)> {
    let folder = Folder::new(folder);
    let manifest = Manifest::read(&folder.manifest())?;
    folder.create()?;
    Ok((folder, manifest))
}

/// Lists the tables that cannot be planned.
fn list_broken(manifest: &Manifest) -> Outcome {
    for (label, reason) in manifest.broken() {
        eprintln!("broken: {label}: {reason}");
    }
    if manifest.broken().next().is_some() { Outcome::CheckFailed } else { Outcome::Done }
}

fn local(folder: &Folder, manifest: &Manifest, jobs: usize) -> Result<Outcome> {
    let entries: Vec<&Entry> = manifest.tables().collect();
    let ran = finish(compile(folder, &entries, jobs)?)?;
    Ok(if list_broken(manifest) == Outcome::Done { ran } else { Outcome::CheckFailed })
}

fn finish(ran: crate::campaign::Ran) -> Result<Outcome> {
    eprintln!("{} compiled, {} there already, {} failed", ran.compiled, ran.there, ran.failed.len());
    for (label, reason) in &ran.failed {
        eprintln!("failed: {label}: {reason}");
    }
    Ok(if ran.failed.is_empty() { Outcome::Done } else { Outcome::CheckFailed })
}

fn submit(folder: &Folder, manifest: &Manifest, dry_run: bool) -> Result<Outcome> {
    let wanted: Vec<&Entry> = manifest.tables().filter(|entry| folder.state(entry) != State::Whole).collect();
    if wanted.is_empty() {
        eprintln!("all {} tables are there", manifest.tables().count());
        return Ok(list_broken(manifest));
    }
    let submission = slurm::prepare(folder, &manifest.slurm, &wanted)?;
    eprintln!("{}: {} tables in {} tasks", submission.script.display(), wanted.len(), submission.tasks);
    if dry_run {
        submission.calls.iter().try_for_each(|call| super::print(&call.join(" ")))?;
    } else {
        slurm::submit(&submission)?.iter().try_for_each(|job| super::print(job))?;
    }
    Ok(list_broken(manifest))
}

fn status(folder: &Path, as_json: bool) -> Result<Outcome> {
    let (folder, manifest) = opened(folder)?;
    let records = read_records(&folder)?;
    let (mut whole, mut missing) = (0, 0);
    let (mut damaged, mut failed) = (Vec::new(), Vec::new());
    for entry in manifest.tables() {
        match (folder.state(entry), records.get(&entry.id).and_then(Record::reason)) {
            (State::Whole, _) => whole += 1,
            (State::Damaged(reason), _) => damaged.push((entry.label.clone(), reason)),
            (State::Missing, Some(reason)) => failed.push((entry.label.clone(), reason.to_owned())),
            (State::Missing, None) => missing += 1,
        }
    }
    let known: Vec<_> = manifest.tables().filter_map(|entry| records.get(&entry.id)).collect();
    let cpu = known.iter().map(|record| record.cpu_seconds.unwrap_or(record.seconds)).sum::<f64>();
    let mean = cpu / known.len().max(1) as f64;
    let peak = known.iter().filter_map(|record| record.peak_bytes).max();
    let broken: Vec<_> = manifest.broken().collect();
    eprintln!(
        "{whole} whole, {} damaged, {missing} missing, {} failed, {} broken",
        damaged.len(),
        failed.len(),
        broken.len()
    );
    if !known.is_empty() {
        eprintln!(
            "{mean:.2} s of one core a table, largest memory of a process {:.0} MB",
            1e-6 * peak.unwrap_or(0) as f64
        );
    }
    damaged.iter().for_each(|(label, reason)| eprintln!("damaged: {label}: {reason}"));
    failed.iter().for_each(|(label, reason)| eprintln!("failed: {label}: {reason}"));
    let planned = list_broken(&manifest);
    if as_json {
        print_json(&json!({
            "whole": whole,
            "missing": missing,
            "damaged": damaged,
            "failed": failed,
            "broken": broken,
            "cpu_seconds_a_table": mean,
            "peak_bytes": peak,
        }))?;
    }
    let all = damaged.is_empty() && failed.is_empty() && missing == 0 && planned == Outcome::Done;
    Ok(if all { Outcome::Done } else { Outcome::CheckFailed })
}

fn report(folder: &Path) -> Result<Outcome> {
    let (folder, manifest) = opened(folder)?;
    let entries: Vec<&Entry> = manifest.tables().collect();
    let found = summaries(&folder, &entries);
    let tables: Vec<_> = entries.into_iter().zip(&found).collect();
    let name = std::path::absolute(folder.path()).ok();
    let name = name.as_deref().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
    let path = folder.path().join("report.html");
    write_atomically(&path, html(&name, &manifest, &tables, &read_records(&folder)?).as_bytes())?;
    eprintln!("{}: {} pairs", path.display(), tables.len());
    Ok(Outcome::Done)
}
