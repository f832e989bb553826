//! What a campaign's report says of each table.

use flangeway::{AxisName, ContactTable, Coordinates, ErrorFigures, Side};
use rayon::prelude::*;

use super::conicity::{AMPLITUDE, RadiusDifference};
use super::manifest::Entry;
use super::store::{Folder, State};
use crate::pair::Pair;
use crate::progress;
use crate::verify::CARRYING;

/// Cells of the map of contacts over lateral displacement and yaw.
pub const CELLS: [usize; 2] = [40, 12];
/// Load (N) of a wheel at which contacts are counted.
pub const LOAD: f64 = 60e3;

/// A table of a campaign, looked at.
#[derive(Debug, Clone)]
pub struct Summary {
    /// Whether the table is there; of the following nothing is known without it.
    pub state: State,
    /// Its bytes.
    pub bytes: usize,
    /// Its errors against the direct solver, as its compiler has measured them.
    pub errors: Option<ErrorFigures>,
    /// tan γ_e at an amplitude of 3 mm; none where there is no such motion.
    pub conicity: Option<f64>,
    /// Number of contacts of the right wheel that carry more than 2 % of [`LOAD`], `[lateral][yaw]` in [`CELLS`] cells
    /// over the table's ranges, at the roll of the rigid contact; 0 where the load is beyond the table.
    pub contacts: Vec<u8>,
    /// Ends of the map: lateral displacement (m), yaw (rad).
    pub ends: [[f64; 2]; 2],
}

/// Looks at every table of these entries.
pub fn summaries(folder: &Folder, entries: &[&Entry]) -> Vec<Summary> {
    let bar = progress::bar(entries.len() as u64, "looking up");
    let one = |entry: &&Entry| {
        let summary = Summary::of(folder, entry);
        bar.inc(1);
        summary
    };
    entries.par_iter().map(one).collect()
}

impl Summary {
    fn of(folder: &Folder, entry: &Entry) -> Self {
        let nothing = |state: State| Self {
            state,
            bytes: 0,
            errors: None,
            conicity: None,
            contacts: Vec::new(),
            ends: [[0.0; 2]; 2],
        };
        let state = folder.state(entry);
        if state != State::Whole {
            return nothing(state);
        }
        let damaged = |e: String| nothing(State::Damaged(e));
        let image = match std::fs::read(folder.table(&entry.id)) {
            Ok(image) => image,
            Err(e) => return damaged(e.to_string()),
        };
        let table = match ContactTable::new(&image) {
            Ok(table) => table,
            Err(e) => return damaged(e.to_string()),
        };
        let pair = folder.recipe(entry).and_then(|recipe| Pair::build(&recipe));
        let ends = [AxisName::Lateral, AxisName::Yaw].map(|name| <[f64; 2]>::from(table.axis(name).range()));
        Self {
            state,
            bytes: image.len(),
            errors: Some(table.header().errors),
            conicity: pair.ok().and_then(|pair| RadiusDifference::of(&pair).conicity(AMPLITUDE)),
            contacts: contacts(&table, ends),
            ends,
        }
    }
}

/// The map of contacts, in the middles of its cells.
fn contacts(table: &ContactTable<'_>, [lateral, yaw]: [[f64; 2]; 2]) -> Vec<u8> {
    let middle = |[from, to]: [f64; 2], i: usize, count: usize| from + (to - from) * (i as f64 + 0.5) / count as f64;
    let cell = |n: usize| (middle(lateral, n / CELLS[1], CELLS[0]), middle(yaw, n % CELLS[1], CELLS[1]));
    (0..CELLS[0] * CELLS[1]).map(cell).map(|(lateral, yaw)| carrying(table, lateral, yaw)).collect()
}

/// Contacts that carry at the height at which the table carries the load.
fn carrying(table: &ContactTable<'_>, lateral: f64, yaw: f64) -> u8 {
    let geometry = table.header().side(Side::Right).geometry;
    let maps = table.rigid(Side::Right);
    let at = |vertical: f64| {
        let pose = maps.pose(&geometry, &Coordinates { lateral, yaw, roll_offset: 0.0, vertical });
        table.contacts(Side::Right, &pose)
    };
    let force = |vertical: f64| f64::from(at(vertical).total_normal_force());
    let (mut low, mut high) = (0.0, 4.0 * table.axis(AxisName::Vertical).range().1.max(1e-5));
    if force(high) < LOAD {
        return 0;
    }
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if force(middle) < LOAD { low = middle } else { high = middle }
    }
    let found = at(high);
    let least = CARRYING * f64::from(found.total_normal_force());
    found.iter().filter(|contact| f64::from(contact.normal_force) > least).count() as u8
}
