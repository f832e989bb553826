//! The track's centre line: straight, transitions, circular curves, and their cant.
//!
//! A vehicle runs along it at constant speed, and everything is described in the [track frame](flangeway#frame) that
//! moves with it: x along the tangent, y to the right, z down, turned about x by the cant. Curvature is positive in a
//! right-hand curve; cant is positive where the right rail is the lower one, as it is in a canted right-hand curve.
//! Between its ends a transition is a clothoid: curvature and cant change linearly with the distance.

use flangeway::Attitude;
use nalgebra::Vector2;

use super::body::FrameTurn;

/// Standard acceleration of free fall, m/s².
pub const GRAVITY: f64 = 9.80665;

/// A piece of track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Length along the centre line, m.
    pub length: f64,
    /// Curvature at its begin and end, 1/m.
    pub curvature: [f64; 2],
    /// Cant angle at its begin and end, rad.
    pub cant: [f64; 2],
}

/// Where the vehicle stands on the centre line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrackPoint {
    /// Curvature κ, 1/m.
    pub curvature: f64,
    /// Cant angle θ, rad.
    pub cant: f64,
    /// Change of the cant angle over the distance, rad/m.
    pub cant_slope: f64,
}

impl TrackPoint {
    /// What gravity and the curve do to a mass that runs along with the track frame, `[y, z]`, m/s²:
    ///
    /// ```text
    /// a_y = g sin θ - V² κ cos θ
    /// a_z = g cos θ + V² κ sin θ
    /// ```
    #[must_use]
    pub fn apparent_gravity(&self, speed: f64) -> Vector2<f64> {
        let roll = Attitude::new(0.0, self.cant).roll;
        // Steeper than the kernel's series reach.
        let (sin, cos) = if roll.limited { (libm::sin(self.cant), libm::cos(self.cant)) } else { (roll.sin, roll.cos) };
        let inward = speed * speed * self.curvature;
        Vector2::new(GRAVITY * sin - inward * cos, GRAVITY * cos + inward * sin)
    }
}

/// The centre line, straight and level before its begin, as it ends after its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track {
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    heading: f64,
    section: Section,
    /// Change of curvature and cant over the distance, 1/m² and rad/m.
    curvature_slope: f64,
    cant_slope: f64,
}

impl Track {
    /// Joins sections.
    #[must_use]
    pub fn new(sections: &[Section]) -> Self {
        let (mut start, mut heading) = (0.0, 0.0);
        let mut pieces = Vec::with_capacity(sections.len());
        for &section in sections {
            let slope = |[from, to]: [f64; 2]| (to - from) / section.length;
            let (curvature_slope, cant_slope) = (slope(section.curvature), slope(section.cant));
            let piece = Piece { start, heading, section, curvature_slope, cant_slope };
            heading = piece.heading_at(start + section.length);
            start += section.length;
            pieces.push(piece);
        }
        Self { pieces }
    }

    /// Length of all sections, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.start + piece.section.length)
    }

    fn piece(&self, distance: f64) -> Option<&Piece> {
        let index = self.pieces.partition_point(|piece| piece.start <= distance);
        self.pieces.get(index.checked_sub(1)?)
    }

    /// Curvature and cant at a distance from the begin, m.
    #[must_use]
    pub fn at(&self, distance: f64) -> TrackPoint {
        self.piece(distance).map_or(TrackPoint::default(), |piece| piece.at(distance))
    }

    /// Heading Θ = ∫ κ ds from the begin to a distance (m), rad; positive turned to the right.
    #[must_use]
    pub fn heading(&self, distance: f64) -> f64 {
        self.piece(distance).map_or(0.0, |piece| piece.heading_at(distance))
    }

    /// Curvature, cant and heading at a distance from the begin, m.
    #[must_use]
    pub fn place(&self, distance: f64) -> Place {
        let index = self.pieces.partition_point(|piece| piece.start <= distance);
        match index.checked_sub(1).and_then(|before| self.pieces.get(before)) {
            Some(piece) => piece.place(distance, index),
            None => Place::default(),
        }
    }

    /// How the track at `distance + ahead` (m) lies in the track frame at `distance`: how far it is to the right (m) and
    /// how far its heading is turned to the right (rad). To first order in the turn, the offset by Simpson's rule:
    ///
    /// ```text
    /// β = Θ(s + a) - Θ(s),   offset = ∫₀ᵃ Θ(s + u) - Θ(s) du
    /// ```
    #[must_use]
    pub fn chord(&self, distance: f64, ahead: f64) -> [f64; 2] {
        self.chord_between(distance, ahead, [&self.place(distance), &self.place(distance + ahead)])
    }

    /// [`Track::chord`] where the places at both its ends are known.
    #[must_use]
    pub fn chord_between(&self, distance: f64, ahead: f64, [here, there]: [&Place; 2]) -> [f64; 2] {
        let end = there.heading - here.heading;
        if here.piece == there.piece {
            // What Simpson's rule gives exactly where the heading is a parabola: κ a² / 2 + κ' a³ / 6
            return [ahead * ahead * (0.5 * here.point.curvature + ahead / 6.0 * here.curvature_slope), end];
        }
        let turn = |share: f64| self.heading(distance + share * ahead) - here.heading;
        [ahead / 12.0 * (4.0 * turn(0.25) + 2.0 * turn(0.5) + 4.0 * turn(0.75) + end), end]
    }
}

