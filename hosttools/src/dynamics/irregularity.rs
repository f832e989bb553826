//! How the rails deviate from the track: lateral alignment, vertical profile, cross level, measured or generated.

use std::path::Path;

use crate::error::{Error, Result};

/// Deviation of the rails at one place, or its slope (per m).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Offsets {
    /// Lateral alignment of both rails, positive to the right, m.
    pub lateral: f64,
    /// Vertical profile of both rails, positive down, m.
    pub vertical: f64,
    /// Cross level as an angle about x, positive where the right rail is lower, rad.
    pub cross_level: f64,
}

impl Offsets {
    fn numbers(self) -> [f64; 3] {
        [self.lateral, self.vertical, self.cross_level]
    }

    fn of([lateral, vertical, cross_level]: [f64; 3]) -> Self {
        Self { lateral, vertical, cross_level }
    }
}

/// Over this distance (m) a series rises from nothing at its begin and falls to nothing at its end.
const FADE: f64 = 10.0;

const COLUMNS: [&str; 4] = ["s_m", "lateral_m", "vertical_m", "cross_level_rad"];

/// A series of deviations over the distance, smooth between its samples (cubic, with the slopes of the neighbours'
/// chords, so that the rails have a continuous direction), faded in and out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Irregularity {
    samples: Vec<(f64, Offsets)>,
}

impl Irregularity {
    /// A series of distance (m, strictly increasing) and deviation.
    #[must_use]
    pub fn new(samples: Vec<(f64, Offsets)>) -> Self {
        Self { samples }
    }

    /// The samples.
    #[must_use]
    pub fn samples(&self) -> &[(f64, Offsets)] {
        &self.samples
    }

    /// Reads a CSV file with the columns `s_m,lateral_m,vertical_m,cross_level_rad`, in any order, without others.
    ///
    /// # Errors
    /// When the file cannot be read, a column is missing or unknown, a field is no number below 1 m, the distance does
    /// not increase, or there are fewer than two rows.
    pub fn read(path: &Path) -> Result<Self> {
        let file = std::fs::File::open(path).map_err(|e| Error::file(path, e.to_string()))?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(file);
        let header = reader.headers().map_err(|e| Error::line(path, 1, e.to_string()))?.clone();
        if header.len() != COLUMNS.len() {
            return Err(Error::line(path, 1, format!("the columns are {}", COLUMNS.join(","))));
        }
        let mut order = [0; 4];
        for (place, column) in order.iter_mut().zip(COLUMNS) {
            *place = header.iter().position(|name| name == column).ok_or_else(|| {
                Error::line(path, 1, format!("column {column} is missing; the columns are {}", COLUMNS.join(",")))
            })?;
        }
        let mut samples: Vec<(f64, Offsets)> = Vec::new();
        for record in reader.records() {
            let record =
                record.map_err(|e| Error::line(path, e.position().map_or(0, |p| p.line() as usize), e.to_string()))?;
            let line = record.position().map_or(0, |p| p.line() as usize);
            let mut row = [0.0; 4];
            for ((value, &place), column) in row.iter_mut().zip(&order).zip(COLUMNS) {
                let field = record.get(place).unwrap_or("");
                let limit = if column == "s_m" { 1e7 } else { 1.0 };
                *value = field.parse().ok().filter(|v: &f64| v.abs() <= limit).ok_or_else(|| {
                    Error::line(path, line, format!("{column}: \"{field}\" is not a number up to {limit}"))
                })?;
            }
            let [distance, offsets @ ..] = row;
            if samples.last().is_some_and(|(before, _)| distance <= *before) {
                return Err(Error::line(path, line, format!("s_m: {distance} does not increase")));
            }
            samples.push((distance, Offsets::of(offsets)));
        }
        if samples.len() < 2 {
            return Err(Error::file(path, "fewer than two samples"));
        }
        Ok(Self { samples })
    }

    /// Deviation and its slope over the distance, at a distance (m); nothing outside the series.
    #[must_use]
    pub fn at(&self, distance: f64) -> (Offsets, Offsets) {
        let index = self.samples.partition_point(|(s, _)| *s <= distance);
        let (Some((s0, below)), Some((s1, above))) = (self.before(index, 1), self.samples.get(index)) else {
            return (Offsets::default(), Offsets::default());
        };
        let (first, last) = (self.samples[0].0, self.samples[self.samples.len() - 1].0);
        let [(before_at, before), (after_at, after)] =
            [*self.before(index, 2).unwrap_or(&(*s0, *below)), *self.samples.get(index + 1).unwrap_or(&(*s1, *above))];
        let width = s1 - s0;
        let t = (distance - s0) / width;
        let fade = Fade::at(distance - first, 1.0).times(Fade::at(last - distance, -1.0));
        let mut value = [0.0; 3];
        let mut slope = [0.0; 3];
        for k in 0..3 {
            let [p, a, b, n] = [before, *below, *above, after].map(|o| o.numbers()[k]);
            let (left, right) = ((b - p) / (s1 - before_at), (n - a) / (after_at - s0));
            // Hermite's cubic
            let x = a * (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t)
                + b * t * t * (3.0 - 2.0 * t)
                + width * t * (1.0 - t) * (left * (1.0 - t) - right * t);
            let d = 6.0 * t * (1.0 - t) * (b - a) / width
                + left * (1.0 - t) * (1.0 - 3.0 * t)
                + right * t * (3.0 * t - 2.0);
            value[k] = fade.value * x;
            slope[k] = fade.value * d + fade.slope * x;
        }
        (Offsets::of(value), Offsets::of(slope))
    }

    fn before(&self, index: usize, steps: usize) -> Option<&(f64, Offsets)> {
        self.samples.get(index.checked_sub(steps)?)
    }
}

/// A factor from 0 to 1 and its slope over the distance (1/m).
#[derive(Clone, Copy)]
struct Fade {
    value: f64,
    slope: f64,
}

impl Fade {
    /// The factor `inside` (m) from an end, whose distance grows in this direction.
    fn at(inside: f64, direction: f64) -> Self {
        let t = (inside / FADE).clamp(0.0, 1.0);
        Self { value: t * t * (3.0 - 2.0 * t), slope: direction * 6.0 * t * (1.0 - t) / FADE }
    }

    fn times(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.value * other.slope + self.slope * other.value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_with_its_own_slope_and_nothing_outside() {
        let wave = |i: i32| {
            let s = 0.5 * f64::from(i);
            (s, Offsets { lateral: 3e-3 * libm::sin(s), vertical: 1e-3 * libm::cos(2.0 * s), cross_level: 1e-4 * s })
        };
        let series = Irregularity::new((0..200).map(wave).collect());
        assert_eq!((series.at(-1.0), series.at(1000.0)), Default::default());
        for i in 1..995 {
            let s = 0.1 * f64::from(i) + 0.013;
            let (value, slope) = series.at(s);
            let [before, after] = [s - 1e-6, s + 1e-6].map(|s| series.at(s).0);
            assert!((slope.lateral - (after.lateral - before.lateral) / 2e-6).abs() < 1e-7);
            assert!((slope.cross_level - (after.cross_level - before.cross_level) / 2e-6).abs() < 1e-7);
            if s > 11.0 && s < 88.0 {
                assert!((value.lateral - 3e-3 * libm::sin(s)).abs() < 4e-5, "{s}");
                assert!((slope.cross_level - 1e-4).abs() < 1e-12, "a straight line is kept");
            }
        }
    }
}
