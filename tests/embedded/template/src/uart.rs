//! The board's UART, as far as it sends: here the first CMSDK UART of Arm's MPS2 boards. Your vendor's HAL has yours.

use crate::register::{read, write};

/// First of its registers, that of data.
pub(crate) const UART0: usize = 0x4000_4000;
/// Whether sender and receiver hold a byte.
pub(crate) const STATE: usize = UART0 + 0x04;
/// What is switched on.
pub(crate) const CONTROL: usize = UART0 + 0x08;
const BAUD_DIVIDER: usize = UART0 + 0x10;

const SENDER_FULL: u32 = 1;
/// The sender is on.
pub(crate) const SENDER: u32 = 1;
/// 25 MHz by 115,200 bits a second.
const DIVIDER: u32 = 217;

/// The UART, running.
pub(crate) struct Uart(());

impl Uart {
    pub(crate) fn start() -> Self {
        write(BAUD_DIVIDER, DIVIDER);
        write(CONTROL, SENDER);
        Self(())
    }

    /// Sends a byte, once there is room.
    pub(crate) fn send(&mut self, byte: u8) {
        while read(STATE) & SENDER_FULL != 0 {}
        write(UART0, byte.into());
    }
}
