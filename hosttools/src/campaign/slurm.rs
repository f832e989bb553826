//! Campaigns on a Slurm cluster: a job array whose tasks cost about the same.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

use super::manifest::Entry;
use super::store::Folder;
use crate::contact::Normal;
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::recipe::{self, NodeValues, Nodes, Recipe};

/// `[slurm]` of a campaign file. What is not given is left to the cluster.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Job name.
    pub name: String,
    /// Partition.
    pub partition: Option<String>,
    /// Account.
    pub account: Option<String>,
    /// Time limit of a task, as Slurm writes it.
    pub time: String,
    /// Memory of a task, as Slurm writes it.
    pub memory: String,
    /// Cores of a task: so many tables at once.
    pub cpus: usize,
    /// Number of tasks, instead of as many as `task_minutes` makes.
    pub tasks: Option<usize>,
    /// Expected length of a task: long enough that starting it costs nothing, short enough that little is lost with it.
    pub task_minutes: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            name: "flangeway".into(),
            partition: None,
            account: None,
            time: "02:00:00".into(),
            memory: "1G".into(),
            cpus: 1,
            tasks: None,
            task_minutes: 10.0,
        }
    }
}

/// The job script as it comes; a campaign's own copy may be edited.
const TEMPLATE: &str = include_str!("slurm_job.sh");
/// Longest array where the cluster does not tell: Slurm's own default.
const MAX_ARRAY_SIZE: usize = 1001;

/// Expected seconds of one core for a table, by its bytes and its solver; roughly those of tables of 43 KB to 1 MiB
/// (CAMPAIGNS.md). Only the proportions matter to the balance of tasks.
pub(super) fn cost(recipe: &Recipe) -> f64 {
    let grid = &recipe.grid;
    let axes = [grid.lateral_m, grid.yaw_rad, grid.vertical_m, grid.roll_rad];
    let sides = if recipe.wheel.left.is_some() || recipe.rail.left.is_some() { 2.0 } else { 1.0 };
    let count = |axis: &recipe::Axis| match axis.nodes {
        Nodes::Count(n) => n as f64,
        Nodes::Auto => 3.0,
    };
    let counted = sides * flangeway::layout::RECORD as f64 * axes.iter().map(count).product::<f64>();
    let searched = axes.iter().any(|axis| axis.nodes == Nodes::Auto);
    let bytes = if searched { counted.max(grid.max_bytes as f64) } else { counted };
    // Measuring the errors; the search for axes; node values.
    let search = if searched { 6.0 + 4e-6 * bytes } else { 0.0 };
    let values = match grid.node_values {
        NodeValues::Fitted => 16e-6,
        NodeValues::Sampled => 1e-6,
    };
    let measuring = 3.0 * grid.error_poses.unwrap_or(4000) as f64 / 4000.0;
    let hertz = measuring + search + values * bytes;
    match recipe.solver.normal {
        Normal::Hertz => hertz,
        Normal::SemiHertzian => STRIPS * hertz,
        // Prepared with strips, then every node is solved.
        Normal::HalfSpace => PREPARED * hertz + HALF_SPACE * bytes,
    }
}

/// What semi-Hertzian tables, and the preparation of half-space ones, cost over Hertzian ones, as measured.
const STRIPS: f64 = 4.0;
const PREPARED: f64 = 2.6;
/// Seconds a byte for the half-space at the nodes.
const HALF_SPACE: f64 = 4e-5;

/// Parts of equal cost: the costliest table first, each to the part that has the least so far.
pub fn balance(costs: &[f64], parts: usize) -> Vec<Vec<usize>> {
    let parts = parts.clamp(1, costs.len().max(1));
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]).then(a.cmp(&b)));
    let mut filled = vec![(0.0_f64, Vec::new()); parts];
    for index in order {
        let least = (0..parts).min_by(|&a, &b| filled[a].0.total_cmp(&filled[b].0)).unwrap_or(0);
        filled[least].0 += costs[index];
        filled[least].1.push(index);
    }
    filled.into_iter().map(|(_, part)| part).collect()
}

/// What was made for a submission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// The job script.
    pub script: PathBuf,
    /// `sbatch` with its arguments, one call an array.
    pub calls: Vec<Vec<String>>,
    /// Number of tasks.
    pub tasks: usize,
}

/// Writes the job script and the list of tasks for these tables.
///
/// # Errors
/// When they cannot be written.
pub fn prepare(folder: &Folder, settings: &Settings, entries: &[&Entry]) -> Result<Submission> {
    let costs: Vec<f64> = entries.iter().map(|entry| entry.cost).collect();
    let needed = (costs.iter().sum::<f64>() / (60.0 * settings.task_minutes).max(1.0)).ceil() as usize;
    let parts = balance(&costs, settings.tasks.unwrap_or(needed));
    let home = folder.slurm();
    let number = (1..).find(|n| !home.join(format!("job-{n}.sh")).exists()).unwrap_or(1);
    let list = home.join(format!("tasks-{number}.jsonl"));
    let ids = |part: &Vec<usize>| part.iter().map(|&i| entries[i].id.as_str()).collect::<Vec<_>>();
    let mut text = String::new();
    for part in &parts {
        text += &serde_json::to_string(&ids(part)).map_err(|e| Error::file(&list, e.to_string()))?;
        text.push('\n');
    }
    write_atomically(&list, text.as_bytes())?;
    let template = home.join("template.sh");
    if !template.exists() {
        write_atomically(&template, TEMPLATE.as_bytes())?;
    }
    let template = std::fs::read_to_string(&template).map_err(|e| Error::file(&template, e.to_string()))?;
    let script = home.join(format!("job-{number}.sh"));
    write_atomically(&script, filled(&template, folder, settings, &list)?.as_bytes())?;
    let most = longest_array();
    let call = |first: usize| {
        let last = (parts.len() - first).min(most) - 1;
        let array = format!("--array=0-{last}");
        ["sbatch".into(), "--parsable".into(), array, script.display().to_string(), first.to_string()].into()
    };
    let calls = (0..parts.len()).step_by(most).map(call).collect();
    Ok(Submission { script, calls, tasks: parts.len() })
}

