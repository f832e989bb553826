//! Primary suspension: a linear spring and damper in x, y and z at each axle box.

use nalgebra::Vector3;

use super::body::{Body, LATERAL, PITCH, ROLL, VERTICAL, Vector5, YAW};
use super::track::{Place, Track};

/// One axle box, and where they all are.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suspension {
    /// Stiffness of one box along x, y, z, N/m.
    pub stiffness_n_per_m: [f64; 3],
    /// Damping of one box along x, y, z, N s/m.
    pub damping_ns_per_m: [f64; 3],
    /// Distance d of a box from the wheelset's centre along the axle, m.
    pub half_spacing_m: f64,
    /// How far the boxes lie below the bogie frame's centre of gravity, m.
    #[serde(default)]
    pub below_frame_m: f64,
}

/// What an axle's two boxes do, as generalised forces `[Fy, Fz, Mx, Mz, My]`, N and N m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// On the wheelset.
    pub wheelset: Vector5,
    /// On the frame.
    pub frame: Vector5,
}

/// Where an axle stands seen from the bogie's centre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seat {
    /// Ahead of the bogie's centre, m.
    pub ahead: f64,
    /// The track frame there against that at the bogie's centre: how far to the right, m.
    pub offset: f64,
    /// How fast that changes, seen by bodies whose angular velocities are absolute, m/s.
    pub offset_rate: f64,
    /// How far it is turned to the right, rad.
    pub yaw: f64,
    /// How far it is turned about x, rad.
    pub roll: f64,
}

impl Seat {
    /// The seat of an axle's boxes, `[ahead, below]` a bogie's centre (m), which is at a distance (m) on the track, at a
    /// speed (m/s).
    #[must_use]
    pub fn at(track: &Track, distance: f64, [ahead, below]: [f64; 2], speed: f64) -> Self {
        let places = [distance, distance + ahead].map(|distance| track.place(distance));
        Self::between(track, distance, places, [ahead, below], speed)
    }

    /// [`Seat::at`] where the track at the bogie's centre and at the axle is known.
    #[must_use]
    pub fn between(
        track: &Track,
        distance: f64,
        [here, there]: [Place; 2],
        [ahead, below]: [f64; 2],
        speed: f64,
    ) -> Self {
        let [offset, yaw] = track.chord_between(distance, ahead, [&here, &there]);
        let roll = there.point.cant - here.point.cant;
        // d/dt (offset - a ψf + h φf) = V (β - a κ) - a (ψf' - V κ) + h (φf' - V θ'), with ψf' and φf' absolute
        Self { ahead, offset, offset_rate: speed * (yaw - below * here.point.cant_slope), yaw, roll }
    }
}

impl Suspension {
    /// Forces of both boxes of an axle. `preload` (N) is what each box bears at rest, down on the wheelset.
    ///
    /// Seen from the frame the box σ = ±1 is displaced by, for small angles (φ, ψ, θ roll, yaw and pitch, a how far the
    /// axle stands ahead, h how far the boxes lie below the frame's centre, f the frame, β the track's own turn):
    ///
    /// ```text
    /// e_x = -σ d (ψ + β - ψf) - h θf
    /// e_y = y + offset - yf - a ψf + h φf
    /// e_z = z - zf + σ d (φ + βφ - φf) + a θf
    /// ```
    /// and each force acts with the same arms, so that the suspension does no work of its own.
    #[must_use]
    pub fn reaction(&self, wheelset: &Body, frame: &Body, seat: &Seat, preload: f64) -> Reaction {
        let (d, h, a) = (self.half_spacing_m, self.below_frame_m, seat.ahead);
        let stretch = |w: &Vector5, f: &Vector5, [offset, yaw, roll]: [f64; 3], side: f64| {
            Vector3::new(
                -side * d * (w[YAW] + yaw - f[YAW]) - h * f[PITCH],
                w[LATERAL] + offset - f[LATERAL] - a * f[YAW] + h * f[ROLL],
                w[VERTICAL] - f[VERTICAL] + side * d * (w[ROLL] + roll - f[ROLL]) + a * f[PITCH],
            )
        };
        let mut reaction = Reaction::default();
        for side in [1.0, -1.0] {
            let e = stretch(&wheelset.position, &frame.position, [seat.offset, seat.yaw, seat.roll], side);
            // Absolute angular velocities hold the track's own turn already.
            let rate = stretch(&wheelset.velocity, &frame.velocity, [seat.offset_rate, 0.0, 0.0], side);
            let (stiffness, damping) = (Vector3::from(self.stiffness_n_per_m), Vector3::from(self.damping_ns_per_m));
            let mut force = -(stiffness.component_mul(&e) + damping.component_mul(&rate));
            force.z += preload;
            let [x, y, z] = force.into();
            reaction.wheelset += Vector5::new(y, z, side * d * z, -side * d * x, 0.0);
            reaction.frame -= Vector5::new(y, z, side * d * z - h * y, a * y - side * d * x, h * x - a * z);
        }
        reaction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUSPENSION: Suspension = Suspension {
        stiffness_n_per_m: [3e6, 2e6, 1e6],
        damping_ns_per_m: [0.0; 3],
        half_spacing_m: 0.9,
        below_frame_m: 0.3,
    };

    /// The springs' energy, from their stretches found with vectors: r = attachment, ω × r for the rotations.
    fn energy(wheelset: &Vector5, frame: &Vector5, seat: &Seat) -> f64 {
        let moved = |at: &Vector5, arm: Vector3<f64>| {
            let turn = Vector3::new(at[ROLL], at[PITCH], at[YAW]);
            Vector3::new(0.0, at[LATERAL], at[VERTICAL]) + turn.cross(&arm)
        };
        let box_of = |side: f64| {
            let d = side * SUSPENSION.half_spacing_m;
            // The wheelset turns in its boxes: its pitch moves nothing.
            let own = Vector5::new(wheelset[0], wheelset[1], wheelset[2], wheelset[3], 0.0);
            let e = moved(&own, Vector3::new(0.0, d, 0.0))
                - moved(frame, Vector3::new(seat.ahead, d, SUSPENSION.below_frame_m));
            e.component_mul(&e).dot(&Vector3::from(SUSPENSION.stiffness_n_per_m)) / 2.0
        };
        box_of(1.0) + box_of(-1.0)
    }

    #[test]
    fn forces_are_the_gradient_of_the_energy() {
        let seat = Seat { ahead: -1.1, ..Seat::default() };
        let wheelset = Vector5::new(3e-3, -1e-3, 2e-3, -4e-3, 7.0);
        let frame = Vector5::new(-2e-3, 2e-3, 5e-3, 1e-3, -3e-3);
        let at = |position: Vector5| Body { position, ..Body::default() };
        let reaction = SUSPENSION.reaction(&at(wheelset), &at(frame), &seat, 0.0);
        for i in 0..5 {
            let mut step = Vector5::zeros();
            step[i] = 1e-6;
            let by_wheelset = energy(&(wheelset - step), &frame, &seat) - energy(&(wheelset + step), &frame, &seat);
            let by_frame = energy(&wheelset, &(frame - step), &seat) - energy(&wheelset, &(frame + step), &seat);
            assert!((reaction.wheelset[i] - by_wheelset / 2e-6).abs() < 1e-4, "wheelset {i}");
            assert!((reaction.frame[i] - by_frame / 2e-6).abs() < 1e-4, "frame {i}");
        }
    }
}
