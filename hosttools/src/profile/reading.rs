//! What the readers share: the raw contents of a file, its lines, words and numbers.

use std::path::Path;

use super::ProfileKind;
use crate::error::{Error, Result};

/// The family a file belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Simpack,
    MiniProf,
    Text,
}

impl Format {
    /// By what stands in the file, then by its extension.
    pub(super) fn of(path: &Path, content: &str) -> Self {
        let starts = |prefixes: &[&str]| {
            content.lines().any(|line| {
                let line = line.trim_start().to_ascii_lowercase();
                prefixes.iter().any(|p| line.starts_with(p))
            })
        };
        let extension = extension(path);
        if starts(&["header.begin", "spline.begin"]) || matches!(&*extension, "prw" | "prr") {
            Self::Simpack
        } else if starts(&["#mini", "columndef=", "xypoints="]) || matches!(&*extension, "whl" | "ban") {
            Self::MiniProf
        } else {
            Self::Text
        }
    }
}

/// The kind that an extension stands for in the Simpack and MiniProf families.
pub(super) fn kind_of_extension(path: &Path) -> Option<ProfileKind> {
    match &*extension(path) {
        "prw" | "whl" => Some(ProfileKind::Wheel),
        "prr" | "ban" => Some(ProfileKind::Rail),
        _ => None,
    }
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// A point as it stands in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Line, counted from 1.
    pub(super) line: usize,
    /// Lateral and vertical coordinate in the file's unit.
    pub(super) at: [f64; 2],
}

/// A file's contents before units, orientation and order are settled.
#[derive(Debug)]
pub(super) struct Reading {
    pub(super) format: Format,
    /// Wheel or rail, where the contents say so.
    pub(super) kind: Option<ProfileKind>,
    /// Metres in the file's unit, where the format fixes or the header gives it.
    pub(super) metres_per_unit: Option<f64>,
    pub(super) samples: Vec<Sample>,
    /// Mirroring of y and z that the header asks for.
    pub(super) mirror: [bool; 2],
    /// Points closer to each other are dropped; in the unit of the file until it is placed.
    pub(super) least_distance: f64,
    pub(super) smoothing: f64,
    pub(super) recognised: Vec<String>,
}

impl Reading {
    pub(super) fn new(format: Format, dialect: impl Into<String>) -> Self {
        Self {
            format,
            kind: None,
            metres_per_unit: None,
            samples: Vec::new(),
            mirror: [false; 2],
            least_distance: 0.0,
            smoothing: 0.0,
            recognised: vec![dialect.into()],
        }
    }
}

/// The lines of a text with their numbers from 1, trimmed.
pub(super) fn lines(content: &str) -> impl Iterator<Item = (usize, &str)> {
    content.lines().enumerate().map(|(i, line)| (i + 1, line.trim()))
}

/// The non-empty words between blanks, tabs, commas and semicolons.
pub(super) fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty())
}

/// A number as it may stand in a profile file; Fortran's exponent letter D is allowed.
pub(super) fn parse(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| word.replace(['d', 'D'], "e").parse().ok())
}

/// A finite number, or an error that names line and value.
pub(super) fn number(path: &Path, line: usize, what: &str, word: &str) -> Result<f64> {
    match parse(word) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(Error::line(path, line, format!("{what} is {}, not a finite number", excerpt(word)))),
        None => Err(Error::line(path, line, format!("{what} is {}, not a number", excerpt(word)))),
    }
}

/// The beginning of a text, quoted and with control characters escaped.
pub(super) fn excerpt(text: &str) -> String {
    let beginning: String = text.chars().take(40).collect();
    let more = if beginning.len() < text.len() { "..." } else { "" };
    format!("\"{}{more}\"", beginning.escape_debug())
}

/// "1 point", "2 points".
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// "line 3", "lines 3, 4, 5 and 2 more".
pub(super) fn list(lines: &[usize]) -> String {
    let shown: Vec<String> = lines.iter().take(6).map(usize::to_string).collect();
    let noun = if lines.len() == 1 { "line" } else { "lines" };
    let more = lines.len() - shown.len();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{noun} {}{rest}", shown.join(", "))
}
