//! Order and repetition: from points as measured to a contour that runs from the flange or gauge side to the field
//! side without coming back on itself.

use std::path::Path;

use super::reading::{counted, list};
use crate::error::{Error, Result};

/// Points closer (m) to their predecessor are repetitions. Files print to a nanometre at best, and half of that shows
/// as a curvature of 6 x 0.5 nm / spacing²: 30 1/m at this spacing, which no contact is wide enough to see.
const REPEATED: f64 = 1e-5;
/// Noise may run back (m) along the contour by this much; the points that do are dropped.
const MOST_BACKWARD: f64 = 1e-3;
/// Segments on each side of a point whose mean direction is the contour's there.
const WINDOW: usize = 5;
/// cos 150°: a contour that heads further back than this towards the flange side is not one head or tread.
const MOST_REVERSED: f64 = -0.866;
/// Fewest points of a contour.
const FEWEST: usize = 5;

/// Puts the points in order and drops what repeats or runs back; the lines stay beside their points.
pub(super) fn clean(
    path: &Path,
    points: Vec<[f64; 2]>,
    lines: Vec<usize>,
    least_distance: f64,
    said: &mut Vec<String>,
) -> Result<(Vec<[f64; 2]>, Vec<usize>)> {
    let mut contour: Vec<([f64; 2], usize)> = points.into_iter().zip(lines).collect();
    turn_to_field_side(path, &mut contour, said)?;
    drop_repeated(&mut contour, least_distance.max(REPEATED), said);
    if contour.len() < FEWEST {
        let count = contour.len();
        return Err(Error::file(path, format!("has {count} distinct points, a contour needs {FEWEST} or more")));
    }
    drop_backward(path, &mut contour, said)?;
    refuse_crossing(path, &contour)?;
    Ok(contour.into_iter().unzip())
}

fn turn_to_field_side(path: &Path, contour: &mut [([f64; 2], usize)], said: &mut Vec<String>) -> Result<()> {
    let (Some((first, line)), Some((last, last_line))) = (contour.first(), contour.last()) else {
        return Ok(());
    };
    let (low, high) = contour.iter().fold((f64::MAX, f64::MIN), |(low, high), (p, _)| (low.min(p[0]), high.max(p[0])));
    let advance = last[0] - first[0];
    if advance.abs() < 0.2 * (high - low) {
        let message = format!(
            "the points end {:.3} mm from where they begin on line {line}, in no order from the flange or gauge side \
             to the field side",
            1e3 * advance.abs()
        );
        return Err(Error::line(path, *last_line, message));
    }
    if advance < 0.0 {
        contour.reverse();
        said.push("order reversed: the file begins on the field side".into());
    }
    Ok(())
}

/// Drops repetitions; the end points stay.
fn drop_repeated(contour: &mut Vec<([f64; 2], usize)>, least: f64, said: &mut Vec<String>) {
    let Some(&last) = contour.last() else { return };
    let before = contour.len();
    let mut first_line = usize::MAX;
    contour.dedup_by(|next, kept| {
        let repeated = distance(next.0, kept.0) < least;
        if repeated {
            first_line = first_line.min(next.1);
        }
        repeated
    });
    if let Some(end) = contour.last_mut() {
        *end = last;
    }
    let dropped = before - contour.len();
    if dropped > 0 {
        let (points, least) = (counted(dropped, "repeated point"), 1e3 * least);
        said.push(format!("{points} (closer than {least} mm) dropped, the first on line {first_line}"));
    }
}

/// Drops points by which noise runs back along the contour, and refuses a contour that really turns back.
fn drop_backward(path: &Path, contour: &mut Vec<([f64; 2], usize)>, said: &mut Vec<String>) -> Result<()> {
    let headings: Vec<[f64; 2]> = contour
        .windows(2)
        .map(|w| {
            let step = distance(w[0].0, w[1].0);
            [(w[1].0[0] - w[0].0[0]) / step, (w[1].0[1] - w[0].0[1]) / step]
        })
        .collect();
    let mut kept: Vec<([f64; 2], usize)> = Vec::with_capacity(contour.len());
    let mut dropped = Vec::new();
    for (i, &(p, line)) in contour.iter().enumerate() {
        let (first, last) = (i.saturating_sub(WINDOW), (i + WINDOW).min(headings.len()));
        let (before, after) = (sum(&headings[first..i]), sum(&headings[i..last]));
        let heading = [before[0] + after[0], before[1] + after[1]];
        let length = libm::hypot(heading[0], heading[1]);
        if length < 0.2 * (last - first) as f64 {
            return Err(Error::line(path, line, "the points zig-zag here and are in no order along a contour"));
        }
        if heading[0] < MOST_REVERSED * length {
            return Err(Error::line(path, line, "the contour runs back to the flange or gauge side here"));
        }
        let Some(&(from, _)) = kept.last() else {
            kept.push((p, line));
            continue;
        };
        // at a sharp corner a point is ahead in the direction of one side only
        let ahead = [before, after].into_iter().map(|heading| advance(from, p, heading)).fold(f64::MIN, f64::max);
        if ahead > 0.0 {
            kept.push((p, line));
        } else if ahead > -MOST_BACKWARD {
            dropped.push(line);
        } else {
            return Err(Error::line(path, line, format!("the contour runs back by {:.3} mm here", -1e3 * ahead)));
        }
    }
    if !dropped.is_empty() {
        dropped.sort_unstable();
        let points = counted(dropped.len(), "point");
        said.push(format!("{points} dropped where the contour runs back by noise, on {}", list(&dropped)));
    }
    if kept.len() < FEWEST {
        let count = kept.len();
        return Err(Error::file(path, format!("has {count} points in order, a contour needs {FEWEST} or more")));
    }
    *contour = kept;
    Ok(())
}

/// Distance (m) from one point to another along a heading; nothing along none.
fn advance(from: [f64; 2], to: [f64; 2], heading: [f64; 2]) -> f64 {
    let length = libm::hypot(heading[0], heading[1]);
    let along = (to[0] - from[0]) * heading[0] + (to[1] - from[1]) * heading[1];
    if length > 0.0 { along / length } else { f64::MIN }
}

fn sum(headings: &[[f64; 2]]) -> [f64; 2] {
    headings.iter().fold([0.0, 0.0], |s, h| [s[0] + h[0], s[1] + h[1]])
}

fn refuse_crossing(path: &Path, contour: &[([f64; 2], usize)]) -> Result<()> {
    for i in 0..contour.len().saturating_sub(1) {
        let (a, b) = (contour[i].0, contour[i + 1].0);
        for j in i + 2..contour.len().saturating_sub(1) {
            if cross(a, b, contour[j].0, contour[j + 1].0) {
                let (line, other) = (contour[j].1, contour[i].1);
                return Err(Error::line(path, line, format!("the contour crosses itself, its part from line {other}")));
            }
        }
    }
    Ok(())
}

/// Whether the segments a-b and c-d share a point other than by touching with an end.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
    if apart(0) || apart(1) {
        return false;
    }
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}
