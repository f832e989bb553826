//! A wheelset between its rails: a rigid body of revolution that rolls, with its gyroscopic torque, and its step.
//!
//! This is all that a co-simulation unit of a wheelset needs: state, inputs, [`Wheelset::step`]; nothing is allocated.

use flangeway::wheelset::{Motion, Rates, Wrench};
use flangeway::{Attitude, Pose, Side};
use nalgebra::{Vector2, Vector3};

use super::body::{Body, FrameTurn, LATERAL, PITCH, ROLL, VERTICAL, Vector5, YAW};
use super::irregularity::Offsets;
use super::track::TrackPoint;
use super::wheel_rail::{Wheel, WheelRail};

/// Mass and inertia of a wheelset.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia about x and z, kg m².
    pub roll_yaw_inertia_kgm2: f64,
    /// Moment of inertia about the axle, kg m².
    pub spin_inertia_kgm2: f64,
}

/// Where and how fast a wheelset runs, and what loads it beside its rails.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {
    /// Speed along the track, m/s.
    pub speed: f64,
    /// Curvature and cant here.
    pub track: TrackPoint,
    /// How the rails deviate here, and the slopes of that over the distance.
    pub rails: [Offsets; 2],
    /// Generalised forces `[Fy, Fz, Mx, Mz, My]` of everything but rails and weight, N and N m.
    pub loads: Vector5,
}

/// A wheelset.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wheelset {
    /// Its place and velocity; pitch is the angle rolled, its velocity the absolute one about the axle, V / r0 when
    /// it rolls freely.
    pub body: Body,
    /// Both wheels as of the last evaluation, right first.
    pub wheels: [Wheel; 2],
}

impl Wheelset {
    /// A step of `h` seconds under constant loads: [`Body::predict`], then [`Wheelset::correct`] with the inputs of its end.
    pub fn step(&mut self, h: f64, turn: FrameTurn, inputs: &Inputs, parameters: &Parameters, contact: &WheelRail<'_>) {
        self.body.predict(h, turn);
        self.correct(h, inputs, parameters, contact);
    }

    /// Second half of a step, once all bodies stand at its end.
    pub fn correct(&mut self, h: f64, inputs: &Inputs, parameters: &Parameters, contact: &WheelRail<'_>) {
        let acceleration = self.acceleration(inputs, parameters, contact);
        self.body.correct(h, acceleration);
    }

    /// Accelerations at the present place and velocity. Also finds both wheels.
    ///
    /// With θ⃗ = φ (cos ψ, sin ψ, 0) + ψ e_z - χ e_a, e_a the axle's direction, Ω the spin about the axle, I and I_s the
    /// inertia across and about it, φ' and ψ' absolute (Lagrange's equations of the symmetric top, with the
    /// gyroscopic terms in I_s Ω):
    ///
    /// ```text
    /// m y'' = Fy + m a_y,   m z'' = Fz + m a_z
    /// I_s Ω' = -M·e_a
    /// I φ'' = M·(cos ψ, sin ψ, 0) - I ψ'² sin φ cos φ - I_s Ω ψ' cos φ
    /// I ψ'' cos²φ = M_z + I_s Ω' sin φ + I_s Ω φ' cos φ + 2 I ψ' φ' sin φ cos φ
    /// ```
    /// Left out are Coriolis' terms of the track frame, 2 θ' z' and 2 θ' y' in a cant ramp: below 1e-3 m/s² here.
    fn acceleration(&mut self, inputs: &Inputs, parameters: &Parameters, contact: &WheelRail<'_>) -> Vector5 {
        let wrench = self.between_rails(inputs, contact);
        let Parameters { mass_kg: mass, roll_yaw_inertia_kgm2: across, spin_inertia_kgm2: about } = *parameters;
        let (q, v) = (&self.body.position, &self.body.velocity);
        let Attitude { yaw: psi, roll: phi } = Attitude::new(q[YAW], q[ROLL]);
        let (sin_yaw, cos_yaw, sin_roll, cos_roll) = (psi.sin, psi.cos, phi.sin, phi.cos);
        let axle = Vector3::new(-sin_yaw * cos_roll, cos_yaw * cos_roll, sin_roll);
        let gravity: Vector2<f64> = inputs.track.apparent_gravity(inputs.speed);
        let (force, moment, loads) = (wrench.force, wrench.moment, &inputs.loads);
        let (roll_rate, yaw_rate, momentum) = (v[ROLL], v[YAW], about * v[PITCH]);
        // I_s Ω' = -M·e_a
        let spin = (loads[PITCH] - moment.dot(&axle)) / about;
        // I φ'' = M·(cos ψ, sin ψ, 0) - I ψ'² sin φ cos φ - I_s Ω ψ' cos φ
        let roll = (moment.x * cos_yaw + moment.y * sin_yaw + loads[ROLL] - momentum * yaw_rate * cos_roll) / across
            - yaw_rate * yaw_rate * sin_roll * cos_roll;
        // I ψ'' cos²φ = M_z + I_s Ω' sin φ + I_s Ω φ' cos φ + 2 I ψ' φ' sin φ cos φ
        let yaw_moment = moment.z + loads[YAW] + about * spin * sin_roll + momentum * roll_rate * cos_roll;
        let yaw = yaw_moment / (across * cos_roll * cos_roll) + 2.0 * yaw_rate * roll_rate * sin_roll / cos_roll;
        Vector5::new(
            (force.y + loads[LATERAL]) / mass + gravity.x,
            (force.z + loads[VERTICAL]) / mass + gravity.y,
            roll,
            yaw,
            spin,
        )
    }

    /// Wrench of the rails in the track frame; fills in both wheels.
    ///
    /// The contact sees the pose against the displaced rails, whose own frame is moved by the lateral and vertical
    /// offset, turned by the cross level γ about x and by the lateral offset's slope σ about z, and moves along:
    ///
    /// ```text
    /// y - y_r - γ r0,   ψ - σ,   z - z_r - γ y,   φ - γ
    /// ```
    fn between_rails(&mut self, inputs: &Inputs, contact: &WheelRail<'_>) -> Wrench {
        let (q, v) = (&self.body.position, &self.body.velocity);
        let [rails, slopes] = inputs.rails;
        let (radius, speed) = (contact.source.geometry(Side::Right).nominal_radius, inputs.speed);
        let motion = Motion {
            pose: Pose {
                lateral: q[LATERAL] - rails.lateral - radius * rails.cross_level,
                yaw: q[YAW] - slopes.lateral,
                vertical: q[VERTICAL] - rails.vertical - rails.cross_level * q[LATERAL],
                roll: q[ROLL] - rails.cross_level,
            },
            rates: Rates {
                lateral: v[LATERAL] - speed * (slopes.lateral + radius * slopes.cross_level),
                // The track frame turns too: relative to it.
                yaw: v[YAW] - speed * inputs.track.curvature,
                vertical: v[VERTICAL] - speed * slopes.vertical,
                roll: v[ROLL] - speed * (inputs.track.cant_slope + slopes.cross_level),
            },
            speed,
            spin: v[PITCH],
            track_curvature: inputs.track.curvature,
        };
        let wrench = contact.forces(&motion, &mut self.wheels);
        // Back to the track frame by the small turn.
        let turn = Vector3::new(rails.cross_level, 0.0, slopes.lateral);
        let back = |vector: Vector3<f64>| vector + turn.cross(&vector);
        Wrench { force: back(wrench.force), moment: back(wrench.moment) }
    }
}
