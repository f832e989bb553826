//! The board's UART, received byte by byte: here the first CMSDK UART of Arm's MPS2 boards. Your vendor's HAL has yours.

use cortex_m::interrupt::{self, InterruptNumber};
use cortex_m::peripheral::NVIC;

const UART0: usize = 0x4000_4000;
const DATA: usize = UART0;
const STATE: usize = UART0 + 0x04;
const CONTROL: usize = UART0 + 0x08;
const INTERRUPT_CLEAR: usize = UART0 + 0x0c;
const BAUD_DIVIDER: usize = UART0 + 0x10;

const SENDER_FULL: u32 = 1;
const RECEIVER_FULL: u32 = 1 << 1;
/// Sender, receiver, the receiver's interrupt.
const ENABLE: u32 = 1 | 1 << 1 | 1 << 3;
const RECEIVED: u32 = 1 << 1;
/// 25 MHz by 115,200 bits a second.
const DIVIDER: u32 = 217;

/// The receiver's interrupt. It has no handler: interrupts stay off, and it only wakes the processor.
#[derive(Clone, Copy)]
struct Receive;

// SAFETY: the first UART's receiver is interrupt 0 of these boards.
unsafe impl InterruptNumber for Receive {
    fn number(self) -> u16 {
        0
    }
}

/// The UART, running.
pub(crate) struct Uart(());

impl Uart {
    pub(crate) fn start() -> Self {
        interrupt::disable();
        write(BAUD_DIVIDER, DIVIDER);
        write(CONTROL, ENABLE);
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
        read(DATA) as u8
    }

    /// Sends a byte, once there is room.
    pub(crate) fn send(&mut self, byte: u8) {
        while read(STATE) & SENDER_FULL != 0 {}
        write(DATA, byte.into());
    }
}

fn read(register: usize) -> u32 {
    // SAFETY: called with the UART's registers alone, which nobody else uses.
    unsafe { core::ptr::with_exposed_provenance::<u32>(register).read_volatile() }
}

fn write(register: usize, value: u32) {
    // SAFETY: as above.
    unsafe { core::ptr::with_exposed_provenance_mut::<u32>(register).write_volatile(value) }
}
