//! Compiles tables on this machine, several at a time, each by one thread.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::manifest::Entry;
use super::records::{self, Finish, Log, Record};
use super::store::{Folder, State};
use crate::compile::{Checkpoint, compile_from};
use crate::error::{Error, Result};
use crate::image::write_atomically;
use crate::pair::Pair;
use crate::{profile_noise, progress};

/// What a run has done.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ran {
    /// Tables that were there and whole.
    pub there: usize,
    /// Tables compiled.
    pub compiled: usize,
    /// Labels of those that cannot be compiled, with the reason.
    pub failed: Vec<(String, String)>,
}

/// Compiles those of the tables that are missing or damaged, `jobs` at a time, the costliest first.
///
/// # Errors
/// When something cannot be written: the disk is full, or the folder not ours. What is written is whole.
pub fn run(folder: &Folder, entries: &[&Entry], jobs: usize) -> Result<Ran> {
    let mut wanted: Vec<&Entry> = entries.iter().copied().filter(|e| folder.state(e) != State::Whole).collect();
    wanted.sort_by(|a, b| b.cost.total_cmp(&a.cost).then_with(|| a.id.cmp(&b.id)));
    let shared = Shared {
        folder,
        wanted: &wanted,
        jobs: jobs.clamp(1, wanted.len().max(1)),
        next: AtomicUsize::new(0),
        log: Log::new(folder),
        ran: Mutex::new(Ran { there: entries.len() - wanted.len(), ..Ran::default() }),
        bar: progress::bar(wanted.len() as u64, "tables"),
    };
    progress::silence_parts();
    let finished: Result<Vec<()>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..shared.jobs).map(|_| scope.spawn(|| shared.work())).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    });
    shared.bar.finish_and_clear();
    finished?;
    Ok(shared.ran.into_inner().unwrap_or_else(|e| e.into_inner()))
}

/// What the workers share.
struct Shared<'a> {
    folder: &'a Folder,
    wanted: &'a [&'a Entry],
    jobs: usize,
    next: AtomicUsize,
    log: Log,
    ran: Mutex<Ran>,
    bar: indicatif::ProgressBar,
}

impl Shared<'_> {
    /// Takes one table after the other, until there are none or something cannot be written.
    fn work(&self) -> Result<()> {
        let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let thread = thread.map_err(|e| Error::field("", "--jobs", e.to_string()))?;
        while let Some(entry) = self.wanted.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let done = thread.install(|| self.one(entry));
            if done.is_err() {
                // The others would fail for the same reason.
                self.next.store(self.wanted.len(), Ordering::Relaxed);
            }
            done?;
        }
        Ok(())
    }

    fn one(&self, entry: &Entry) -> Result<()> {
        // Another process may have been quicker.
        if self.folder.state(entry) == State::Whole {
            self.ran().there += 1;
            self.bar.inc(1);
            return Ok(());
        }
        let (start, cpu) = (Instant::now(), records::cpu_seconds());
        let (recipe, table) = (self.folder.recipe(entry)?, self.folder.table(&entry.id));
        let (mut warnings, mut checkpoint) = (Vec::new(), Checkpoint::none());
        let compiled = Pair::build(&recipe).and_then(|pair| {
            warnings = profile_noise::warnings(&recipe, &pair)?;
            checkpoint = Checkpoint::of_table(&table, &recipe, &pair, None, None)?;
            compile_from(&recipe, &pair, None, &mut checkpoint)
        });
        let (finish, said) = match &compiled {
            Ok(compiled) => {
                write_atomically(&table, &compiled.image)?;
                checkpoint.finish()?;
                (Finish::Done, format!("p95 {:.2} %", 1e2 * compiled.errors.force_p95))
            }
            // Not the pair's fault: the disk is full.
            Err(e) if checkpoint.path() == Some(&e.path) => return Err(e.clone()),
            Err(e) => (Finish::Failed(e.to_string()), format!("failed: {e}")),
        };
        let seconds = start.elapsed().as_secs_f64();
        self.log.append(&Record {
            id: entry.id.clone(),
            finish,
            warnings,
            seconds,
            cpu_seconds: records::cpu_seconds().zip(cpu).map(|(now, then)| now - then),
            peak_bytes: records::peak_bytes(),
            jobs: self.jobs,
            host: records::host(),
            task: records::task(),
        })?;
        self.bar.suspend(|| eprintln!("{} {}: {seconds:.1} s, {said}", entry.id, entry.label));
        self.bar.inc(1);
        match compiled {
            Ok(_) => self.ran().compiled += 1,
            Err(e) => self.ran().failed.push((entry.label.clone(), e.to_string())),
        }
        Ok(())
    }

    fn ran(&self) -> std::sync::MutexGuard<'_, Ran> {
        self.ran.lock().unwrap_or_else(|e| e.into_inner())
    }
}
