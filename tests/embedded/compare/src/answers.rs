//! The firmware's answers against the host's.

use flangeway::SLOTS;
use flangeway_pil::{ContactNumbers, WheelAnswer};

use crate::poses::{poses, tables};

/// Bytes of a contact: slot, twelve `f32`.
const CONTACT: usize = 1 + 12 * 4;
/// Bytes of an answer: instructions, flags, number of contacts, three contacts, those that are none zero.
const ANSWER: usize = 4 + 1 + 1 + SLOTS * CONTACT;
/// Bytes at the end: three numbers.
const END: usize = 3 * 4;

/// What came of a run.
pub(crate) struct Report {
    /// Poses looked up.
    pub(crate) poses: usize,
    /// Answers that are not the host's.
    pub(crate) mismatches: usize,
    /// Fewest instructions of a lookup.
    pub(crate) least: u32,
    /// Most instructions of a lookup.
    pub(crate) most: u32,
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
            least: u32::MAX,
            most: 0,
            thousand,
            stack,
            check_stack,
            contacts: [0; SLOTS + 1],
        };
        for (case, bytes) in cases.iter().zip(answers.as_chunks::<ANSWER>().0) {
            let here = WheelAnswer::from(&tables[case.table].contacts(case.side, &case.pose));
            let (instructions, there) = read(bytes);
            report.contacts[here.contacts.len()] += 1;
            report.least = report.least.min(instructions);
            report.most = report.most.max(instructions);
            if !there.is_some_and(|there| there.same_bits(&here)) {
                report.mismatches += 1;
                if report.mismatches == 1 {
                    eprintln!("compare: {case:?}: {here:?} here, other bits there");
                }
            }
        }
        Ok(report)
    }
}

/// Instructions and contacts; no contacts if there cannot be as many.
fn read(bytes: &[u8; ANSWER]) -> (u32, Option<WheelAnswer>) {
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
