//! `flangeway pil`: exchanges with boards made of the very code that firmware uses, over lines that lose and damage, and
//! the program's words on bad input.

use std::collections::VecDeque;
use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::thread;
use std::time::Duration;

use crate::common::Folder;
use flangeway::{ContactTable, Pose, layout};
use flangeway_host::pil::{Came, Line, Report, Settings, pil};
use flangeway_host::rig::synthetic;
use flangeway_pil::{Board, Identity, Step, StepAnswer, Unit, answer};
use flangeway_tables::S1002_60E1_40_TABLE as IMAGE;

const SETTINGS: Settings = Settings { exchanges: 3000, damage: 0.0, seed: 1, timeout: 0.001, patience: 2.0 };

fn table() -> ContactTable<'static> {
    ContactTable::new(IMAGE).unwrap()
}

fn new_board(name: &'static str) -> Board<'static> {
    let (table_checksum, table_length) = (layout::checksum(IMAGE), IMAGE.len() as u32);
    Board::new(Identity { session: 0, table_checksum, table_length, unit: Unit::Instructions, board: name })
}

/// A board at the other end of a line without any system in between.
struct Direct {
    board: Board<'static>,
    table: ContactTable<'static>,
    answers: VecDeque<u8>,
    /// Steps looked up, each time the board's count.
    lookups: u32,
    /// Lookups after which the board is started anew, once, with this name.
    restart: Option<(u32, &'static str)>,
    /// The step whose answer is changed in one bit before it is sent.
    wrong: Option<u32>,
}

impl Direct {
    fn new() -> Self {
        let (board, table) = (new_board("test"), table());
        Self { board, table, answers: VecDeque::new(), lookups: 0, restart: None, wrong: None }
    }
}

impl Line for &mut Direct {
    fn read(&mut self, bytes: &mut [u8], _: Duration) -> Came {
        // By threes, so that frames come in parts.
        let count = self.answers.len().min(3);
        bytes.iter_mut().zip(self.answers.drain(..count)).for_each(|(place, byte)| *place = byte);
        if count == 0 { Came::Nothing } else { Came::Bytes(count) }
    }

    fn write(&mut self, bytes: &[u8]) -> bool {
        if let Some((at, name)) = self.restart
            && self.lookups == at
        {
            (self.board, self.restart) = (new_board(name), None);
        }
        let Direct { board, table, answers, lookups, wrong, .. } = &mut **self;
        for byte in bytes {
            let look_up = |step: &Step| -> StepAnswer {
                *lookups += 1;
                let mut answer = answer(table, step, || 0);
                answer.count = *lookups;
                if *wrong == Some(step.sequence) {
                    let number = &mut answer.wheels[0].contacts[0].numbers[0];
                    *number = number.next_up();
                }
                answer
            };
            if let Some(frame) = board.receive(*byte, look_up) {
                answers.extend(frame);
            }
        }
        true
    }

    fn reopen(&mut self) -> bool {
        true
    }
}

fn run(settings: &Settings, line: &mut Direct) -> Report {
    let table = table();
    pil(settings, &table, IMAGE, &poses(), line).unwrap()
}

fn poses() -> Vec<Pose> {
    synthetic(&table(), 100)
}

#[test]
fn a_good_line_asks_once() {
    let mut board = Direct::new();
    // However long this process is held up, nothing is asked again.
    let report = run(&Settings { timeout: 3600.0, ..SETTINGS }, &mut board);
    assert_eq!((report.exchanges, report.mismatches, report.retries.total(), report.dropped), (3000, 0, 0, 0));
    // The board counts its lookups: the first was number 1, the last number 3000.
    assert_eq!(report.counts, [1, 3000]);
    assert!(report.contacts > 6000);
}

#[test]
fn with_damage_every_step_is_still_looked_up_once_and_answered_right() {
    for seed in 1..4 {
        let mut board = Direct::new();
        let report = run(&Settings { damage: 0.1, seed, ..SETTINGS }, &mut board);
        println!("{report:?}");
        assert_eq!((report.exchanges, report.mismatches), (3000, 0));
        assert_eq!(board.lookups, 3000);
        for damages in report.damaged {
            assert!([damages.changed, damages.shortened, damages.lost, damages.repeated].iter().all(|n| *n > 30));
        }
        let retries = report.retries;
        assert!(retries.request_damaged > 30 && retries.answer_damaged > 30 && retries.no_answer > 30);
        assert!(report.dropped > 30 && retries.board_restarted == 0);
    }
}

#[test]
fn a_restart_is_noticed_and_gone_on_after() {
    let mut board = Direct { restart: Some((1234, "test")), ..Direct::new() };
    let report = run(&Settings { damage: 0.02, ..SETTINGS }, &mut board);
    assert_eq!((report.exchanges, report.mismatches, report.retries.board_restarted), (3000, 0, 1));
    // What was asked for when it was started anew may have been looked up before and after.
    assert!((3000..=3001).contains(&board.lookups));
}

#[test]
fn another_board_after_a_restart_is_refused() {
    let mut board = Direct { restart: Some((10, "another")), ..Direct::new() };
    let error = pil(&SETTINGS, &table(), IMAGE, &poses(), &mut board).unwrap_err().to_string();
    assert!(error.contains("restart") && error.contains("another"), "{error}");
}

#[test]
fn one_wrong_bit_is_found() {
    let mut board = Direct { wrong: Some(77), ..Direct::new() };
    let report = run(&SETTINGS, &mut board);
    assert_eq!((report.mismatches, report.first_mismatch), (1, Some(77)));
}

#[test]
fn another_table_and_silence_are_refused() {
    let other = flangeway_tables::SIMPLIFIED_PAIR_TABLE;
    let error = pil(&SETTINGS, &ContactTable::new(other).unwrap(), other, &poses(), &mut Direct::new());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("checksum") && error.contains(&IMAGE.len().to_string()), "{error}");
    let silent = Settings { damage: 0.0, patience: 0.01, ..SETTINGS };
    let error = pil(&silent, &table(), IMAGE, &poses(), Silent).unwrap_err().to_string();
    assert!(error.contains("no board answers"), "{error}");
}

/// A line that nobody is at.
struct Silent;

impl Line for Silent {
    fn read(&mut self, _: &mut [u8], wait: Duration) -> Came {
        thread::sleep(wait);
        Came::Nothing
    }

    fn write(&mut self, _: &[u8]) -> bool {
        true
    }

    fn reopen(&mut self) -> bool {
        true
    }
}

/// A board behind a TCP socket, which hangs up once in the middle of an answer and is another one after.
fn serve(listener: &TcpListener) {
    for hang_up in [Some(50), None] {
        let (mut stream, _) = listener.accept().unwrap();
        let (table, mut board, mut answers) = (table(), new_board("socket"), 0);
        let mut byte = [0];
        'connection: while let Ok(1) = stream.read(&mut byte) {
            if let Some(frame) = board.receive(byte[0], |step| answer(&table, step, || 0)) {
                answers += 1;
                if Some(answers) == hang_up {
                    stream.write_all(&frame[..frame.len() / 2]).unwrap();
                    break 'connection;
                }
                stream.write_all(frame).unwrap();
            }
        }
    }
}

