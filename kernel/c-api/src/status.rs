//! What functions return, and its words.

use core::ffi::{CStr, c_char};

use flangeway::TableError;

/// What a function returns. Zero is success, everything else is an error; nothing is written then unless said.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer is NULL.
    Null = 1,
    /// A pointer is not aligned for what it points to.
    Misaligned = 2,
    /// A length times its element's size is beyond what memory can hold.
    Length = 3,
    /// The caller's room is too small: another header than this library's, or fewer places than results.
    ShortBuffer = 4,
    /// An input is NaN, infinite or beyond its limit. Outputs are written: zero force where it matters.
    NotANumber = 5,
    /// No such side.
    Side = 6,
    /// No such creep law.
    Law = 7,
    /// No such slot.
    Slot = 8,
    /// The table was not loaded, or was moved after it was loaded.
    NotLoaded = 9,
    /// The image does not begin as a contact table does.
    TableMagic = 16,
    /// The image is of a format version that this library does not read.
    TableVersion = 17,
    /// The image is shorter or longer than it says.
    TableLength = 18,
    /// The image's checksum does not fit its bytes.
    TableChecksum = 19,
    /// The image's header, axes, maps or records hold what no table may hold.
    TableContent = 20,
}

impl Status {
    const ALL: [Self; 15] = [
        Self::Ok,
        Self::Null,
        Self::Misaligned,
        Self::Length,
        Self::ShortBuffer,
        Self::NotANumber,
        Self::Side,
        Self::Law,
        Self::Slot,
        Self::NotLoaded,
        Self::TableMagic,
        Self::TableVersion,
        Self::TableLength,
        Self::TableChecksum,
        Self::TableContent,
    ];

    const fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Null => c"a pointer is NULL",
            Self::Misaligned => c"a pointer is not aligned for what it points to",
            Self::Length => c"a length is beyond what memory can hold",
            Self::ShortBuffer => c"the caller's room is too small",
            Self::NotANumber => c"an input is NaN, infinite or beyond its limit",
            Self::Side => c"no such side",
            Self::Law => c"no such creep law",
            Self::Slot => c"no such slot",
            Self::NotLoaded => c"the table was not loaded, or was moved after it was loaded",
            Self::TableMagic => c"not a contact table: it does not begin with FWT1",
            Self::TableVersion => c"a table of a format version that this library does not read",
            Self::TableLength => c"the table is shorter or longer than it says",
            Self::TableChecksum => c"the table is damaged: its checksum does not fit",
            Self::TableContent => c"the table holds what no table may hold",
        }
    }

    /// The code of an outcome.
    pub(crate) fn of(outcome: Result<(), Self>) -> i32 {
        match outcome {
            Ok(()) => Self::Ok as i32,
            Err(status) => status as i32,
        }
    }
}

impl From<TableError> for Status {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Magic { .. } => Self::TableMagic,
            TableError::Version { .. } => Self::TableVersion,
            TableError::NoPrelude { .. } | TableError::Truncated { .. } | TableError::TrailingBytes { .. } => {
                Self::TableLength
            }
            TableError::Checksum { .. } => Self::TableChecksum,
            _ => Self::TableContent,
        }
    }
}

/// A status in words; "no such status" for a number that is none. The text is constant and never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn flangeway_status_text(status: i32) -> *const c_char {
    let known = Status::ALL.into_iter().find(|known| *known as i32 == status);
    known.map_or(c"no such status", Status::text).as_ptr()
}
