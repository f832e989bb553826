//! A wheelset on its suspension: the single wheelset of [`crate::dynamics::vehicle`], its track and the far end of its
//! suspension given step by step.

use flangeway::wheelset::Rates;

use super::variables::{Real, input, output, parameter};
use crate::dynamics::body::{Body, FrameTurn, LATERAL, PITCH, ROLL, VERTICAL, Vector5, YAW};
use crate::dynamics::irregularity::{Irregularity, Offsets};
use crate::dynamics::suspension::{Seat, Suspension};
use crate::dynamics::track::{Track, TrackPoint};
use crate::dynamics::vehicle::{Carried, Line, Parameters, Vehicle};
use crate::dynamics::wheel_rail::WheelRail;
use crate::dynamics::wheelset::{self, Wheelset};
use crate::error::Result;

const PARAMETERS: usize = 13;
const INPUTS: usize = 24;
const OUTPUTS: usize = 13;

/// Lateral displacement against the rails (m) at which a wheelset has left them.
const DERAILED: f64 = 0.03;

/// Masses and suspension are those of `tables/scenarios/wheelset_r1000.toml` unless set.
pub(super) fn parameters() -> Vec<Real> {
    let parameter = |name, unit, description, start, low, high| parameter(name, unit, description, start, [low, high]);
    vec![
        parameter(
            "step",
            "s",
            "Longest step of the integration inside; a communication step is divided evenly",
            1e-4,
            1e-6,
            1e-2,
        ),
        parameter("mass", "kg", "Mass of the wheelset", 1500.0, 1.0, 1e5),
        parameter("roll_yaw_inertia", "kg.m2", "Moment of inertia about x and z", 1050.0, 0.1, 1e6),
        parameter("spin_inertia", "kg.m2", "Moment of inertia about the axle", 110.0, 0.1, 1e6),
        parameter(
            "stiffness_x",
            "N/m",
            "Stiffness of each axle box along x; 0 leaves the suspension to the inputs",
            2e7,
            0.0,
            1e10,
        ),
        parameter("stiffness_y", "N/m", "Stiffness of each axle box along y", 3e4, 0.0, 1e10),
        parameter("stiffness_z", "N/m", "Stiffness of each axle box along z, about the rest position", 1e6, 0.0, 1e10),
        parameter("damping_x", "N.s/m", "Damping of each axle box along x", 1e4, 0.0, 1e9),
        parameter("damping_y", "N.s/m", "Damping of each axle box along y", 1e4, 0.0, 1e9),
        parameter("damping_z", "N.s/m", "Damping of each axle box along z", 2e4, 0.0, 1e9),
        parameter("half_spacing", "m", "Distance of an axle box from the wheelset's centre", 1.0, 0.1, 3.0),
        parameter("carried_mass", "kg", "Mass that the axle carries and that follows the track", 6650.0, 0.0, 1e6),
        parameter("carried_height", "m", "Height of its centre of gravity above the axle", 0.6, -5.0, 5.0),
    ]
}

pub(super) fn inputs() -> Vec<Real> {
    let all = [
        ("speed", "m/s", "Speed along the track; the wheelset starts rolling freely at it", 200.0),
        ("track_curvature", "1/m", "Curvature of the track, positive to the right", 1.0),
        ("track_cant", "rad", "Cant angle, positive where the right rail is lower", 1.0),
        ("track_heading", "rad", "Heading of the track, the integral of its curvature; used if exact_track", 1e6),
        ("track_cant_slope", "rad/m", "Change of the cant over the distance; used if exact_track", 1.0),
        ("rail_lateral", "m", "Irregularity: lateral alignment of both rails, to the right", 1.0),
        ("rail_vertical", "m", "Irregularity: vertical profile of both rails, down", 1.0),
        ("rail_cross_level", "rad", "Irregularity: cross level, positive where the right rail is lower", 1.0),
        ("rail_lateral_slope", "", "Change of rail_lateral over the distance", 1.0),
        ("rail_vertical_slope", "", "Change of rail_vertical over the distance", 1.0),
        ("rail_cross_level_slope", "rad/m", "Change of rail_cross_level over the distance", 1.0),
        ("frame_lateral", "m", "Far end of the suspension: lateral displacement, from rest", 10.0),
        ("frame_vertical", "m", "Far end of the suspension: vertical displacement, from rest", 10.0),
        ("frame_roll", "rad", "Far end of the suspension: roll", 10.0),
        ("frame_yaw", "rad", "Far end of the suspension: yaw against the track at the axle", 10.0),
        ("frame_lateral_rate", "m/s", "Rate of frame_lateral", 1e3),
        ("frame_vertical_rate", "m/s", "Rate of frame_vertical", 1e3),
        ("frame_roll_rate", "rad/s", "Absolute rate of frame_roll, in a cant ramp with the track's", 1e3),
        ("frame_yaw_rate", "rad/s", "Absolute rate of frame_yaw, in a curve with the track's", 1e3),
        ("force_y", "N", "Force on the wheelset beside suspension and weight, to the right", 1e8),
        ("force_z", "N", "Force on the wheelset beside suspension and weight, down", 1e8),
        ("moment_x", "N.m", "Moment on the wheelset about x", 1e8),
        ("moment_axle", "N.m", "Driving moment about the axle; a brake's is negative when running forward", 1e8),
        ("moment_z", "N.m", "Moment on the wheelset about z", 1e8),
    ];
    debug_assert_eq!(all.len(), INPUTS);
    let mut all: Vec<Real> =
        all.into_iter().map(|(name, unit, description, limit)| input(name, unit, description, limit)).collect();
    (all[0].range, all[0].start) = ([0.0, 200.0], 15.0);
    all
}

