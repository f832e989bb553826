//! Campaigns: a table for every combination of wheels, rails, gauges and settings, on one machine or on a cluster.
//!
//! A campaign file is a recipe in which a value may be a list. It expands to a manifest with one line a table. Each
//! table has an identifier made from all that determines its bytes, and is stored under it:
//!
//! ```text
//! DIR/manifest.jsonl     what there is to compile, with recipes
//! DIR/profiles/SHA256    the profile files, so that DIR is all that a node needs
//! DIR/tables/ID.fwt      the tables
//! DIR/records/*.jsonl    a file for each process that compiled, a line for each table: seconds, memory, failures
//! DIR/slurm/             the job script's template, the tasks of each submission, their logs
//! ```
//!
//! **Nothing is lost.** A table is written under a temporary name, synchronised to disk and renamed, so a killed task
//! leaves no half table under a table's name; before anything is taken as done its CRC and its recipe's hash are
//! checked. Two tasks on the same table write the same bytes, and the second rename replaces the first's file by an
//! equal one: there is no lock to be left behind. A full disk ends the run; what was renamed before is whole.

pub mod conicity;
mod expand;
mod manifest;
mod records;
mod run;
pub mod slurm;
mod store;
mod summary;

pub use expand::{expand, plan};
pub use manifest::{Entry, Manifest, Planned};
pub use records::{Finish, Record, cpu_seconds, read as read_records};
pub use run::{Ran, run};
pub use store::{Folder, State};
pub use summary::{CELLS, LOAD, Summary, summaries};
