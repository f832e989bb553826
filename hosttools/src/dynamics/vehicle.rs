//! Vehicles: a single wheelset on a suspension that is led along the track, and a bogie of two wheelsets.
//!
//! What is carried is a mass that follows the track: gravity, cant and curve act on it, through its height they load the
//! wheels of one side, and it neither sways nor turns. A single wheelset carries it on its axle boxes, and its suspension
//! holds it to a frame that runs along the track exactly and points, and turns, as the track does at a distance behind
//! the axle: so it stands for the leading wheelset of a longer vehicle, which a curve leaves at an angle. A bogie carries
//! it on the centre of its frame, which has five degrees of freedom of its own; the boxes' springs are preloaded by the
//! weight, so that displacements count from rest.

use super::body::{Body, LATERAL, PITCH, ROLL, VERTICAL, Vector5, YAW};
use super::irregularity::Irregularity;
use super::suspension::{Seat, Suspension};
use super::track::{GRAVITY, Track};
use super::wheel_rail::WheelRail;
use super::wheelset::{self, Inputs, Wheelset};
use crate::error::{Error, Result};

/// Mass and inertia of a bogie's frame.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameParameters {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moments of inertia about x, y, z, kg m².
    pub inertia_kgm2: [f64; 3],
    /// Distance between the two wheelsets, m.
    pub wheelbase_m: f64,
}

/// What the vehicle carries.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Carried {
    /// Mass on this wheelset or bogie, kg.
    pub mass_kg: f64,
    /// Height of its centre of gravity above the axle (single wheelset) or above the bogie frame's centre, m.
    pub height_m: f64,
}

/// A vehicle's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Each wheelset.
    pub wheelset: wheelset::Parameters,
    /// Each wheelset's suspension.
    pub suspension: Suspension,
    /// What is carried.
    pub carried: Carried,
    /// The bogie's frame; none for a single wheelset.
    pub frame: Option<FrameParameters>,
    /// How far behind a single wheelset its leading frame takes the track's direction, m.
    pub led_from_m: f64,
}

/// What a vehicle runs on.
#[derive(Debug, Clone, Copy)]
pub struct Line<'a> {
    /// The centre line.
    pub track: &'a Track,
    /// How the rails deviate from it.
    pub irregularity: &'a Irregularity,
    /// Contact and creep.
    pub contact: &'a WheelRail<'a>,
    /// Speed, m/s.
    pub speed: f64,
}

/// A vehicle on its way.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    parameters: Parameters,
    /// Wheelsets, the leading one first.
    pub wheelsets: Vec<Wheelset>,
    /// The bogie's frame, or the one that leads a single wheelset, seen from the track at the axle.
    pub frame: Body,
    /// Distance of its centre from the track's begin, m.
    pub distance: f64,
    /// Time since the start, s.
    pub time: f64,
}

impl Parameters {
    /// How far each axle stands ahead of the vehicle's centre, m.
    #[must_use]
    pub fn axles(&self) -> Vec<f64> {
        self.frame.map_or(vec![0.0], |frame| vec![0.5 * frame.wheelbase_m, -0.5 * frame.wheelbase_m])
    }

    /// Weight on each axle at rest on level track, wheelset included, N.
    #[must_use]
    pub fn axle_load(&self) -> f64 {
        let frame = self.frame.map_or(0.0, |frame| frame.mass_kg);
        GRAVITY * (self.wheelset.mass_kg + (self.carried.mass_kg + frame) / self.axles().len() as f64)
    }
}

impl Vehicle {
    /// A vehicle at the begin of a line, its wheels rolling freely in the middle of the track under their weight.
    ///
    /// # Errors
    /// When the wheels do not carry the weight at any height.
    pub fn at_rest(parameters: Parameters, line: &Line<'_>) -> Result<Self> {
        let seats = parameters.axles();
        let distance = seats.iter().copied().fold(0.0, f64::max);
        let mut at_rest = Wheelset::default();
        at_rest.body.position[VERTICAL] = height(&mut at_rest, &parameters, line)?;
        // Rolling freely: by the radii at which the wheels touch.
        let radii =
            at_rest.wheels.iter().flat_map(|w| w.touches).flatten().map(|t| f64::from(t.contact.rolling_radius));
        let (sum, count) = radii.fold((0.0, 0), |(sum, count), radius| (sum + radius, count + 1));
        at_rest.body.velocity[PITCH] = line.speed * f64::from(count.max(1)) / sum;
        let mut frame = Body::default();
        frame.position[VERTICAL] = at_rest.body.position[VERTICAL];
        let turning = |at: f64| line.speed * line.track.at(at).curvature;
        let wheelset = |ahead: &f64| {
            let mut wheelset = at_rest;
            wheelset.body.velocity[YAW] = turning(distance + ahead);
            wheelset
        };
        frame.velocity[YAW] = turning(distance);
        let wheelsets = seats.iter().map(wheelset).collect();
        let mut vehicle = Self { parameters, wheelsets, frame, distance, time: 0.0 };
        // Accelerations to start from: a step of no length.
        vehicle.step(0.0, line);
        for body in vehicle.wheelsets.iter_mut().map(|w| &mut w.body).chain([&mut vehicle.frame]) {
            body.start(body.acceleration);
        }
        Ok(vehicle)
    }

