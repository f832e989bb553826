//! The board's side: what to answer to the bytes that come in.

use flangeway::ContactTable;
use heapless::Vec;

use crate::frame::{Damage, FRAME_LIMIT, Receiver, decode, encode};
use crate::message::{Answer, Identity, Request, Step, StepAnswer, WheelAnswer, sides};

/// A board, which answers every step once: a repeated request gets the answer that was given, without another lookup.
#[derive(Debug)]
pub struct Board<'a> {
    identity: Identity<'a>,
    receiver: Receiver,
    session: Option<u32>,
    /// The step answered last.
    last: Option<u32>,
    /// The frame that answered it.
    frame: Vec<u8, FRAME_LIMIT>,
    /// A frame that answers no step.
    note: Vec<u8, FRAME_LIMIT>,
}

impl<'a> Board<'a> {
    /// A board that was just started; the session in its identity is not looked at.
    #[must_use]
    pub const fn new(identity: Identity<'a>) -> Self {
        Self { identity, receiver: Receiver::new(), session: None, last: None, frame: Vec::new(), note: Vec::new() }
    }

    /// Takes a byte, looks up what it completes, and gives the frame to send, if any.
    pub fn receive(&mut self, byte: u8, look_up: impl FnOnce(&Step) -> StepAnswer) -> Option<&[u8]> {
        let bytes = self.receiver.push(byte)?;
        match decode(bytes) {
            Ok(Request::Hello { session }) => {
                // A hello that came twice begins nothing.
                if self.session != Some(session) {
                    (self.session, self.last) = (Some(session), None);
                }
                let identity = Identity { session, ..self.identity };
                self.say(&Answer::Identity(identity))
            }
            Ok(Request::Step(Step { session, .. })) if self.session != Some(session) => {
                self.say(&Answer::UnknownSession { session })
            }
            Ok(Request::Step(step)) => self.step(&step, look_up),
            Err(Damage::Damaged) => self.say(&Answer::Damaged),
            Err(Damage::OtherVersion(_)) => self.say(&Answer::OtherVersion),
        }
    }

    /// The next step is looked up, the last one's answer repeated, any other left unanswered: it is an old request that
    /// was held up on its way.
    fn step(&mut self, step: &Step, look_up: impl FnOnce(&Step) -> StepAnswer) -> Option<&[u8]> {
        if self.last != Some(step.sequence) {
            if self.last.is_some_and(|last| last.wrapping_add(1) != step.sequence) {
                return None;
            }
            self.frame = encode(&Answer::Step(look_up(step)));
            self.last = Some(step.sequence);
        }
        Some(&self.frame)
    }

    fn say(&mut self, answer: &Answer<'_>) -> Option<&[u8]> {
        self.note = encode(answer);
        Some(&self.note)
    }
}

/// The contacts of a step by a table, and what `count` grew by meanwhile.
pub fn answer(table: &ContactTable<'_>, step: &Step, mut count: impl FnMut() -> u32) -> StepAnswer {
    let pose = step.pose();
    let before = count();
    let found = sides(step.sides).map(|side| table.contacts(side, &pose)).collect::<Vec<_, 2>>();
    let count = count().wrapping_sub(before);
    let wheels = found.iter().map(WheelAnswer::from).collect();
    StepAnswer { session: step.session, sequence: step.sequence, count, wheels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Unit;
    use std::vec;

    const IDENTITY: Identity<'_> =
        Identity { session: 0, table_checksum: 1, table_length: 2, unit: Unit::Nothing, board: "test" };

    /// A board and how many steps it looked up.
    struct Tested(Board<'static>, u32);

    impl Tested {
        fn new() -> Self {
            Self(Board::new(IDENTITY), 0)
        }

        /// The frame that bytes are answered with, if any.
        fn send(&mut self, bytes: &[u8]) -> Option<vec::Vec<u8>> {
            let mut answers = vec![];
            for byte in bytes {
                let lookups = &mut self.1;
                let look_up = |step: &Step| {
                    *lookups += 1;
                    StepAnswer { session: step.session, sequence: step.sequence, count: *lookups, wheels: Vec::new() }
                };
                answers.extend(self.0.receive(*byte, look_up).map(<[u8]>::to_vec));
            }
            assert!(answers.len() < 2);
            answers.pop()
        }

        /// What a request is answered with, as its message.
        fn ask(&mut self, request: Request) -> Option<Heard> {
            let mut frame = self.send(&encode(&request))?;
            let end = frame.len() - 1;
            Some(match decode(&mut frame[1..end]).unwrap() {
                Answer::Identity(identity) => Heard::Session(identity.session),
                Answer::Step(step) => Heard::Step(step.sequence, step.count),
                Answer::UnknownSession { session } => Heard::Unknown(session),
                Answer::Damaged | Answer::OtherVersion => panic!(),
            })
        }

        fn step(&mut self, session: u32, sequence: u32) -> Option<Heard> {
            self.ask(Request::Step(Step { session, sequence, sides: 3, pose: [0.0; 4] }))
        }
    }

    #[derive(Debug, PartialEq)]
    enum Heard {
        Session(u32),
        Step(u32, u32),
        Unknown(u32),
    }
    use Heard::{Session, Unknown};

    #[test]
    fn every_step_is_looked_up_once() {
        let mut board = Tested::new();
        assert_eq!(board.ask(Request::Hello { session: 5 }), Some(Session(5)));
        assert_eq!(board.step(5, 0), Some(Heard::Step(0, 1)));
        // The answer was lost, and the hello comes again: the same answer, not another lookup.
        assert_eq!(board.ask(Request::Hello { session: 5 }), Some(Session(5)));
        assert_eq!(board.step(5, 0), Some(Heard::Step(0, 1)));
        assert_eq!(board.step(5, 1), Some(Heard::Step(1, 2)));
        // An old request that was held up.
        assert_eq!(board.step(5, 0), None);
        assert_eq!(board.step(5, 1), Some(Heard::Step(1, 2)));
    }

    #[test]
    fn a_restarted_board_asks_for_a_hello_and_goes_on() {
        let mut board = Tested::new();
        assert_eq!(board.step(5, 1000), Some(Unknown(5)));
        assert_eq!(board.ask(Request::Hello { session: 6 }), Some(Session(6)));
        assert_eq!(board.step(5, 1000), Some(Unknown(5)));
        assert_eq!(board.step(6, 1000), Some(Heard::Step(1000, 1)));
    }

    #[test]
    fn damage_and_other_versions_are_answered() {
        let mut board = Tested::new();
        let damaged = board.send(&[0, 1, 2, 3, 0]).unwrap();
        assert_eq!(damaged, encode(&Answer::Damaged)[..]);
        let mut hello = encode(&Request::Hello { session: 5 });
        hello[3] ^= 1;
        assert_eq!(board.send(&hello).unwrap(), damaged);
        assert_eq!(board.0.session, None);
        assert_eq!(board.send(&[0, 0, 0]), None);
    }
}
