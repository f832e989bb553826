//! Files of the host.

use cortex_m_semihosting::hio::{HostStream, hstdout};
use cortex_m_semihosting::{nr, syscall};

/// A file to be read.
pub(crate) struct File(usize);

impl File {
    /// Opens a file by its name, which ends with a zero.
    pub(crate) fn open(name: &str) -> Option<Self> {
        const READ_BINARY: usize = 1;
        // SAFETY: the host reads the name's bytes, which outlive the call.
        let handle = unsafe { syscall(nr::OPEN, &[name.as_ptr() as usize, READ_BINARY, name.len() - 1]) };
        (handle != usize::MAX).then_some(Self(handle))
    }

    /// Fills the bytes; false where the file holds no more.
    pub(crate) fn read(&self, bytes: &mut [u8]) -> bool {
        // SAFETY: the host writes at most as many bytes as there are, which nobody else holds.
        let missing = unsafe { syscall(nr::READ, &[self.0, bytes.as_mut_ptr() as usize, bytes.len()]) };
        missing == 0
    }
}

/// The host's standard output.
pub(crate) struct Output(HostStream);

impl Output {
    pub(crate) fn open() -> Option<Self> {
        hstdout().ok().map(Self)
    }

    pub(crate) fn write(&mut self, bytes: &[u8]) -> Option<()> {
        self.0.write_all(bytes).ok()
    }
}
