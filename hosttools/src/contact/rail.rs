//! A rail placed in the track frame, and the signed distance of a point from it.

use crate::curve::{Curve, CurvePoint};

/// Distance (m) beyond which a point is simply far from the rail: neither contact nor a gap worth knowing.
pub const FAR: f64 = 1.5e-3;

/// Edge (m) of the cells of the map of nearest points, and how far the map reaches around the rail.
const CELL: f64 = 0.5e-3;
const MARGIN: f64 = 12e-3;

/// The point of the rail nearest to some point.
#[derive(Debug, Clone, Copy)]
pub struct Foot {
    /// Parameter on the rail's curve (m).
    pub t: f64,
    /// Signed normal distance (m), positive inside the rail: an overlap.
    pub depth: f64,
    /// Unit tangent `[y, z]` of the rail there, towards the field side.
    pub tangent: [f64; 2],
}

/// What is known of a point without a Newton step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nearness {
    /// Nearest to the rail's end, or outside of what the map covers: no answer.
    Outside,
    /// Farther than [`FAR`] from the surface, on the free side.
    Far,
    /// Near; the value is a first guess of the foot's parameter (m).
    Near(f64),
}

/// A prismatic rail: its section in the track frame (y right, z down), with a map of nearest points.
#[derive(Debug, Clone)]
pub struct Rail {
    curve: Curve,
    origin: [f64; 2],
    columns: usize,
    rows: usize,
    cells: Vec<Nearness>,
    top: Vec<f64>,
}

impl Rail {
    /// Takes the rail's section in the track frame and maps the space around it.
    pub fn new(curve: Curve) -> Self {
        let steps = (curve.length() / (0.5 * CELL)).ceil() as usize;
        let samples: Vec<CurvePoint> =
            (0..=steps).map(|i| curve.at(curve.length() * i as f64 / steps as f64)).collect();
        let bounds = |value: fn(&CurvePoint) -> f64| {
            let low = samples.iter().map(value).fold(f64::INFINITY, f64::min);
            let high = samples.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
            (low - MARGIN, high + MARGIN)
        };
        let ((y0, y1), (z0, z1)) = (bounds(|p| p.y), bounds(|p| p.z));
        let (columns, rows) = (((y1 - y0) / CELL).ceil() as usize, ((z1 - z0) / CELL).ceil() as usize);
        let mut rail =
            Self { curve, origin: [y0, z0], columns, rows, cells: Vec::new(), top: vec![f64::INFINITY; columns] };
        rail.fill_cells(&samples);
        rail.fill_top(&samples);
        rail
    }

