//! The UART's receiver, byte by byte.

use cortex_m::interrupt::{self, InterruptNumber};
use cortex_m::peripheral::NVIC;

use crate::register::{read, write};
use crate::uart::{CONTROL, SENDER, STATE, UART0, Uart};

const INTERRUPT_CLEAR: usize = UART0 + 0x0c;

const RECEIVER_FULL: u32 = 1 << 1;
/// The receiver and its interrupt.
const RECEIVER: u32 = 1 << 1 | 1 << 3;
const RECEIVED: u32 = 1 << 1;

/// The receiver's interrupt. It has no handler: interrupts stay off, and it only wakes the processor.
#[derive(Clone, Copy)]
struct Receive;

// SAFETY: the first UART's receiver is interrupt 0 of these boards.
unsafe impl InterruptNumber for Receive {
    fn number(self) -> u16 {
        0
    }
}

/// The receiver, running.
pub(crate) struct Receiver(());

impl Receiver {
    /// Of a UART that runs. Turns all interrupts off.
    pub(crate) fn start(_: &Uart) -> Self {
        interrupt::disable();
        write(CONTROL, SENDER | RECEIVER);
        // SAFETY: with interrupts off no critical section is broken.
        unsafe { NVIC::unmask(Receive) }
        Self(())
    }

    /// Sleeps until a byte has come.
    pub(crate) fn receive(&mut self) -> u8 {
        while read(STATE) & RECEIVER_FULL == 0 {
            cortex_m::asm::wfi();
            write(INTERRUPT_CLEAR, RECEIVED);
            NVIC::unpend(Receive);
        }
        read(UART0) as u8
    }
}