pub(super) fn outputs() -> Vec<Real> {
    let all = [
        ("lateral", "m", "Lateral displacement of the wheelset against the track, to the right"),
        ("yaw", "rad", "Yaw against the track"),
        ("vertical", "m", "Vertical displacement, down"),
        ("roll", "rad", "Roll against the track"),
        ("lateral_rate", "m/s", "Rate of lateral"),
        ("yaw_rate", "rad/s", "Rate of yaw against the track"),
        ("vertical_rate", "m/s", "Rate of vertical"),
        ("roll_rate", "rad/s", "Rate of roll against the track"),
        ("spin", "rad/s", "Angular speed about the axle"),
        ("suspension_force_y", "N", "Force of the suspension on its far end, to the right"),
        ("suspension_force_z", "N", "Force of the suspension on its far end, down"),
        ("suspension_moment_x", "N.m", "Moment of the suspension on its far end, about x"),
        ("suspension_moment_z", "N.m", "Moment of the suspension on its far end, about z"),
    ];
    debug_assert_eq!(all.len(), OUTPUTS);
    all.into_iter().map(|(name, unit, description)| output(name, unit, description)).collect()
}

/// What the parameters say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Constants {
    step: f64,
    vehicle: Parameters,
}

impl Constants {
    /// From the first parameters, in their order.
    pub(super) fn new(values: &[f64]) -> Self {
        let mut numbers = [0.0; PARAMETERS];
        numbers.copy_from_slice(&values[..PARAMETERS]);
        let [step, mass_kg, roll_yaw_inertia_kgm2, spin_inertia_kgm2, rest @ ..] = numbers;
        let [kx, ky, kz, cx, cy, cz, half_spacing_m, carried_mass, height_m] = rest;
        let vehicle = Parameters {
            wheelset: wheelset::Parameters { mass_kg, roll_yaw_inertia_kgm2, spin_inertia_kgm2 },
            suspension: Suspension {
                stiffness_n_per_m: [kx, ky, kz],
                damping_ns_per_m: [cx, cy, cz],
                half_spacing_m,
                below_frame_m: 0.0,
            },
            carried: Carried { mass_kg: carried_mass, height_m },
            frame: None,
            led_from_m: 0.0,
        };
        Self { step, vehicle }
    }
}

/// The inputs at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inputs([f64; INPUTS]);

impl Inputs {
    pub(super) fn new(values: &[f64]) -> Self {
        let mut numbers = [0.0; INPUTS];
        numbers.copy_from_slice(values);
        Self(numbers)
    }

    /// Between these and others; the others themselves at the end.
    fn towards(&self, end: &Self, part: u32, parts: u32) -> Self {
        if part == parts {
            return *end;
        }
        let t = f64::from(part) / f64::from(parts);
        let mut between = self.0;
        between.iter_mut().zip(end.0).for_each(|(x, end)| *x += t * (end - *x));
        Self(between)
    }

    fn speed(&self) -> f64 {
        self.0[0]
    }

    fn curvature(&self) -> f64 {
        self.0[1]
    }

    fn cant(&self) -> f64 {
        self.0[2]
    }

    fn heading(&self) -> f64 {
        self.0[3]
    }

    fn cant_slope(&self) -> f64 {
        self.0[4]
    }

    /// Deviation of the rails and its slope.
    fn rails(&self) -> [Offsets; 2] {
        let [lateral, vertical, cross_level, lateral_slope, vertical_slope, cross_level_slope] =
            *self.0[5..].first_chunk().unwrap_or(&[0.0; 6]);
        [
            Offsets { lateral, vertical, cross_level },
            Offsets { lateral: lateral_slope, vertical: vertical_slope, cross_level: cross_level_slope },
        ]
    }

    /// Far end of the suspension, which at rest stands at this height (m).
    fn frame(&self, rest: f64) -> Body {
        let [y, z, roll, yaw, y_rate, z_rate, roll_rate, yaw_rate] = *self.0[11..].first_chunk().unwrap_or(&[0.0; 8]);
        Body {
            position: Vector5::new(y, rest + z, roll, yaw, 0.0),
            velocity: Vector5::new(y_rate, z_rate, roll_rate, yaw_rate, 0.0),
            ..Body::default()
        }
    }

    /// Forces beside suspension and weight.
    fn forces(&self) -> Vector5 {
        let [y, z, about_x, about_y, about_z] = *self.0.last_chunk().unwrap_or(&[0.0; 5]);
        Vector5::new(y, z, about_x, about_z, about_y)
    }
}

