//! Where the board is: a TCP socket, as an emulator offers its serial line, or a serial device.

use std::fmt;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::time::Duration;

use crate::error::{Error, Result};

/// Bits a second of a serial device that is named without.
const BAUD: u32 = 115_200;
/// Longest wait for a connection.
const CONNECT: Duration = Duration::from_secs(1);

/// Address of a board: `tcp:HOST:PORT`, or a serial device, `DEVICE[:BAUD]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// Host and port.
    Tcp(String),
    /// Path (or name) and bits a second; 8 data bits, no parity, one stop bit, no flow control.
    Serial(String, u32),
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if let Some(address) = text.strip_prefix("tcp:") {
            let port = address.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port);
            return match port.map(str::parse::<u16>) {
                Some(Ok(_)) => Ok(Self::Tcp(address.into())),
                _ => Err(format!("\"{text}\" is not tcp:HOST:PORT")),
            };
        }
        let (device, baud) = match text.rsplit_once(':') {
            Some((device, baud)) if !device.is_empty() => {
                let baud = baud.parse().ok().filter(|baud| *baud > 0);
                (device, baud.ok_or_else(|| format!("\"{text}\" is not DEVICE:BAUD"))?)
            }
            _ => (text, BAUD),
        };
        if device.is_empty() { Err("no device is named".into()) } else { Ok(Self::Serial(device.into(), baud)) }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::Serial(device, baud) => write!(f, "{device}:{baud}"),
        }
    }
}

/// What came of waiting for bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Came {
    /// So many.
    Bytes(usize),
    /// None in time.
    Nothing,
    /// The line is gone.
    Closed,
}

/// A line that carries bytes both ways.
pub trait Line {
    /// Waits for bytes, no longer than `wait`.
    fn read(&mut self, bytes: &mut [u8], wait: Duration) -> Came;
    /// Sends bytes; false where the line is gone.
    fn write(&mut self, bytes: &[u8]) -> bool;
    /// Opens a line that is gone anew; false where that is not possible (yet).
    fn reopen(&mut self) -> bool;
}

/// An open line to a board.
pub struct Port {
    address: Address,
    line: Open,
}

enum Open {
    Tcp(TcpStream),
    Serial(Box<dyn serialport::SerialPort>),
}

impl Port {
    /// Opens the line.
    ///
    /// # Errors
    /// With the address and the system's reason.
    pub fn open(address: &Address) -> Result<Self> {
        let line = open(address).map_err(|e| Error::field("", "--port", format!("{address}: {e}")))?;
        Ok(Self { address: address.clone(), line })
    }
}

fn open(address: &Address) -> std::io::Result<Open> {
    match address {
        Address::Tcp(address) => {
            let found = address.to_socket_addrs()?.next().ok_or(ErrorKind::AddrNotAvailable)?;
            let stream = TcpStream::connect_timeout(&found, CONNECT)?;
            stream.set_nodelay(true)?;
            Ok(Open::Tcp(stream))
        }
        Address::Serial(device, baud) => Ok(Open::Serial(serialport::new(device, *baud).open()?)),
    }
}

impl Line for Port {
    fn read(&mut self, bytes: &mut [u8], wait: Duration) -> Came {
        // Zero would mean for ever.
        let wait = wait.max(Duration::from_millis(1));
        let (read, end) = match &mut self.line {
            Open::Tcp(stream) => (stream.set_read_timeout(Some(wait)).and_then(|()| stream.read(bytes)), true),
            Open::Serial(port) => (port.set_timeout(wait).map_err(Into::into).and_then(|()| port.read(bytes)), false),
        };
        match read {
            Ok(0) if end => Came::Closed,
            Ok(count) if count > 0 => Came::Bytes(count),
            Ok(_) => Came::Nothing,
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                Came::Nothing
            }
            Err(_) => Came::Closed,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> bool {
        match &mut self.line {
            Open::Tcp(stream) => stream.write_all(bytes).is_ok(),
            Open::Serial(port) => port.write_all(bytes).is_ok(),
        }
    }

    fn reopen(&mut self) -> bool {
        let opened = open(&self.address);
        opened.map(|line| self.line = line).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        let good = |text: &str| text.parse::<Address>().unwrap();
        assert_eq!(good("tcp:127.0.0.1:4000"), Address::Tcp("127.0.0.1:4000".into()));
        assert_eq!(good("/dev/ttyACM0"), Address::Serial("/dev/ttyACM0".into(), 115_200));
        assert_eq!(good("/dev/ttyACM0:921600"), Address::Serial("/dev/ttyACM0".into(), 921_600));
        assert_eq!(good("COM3:9600").to_string(), "COM3:9600");
        for bad in ["", "tcp:", "tcp:4000", "tcp::4000", "tcp:here:70000", "/dev/ttyACM0:fast", "/dev/ttyACM0:0"] {
            assert!(bad.parse::<Address>().is_err(), "{bad}");
        }
    }
}
