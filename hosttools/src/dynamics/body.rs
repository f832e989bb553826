//! A rigid body in the moving track frame, and the integration scheme of all of them.
//!
//! Coordinates `[y, z, φ, ψ, χ]`: lateral (m), vertical (m, down), roll, yaw (rad), and pitch or, of a wheelset, the
//! angle it has rolled. Along x a body runs with the track frame at constant speed. Velocities of roll and yaw are
//! *absolute*: the track frame's own rotation is taken off where the angles are advanced, so neither a transition's
//! change of curvature nor the kink of a cant ramp needs a torque of its own.
//!
//! **Scheme**: velocity Verlet with an extrapolated velocity, fixed step h, one evaluation of all forces a step:
//!
//! ```text
//! q₁ = q₀ + h v₀ + h²/2 a₀ - track's own rotation
//! v* = v₀ + h (3 a₀ - a₋₁) / 2
//! a₁ = a(q₁, v*)
//! v₁ = v₀ + h/2 (a₀ + a₁)
//! ```
//!
//! Second order (`tests/vehicle_integration.rs` halves the step). In the undamped contact springs it is Störmer and
//! Verlet's symplectic scheme, which neither gains nor loses energy, stable up to ω h = 2; damping is stable up to
//! λ h = 1/2 (eigenvalues of the scheme's matrix). A wheelset of 1,200 kg on contacts of 1e9 N/m has ω of 1,400 1/s:
//! 0.1 ms is ω h = 0.14. Creep damps the spin most, with λ = 2 f r² / (I V), about 2,500 1/s at 15 m/s. The plain
//! prediction v₀ + h a₀ is off by h² v'' / 2, which the stiff creep damping turns into a force of D (ω h)² / 2 per
//! velocity: at 0.1 ms it made a wheelset with a flange contact bounce at 180 Hz.

use nalgebra::SVector;

/// Lateral, vertical, roll, yaw, pitch.
pub type Vector5 = SVector<f64, 5>;

/// Order of the coordinates.
pub const LATERAL: usize = 0;
/// See [`LATERAL`].
pub const VERTICAL: usize = 1;
/// See [`LATERAL`].
pub const ROLL: usize = 2;
/// See [`LATERAL`].
pub const YAW: usize = 3;
/// See [`LATERAL`].
pub const PITCH: usize = 4;

/// Place, velocity and acceleration of a body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Body {
    /// Displacement against the track frame, m and rad.
    pub position: Vector5,
    /// Velocity, m/s and rad/s; roll and yaw absolute.
    pub velocity: Vector5,
    /// Acceleration of the last evaluation, m/s² and rad/s².
    pub acceleration: Vector5,
    /// Acceleration of the evaluation before.
    pub before: Vector5,
}

/// How far the track frame itself turns in a step, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameTurn {
    /// About x: change of cant.
    pub roll: f64,
    /// About z: change of heading.
    pub yaw: f64,
}

impl Body {
    /// First half of a step of `h` seconds: the new place and the extrapolated velocity.
    #[inline]
    pub fn predict(&mut self, h: f64, turn: FrameTurn) {
        self.position += h * self.velocity + 0.5 * h * h * self.acceleration;
        self.position[ROLL] -= turn.roll;
        self.position[YAW] -= turn.yaw;
        self.velocity += 0.5 * h * (3.0 * self.acceleration - self.before);
    }

    /// Second half: the velocity by the mean of the accelerations before and after.
    #[inline]
    pub fn correct(&mut self, h: f64, acceleration: Vector5) {
        // From v* to v₁
        self.velocity += 0.5 * h * (acceleration - 2.0 * self.acceleration + self.before);
        self.before = self.acceleration;
        self.acceleration = acceleration;
    }

    /// Takes an acceleration to start from.
    pub fn start(&mut self, acceleration: Vector5) {
        self.acceleration = acceleration;
        self.before = acceleration;
    }
}
