//! Processor in the loop: a host sends poses, a board answers contacts, over a serial line or anything that carries
//! bytes. `PROTOCOL.md` beside this crate specifies every byte. No allocation; the host's side of the exchange is
//! `flangeway pil`.
//!
//! A board hands every byte it receives to a [`Board`], and sends what that gives:
//!
//! ```
//! use flangeway::{ContactTable, Contacts};
//! use flangeway_pil::{Board, Identity, Step, answer};
//!
//! fn serve(table: &ContactTable<'_>, board: &mut Board<'_>, byte: u8, mut send: impl FnMut(&[u8])) {
//!     let look_up = |step: &Step| answer(table, step, || 0);
//!     if let Some(frame) = board.receive(byte, look_up) {
//!         send(frame);
//!     }
//! }
//! ```
#![no_std]
#![warn(clippy::std_instead_of_core)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

#[cfg(test)]
extern crate std;

mod board;
mod frame;
mod message;

pub use board::{Board, answer};
pub use frame::{Damage, FRAME_LIMIT, MESSAGE_LIMIT, Receiver, decode, encode};
pub use message::{Answer, ContactNumbers, Identity, Request, Step, StepAnswer, Unit, WheelAnswer, sides};

/// Version of the protocol: the first byte of every frame.
pub const VERSION: u8 = 1;
