//! A line that damages frames on purpose, in both directions, the same way for the same seed and the same frames.

use std::collections::VecDeque;
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::port::{Came, Line};

/// Frames damaged on purpose, by what was done to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Damages {
    /// A byte changed.
    pub changed: u64,
    /// A byte left out.
    pub shortened: u64,
    /// The whole frame left out.
    pub lost: u64,
    /// The frame sent twice.
    pub repeated: u64,
}

impl Damages {
    /// All of them.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.changed + self.shortened + self.lost + self.repeated
    }
}

/// A line with damage.
pub struct Damaging<L> {
    line: L,
    share: f64,
    random: Pcg64,
    /// What came in and makes no whole frame yet.
    partial: Vec<u8>,
    /// What comes out for the host.
    ready: VecDeque<u8>,
    /// Damage on the way to the board.
    pub to_board: Damages,
    /// Damage on the way to the host.
    pub to_host: Damages,
}

impl<L: Line> Damaging<L> {
    /// A line on which this share of the frames is damaged, 0 for none.
    pub fn new(line: L, share: f64, seed: u64) -> Self {
        Self {
            line,
            share,
            random: Pcg64::seed_from_u64(seed),
            partial: Vec::new(),
            ready: VecDeque::new(),
            to_board: Damages::default(),
            to_host: Damages::default(),
        }
    }
}

/// A frame as it arrives.
fn pass(frame: &[u8], share: f64, random: &mut Pcg64, damages: &mut Damages) -> Vec<u8> {
    let mut frame = frame.to_vec();
    if frame.is_empty() || random.random::<f64>() >= share {
        return frame;
    }
    let place = random.random_range(0..frame.len());
    match random.random_range(0..4) {
        0 => {
            damages.changed += 1;
            frame[place] ^= random.random_range(1..=255_u8);
        }
        1 => {
            damages.shortened += 1;
            frame.remove(place);
        }
        2 => {
            damages.lost += 1;
            frame.clear();
        }
        _ => {
            damages.repeated += 1;
            frame = frame.repeat(2);
        }
    }
    frame
}

impl<L: Line> Line for Damaging<L> {
    fn read(&mut self, bytes: &mut [u8], wait: Duration) -> Came {
        if self.ready.is_empty() {
            match self.line.read(bytes, wait) {
                Came::Bytes(count) => {
                    for &byte in &bytes[..count] {
                        self.partial.push(byte);
                        // A frame's first zero is no frame.
                        if byte == 0 && self.partial.len() > 1 {
                            self.ready.extend(pass(&self.partial, self.share, &mut self.random, &mut self.to_host));
                        }
                        if byte == 0 {
                            self.partial.clear();
                        }
                    }
                }
                other => return other,
            }
        }
        let count = self.ready.len().min(bytes.len());
        bytes.iter_mut().zip(self.ready.drain(..count)).for_each(|(place, byte)| *place = byte);
        if count == 0 { Came::Nothing } else { Came::Bytes(count) }
    }

    fn write(&mut self, bytes: &[u8]) -> bool {
        let frame = pass(bytes, self.share, &mut self.random, &mut self.to_board);
        self.line.write(&frame)
    }

    fn reopen(&mut self) -> bool {
        self.partial.clear();
        self.ready.clear();
        self.line.reopen()
    }
}
