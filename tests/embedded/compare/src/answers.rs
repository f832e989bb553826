//! The firmware's answers against the host's.

use flangeway::{ContactTable, SLOTS};
use flangeway_pil::{ContactNumbers, WheelAnswer};

use crate::creep::{LAWS, NUMBERS};
use crate::poses::{Case, poses, tables};

/// Bytes of a contact: slot, twelve `f32`.
const CONTACT: usize = 1 + 12 * 4;
/// Bytes of a lookup's answer: instructions, flags, number of contacts, three contacts, those that are none zero.
const LOOKUP: usize = 4 + 1 + 1 + SLOTS * CONTACT;
/// Bytes of a law's answer for a contact: instructions, numbers.
const LAW: usize = 4 + NUMBERS;
/// Bytes of an answer: the lookup's, then those of the laws for three contacts.
const ANSWER: usize = LOOKUP + SLOTS * LAWS.len() * LAW;
/// Bytes at the end: three numbers.
const END: usize = 3 * 4;

/// Fewest and most instructions of a call.
#[derive(Clone, Copy)]
pub(crate) struct Instructions {
    least: u32,
    most: u32,
}

impl Instructions {
    const NONE: Self = Self { least: u32::MAX, most: 0 };

    fn add(&mut self, instructions: u32) {
        *self = Self { least: self.least.min(instructions), most: self.most.max(instructions) };
    }

    /// Fields of a line of JSON.
    pub(crate) fn fields(self, prefix: &str) -> String {
        let Self { least, most } = self;
        format!("\"{prefix}instructions_min\": {least}, \"{prefix}instructions_max\": {most}")
    }
}

/// What came of a run.
pub(crate) struct Report {
    /// Poses looked up.
    pub(crate) poses: usize,
    /// Poses with an answer that is not the host's.
    pub(crate) mismatches: usize,
    /// Of a lookup.
    pub(crate) lookup: Instructions,
    /// Of a contact's creepages, forces and wrench, by law.
    pub(crate) laws: [Instructions; LAWS.len()],
    /// Instructions counted for a thousand that do nothing.
    pub(crate) thousand: u32,
    /// Stack of a lookup, bytes.
    pub(crate) stack: u32,
    /// Stack of the tables' check, bytes.
    pub(crate) check_stack: u32,
    /// Poses without, with one, two, three contacts.
    pub(crate) contacts: [usize; SLOTS + 1],
}

impl Report {
    /// Reads all answers.
    pub(crate) fn of(bytes: &[u8]) -> Result<Self, String> {
        let (tables, cases) = (tables(), poses());
        if bytes.len() != cases.len() * ANSWER + END {
            return Err(format!("{} bytes, not those of {} answers", bytes.len(), cases.len()));
        }
        let (answers, end) = bytes.split_at(cases.len() * ANSWER);
        let numbers: Vec<u32> = end.as_chunks().0.iter().copied().map(u32::from_le_bytes).collect();
        let [thousand, stack, check_stack] = numbers[..] else { unreachable!("three numbers") };
        let mut report = Self {
            poses: cases.len(),
            mismatches: 0,
            lookup: Instructions::NONE,
            laws: [Instructions::NONE; LAWS.len()],
            thousand,
            stack,
            check_stack,
            contacts: [0; SLOTS + 1],
        };
        for (case, bytes) in cases.iter().zip(answers.as_chunks::<ANSWER>().0) {
            if !report.add(case, &tables[case.table], bytes) {
                report.mismatches += 1;
                if report.mismatches == 1 {
                    eprintln!("compare: {case:?}: other bits there than here");
                }
            }
        }
        Ok(report)
    }

    /// Counts an answer; whether it is the host's.
    fn add(&mut self, case: &Case, table: &ContactTable<'_>, bytes: &[u8; ANSWER]) -> bool {
        let here = table.contacts(case.side, &case.pose);
        self.contacts[here.list.len()] += 1;
        let (lookup, laws) = bytes.split_first_chunk().expect("longer");
        let (instructions, there) = read(lookup);
        self.lookup.add(instructions);
        let mut same = there.is_some_and(|there| there.same_bits(&WheelAnswer::from(&here)));
        let header = table.header();
        let (geometry, elasticity) = (&header.side(case.side).geometry, (&header.material).into());
        let answers = laws.as_chunks::<LAW>().0.as_chunks::<{ LAWS.len() }>().0;
        for (contact, answers) in here.iter().zip(answers) {
            for ((law, bytes), counted) in LAWS.into_iter().zip(answers).zip(&mut self.laws) {
                let (instructions, numbers) = bytes.split_first_chunk().expect("longer");
                counted.add(u32::from_le_bytes(*instructions));
                same &= case.creep.numbers(geometry, &elasticity, contact, law) == numbers;
            }
        }
        same
    }
}

/// Instructions and contacts; no contacts if there cannot be as many.
fn read(bytes: &[u8; LOOKUP]) -> (u32, Option<WheelAnswer>) {
    let ([a, b, c, d, flags, count], contacts) = bytes.split_first_chunk().expect("longer");
    let contacts = contacts.as_chunks::<CONTACT>().0.get(..usize::from(*count));
    let contact = |bytes: &[u8; CONTACT]| {
        let (slot, numbers) = bytes.split_first().expect("longer");
        let numbers = numbers.as_chunks().0;
        ContactNumbers { slot: *slot, numbers: std::array::from_fn(|i| f32::from_le_bytes(numbers[i])) }
    };
    let answer = contacts.map(|all| WheelAnswer { flags: *flags, contacts: all.iter().map(contact).collect() });
    (u32::from_le_bytes([*a, *b, *c, *d]), answer)
}
