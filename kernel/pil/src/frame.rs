//! Frames: `0 COBS(version, message, CRC-32C) 0`.

use crc::{CRC_32_ISCSI, Crc, NoTable};
use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::VERSION;

/// The same checksum as a table's, without a table of a kilobyte: frames are short.
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// Bytes of a message with version and checksum at most: two wheels of three contacts.
pub const MESSAGE_LIMIT: usize = 1 + (1 + 3 * 5 + 1 + 2 * (2 + 3 * (1 + 48))) + CHECKSUM;
/// Bytes of a frame at most.
pub const FRAME_LIMIT: usize = cobs::max_encoding_length(MESSAGE_LIMIT) + 2;
/// Bytes of the checksum.
const CHECKSUM: usize = 4;

/// Why a frame is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damage {
    /// Too long, no COBS, a checksum that does not hold, or a message that is none.
    Damaged,
    /// Whole, but of this version of the protocol.
    OtherVersion(u8),
}

/// A message as a frame; empty if it is longer than any.
pub fn encode<T: Serialize>(message: &T) -> Vec<u8, FRAME_LIMIT> {
    try_encode(message).unwrap_or_default()
}

fn try_encode<T: Serialize>(message: &T) -> Option<Vec<u8, FRAME_LIMIT>> {
    let mut plain = [0; MESSAGE_LIMIT];
    let (version, rest) = plain.split_first_mut()?;
    *version = VERSION;
    let length = 1 + postcard::to_slice(message, rest).ok()?.len();
    let checksum = CRC.checksum(plain.get(..length)?).to_le_bytes();
    plain.get_mut(length..length + CHECKSUM)?.copy_from_slice(&checksum);
    let mut frame = Vec::new();
    frame.resize(FRAME_LIMIT, 0).ok()?;
    let length = cobs::try_encode(plain.get(..length + CHECKSUM)?, frame.get_mut(1..FRAME_LIMIT - 1)?).ok()?;
    frame.truncate(length + 2);
    Some(frame)
}

/// The message in a frame's bytes without its zeros, which are decoded in their place.
///
/// # Errors
/// If it was damaged, or is of another version.
pub fn decode<'a, T: Deserialize<'a>>(frame: &'a mut [u8]) -> Result<T, Damage> {
    let length = cobs::decode_in_place(frame).map_err(|_| Damage::Damaged)?;
    let plain = frame.get(..length).ok_or(Damage::Damaged)?;
    let (body, checksum) = plain.split_last_chunk::<CHECKSUM>().ok_or(Damage::Damaged)?;
    if CRC.checksum(body) != u32::from_le_bytes(*checksum) {
        return Err(Damage::Damaged);
    }
    let (version, message) = body.split_first().ok_or(Damage::Damaged)?;
    if *version != VERSION {
        return Err(Damage::OtherVersion(*version));
    }
    match postcard::take_from_bytes(message) {
        Ok((message, [])) => Ok(message),
        _ => Err(Damage::Damaged),
    }
}

/// Gathers bytes until a frame is whole.
#[derive(Debug, Clone, Default)]
pub struct Receiver {
    bytes: Vec<u8, FRAME_LIMIT>,
    /// Whether the frame was done: the next byte begins another.
    done: bool,
    /// Whether more came than a frame can hold.
    overlong: bool,
}