/// A place on the centre line, with its heading.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    /// Curvature and cant.
    pub point: TrackPoint,
    /// Heading Θ, rad.
    pub heading: f64,
    /// Change of the curvature over the distance, 1/m².
    curvature_slope: f64,
    /// Number of the piece, in which curvature and cant are linear.
    piece: usize,
}

impl Place {
    /// How the track frame turns from another place to here: by the differences that a co-simulation unit takes, which is
    /// told cant and heading at each step's end.
    #[must_use]
    pub fn turn_from(&self, before: &Self) -> FrameTurn {
        FrameTurn { roll: self.point.cant - before.point.cant, yaw: self.heading - before.heading }
    }
}

impl Piece {
    fn at(&self, distance: f64) -> TrackPoint {
        let Section { length, curvature, cant } = self.section;
        let x = distance - self.start;
        if x < length {
            let (curvature, cant) = (curvature[0] + self.curvature_slope * x, cant[0] + self.cant_slope * x);
            TrackPoint { curvature, cant, cant_slope: self.cant_slope }
        } else {
            TrackPoint { curvature: curvature[1], cant: cant[1], cant_slope: 0.0 }
        }
    }

    /// The place at a distance on this piece, of a number, or beyond its end, which is the next piece then.
    fn place(&self, distance: f64, piece: usize) -> Place {
        let beyond = distance - self.start - self.section.length;
        let (point, heading) = (self.at(distance), self.heading_at(distance));
        if beyond < 0.0 {
            Place { point, heading, curvature_slope: self.curvature_slope, piece }
        } else {
            Place { point, heading, curvature_slope: 0.0, piece: piece + 1 }
        }
    }

    fn heading_at(&self, distance: f64) -> f64 {
        let Section { length, curvature: [from, to], .. } = self.section;
        let x = distance - self.start;
        let inside = x.min(length);
        // Θ = Θ0 + κ0 x + (κ1 - κ0) x² / 2 L, and at the last curvature beyond the end
        self.heading + from * inside + 0.5 * self.curvature_slope * (inside * inside) + to * (x - inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Track {
        Track::new(&[
            Section { length: 20.0, curvature: [0.0; 2], cant: [0.0; 2] },
            Section { length: 30.0, curvature: [0.0, 1.0 / 60.0], cant: [0.0, 0.1] },
            Section { length: 40.0, curvature: [1.0 / 60.0; 2], cant: [0.1; 2] },
        ])
    }

    #[test]
    fn clothoid_turns_by_half_of_its_end() {
        let track = curve();
        assert!((track.heading(50.0) - 0.25).abs() < 1e-15);
        assert!((track.at(35.0).curvature - 1.0 / 120.0).abs() < 1e-15 && (track.at(35.0).cant - 0.05).abs() < 1e-15);
        assert!((track.heading(200.0) - (0.25 + 150.0 / 60.0)).abs() < 1e-12, "the last curvature goes on");
        assert_eq!((track.at(-5.0), track.heading(-5.0)), (TrackPoint::default(), 0.0));
    }

    #[test]
    fn chord_of_a_circle_and_of_a_clothoid() {
        let track = curve();
        let [offset, turn] = track.chord(70.0, -1.5);
        assert!((offset - 1.5 * 1.5 / 120.0).abs() < 1e-15 && (turn + 1.5 / 60.0).abs() < 1e-15);
        // From the clothoid's begin: the cubic parabola x³ / 6 R L.
        let [offset, _] = track.chord(20.0, 3.0);
        assert!((offset - 27.0 / (6.0 * 60.0 * 30.0)).abs() < 1e-12);
        // From the straight into the clothoid, by Simpson's rule.
        let [offset, turn] = track.chord(19.0, 3.0);
        assert!((offset - 8.0 / (6.0 * 60.0 * 30.0)).abs() < 2e-5 && (turn - 4.0 / (2.0 * 60.0 * 30.0)).abs() < 1e-15);
    }

    #[test]
    fn a_place_is_what_is_told_of_its_distance() {
        let track = curve();
        for i in -20..240 {
            let at = 0.5 * f64::from(i) + 0.1;
            let (place, before) = (track.place(at), track.place(at - 0.3));
            assert_eq!((place.point, place.heading), (track.at(at), track.heading(at)));
            let turn = place.turn_from(&before);
            // Θ' = κ
            let mean = 0.5 * (place.point.curvature + before.point.curvature);
            assert!((turn.yaw - 0.3 * mean).abs() < 1e-4 && (turn.roll - 0.3 * place.point.cant_slope).abs() < 1e-3);
        }
    }

    #[test]
    fn equilibrium_cant_leaves_no_lateral_acceleration() {
        let speed = 15.0;
        let curvature = 1.0 / 300.0;
        let cant = libm::atan(speed * speed * curvature / GRAVITY);
        let gravity = TrackPoint { curvature, cant, cant_slope: 0.0 }.apparent_gravity(speed);
        assert!(gravity.x.abs() < 1e-15 && gravity.y > GRAVITY);
    }
}
