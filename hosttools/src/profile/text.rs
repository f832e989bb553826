//! Plain text and CSV: two columns, lateral and vertical coordinate.
//!
//! Columns are split by semicolons, commas, or blanks and tabs; `#`, `!` and `%` begin comments; one header line is
//! allowed, and a unit in it (`y_m`, `y [mm]`, `y (inch)`) is taken. With semicolons or tabs as separators a comma is
//! a decimal comma.

use std::path::Path;

use super::LengthUnit;
use super::reading::{Format, Reading, Sample, excerpt, lines, number, parse};
use crate::error::{Error, Result};

pub(super) fn read(path: &Path, content: &str) -> Result<Reading> {
    let mut reading = Reading::new(Format::Text, "plain text in two columns");
    let mut decimal_comma = false;
    let mut header_seen = false;
    for (line, raw) in lines(content) {
        let text = raw.split(['#', '!', '%']).next().unwrap_or_default().trim();
        if text.is_empty() {
            continue;
        }
        let (columns, commas) = columns(text);
        let is_header = reading.samples.is_empty() && !header_seen && columns.iter().all(|c| parse(c).is_none());
        if is_header {
            header_seen = true;
            reading.recognised.push(format!("header line {}", excerpt(text)));
            reading.metres_per_unit = unit_in(text).map(LengthUnit::metres);
            continue;
        }
        let [y, z] = columns.as_slice() else {
            let found = columns.len();
            return Err(Error::line(path, line, format!("{} has {found} columns where two are wanted", excerpt(text))));
        };
        decimal_comma |= commas;
        reading.samples.push(Sample { line, at: [number(path, line, "y", y)?, number(path, line, "z", z)?] });
    }
    if decimal_comma {
        reading.recognised.push("decimal commas".into());
    }
    Ok(reading)
}

/// A line's columns, and whether decimal commas were turned into points.
fn columns(text: &str) -> (Vec<String>, bool) {
    let tidy = |column: &str| column.trim().trim_matches('"').trim().to_owned();
    if let Some(separator) = [';', '\t'].into_iter().find(|&s| text.contains(s)) {
        let parts = text.split(separator).map(tidy).filter(|part| separator == ';' || !part.is_empty());
        let mut commas = false;
        let parts = parts.map(|part| match part.split_once(',') {
            Some((whole, rest)) if parse(&format!("{whole}.{rest}")).is_some() => {
                commas = true;
                format!("{whole}.{rest}")
            }
            _ => part.trim_end_matches(',').to_owned(),
        });
        (parts.collect(), commas)
    } else if text.contains(',') {
        (text.split(',').map(tidy).collect(), false)
    } else {
        (text.split_whitespace().map(tidy).collect(), false)
    }
}

/// The unit that a header line names.
fn unit_in(header: &str) -> Option<LengthUnit> {
    let header = header.to_ascii_lowercase();
    let names = |units: &[&str]| header.split(|c: char| !c.is_ascii_alphanumeric()).any(|word| units.contains(&word));
    if names(&["mm"]) {
        Some(LengthUnit::Mm)
    } else if names(&["m"]) {
        Some(LengthUnit::M)
    } else if names(&["inch", "inches"]) {
        Some(LengthUnit::Inch)
    } else {
        None
    }
}
