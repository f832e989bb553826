//! Units and orientation: from a file's numbers to metres with y to the field side and z down.

use std::path::Path;

use super::reading::{Format, Reading};
use super::{LengthUnit, ProfileKind, ReadOptions};
use crate::error::{Error, Result};

/// Widths (m) that a wheel or rail contour can have.
const WIDTHS: std::ops::RangeInclusive<f64> = 0.001..=1.0;
/// Largest coordinate (m) that is taken for one.
const FARTHEST: f64 = 10.0;
/// More points than any profile has.
const MOST_POINTS: usize = 20_000;

/// The contour in metres in the common frame, and each point's line in the file; the reading's least distance of
/// points becomes metres too.
pub(super) fn place(
    path: &Path,
    reading: &mut Reading,
    kind: ProfileKind,
    options: &ReadOptions,
) -> Result<(Vec<[f64; 2]>, Vec<usize>)> {
    let count = reading.samples.len();
    if count == 0 {
        return Err(Error::file(path, "holds no points"));
    }
    if count > MOST_POINTS {
        return Err(Error::file(path, format!("holds {count} points, more than the {MOST_POINTS} allowed")));
    }
    let metres = metres_per_unit(path, reading, options)?;
    reading.least_distance *= metres;
    let mut points: Vec<[f64; 2]> = reading.samples.iter().map(|s| [s.at[0] * metres, s.at[1] * metres]).collect();
    let lines: Vec<usize> = reading.samples.iter().map(|s| s.line).collect();
    if let Some((p, line)) = points.iter().zip(&lines).find(|(p, _)| p.iter().any(|c| c.abs() > FARTHEST)) {
        return Err(Error::line(path, *line, format!("the point ({} m, {} m) is too far out", p[0], p[1])));
    }
    let width = width(&points);
    if !WIDTHS.contains(&width) {
        let least = WIDTHS.start();
        let most = WIDTHS.end();
        return Err(Error::file(path, format!("is {width} m wide; a contour is {least} m to {most} m wide")));
    }

    let said = &mut reading.recognised;
    let rail_x_to_gauge = reading.format == Format::MiniProf && kind == ProfileKind::Rail;
    if options.mirror_y.unwrap_or(reading.mirror[0] || rail_x_to_gauge) {
        mirror(&mut points, 0);
        said.push(match options.mirror_y {
            Some(_) => "y mirrored as asked".into(),
            None if rail_x_to_gauge => "y mirrored: a MiniProf rail's X is positive to the gauge side".into(),
            None => "y mirrored as the file asks".into(),
        });
    }
    if options.mirror_z.unwrap_or(reading.mirror[1]) {
        mirror(&mut points, 1);
        said.push(
            if options.mirror_z.is_some() { "z mirrored as asked" } else { "z mirrored as the file asks" }.into(),
        );
    }
    match upside_down(&points, kind) {
        Some(true) if options.mirror_z.is_none() => {
            mirror(&mut points, 1);
            said.push(format!("z mirrored: by the shape of the {kind}, the file's z points up"));
        }
        Some(true) => said.push(format!("by its shape the {kind} is upside down, mirrored as asked")),
        Some(false) => {}
        None => said.push("the shape does not tell up from down; z is taken to point down".into()),
    }
    if kind == ProfileKind::Wheel && flange_on_field_side(&points) {
        if options.mirror_y.is_none() {
            mirror(&mut points, 0);
            said.push("y mirrored: by the shape of the wheel, the flange was on the field side".into());
        } else {
            said.push("by its shape the wheel has its flange on the field side, mirrored as asked".into());
        }
    }
    Ok((points, lines))
}

