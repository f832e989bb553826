//! What processes write down of the tables they have compiled: one file for each process, so that nobody waits for a
//! lock, and one line for each table.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::store::Folder;
use crate::error::{Error, Result};

/// How the compilation of a table ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Finish {
    /// The table is there.
    Done,
    /// It cannot be compiled, with the reason.
    Failed(String),
}

/// One compilation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The table.
    pub id: String,
    /// How it ended.
    pub finish: Finish,
    /// What its profiles are warned of.
    pub warnings: Vec<String>,
    /// Time it took (s).
    pub seconds: f64,
    /// Processor time of it (s), where the system tells.
    pub cpu_seconds: Option<f64>,
    /// Largest resident memory (bytes) of the process so far, where the system tells; of all its jobs together.
    pub peak_bytes: Option<u64>,
    /// Tables that the process compiled at once.
    pub jobs: usize,
    /// The machine.
    pub host: String,
    /// The Slurm task, as `job_task`.
    pub task: Option<String>,
}

impl Record {
    /// Why the table cannot be compiled.
    pub fn reason(&self) -> Option<&str> {
        match &self.finish {
            Finish::Done => None,
            Finish::Failed(reason) => Some(reason),
        }
    }
}

/// The file of this process.
#[derive(Debug)]
pub(super) struct Log(PathBuf);

impl Log {
    pub(super) fn new(folder: &Folder) -> Self {
        Self(folder.records().join(format!("{}-{}.jsonl", host(), std::process::id())))
    }

    /// Appends a record, in one write.
    pub(super) fn append(&self, record: &Record) -> Result<()> {
        let mut line = serde_json::to_string(record).map_err(|e| Error::file(&self.0, e.to_string()))?;
        line.push('\n');
        let file = std::fs::OpenOptions::new().create(true).append(true).open(&self.0);
        file.and_then(|mut file| file.write_all(line.as_bytes())).map_err(|e| Error::file(&self.0, e.to_string()))
    }
}

/// The latest record of each table by its file's time; lines that a killed process has not finished are left out.
///
/// # Errors
/// When the folder cannot be read.
pub fn read(folder: &Folder) -> Result<BTreeMap<String, Record>> {
    let path = folder.records();
    let failed = |e: std::io::Error| Error::file(&path, e.to_string());
    let mut files: Vec<_> = std::fs::read_dir(&path).map_err(failed)?.flatten().collect();
    files.sort_by_key(|file| (file.metadata().and_then(|m| m.modified()).ok(), file.file_name()));
    let mut records = BTreeMap::new();
    for file in files {
        let text = std::fs::read_to_string(file.path()).unwrap_or_default();
        let lines = text.lines().filter_map(|line| serde_json::from_str::<Record>(line).ok());
        records.extend(lines.map(|record| (record.id.clone(), record)));
    }
    Ok(records)
}

/// The name of this machine, of the Slurm node inside a job.
pub(super) fn host() -> String {
    let named = std::env::var("SLURMD_NODENAME").ok();
    let kernel = || std::fs::read_to_string(Path::new("/proc/sys/kernel/hostname")).ok();
    named.or_else(kernel).or_else(|| std::env::var("COMPUTERNAME").ok()).unwrap_or_default().trim().replace('/', "_")
}

/// The Slurm task that this process runs in.
pub(super) fn task() -> Option<String> {
    let of = |name: &str| std::env::var(name).ok();
    Some(format!("{}_{}", of("SLURM_ARRAY_JOB_ID")?, of("SLURM_ARRAY_TASK_ID")?))
}

/// Processor time (s) of this thread so far; none where the system does not tell.
#[must_use]
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(target_os = "linux")]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(target_os = "linux"))]
    None
}

/// Largest resident memory (bytes) of this process so far.
pub(super) fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok()?)
}