    /// The section's curve in the track frame.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    fn fill_cells(&mut self, samples: &[CurvePoint]) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                let p = [self.origin[0] + (column as f64 + 0.5) * CELL, self.origin[1] + (row as f64 + 0.5) * CELL];
                let squared = |s: &CurvePoint| (s.y - p[0]).powi(2) + (s.z - p[1]).powi(2);
                let mut nearest = &samples[0];
                for s in samples {
                    if squared(s) < squared(nearest) {
                        nearest = s;
                    }
                }
                let free = (p[0] - nearest.y) * -nearest.tangent[1] + (p[1] - nearest.z) * nearest.tangent[0] < 0.0;
                let at_end = nearest.t < CELL || nearest.t > self.curve.length() - CELL;
                self.cells.push(if at_end && squared(nearest) > 4.0 * CELL * CELL {
                    Nearness::Outside
                } else if free && squared(nearest).sqrt() > FAR + CELL {
                    Nearness::Far
                } else {
                    Nearness::Near(nearest.t)
                });
            }
        }
    }

    fn fill_top(&mut self, samples: &[CurvePoint]) {
        for pair in samples.windows(2) {
            for s in [0.0, 0.5] {
                let (y, z) = (pair[0].y + s * (pair[1].y - pair[0].y), pair[0].z + s * (pair[1].z - pair[0].z));
                let column = ((y - self.origin[0]) / CELL) as usize;
                if let Some(top) = self.top.get_mut(column) {
                    *top = top.min(z);
                }
            }
        }
    }

    /// Height (m, down) of the rail's top at a lateral position, to about a cell's accuracy; infinite beside the rail.
    pub fn rough_top(&self, y: f64) -> f64 {
        let column = (y - self.origin[0]) / CELL;
        if column >= 0.0 { self.top.get(column as usize).copied().unwrap_or(f64::INFINITY) } else { f64::INFINITY }
    }

    /// What the map says about a point.
    #[inline]
    pub fn nearness(&self, p: [f64; 2]) -> Nearness {
        let (column, row) = ((p[0] - self.origin[0]) / CELL, (p[1] - self.origin[1]) / CELL);
        if !(column >= 0.0 && row >= 0.0) || column as usize >= self.columns || row as usize >= self.rows {
            return Nearness::Outside;
        }
        self.cells[row as usize * self.columns + column as usize]
    }

    /// Newton's method for the foot of the normal from `p`, from a first guess of its parameter.
    ///
    /// ```text
    /// (p - r(t)) · r'(t) = 0,   depth = (p - r) · n,   n = (-r'_z, r'_y) / |r'|, into the rail
    /// ```
    /// `None` where the foot is an end of the curve.
    #[inline]
    pub fn foot(&self, p: [f64; 2], guess: f64, iterations: usize) -> Option<Foot> {
        let mut t = guess;
        for _ in 0..iterations {
            let j = self.curve.jet(t);
            let gap = [p[0] - j.position[0], p[1] - j.position[1]];
            let speed2 = j.first[0] * j.first[0] + j.first[1] * j.first[1];
            let along = gap[0] * j.first[0] + gap[1] * j.first[1];
            let bend = gap[0] * j.second[0] + gap[1] * j.second[1];
            t = (t + along / (speed2 - bend).max(0.2 * speed2)).clamp(0.0, self.curve.length());
        }
        if t <= 0.0 || t >= self.curve.length() {
            return None;
        }
        let j = self.curve.jet(t);
        let speed = (j.first[0] * j.first[0] + j.first[1] * j.first[1]).sqrt();
        let tangent = [j.first[0] / speed, j.first[1] / speed];
        let gap = [p[0] - j.position[0], p[1] - j.position[1]];
        Some(Foot { t, depth: gap[1] * tangent[0] - gap[0] * tangent[1], tangent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Profile, ProfileKind};

    #[test]
    fn depth_below_a_circular_rail_is_radial() {
        let points = (0..=400)
            .map(|i| {
                let angle = -0.5 + f64::from(i) / 400.0;
                [0.08 * libm::sin(angle), 0.08 * (1.0 - libm::cos(angle))]
            })
            .collect();
        let profile = Profile {
            kind: ProfileKind::Rail,
            name: "circle".into(),
            points,
            joints: vec![],
            recognised: vec![],
            source_hash: [0; 32],
            smoothing: 0.0,
        };
        let rail = Rail::new(Curve::fit(&profile, 0.0).unwrap());
        for (angle, depth) in [(0.0, 1e-4), (0.3, 2e-5), (-0.37, -1e-3), (0.2, -1.4e-3), (0.1, 1e-3)] {
            let (angle, depth): (f64, f64) = (angle, depth);
            let r = 0.08 - depth;
            let p = [r * libm::sin(angle), 0.08 - r * libm::cos(angle)];
            let Nearness::Near(guess) = rail.nearness(p) else { panic!("{p:?} is near") };
            let foot = rail.foot(p, guess, 3).unwrap();
            assert!((foot.depth - depth).abs() < 1e-12, "{} {depth}", foot.depth);
            assert!((libm::atan2(foot.tangent[1], foot.tangent[0]) - angle).abs() < 1e-9);
        }
        assert_eq!(rail.nearness([0.0, -0.005]), Nearness::Far);
        assert_eq!(rail.nearness([0.5, 0.0]), Nearness::Outside);
    }
}