/// The unit given, fixed by the format or header, or guessed from the width.
fn metres_per_unit(path: &Path, reading: &mut Reading, options: &ReadOptions) -> Result<f64> {
    if let Some(unit) = options.length_unit {
        reading.recognised.push(format!("lengths in {} as asked", unit_name(unit.metres())));
        return Ok(unit.metres());
    }
    if let Some(metres) = reading.metres_per_unit {
        reading.recognised.push(format!("lengths in {} by the header", unit_name(metres)));
        return Ok(metres);
    }
    let raw: Vec<[f64; 2]> = reading.samples.iter().map(|s| s.at).collect();
    let width = width(&raw);
    let unit = match width {
        w if w > 10.0 => LengthUnit::Mm,
        w if w < 1.0 => LengthUnit::M,
        _ => {
            let message = format!("is {width} units wide, which is neither millimetres nor metres; give its unit");
            return Err(Error::file(path, message));
        }
    };
    let name = unit_name(unit.metres());
    reading.recognised.push(format!("lengths taken as {name}, the contour being {width:.4} units wide"));
    Ok(unit.metres())
}

fn unit_name(metres: f64) -> String {
    let known = [(LengthUnit::M, "metres"), (LengthUnit::Mm, "millimetres"), (LengthUnit::Inch, "inches")];
    let known = known.into_iter().find(|(unit, _)| (unit.metres() / metres - 1.0).abs() < 1e-12);
    known.map_or_else(|| format!("units of {metres} m"), |(_, name)| name.into())
}

fn width(points: &[[f64; 2]]) -> f64 {
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[0]), high.max(p[0])));
    high - low
}

fn mirror(points: &mut [[f64; 2]], axis: usize) {
    for p in points {
        p[axis] = -p[axis];
    }
}

/// Whether the shape says that z points up; `None` where it does not tell (a cone, a plane).
///
/// A whole contour bulges away from its body: the flange tip down, the rail crown up. A contour cut off at its flange
/// or gauge face has no bulge, but that face leads down from the middle height in both cases.
fn upside_down(points: &[[f64; 2]], kind: ProfileKind) -> Option<bool> {
    let (down, up) = (bulge(points, 1.0), bulge(points, -1.0));
    if down.max(up) > 1e-3 && (down > 3.0 * up || up > 3.0 * down) {
        return Some((down > up) != (kind == ProfileKind::Wheel));
    }
    let middle = middle_height(points);
    let (below, above) = points
        .iter()
        .fold((0.0_f64, 0.0_f64), |(below, above), p| (below.max(p[1] - middle), above.max(middle - p[1])));
    (below.max(above) > 3e-3 && (below > 2.0 * above || above > 2.0 * below)).then_some(above > below)
}

/// The largest height (m) of a peak of `sign * z` over both of its sides.
fn bulge(points: &[[f64; 2]], sign: f64) -> f64 {
    let lowest = |low: &mut f64, p: &[f64; 2]| {
        *low = low.min(sign * p[1]);
        Some(*low)
    };
    let left: Vec<f64> = points.iter().scan(f64::MAX, lowest).collect();
    let mut right: Vec<f64> = points.iter().rev().scan(f64::MAX, lowest).collect();
    right.reverse();
    points.iter().zip(left.iter().zip(&right)).fold(0.0, |most, (p, (l, r))| most.max(sign * p[1] - l.max(*r)))
}

/// The height (m) that half of the contour's width lies below.
fn middle_height(points: &[[f64; 2]]) -> f64 {
    let mut spans: Vec<(f64, f64)> =
        points.windows(2).map(|w| (0.5 * (w[0][1] + w[1][1]), (w[1][0] - w[0][0]).abs())).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * spans.iter().map(|s| s.1).sum::<f64>();
    let mut reached = 0.0;
    let middle = spans.iter().find(|s| {
        reached += s.1;
        reached >= half
    });
    middle.map_or(0.0, |s| s.0)
}

/// Whether a wheel (z down) has a flange, and that at positive y.
fn flange_on_field_side(points: &[[f64; 2]]) -> bool {
    let deepest = points.iter().fold([0.0, f64::MIN], |tip, &p| if p[1] > tip[1] { p } else { tip });
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[0]), high.max(p[0])));
    let has_flange = deepest[1] - middle_height(points) > 8e-3;
    has_flange && deepest[0] > low + 0.6 * (high - low)
}