/// Submits the arrays; answers their job numbers.
///
/// # Errors
/// When `sbatch` is not there or refuses.
pub fn submit(submission: &Submission) -> Result<Vec<String>> {
    let mut jobs = Vec::new();
    for call in &submission.calls {
        let output = Command::new(&call[0]).args(&call[1..]).output();
        let output = output.map_err(|e| Error::field("", "sbatch", format!("cannot be started: {e}")))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).trim().replace('\n', " ");
            return Err(Error::file(&submission.script, format!("sbatch refuses: {said}")));
        }
        jobs.push(String::from_utf8_lossy(&output.stdout).trim().to_owned());
    }
    Ok(jobs)
}

/// Identifiers of one task's tables.
///
/// # Errors
/// When the list has no such task.
pub fn task(list: &Path, number: usize) -> Result<Vec<String>> {
    let text = std::fs::read_to_string(list).map_err(|e| Error::file(list, e.to_string()))?;
    let Some(line) = text.lines().nth(number) else {
        return Err(Error::file(list, format!("has {} tasks, not one of number {number}", text.lines().count())));
    };
    serde_json::from_str(line).map_err(|e| Error::line(list, number + 1, e.to_string()))
}

/// Most tasks in an array of this cluster.
fn longest_array() -> usize {
    let said = Command::new("scontrol").args(["show", "config"]).output().ok();
    let said = said.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let line = said.lines().find_map(|line| line.trim().strip_prefix("MaxArraySize"));
    // The largest index is one less than the size.
    line.and_then(|line| line.trim_start_matches([' ', '=']).trim().parse().ok()).unwrap_or(MAX_ARRAY_SIZE).max(1)
}

/// The script of a template.
fn filled(template: &str, folder: &Folder, settings: &Settings, list: &Path) -> Result<String> {
    let absolute = |path: &Path| {
        let path = std::path::absolute(path).map_err(|e| Error::file(path, e.to_string()))?;
        Ok::<_, Error>(path.display().to_string())
    };
    let program = std::env::current_exe().map_err(|e| Error::field("", "program", e.to_string()))?;
    let options = [("partition", &settings.partition), ("account", &settings.account)];
    let options: Vec<String> =
        options.iter().filter_map(|(key, value)| Some(format!("#SBATCH --{key}={}", value.as_ref()?))).collect();
    let values = [
        ("name", settings.name.clone()),
        ("options", if options.is_empty() { "#".into() } else { options.join("\n") }),
        ("cpus", settings.cpus.max(1).to_string()),
        ("memory", settings.memory.clone()),
        ("time", settings.time.clone()),
        ("logs", absolute(&folder.slurm())?.replace(' ', "\\ ")),
        ("program", quoted(&absolute(&program)?)),
        ("folder", quoted(&absolute(folder.path())?)),
        ("list", quoted(&absolute(list)?)),
    ];
    Ok(values.iter().fold(template.to_owned(), |text, (key, value)| text.replace(&format!("{{{{{key}}}}}"), value)))
}

/// A word for the shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_cost_about_the_same() {
        let costs: Vec<f64> = (0..200).map(|i| 1.0 + f64::from(i * 37 % 100)).collect();
        let parts = balance(&costs, 7);
        let sums: Vec<f64> = parts.iter().map(|part| part.iter().map(|&i| costs[i]).sum()).collect();
        let mean = costs.iter().sum::<f64>() / 7.0;
        assert!(sums.iter().all(|sum| (sum / mean - 1.0).abs() < 0.01), "{sums:?}");
        let mut all: Vec<usize> = parts.concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..200));
        assert_eq!(balance(&[1.0; 3], 10).len(), 3);
    }

    /// As measured at these sizes (CAMPAIGNS.md), within a fifth.
    #[test]
    fn the_dearer_solver_is_expected_to_cost_more() {
        let expected = |normal: &str, bytes: &str| {
            let text =
                flangeway_tables::S1002_60E1_40.replace("max_bytes = 1_048_576", &format!("max_bytes = {bytes}"));
            let text = format!("{text}\n[solver]\nnormal = \"{normal}\"\n");
            assert!(text.contains(bytes));
            cost(&Recipe::parse(&text, Path::new("recipe.toml")).unwrap())
        };
        for (bytes, strips, half_space) in [("65_536", 4.2, 3.0), ("262_144", 3.6, 2.9), ("1_048_576", 4.2, 4.2)] {
            for (normal, measured) in [("semi-hertzian", strips), ("half-space", half_space)] {
                let over_hertz = expected(normal, bytes) / expected("hertz", bytes);
                assert!((over_hertz / measured - 1.0).abs() < 0.2, "{normal}, {bytes}: {over_hertz}, not {measured}");
            }
        }
    }

    #[test]
    fn a_quote_does_not_end_a_word() {
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }

    #[test]
    fn the_template_is_filled_to_the_last_word() {
        let settings = Settings { account: Some("rail".into()), ..Settings::default() };
        let script = filled(TEMPLATE, &Folder::new(Path::new("/a b")), &settings, Path::new("/a b/l")).unwrap();
        assert!(!script.contains("{{") && script.contains("#SBATCH --account=rail\n"), "{script}");
        assert!(script.contains("campaign task '/a b' --list '/a b/l' --task"), "{script}");
    }
}
