//! Simpack profile files (`.prw` wheels, `.prr` rails).
//!
//! The `spline` section's modifications are applied in the order in which the files number them: least distance of
//! points, shift, rotation, bounds, mirroring, inversion, units. Points outside the y bounds are left out, points
//! outside the z bounds are clipped to them; bounds whose minimum is not below the maximum are none. The order of
//! points is settled by [`super::cleanup`] whatever `inversion` says. Mirrored as the header asks, y is positive to
//! the field side.

use std::path::Path;

use super::ProfileKind;
use super::reading::{Format, Reading, Sample, counted, excerpt, lines, number, parse, words};
use crate::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    Outside,
    Header,
    Spline,
    Points,
    Finished,
}

impl Section {
    /// The section after a `*.begin` or `*.end` line, `None` where that line does not belong.
    fn after(self, word: &str) -> Option<Self> {
        match (self, word) {
            (Self::Outside, "header.begin") => Some(Self::Header),
            (Self::Header, "header.end") => Some(Self::Outside),
            (Self::Outside, "spline.begin") | (Self::Points, "point.end") => Some(Self::Spline),
            (Self::Spline, "point.begin") => Some(Self::Points),
            (Self::Spline, "spline.end") => Some(Self::Finished),
            _ => None,
        }
    }
}

/// The modifications of the `spline` section, in the file's units.
struct Settings {
    shift: [f64; 2],
    rotate: f64,
    /// Angle units in a radian.
    angle_factor: f64,
    /// Minimum and maximum of y, then of z.
    bounds: [[f64; 2]; 2],
}

pub(super) fn read(path: &Path, content: &str) -> Result<Reading> {
    let mut reading = Reading::new(Format::Simpack, "Simpack profile");
    let mut settings = Settings { shift: [0.0; 2], rotate: 0.0, angle_factor: 1.0, bounds: [[0.0; 2]; 2] };
    let mut section = Section::Outside;
    let (mut commented_out, mut last_line) = (0_usize, 0);
    for (line, raw) in lines(content) {
        last_line = line;
        let text = without_comment(raw).trim();
        if text.is_empty() {
            let comment: Vec<&str> = words(raw.trim_start_matches('!')).collect();
            let is_point = comment.len() >= 2 && comment.iter().all(|word| parse(word).is_some());
            commented_out += usize::from(section == Section::Points && is_point);
            continue;
        }
        let word = text.to_ascii_lowercase();
        if word.ends_with(".begin") || word.ends_with(".end") {
            section = section
                .after(&word)
                .ok_or_else(|| Error::line(path, line, format!("{} does not belong here", excerpt(text))))?;
            continue;
        }
        match section {
            Section::Points => reading.samples.push(point(path, line, text)?),
            Section::Header | Section::Spline => {
                let (key, value) = text
                    .split_once('=')
                    .ok_or_else(|| Error::line(path, line, format!("{} is not `key = value`", excerpt(text))))?;
                let key = key.trim().to_ascii_lowercase();
                setting(path, line, section, &key, value.trim(), &mut settings, &mut reading)?;
            }
            Section::Outside | Section::Finished => {
                return Err(Error::line(path, line, format!("{} stands outside the sections", excerpt(text))));
            }
        }
    }
    if section != Section::Finished {
        return Err(Error::line(path, last_line.max(1), "the file ends before its spline.end"));
    }
    if commented_out > 0 {
        reading.recognised.push(format!("{} commented out in the file", counted(commented_out, "point")));
    }
    modify(&settings, &mut reading);
    Ok(reading)
}

