//! Firmware to copy: a table in flash, poses in over a UART, contacts out. It speaks the protocol of `flangeway pil`
//! (`kernel/pil/PROTOCOL.md`), so the host can drive it and check every bit.
//!
//! What to change for your board: the crate `flangeway-mps2` (the memory's layout and the interrupts: a peripheral access
//! crate and your `memory.x`), `register.rs`, `uart.rs`, `receiver.rs`, `clock.rs`, the table, the name. A loop with a fixed
//! step of its own is `fixed_step.rs`.
#![no_std]
#![no_main]

mod clock;
mod receiver;
mod register;
mod uart;

use core::mem::MaybeUninit;

use cortex_m::{Peripherals, singleton};
use cortex_m_rt::entry;
use flangeway::{ContactTable, layout};
use flangeway_mps2 as _; // your board's peripheral access crate
use flangeway_pil::{Board, Identity, Step, Unit, answer};
use panic_halt as _;

#[cfg(feature = "defmt")]
use defmt_semihosting as _;

use clock::Clock;
use receiver::Receiver;
use uart::Uart;

/// The table, which stays in flash. Your own: `include_bytes!("your.fwt")`, best aligned to 64 bytes.
static TABLE: &[u8] = flangeway_tables::S1002_60E1_40_TABLE;

#[entry]
fn main() -> ! {
    // Both are there at the first call.
    if let Some(peripherals) = Peripherals::take()
        && let Some(board) = start(peripherals)
    {
        serve(board)
    }
    #[cfg(feature = "defmt")]
    defmt::error!("the table is refused");
    loop {
        cortex_m::asm::wfi();
    }
}

/// What the loop works with.
struct Firmware {
    /// In static memory, since it has two kilobytes; the records are read where they lie, in flash.
    table: &'static ContactTable<'static>,
    board: &'static mut Board<'static>,
    uart: Uart,
    receiver: Receiver,
    clock: Clock,
}

fn start(peripherals: Peripherals) -> Option<Firmware> {
    // Checked once: checksum and every section. From here on nothing can fail.
    let place = singleton!(: MaybeUninit<ContactTable<'static>> = MaybeUninit::uninit())?;
    let table = ContactTable::new_in(place, TABLE).ok()?;
    let identity = Identity {
        session: 0,
        table_checksum: layout::checksum(TABLE),
        table_length: u32::try_from(TABLE.len()).ok()?,
        unit: Unit::Instructions,
        board: "mps2",
    };
    let board = singleton!(: Board<'static> = Board::new(identity))?;
    #[cfg(feature = "defmt")]
    defmt::info!("a table of {} bytes", TABLE.len());
    let uart = Uart::start();
    let receiver = Receiver::start(&uart);
    Some(Firmware { table, board, uart, receiver, clock: Clock::start(peripherals.SYST) })
}

/// Answers for ever.
fn serve(firmware: Firmware) -> ! {
    let Firmware { table, board, mut uart, mut receiver, mut clock } = firmware;
    loop {
        // A board that does anything else receives in an interrupt, or by DMA.
        let byte = receiver.receive();
        let look_up = |step: &Step| {
            clock.restart();
            answer(table, step, || clock.now())
        };
        if let Some(frame) = board.receive(byte, look_up) {
            frame.iter().for_each(|byte| uart.send(*byte));
        }
    }
}
