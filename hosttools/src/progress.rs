//! A progress bar on stderr for work over a second.

use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ParallelProgressIterator, ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;

/// A bar over `length` steps; it draws at most five times a second, and only on a terminal.
pub fn bar(length: u64, what: &'static str) -> ProgressBar {
    if SILENT.load(Ordering::Relaxed) {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(5));
    if let Ok(style) = ProgressStyle::with_template("{prefix:>13} [{wide_bar}] {percent:>3} %, {eta} left") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(what);
    bar
}

/// Whether work runs side by side, where the bars of its parts would write over each other.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Makes no more bars that draw; those that are there go on.
pub fn silence_parts() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Steps below which work is done before anybody would read a bar.
const WORTH_A_BAR: usize = 2000;

/// Maps over a slice on all threads, in order, with a bar where it is worth one.
pub fn parallel<T: Sync, U: Send>(
    items: &[T],
    what: &'static str,
    f: impl Fn(&T) -> U + Sync + Send,
) -> impl ParallelIterator<Item = U> {
    let bar = if items.len() < WORTH_A_BAR { ProgressBar::hidden() } else { bar(items.len() as u64, what) };
    items.par_iter().progress_with(bar).map(f)
}