/// Takes one `key = value` line of the header or spline section.
fn setting(
    path: &Path,
    line: usize,
    section: Section,
    key: &str,
    value: &str,
    settings: &mut Settings,
    reading: &mut Reading,
) -> Result<()> {
    let float = || number(path, line, key, value);
    let factor = || match float()? {
        factor if factor > 0.0 => Ok(factor),
        factor => Err(Error::line(path, line, format!("{key} is {factor}, a unit factor is positive"))),
    };
    let flag = || match float()? {
        0.0 => Ok(false),
        1.0 => Ok(true),
        other => Err(Error::line(path, line, format!("{key} is {other}, not 0 or 1"))),
    };
    match (section, key) {
        (Section::Header, "type") => {
            reading.kind = Some(if flag()? { ProfileKind::Wheel } else { ProfileKind::Rail });
        }
        (Section::Spline, "approx.smooth") => {
            reading.smoothing = float()?;
            if reading.smoothing < 0.0 {
                return Err(Error::line(path, line, format!("{key} is {value}, smoothing is zero or more")));
            }
            if reading.smoothing > 0.0 {
                reading.recognised.push(format!("the file asks for smoothing, approx.smooth = {}", reading.smoothing));
            }
        }
        (Section::Spline, "comment") => {
            let comment = value.trim_matches('\'').trim();
            if !comment.is_empty() {
                reading.recognised.push(format!("comment: {comment}"));
            }
        }
        (Section::Spline, "point.dist.min") => reading.least_distance = float()?.max(0.0),
        (Section::Spline, "shift.y") => settings.shift[0] = float()?,
        (Section::Spline, "shift.z") => settings.shift[1] = float()?,
        (Section::Spline, "rotate") => settings.rotate = float()?,
        (Section::Spline, "bound.y.min") => settings.bounds[0][0] = float()?,
        (Section::Spline, "bound.y.max") => settings.bounds[0][1] = float()?,
        (Section::Spline, "bound.z.min") => settings.bounds[1][0] = float()?,
        (Section::Spline, "bound.z.max") => settings.bounds[1][1] = float()?,
        (Section::Spline, "mirror.y") => reading.mirror[0] = flag()?,
        (Section::Spline, "mirror.z") => reading.mirror[1] = flag()?,
        (Section::Spline, "inversion") => drop(flag()?),
        (Section::Spline, "units.len.f") => reading.metres_per_unit = Some(1.0 / factor()?),
        (Section::Spline, "units.ang.f") => settings.angle_factor = factor()?,
        (Section::Header, "version")
        | (Section::Spline, "file" | "file.mtime" | "type" | "units.len" | "units.ang") => {}
        _ => reading.recognised.push(format!("line {line}: key {} is not known and left alone", excerpt(key))),
    }
    Ok(())
}

/// y, z and perhaps a weight, which is not used.
fn point(path: &Path, line: usize, text: &str) -> Result<Sample> {
    let mut words = words(text);
    let mut next = |what| match words.next() {
        Some(word) => number(path, line, what, word),
        None => Err(Error::line(path, line, format!("{what} is missing in {}", excerpt(text)))),
    };
    let at = [next("y")?, next("z")?];
    if let Some(weight) = words.next() {
        number(path, line, "weight", weight)?;
    }
    match words.next() {
        Some(word) => Err(Error::line(path, line, format!("{} follows y, z and weight", excerpt(word)))),
        None => Ok(Sample { line, at }),
    }
}

/// Applies shift, rotation and bounds; mirroring and units are common to all formats.
fn modify(settings: &Settings, reading: &mut Reading) {
    let Settings { shift, rotate, angle_factor, bounds } = *settings;
    if shift != [0.0; 2] {
        reading.recognised.push(format!("shifted by y {}, z {} file units as the file asks", shift[0], shift[1]));
    }
    // right-handed about x (forward) with y to the right and z down: y' = y cos φ - z sin φ, z' = y sin φ + z cos φ
    let angle = rotate / angle_factor;
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    if angle != 0.0 {
        reading.recognised.push(format!("rotated by {angle} rad about x as the file asks"));
    }
    for sample in &mut reading.samples {
        let (y, z) = (sample.at[0] + shift[0], sample.at[1] + shift[1]);
        sample.at = [y * cos - z * sin, y * sin + z * cos];
    }
    let [[y_min, y_max], [z_min, z_max]] = bounds;
    if y_min < y_max {
        let before = reading.samples.len();
        reading.samples.retain(|s| (y_min..=y_max).contains(&s.at[0]));
        let left_out = before - reading.samples.len();
        reading
            .recognised
            .push(format!("{} outside y {y_min} to {y_max} left out as the file asks", counted(left_out, "point")));
    }
    if z_min < z_max {
        let mut clipped = 0;
        for sample in &mut reading.samples {
            clipped += usize::from(!(z_min..=z_max).contains(&sample.at[1]));
            sample.at[1] = sample.at[1].clamp(z_min, z_max);
        }
        reading
            .recognised
            .push(format!("{} clipped to z {z_min} to {z_max} as the file asks", counted(clipped, "point")));
    }
}

/// The line up to a `!` or `%` that does not stand between single quotes.
fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    let end = line.find(|c| {
        quoted ^= c == '\'';
        !quoted && matches!(c, '!' | '%')
    });
    end.map_or(line, |end| &line[..end])
}