    /// One step of `h` seconds.
    pub fn step(&mut self, h: f64, line: &Line<'_>) {
        let Line { track, irregularity, contact, speed } = *line;
        let (from, to) = (self.distance, self.distance + h * speed);
        let here = track.place(to);
        let half_base = self.parameters.frame.map_or(0.0, |frame| 0.5 * frame.wheelbase_m);
        self.distance = to;
        self.time += h;
        let Parameters { wheelset: constants, suspension, carried, frame, led_from_m } = self.parameters;
        if frame.is_some() {
            self.frame.predict(h, here.turn_from(&track.place(from)));
        } else {
            self.frame = leading_frame(track, to, led_from_m, speed, self.frame.position[VERTICAL]);
        }
        let mut on_frame = Vector5::zeros();
        let axles = self.wheelsets.len() as f64;
        let preload = frame.map_or(0.0, |frame| GRAVITY * (frame.mass_kg + carried.mass_kg) / (2.0 * axles));
        for (index, wheelset) in self.wheelsets.iter_mut().enumerate() {
            let ahead = if index == 0 { half_base } else { -half_base };
            let there = track.place(to + ahead);
            wheelset.body.predict(h, there.turn_from(&track.place(from + ahead)));
            let seat = Seat::between(track, to, [here, there], [ahead, suspension.below_frame_m], speed);
            let reaction = suspension.reaction(&wheelset.body, &self.frame, &seat, preload);
            on_frame += reaction.frame;
            let mut loads = reaction.wheelset;
            if frame.is_none() {
                loads += carried.load(there.point.apparent_gravity(speed));
            }
            let (offsets, slopes) = irregularity.at(to + ahead);
            let inputs = Inputs { speed, track: there.point, rails: [offsets, slopes], loads };
            wheelset.correct(h, &inputs, &constants, contact);
        }
        if let Some(frame) = frame {
            let gravity = here.point.apparent_gravity(speed);
            on_frame += carried.load(gravity);
            let [about_x, about_y, about_z] = frame.inertia_kgm2;
            let acceleration = Vector5::new(
                on_frame[LATERAL] / frame.mass_kg + gravity.x,
                on_frame[VERTICAL] / frame.mass_kg + gravity.y,
                on_frame[ROLL] / about_x,
                on_frame[YAW] / about_z,
                on_frame[PITCH] / about_y,
            );
            self.frame.correct(h, acceleration);
        }
    }
}

/// The frame that leads a single wheelset, seen from the track at its axle: there it follows track and cant, and it points
/// and turns as the track does at a distance `behind` (m); `height` (m) is that at rest.
///
/// ```text
/// ψf = Θ(s - b) - Θ(s),   ψf' = V κ(s - b),   φf' = V θ'(s), both absolute
/// ```
fn leading_frame(track: &Track, distance: f64, behind: f64, speed: f64, height: f64) -> Body {
    let mut frame = Body::default();
    frame.position[VERTICAL] = height;
    frame.position[YAW] = track.heading(distance - behind) - track.heading(distance);
    frame.velocity[YAW] = speed * track.at(distance - behind).curvature;
    frame.velocity[ROLL] = speed * track.at(distance).cant_slope;
    frame
}

impl Carried {
    /// What it does where it is carried, under an apparent gravity `[y, z]` (m/s²): M_x = H F_y.
    pub(crate) fn load(&self, gravity: nalgebra::Vector2<f64>) -> Vector5 {
        let [lateral, vertical] = [self.mass_kg * gravity.x, self.mass_kg * gravity.y];
        Vector5::new(lateral, vertical, self.height_m * lateral, 0.0, 0.0)
    }
}

/// Height (m) at which a centred wheelset's wheels carry the axle load, by bisection.
fn height(at_rest: &mut Wheelset, parameters: &Parameters, line: &Line<'_>) -> Result<f64> {
    let mut lift = |vertical: f64| {
        at_rest.body.position[VERTICAL] = vertical;
        let inputs = Inputs { speed: line.speed, ..Inputs::default() };
        at_rest.correct(0.0, &inputs, &parameters.wheelset, line.contact);
        // What weight and rails together leave.
        parameters.axle_load() + parameters.wheelset.mass_kg * (at_rest.body.acceleration[VERTICAL] - GRAVITY)
    };
    let (mut high, mut low) = (-2e-3, 2e-3);
    if lift(high) < 0.0 || lift(low) > 0.0 {
        return Err(Error::field("", "recipe", "a centred wheelset does not carry the axle load on these rails"));
    }
    for _ in 0..60 {
        let middle = 0.5 * (high + low);
        if lift(middle) > 0.0 { high = middle } else { low = middle }
    }
    Ok(0.5 * (high + low))
}
