//! The one error type of the host tools: what is wrong, where, and with which value.

use std::fmt;
use std::path::{Path, PathBuf};

/// Result of everything in the host tools that reads input or writes output.
pub type Result<T> = std::result::Result<T, Error>;

/// Where in a file something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line, counted from 1.
    Line(usize),
    /// A field by its dotted name (`wheel.nominal_radius_m`) or column name.
    Field(String),
    /// A byte offset of a binary file, counted from 0.
    Byte(usize),
}

/// Bad input or failed output: the program prints it in one line and ends with exit status 2.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    /// File the error is about; empty where there is none (a built-in, an option).
    pub path: PathBuf,
    /// Place in that file.
    pub place: Place,
    /// What is wrong, with the offending value.
    pub message: String,
}

impl Error {
    /// An error about a file as a whole.
    pub fn file(path: impl AsRef<Path>, message: impl Into<String>) -> Self {
        Self { path: path.as_ref().into(), place: Place::Whole, message: message.into() }
    }

    /// An error on a line of a text file (counted from 1).
    pub fn line(path: impl AsRef<Path>, line: usize, message: impl Into<String>) -> Self {
        Self { path: path.as_ref().into(), place: Place::Line(line), message: message.into() }
    }

    /// An error about a field of a recipe, scenario or CSV file.
    pub fn field(path: impl AsRef<Path>, field: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.as_ref().into(), place: Place::Field(field.into()), message: message.into() }
    }

    /// An error at a byte of a binary file (counted from 0).
    pub fn byte(path: impl AsRef<Path>, offset: usize, message: impl Into<String>) -> Self {
        Self { path: path.as_ref().into(), place: Place::Byte(offset), message: message.into() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = !self.path.as_os_str().is_empty();
        if named {
            write!(f, "{}", self.path.display())?;
        }
        match &self.place {
            Place::Whole if named => write!(f, ": ")?,
            Place::Whole => {}
            Place::Line(line) => write!(f, ":{line}: ")?,
            Place::Field(field) if named => write!(f, ": {field}: ")?,
            Place::Field(field) => write!(f, "{field}: ")?,
            Place::Byte(offset) => write!(f, ": byte {offset}: ")?,
        }
        f.write_str(&self.message)
    }
}