/// A wheelset on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct State {
    pub(super) wheelset: Wheelset,
    /// Height at rest, m.
    rest: f64,
    /// Inputs at the last step's end.
    inputs: Inputs,
    /// Turn of the track there: rates of roll and yaw of its frame, rad/s.
    track_rates: [f64; 2],
    /// What the suspension does to its far end.
    reaction: Vector5,
}

impl State {
    /// Rolling freely in the middle of straight level track, or in the curve that the inputs say.
    pub(super) fn at_rest(constants: &Constants, inputs: Inputs, contact: &WheelRail<'_>) -> Result<Self> {
        let (track, irregularity) = (Track::default(), Irregularity::default());
        let line = Line { track: &track, irregularity: &irregularity, contact, speed: inputs.speed() };
        let vehicle = Vehicle::at_rest(constants.vehicle, &line)?;
        let mut wheelset = vehicle.wheelsets[0];
        let track_rates = [0.0, inputs.speed() * inputs.curvature()];
        wheelset.body.velocity[YAW] += track_rates[1];
        let rest = vehicle.frame.position[VERTICAL];
        let mut state = Self { wheelset, rest, inputs, track_rates, reaction: Vector5::zeros() };
        state.reaction = state.suspension(constants, &inputs).frame;
        Ok(state)
    }

    /// A communication step: the integration's steps inside it. An error says what went wrong.
    pub(super) fn advance(
        &mut self,
        length: f64,
        end: Inputs,
        exact_track: bool,
        constants: &Constants,
        contact: &WheelRail<'_>,
    ) -> std::result::Result<(), String> {
        let begin = self.inputs;
        // As many as fit, with a little for the rounding of a length that is a whole number of steps.
        let parts = (length / constants.step - 1e-6).ceil().max(1.0) as u32;
        let h = length / f64::from(parts);
        for part in 1..=parts {
            self.step(h, begin.towards(&end, part, parts), exact_track, constants, contact);
        }
        let position = &self.wheelset.body.position;
        let [rails, _] = end.rails();
        if !position.iter().all(|x| x.abs() < 1e12) {
            return Err("the wheelset's state is no number: the step is too long for these forces".into());
        }
        if (position[LATERAL] - rails.lateral).abs() > DERAILED {
            return Err(format!("the wheelset has left the rails: lateral is {} m", position[LATERAL]));
        }
        Ok(())
    }

    /// One step of the integration, as [`Vehicle::step`] does it.
    fn step(&mut self, h: f64, to: Inputs, exact_track: bool, constants: &Constants, contact: &WheelRail<'_>) {
        let (from, way) = (self.inputs, h * to.speed());
        let turn = FrameTurn {
            roll: to.cant() - from.cant(),
            yaw: if exact_track {
                to.heading() - from.heading()
            } else {
                0.5 * (from.curvature() + to.curvature()) * way
            },
        };
        let cant_slope = if exact_track {
            to.cant_slope()
        } else if way > 0.0 {
            turn.roll / way
        } else {
            0.0
        };
        self.wheelset.body.predict(h, turn);
        let reaction = self.suspension(constants, &to);
        let track = TrackPoint { curvature: to.curvature(), cant: to.cant(), cant_slope };
        let loads =
            reaction.wheelset + constants.vehicle.carried.load(track.apparent_gravity(to.speed())) + to.forces();
        let inputs = wheelset::Inputs { speed: to.speed(), track, rails: to.rails(), loads };
        self.wheelset.correct(h, &inputs, &constants.vehicle.wheelset, contact);
        self.track_rates = [to.speed() * cant_slope, to.speed() * to.curvature()];
        self.reaction = reaction.frame;
        self.inputs = to;
    }

    fn suspension(&self, constants: &Constants, inputs: &Inputs) -> crate::dynamics::suspension::Reaction {
        let frame = inputs.frame(self.rest);
        constants.vehicle.suspension.reaction(&self.wheelset.body, &frame, &Seat::default(), 0.0)
    }

    /// Writes the outputs.
    pub(super) fn write(&self, outputs: &mut [f64]) {
        let (q, v) = (&self.wheelset.body.position, &self.wheelset.body.velocity);
        let [roll_rate, yaw_rate] = self.track_rates;
        let rates =
            Rates { lateral: v[LATERAL], yaw: v[YAW] - yaw_rate, vertical: v[VERTICAL], roll: v[ROLL] - roll_rate };
        let values = [
            q[LATERAL],
            q[YAW],
            q[VERTICAL],
            q[ROLL],
            rates.lateral,
            rates.yaw,
            rates.vertical,
            rates.roll,
            v[PITCH],
            self.reaction[LATERAL],
            self.reaction[VERTICAL],
            self.reaction[ROLL],
            self.reaction[YAW],
        ];
        outputs[..OUTPUTS].copy_from_slice(&values);
        super::wheels::write(&self.wheelset.wheels, &mut outputs[OUTPUTS..]);
    }
}