impl Receiver {
    /// Nothing received yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), done: false, overlong: false }
    }

    /// Takes a byte; the bytes between two zeros, once the second has come and if there are any.
    pub fn push(&mut self, byte: u8) -> Option<&mut [u8]> {
        if self.done {
            self.clear();
        }
        if byte != 0 {
            self.overlong |= self.bytes.push(byte).is_err();
            return None;
        }
        self.done = true;
        if self.overlong {
            // What is left is not a frame, and its checksum would say so; a single byte does that sooner.
            self.bytes.truncate(1);
        }
        (!self.bytes.is_empty()).then_some(&mut self.bytes[..])
    }

    /// Forgets what came.
    pub fn clear(&mut self) {
        self.bytes.clear();
        (self.done, self.overlong) = (false, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::{Answer, ContactNumbers, Request, Step, StepAnswer, WheelAnswer};

    const STEP: Request =
        Request::Step(Step { session: 7, sequence: 300, sides: 3, pose: [0.003, -0.001, f64::NAN, 5e-324] });

    /// The message of a frame that comes in whole.
    fn received(frame: &[u8]) -> Option<Result<Request, Damage>> {
        let mut receiver = Receiver::new();
        frame.iter().fold(None, |found, byte| receiver.push(*byte).map(decode).or(found))
    }

    /// The protocol page's example, byte by byte; its checksum was computed bit by bit in another language.
    #[test]
    fn literal_bytes() {
        let frame = encode(&Request::Hello { session: 300 });
        assert_eq!(&frame[..], [0, 2, 1, 7, 0xac, 2, 0x17, 0x2a, 0xcf, 0x23, 0]);
    }

    #[test]
    fn every_bit_arrives() {
        let Some(Ok(Request::Step(step))) = received(&encode(&STEP)) else { panic!() };
        let Request::Step(sent) = STEP else { panic!() };
        assert_eq!(step.pose.map(f64::to_bits), sent.pose.map(f64::to_bits));
        assert_eq!((step.session, step.sequence, step.sides), (7, 300, 3));
    }

    #[test]
    fn the_longest_answer_fits_exactly() {
        let contact = ContactNumbers { slot: 2, numbers: [f32::MAX; 12] };
        let wheel = WheelAnswer { flags: 255, contacts: [contact; 3].into_iter().collect() };
        let wheels = [wheel.clone(), wheel].into_iter().collect();
        let answer = Answer::Step(StepAnswer { session: u32::MAX, sequence: u32::MAX, count: u32::MAX, wheels });
        let plain = postcard::to_slice(&answer, &mut [0; 512]).unwrap().len();
        assert_eq!(plain + 1 + CHECKSUM, MESSAGE_LIMIT);
        assert!(!encode(&answer).is_empty());
    }

    #[test]
    fn every_single_damage_is_noticed() {
        let frame = encode(&STEP);
        let last = frame.len() - 1;
        for place in 1..last {
            for change in 1..=255 {
                let mut damaged = frame.clone();
                damaged[place] ^= change;
                assert!(!matches!(received(&damaged), Some(Ok(_))), "byte {place} changed by {change}");
            }
            let mut shorter = frame.clone();
            shorter.remove(place);
            assert_eq!(received(&shorter), Some(Err(Damage::Damaged)), "byte {place} missing");
        }
        // Without its end it is no frame yet, and the next one's first zero ends it.
        assert_eq!(received(&frame[..last]), None);
        assert!(matches!(received(&[&frame[..last], &frame[..]].concat()), Some(Ok(_))));
    }

    #[test]
    fn what_is_too_long_is_damaged_and_the_next_frame_taken() {
        let mut receiver = Receiver::new();
        assert!((0..10_000).all(|_| receiver.push(1).is_none()));
        assert_eq!(receiver.push(0).map(decode::<Request>), Some(Err(Damage::Damaged)));
        assert!(receiver.push(0).is_none());
        let frame = encode(&STEP);
        let taken = frame.iter().filter_map(|byte| receiver.push(*byte).map(decode::<Request>)).count();
        assert_eq!(taken, 1);
    }

    #[test]
    fn another_version_is_named() {
        let mut plain = std::vec![VERSION + 1, 9, 9, 9];
        plain.extend(CRC.checksum(&plain).to_le_bytes());
        let mut bytes = [0; 32];
        let length = cobs::encode(&plain, &mut bytes);
        assert_eq!(decode::<Request>(&mut bytes[..length]), Err(Damage::OtherVersion(VERSION + 1)));
    }
}