#[test]
fn the_program_over_tcp() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || serve(&listener));
    let folder = Folder::new();
    let said = folder.run_well(&format!("pil --port tcp:127.0.0.1:{port} --exchanges 200 --damage 0.02 --json"));
    let document: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&document["exchanges"], &document["mismatches"]), (&200.into(), &0.into()));
    assert_eq!(document["board"], "socket");
    assert_eq!(document["retries_by_cause"]["line_reopened"], 1);
    assert_eq!(document["retries_by_cause"]["board_restarted"], 1);
    assert_eq!(document["count_unit"], "instructions");
}

#[test]
fn bad_input() {
    let folder = Folder::new();
    for (words, said) in [
        ("pil --port tcp:nowhere", "tcp:HOST:PORT"),
        ("pil --port /dev/no-such-device", "/dev/no-such-device:115200"),
        ("pil --port tcp:127.0.0.1:1 --exchanges 10", "--port: tcp:127.0.0.1:1"),
        ("pil --port tcp:127.0.0.1:1 --damage 0.9", "--damage: 0.9"),
        ("pil --port tcp:127.0.0.1:1 --exchanges 0", "--exchanges: 0"),
        ("pil --port tcp:127.0.0.1:1 --timeout nan", "--timeout: NaN"),
        ("pil none.fwt --port tcp:127.0.0.1:1", "none.fwt"),
    ] {
        let output = folder.run(words);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words}: {errors}");
        assert!(errors.contains(said), "{words}: {errors}");
    }
}
