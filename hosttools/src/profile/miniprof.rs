//! MiniProf measurements (`.whl` wheels, `.ban` rails) in their dialects.
//!
//! The header is `key=value` lines, or free text under a `#MINIWHEELPROF` line, and ends at the first blank line. Then
//! come columns as `ColumnDef` says (X and Y first where it says nothing), split by blanks, tabs or commas; what
//! follows the columns is a remark. A line that begins with `"` is commented out, in the header as among the points.
//! Lengths are millimetres. A wheel's X grows from the flange back to the field side, a rail's X is positive to the
//! gauge side; Y points up in some files and down in others, which the shape tells.

use std::path::Path;

use super::ProfileKind;
use super::reading::{Format, Reading, Sample, counted, excerpt, lines, list, number, parse, words};
use crate::error::{Error, Result};

/// What the header tells about the points.
struct Header {
    /// Column of X and of Y, counted from 0.
    columns: [usize; 2],
    /// Number of columns, where the header gives it.
    column_count: Option<usize>,
    point_count: Option<f64>,
    offset: [f64; 2],
}

/// Words after the columns of a point.
#[derive(Default)]
struct Remarks {
    lines: Vec<usize>,
    first: Option<String>,
}

pub(super) fn read(path: &Path, content: &str) -> Result<Reading> {
    let mut reading = Reading::new(Format::MiniProf, "MiniProf measurement");
    let mut header = Header { columns: [0, 1], column_count: None, point_count: None, offset: [0.0; 2] };
    let mut in_header = true;
    let mut free_text = false;
    let (mut commented_out, mut remarks) = (0_usize, Remarks::default());
    for (line, text) in lines(content) {
        if line == 1 && text.to_ascii_uppercase().starts_with("#MINI") {
            free_text = true;
            reading.recognised.push(format!("header of the {text} dialect, free text to the first blank line"));
            reading.kind = kind_of_dialect(text);
        } else if text.is_empty() {
            in_header &= line == 1;
        } else if let Some(commented) = text.strip_prefix('"') {
            let is_point = words(commented).take(2).filter(|word| parse(word).is_some()).count() == 2;
            commented_out += usize::from(!in_header && is_point);
        } else if text.starts_with(['!', '%', '#']) {
            // a comment
        } else if in_header && free_text {
            note(text, &mut reading);
        } else if in_header && text.contains('=') {
            keyword(path, line, text, &mut header, &mut reading)?;
        } else if !in_header && text.contains('=') {
            return Err(Error::line(path, line, format!("header line {} follows the points", excerpt(text))));
        } else {
            in_header = false;
            reading.samples.push(point(path, line, text, &header, &mut remarks)?);
        }
    }
    if commented_out > 0 {
        reading.recognised.push(format!("{} commented out in the file", counted(commented_out, "point")));
    }
    if let Some(first) = remarks.first {
        reading.recognised.push(format!("remarks after the columns on {}, the first {first}", list(&remarks.lines)));
    }
    finish(&header, &mut reading);
    Ok(reading)
}

fn kind_of_dialect(text: &str) -> Option<ProfileKind> {
    let text = text.to_ascii_uppercase();
    match (text.contains("WHEEL"), text.contains("RAIL")) {
        (true, false) => Some(ProfileKind::Wheel),
        (false, true) => Some(ProfileKind::Rail),
        _ => None,
    }
}

/// Keeps a line of a free-text header that says something.
fn note(text: &str, reading: &mut Reading) {
    if !text.ends_with(':') && !text.starts_with('(') {
        reading.recognised.push(format!("comment: {text}"));
    }
}

/// Takes one `key=value` line; only what bears on the points is used.
fn keyword(path: &Path, line: usize, text: &str, header: &mut Header, reading: &mut Reading) -> Result<()> {
    let (key, value) = text.split_once('=').unwrap_or((text, ""));
    let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
    if value.is_empty() {
        return Ok(());
    }
    match &*key {
        "columndef" => {
            let names: Vec<String> = words(value).map(str::to_ascii_uppercase).collect();
            let column = |name: &str| names.iter().position(|n| n == name);
            let (Some(x), Some(y)) = (column("X"), column("Y")) else {
                return Err(Error::line(path, line, format!("ColumnDef {} has no X and Y", excerpt(value))));
            };
            header.columns = [x, y];
            header.column_count = (!names.iter().any(|n| n == "*")).then_some(names.len());
            reading.recognised.push(format!("columns {}", names.join(", ")));
        }
        "xypoints" => header.point_count = Some(number(path, line, "XYPoints", value)?),
        "xoffset" => header.offset[0] = number(path, line, "XOffset", value)?,
        "yoffset" => header.offset[1] = number(path, line, "YOffset", value)?,
        "comment" => reading.recognised.push(format!("comment: {value}")),
        _ => {}
    }
    Ok(())
}

fn point(path: &Path, line: usize, text: &str, header: &Header, remarks: &mut Remarks) -> Result<Sample> {
    let words: Vec<&str> = words(text).collect();
    let coordinate = |what: &str, column: usize| match words.get(column) {
        Some(word) => number(path, line, what, word),
        None => Err(Error::line(path, line, format!("{what} is missing in {}", excerpt(text)))),
    };
    let [x, y] = header.columns;
    let at = [coordinate("X", x)?, coordinate("Y", y)?];
    let count = header.column_count.unwrap_or(words.len());
    for (i, word) in words.iter().enumerate().take(count) {
        if parse(word).is_none() {
            return Err(Error::line(path, line, format!("column {} is {}, not a number", i + 1, excerpt(word))));
        }
    }
    if let Some(remark) = words.get(count..).filter(|rest| !rest.is_empty()) {
        remarks.first.get_or_insert_with(|| excerpt(&remark.join(" ")));
        remarks.lines.push(line);
    }
    Ok(Sample { line, at })
}

fn finish(header: &Header, reading: &mut Reading) {
    if let Some(count) = header.point_count.filter(|&count| count != reading.samples.len() as f64) {
        let found = reading.samples.len();
        reading.recognised.push(format!("the header counts {count} points, {found} are in use"));
    }
    let offset = header.offset;
    if offset != [0.0; 2] {
        reading.recognised.push(format!("offset X {}, Y {} added as the header asks", offset[0], offset[1]));
    }
    for sample in &mut reading.samples {
        sample.at = [sample.at[0] + offset[0], sample.at[1] + offset[1]];
    }
}
