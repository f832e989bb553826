//! The host's side of the exchange: asks until the answer to this very step has come.

use std::time::{Duration, Instant};

use flangeway_pil::{Answer, Damage, Identity, Receiver, Request, Step, StepAnswer, Unit, VERSION, decode, encode};

use super::port::{Came, Line};
use crate::error::{Error, Result};

/// How long a line that is gone is left alone before it is tried again.
const REOPEN: Duration = Duration::from_millis(50);

/// What a board says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BoardIdentity {
    /// Its name.
    pub name: String,
    /// Checksum of its table.
    pub table_checksum: u32,
    /// Length of its table, bytes.
    pub table_length: u32,
    /// What it counts.
    pub unit: Unit,
}

/// Times that something was asked again, by the reason, and what else went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Retries {
    /// The board received damage instead of the request.
    pub request_damaged: u64,
    /// Damage came instead of the answer.
    pub answer_damaged: u64,
    /// No answer came in time.
    pub no_answer: u64,
    /// The line was gone, and was opened anew.
    pub line_reopened: u64,
    /// The board had been started anew, and was told hello again.
    pub board_restarted: u64,
}

impl Retries {
    /// All of them.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.request_damaged + self.answer_damaged + self.no_answer + self.line_reopened + self.board_restarted
    }
}

/// How long is waited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// For an answer, until it is asked for again.
    pub answer: Duration,
    /// For any sign of the board, until it is given up.
    pub board: Duration,
}

/// A session with a board.
pub struct Session<L> {
    /// The line to the board.
    pub line: L,
    receiver: Receiver,
    /// Bytes that came and were not looked at yet, the last one first.
    bytes: Vec<u8>,
    number: u32,
    patience: Patience,
    /// What the board said it is.
    pub board: BoardIdentity,
    /// What was asked again.
    pub retries: Retries,
    /// Answers to nothing that was being asked: late or repeated ones, which were dropped.
    pub dropped: u64,
}

/// What was heard of the board.
enum Heard {
    /// A whole message.
    Said(Said),
    /// The board received damage.
    RequestDamaged,
    /// Damage came from the board.
    AnswerDamaged,
    OtherVersion(u8),
    /// Nothing in time.
    Nothing,
    /// The line is gone.
    Closed,
}

/// What a board says in answer.
enum Said {
    Identity(u32, BoardIdentity),
    Step(Box<StepAnswer>),
    UnknownSession(u32),
}

impl<L: Line> Session<L> {
    /// Says hello to the board on a line, until it answers. The number must be another than that of any session before.
    ///
    /// # Errors
    /// If no board answers, or one of another version.
    pub fn begin(line: L, number: u32, patience: Patience) -> Result<Self> {
        let board = BoardIdentity { name: String::new(), table_checksum: 0, table_length: 0, unit: Unit::Nothing };
        let (receiver, retries) = (Receiver::new(), Retries::default());
        let mut session = Self { line, receiver, bytes: Vec::new(), number, patience, board, retries, dropped: 0 };
        session.board = session.hello()?;
        Ok(session)
    }

    /// The contacts of a step, which is asked for until they come. The step's session is filled in here.
    ///
    /// # Errors
    /// If no sign of the board comes for as long as it is waited for, or it is another board than at the beginning.
    pub fn step(&mut self, step: &Step) -> Result<StepAnswer> {
        loop {
            let session = self.number;
            let request = Request::Step(Step { session, ..*step });
            let answer = self.ask(&request, |said| match said {
                Said::Step(answer) if (answer.session, answer.sequence) == (session, step.sequence) => Some(Ok(answer)),
                Said::UnknownSession(unknown) if unknown == session => Some(Err(())),
                _ => None,
            })?;
            match answer {
                Ok(answer) => return Ok(*answer),
                Err(()) => self.restarted()?,
            }
        }
    }

    /// Says hello to a board that was started anew, which must be what it was.
    fn restarted(&mut self) -> Result<()> {
        self.retries.board_restarted += 1;
        self.number = self.number.wrapping_add(1);
        let board = self.hello()?;
        if board == self.board {
            return Ok(());
        }
        Err(port_error(format!("after its restart the board says it is {board:?}; before it was {:?}", self.board)))
    }

    fn hello(&mut self) -> Result<BoardIdentity> {
        let session = self.number;
        self.ask(&Request::Hello { session }, |said| match said {
            Said::Identity(of, board) if of == session => Some(board),
            _ => None,
        })
    }

    /// Sends a request until `take` takes what is said.
    fn ask<T>(&mut self, request: &Request, mut take: impl FnMut(Said) -> Option<T>) -> Result<T> {
        let frame = encode(request);
        let mut last_sign = Instant::now();
        loop {
            if !self.line.write(&frame) {
                self.reopen()?;
                continue;
            }
            let until = Instant::now() + self.patience.answer;
            // Until there is a reason to ask again.
            let reason = loop {
                match self.hear(until) {
                    Heard::Said(said) => match take(said) {
                        Some(taken) => return Ok(taken),
                        None => self.dropped += 1,
                    },
                    Heard::OtherVersion(version) => {
                        let message = format!("the board speaks version {version} of the protocol, this is {VERSION}");
                        return Err(port_error(message));
                    }
                    reason => break reason,
                }
            };
            match reason {
                Heard::Closed => self.reopen()?,
                Heard::Nothing => self.retries.no_answer += 1,
                Heard::RequestDamaged => self.retries.request_damaged += 1,
                _ => self.retries.answer_damaged += 1,
            }
            if !matches!(reason, Heard::Nothing) {
                last_sign = Instant::now();
            } else if last_sign.elapsed() >= self.patience.board {
                return Err(port_error(format!("no board answers for {} s", self.patience.board.as_secs_f64())));
            }
        }
    }

    /// The next that is heard, until a time.
    fn hear(&mut self, until: Instant) -> Heard {
        loop {
            while let Some(byte) = self.bytes.pop() {
                if let Some(frame) = self.receiver.push(byte) {
                    return heard(decode(frame));
                }
            }
            let wait = until.saturating_duration_since(Instant::now());
            if wait.is_zero() {
                return Heard::Nothing;
            }
            let mut bytes = [0; 1024];
            match self.line.read(&mut bytes, wait) {
                Came::Bytes(count) => self.bytes.extend(bytes[..count].iter().rev()),
                Came::Nothing => {}
                Came::Closed => return Heard::Closed,
            }
        }
    }

    /// Opens a line anew that is gone, and begins with nothing half received.
    fn reopen(&mut self) -> Result<()> {
        self.retries.line_reopened += 1;
        let gone = Instant::now();
        while !self.line.reopen() {
            if gone.elapsed() >= self.patience.board {
                return Err(port_error(format!("the line is gone for {} s", self.patience.board.as_secs_f64())));
            }
            std::thread::sleep(REOPEN);
        }
        self.receiver.clear();
        self.bytes.clear();
        Ok(())
    }
}

/// What a frame says.
fn heard(frame: std::result::Result<Answer<'_>, Damage>) -> Heard {
    match frame {
        Ok(Answer::Identity(Identity { session, table_checksum, table_length, unit, board })) => {
            let board = BoardIdentity { name: board.into(), table_checksum, table_length, unit };
            Heard::Said(Said::Identity(session, board))
        }
        Ok(Answer::Step(answer)) => Heard::Said(Said::Step(Box::new(answer))),
        Ok(Answer::UnknownSession { session }) => Heard::Said(Said::UnknownSession(session)),
        Ok(Answer::Damaged) => Heard::RequestDamaged,
        Err(Damage::Damaged) => Heard::AnswerDamaged,
        // A board of this version that received another one.
        Ok(Answer::OtherVersion) => Heard::RequestDamaged,
        Err(Damage::OtherVersion(version)) => Heard::OtherVersion(version),
    }
}

fn port_error(message: String) -> Error {
    Error::field("", "--port", message)
}
