//! The wheelset: from its motion to the creepages of a contact, from the forces of its contacts to the wrench on it.

use nalgebra::Vector3;

use crate::contact::Contact;
use crate::creep::{CreepForces, Creepages};
use crate::displacement::Attitude;
use crate::math::{Two, at_least, sine_cosine, single};
use crate::pose::{Pose, Side, WheelGeometry};

/// Least speed that creepages are divided by, m/s: below it, creep forces fade into viscous ones, and at rest without
/// rates there are none.
pub const SPEED_FLOOR: f64 = 0.01;

/// Largest magnitude of a state's number that is taken as one, in its SI unit.
pub const STATE_LIMIT: f64 = 1e6;

/// Rates of a [`Pose`], seen in the track frame that moves along with the wheelset.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates {
    /// Rate of the lateral displacement, m/s.
    pub lateral: f64,
    /// Rate of yaw, rad/s.
    pub yaw: f64,
    /// Rate of the vertical displacement, m/s.
    pub vertical: f64,
    /// Rate of roll, rad/s.
    pub roll: f64,
}

/// State of a wheelset as far as its contacts move by it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Pose in the [track frame](crate#frame).
    pub pose: Pose,
    /// Rates of the pose.
    pub rates: Rates,
    /// Speed V along the track's centre line, forward, m/s.
    pub speed: f64,
    /// Angular speed ω about the axle, positive when rolling forward (V / r0 when free), rad/s.
    pub spin: f64,
    /// Curvature κ of the track's centre line, positive in a right-hand curve, 1/m.
    pub track_curvature: f64,
}

/// Creepages of a contact: velocity of the wheel's material relative to the rail's at the contact point, in the
/// contact's axes, divided by the speed.
///
/// Kalker (1990); in components Iwnicki (ed.), Handbook of Railway Vehicle Dynamics (2006). The track
/// frame moves with V and turns with V κ about z, so in it the rail runs backwards. With the axle's direction e, the
/// point p of the contact and r from the wheelset's centre to it:
///
/// ```text
/// e = (-sin ψ cos φ, cos ψ cos φ, sin φ)
/// Ω = ψ' z + φ' (cos ψ, sin ψ, 0) - ω e
/// v = (0, y', z') + Ω × r + V (1 - κ py, κ px, 0)
/// t = (0, cos α, sin α)      n = x × t = (0, -sin α, cos α)
/// ξ = v x / V      η = v·t / V      φ = (Ω + V κ z)·n / V
/// ```
///
/// A wheelset that rolls on circles of its true radii has none but spin, φ = sin α / r: negative on the right rail's
/// gauge side. Yaw ψ alone gives η = -ψ on the tread: the wheel rolls to the side it points to, which is the right when
/// ψ > 0, while it is held back.
///
/// `position` is `f32`: its height above the rail plane, of millimetres, is rounded to 1e-10 m, and ξ by 3e-10 of it;
/// across, 3e-8 m times yaw.
///
/// States that are no numbers, or beyond [`STATE_LIMIT`], give no creepages.
#[must_use]
pub fn creepages(geometry: &WheelGeometry, motion: &Motion, contact: &Contact) -> Creepages {
    Footing::new(geometry, &motion.pose, contact).creepages(&Rolling::new(motion))
}

/// A motion as contacts take it: what all contacts of a wheelset have in common. Zeros for a [`Motion`] that is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rolling {
    /// Ω, rad/s.
    turn: Vector3<f64>,
    /// Ω + V κ z along z, rad/s.
    turn_z: f64,
    /// y' and z', m/s; φ' and ψ', rad/s.
    rates: Rates,
    /// V, m/s, and V κ, 1/s.
    speed: f64,
    track_turn: f64,
    /// 1 / V, s/m.
    per_speed: f64,
}

impl Rolling {
    /// What a motion's contacts share.
    #[inline]
    #[must_use]
    pub fn new(motion: &Motion) -> Self {
        let Motion { pose, rates, speed, spin, track_curvature } = *motion;
        // By masks, so that no branch is made of it. Angles are clamped before they are used, so they are asked for here.
        let limit = Two::all(STATE_LIMIT);
        let pairs = [
            [speed, track_curvature],
            [rates.lateral, rates.vertical],
            [rates.roll, rates.yaw],
            [pose.lateral, pose.vertical],
            [spin, pose.yaw],
            [pose.roll, 0.0],
        ]
        .map(Two::new);
        let [first, second, third, fourth, fifth, sixth] = pairs.map(|pair| pair.abs().within(limit));
        let valid = first.and(second).and(third).and(fourth.and(fifth).and(sixth));
        let [first, second, third, _, fifth, _] = pairs.map(|pair| pair.where_all(valid).numbers());
        let ([speed, curvature], [lateral, vertical], [roll, yaw], [spin, _]) = (first, second, third, fifth);
        let Attitude { yaw: psi, roll: phi } = Attitude::new(pose.yaw, pose.roll);
        // e = (-sin ψ cos φ, cos ψ cos φ, sin φ)
        let axle = Vector3::new(-psi.sin * phi.cos, psi.cos * phi.cos, phi.sin);
        // Ω = ψ' z + φ' (cos ψ, sin ψ, 0) - ω e
        let turn = Vector3::new(roll * psi.cos, roll * psi.sin, yaw) - axle * spin;
        let track_turn = speed * curvature;
        Self {
            turn,
            turn_z: turn.z + track_turn,
            rates: Rates { lateral, yaw, vertical, roll },
            speed,
            track_turn,
            per_speed: 1.0 / at_least(speed.abs(), SPEED_FLOOR),
        }
    }
}

/// A contact as its wheelset stands on it: the arm from the wheelset's centre and the axes of the contact plane, found once
/// for the contact's creepages, approach and wrench. Zeros for a contact that is no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Footing {
    /// r, m.
    arm: Vector3<f64>,
    /// y of the contact point; its x is the arm's, m.
    across: f64,
    /// sin α and cos α.
    sin: f64,
    cos: f64,
    /// One.
    along: f64,
}

impl Footing {
    /// Arm and axes of a contact of a wheelset at a pose.
    #[inline]
    #[must_use]
    pub fn new(geometry: &WheelGeometry, pose: &Pose, contact: &Contact) -> Self {
        let (sin, cos) = sine_cosine(f64::from(contact.angle));
        let point = contact.position.cast::<f64>();
        // From the wheelset's centre, at (0, y, z - r0), to the contact point.
        let arm = point - Vector3::new(0.0, pose.lateral, pose.vertical - geometry.nominal_radius);
        let (place, height, turned) = (Two::new([point.x, point.y]), Two::new([arm.y, arm.z]), Two::new([sin, cos]));
        let angle = Two::new([f64::from(contact.angle), point.z]);
        let limit = Two::all(STATE_LIMIT);
        let inside = |pair: Two| pair.abs().within(limit);
        let valid = inside(place).and(inside(height)).and(inside(angle));
        let [[x, y], [arm_y, arm_z], [sin, cos], [along, _]] =
            [place, height, turned, Two::all(1.0)].map(|pair| pair.where_all(valid).numbers());
        Self { arm: Vector3::new(x, arm_y, arm_z), across: y, sin, cos, along }
    }

    /// As [`creepages`].
    #[inline]
    #[must_use]
    pub fn creepages(&self, rolling: &Rolling) -> Creepages {
        let (arm, turn, y) = (&self.arm, &rolling.turn, self.across);
        // v = (0, y', z') + Ω × r + V (1 - κ py, κ px, 0)
        let velocity_x = turn.y * arm.z - turn.z * arm.y + (rolling.speed - rolling.track_turn * y);
        let velocity_y = turn.z * arm.x - turn.x * arm.z + (rolling.rates.lateral + rolling.track_turn * arm.x);
        let velocity_z = turn.x * arm.y - turn.y * arm.x + rolling.rates.vertical;
        let longitudinal = velocity_x * self.along;
        let lateral = velocity_y * self.cos + velocity_z * self.sin;
        let about_normal = rolling.turn_z * self.cos - turn.y * self.sin;
        let per_speed = Two::all(rolling.per_speed);
        let [longitudinal, lateral] = (Two::new([longitudinal, lateral]) * per_speed).single();
        let spin = single(about_normal * rolling.per_speed);
        Creepages { longitudinal, lateral, spin }
    }

    /// Rate δ' at which wheel and rail approach along their normal, by the rates of the pose alone (rolling has no part in
    /// it), m/s:
    ///
    /// ```text
    /// δ' = ((0, y', z') + (φ', 0, ψ') × r)·n
    /// ```
    #[inline]
    #[must_use]
    pub fn approach(&self, rolling: &Rolling) -> f64 {
        let (arm, Rates { lateral, yaw, vertical, roll }) = (&self.arm, rolling.rates);
        (vertical + roll * arm.y) * self.cos - (lateral + yaw * arm.x - roll * arm.z) * self.sin
    }

    /// As [`contact_wrench`], of a normal force (N) and creep forces.
    #[inline]
    #[must_use]
    pub fn wrench(&self, normal_force: f32, creep: &CreepForces) -> Wrench {
        let (sin, cos) = (self.sin, self.cos);
        let (normal, lateral) = (f64::from(normal_force), f64::from(creep.lateral));
        let (longitudinal, spin_moment) = (f64::from(creep.longitudinal), f64::from(creep.spin_moment));
        // F = -N n + Fx x + Fy t
        let force =
            Vector3::new(longitudinal * self.along, normal * sin + lateral * cos, -normal * cos + lateral * sin);
        // M = r × F + Mz n
        let moment = self.arm.cross(&force) + Vector3::new(0.0, -sin, cos) * spin_moment;
        Wrench { force, moment }
    }
}

/// Force and moment on a wheelset in the track frame, about the wheelset's centre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment about the wheelset's centre, N m.
    pub moment: Vector3<f64>,
}

impl core::ops::Add for Wrench {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}

impl core::iter::Sum for Wrench {
    fn sum<I: Iterator<Item = Self>>(wrenches: I) -> Self {
        wrenches.fold(Self::default(), |sum, wrench| sum + wrench)
    }
}

/// Wrench of one contact on the wheelset: normal force, creep forces and spin moment. The contacts of both wheels add up
/// by [`Sum`](core::iter::Sum).
///
/// ```text
/// F = -N n + Fx x + Fy t        M = r × F + Mz n
/// ```
#[must_use]
pub fn contact_wrench(geometry: &WheelGeometry, pose: &Pose, contact: &Contact, creep: &CreepForces) -> Wrench {
    Footing::new(geometry, pose, contact).wrench(contact.normal_force, creep)
}

/// Guiding force and wheel load of one wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelLoads {
    /// Guiding force Y of the wheel on its rail, positive outwards (as a flange presses), N.
    pub guiding_force: f64,
    /// Wheel load Q on the rail, positive down, N.
    pub wheel_load: f64,
}

impl WheelLoads {
    /// Loads of a wheel from the sum of its contacts' wrenches.
    #[must_use]
    pub fn new(side: Side, wheel: &Wrench) -> Self {
        Self { guiding_force: -side.sign() * wheel.force.y, wheel_load: -wheel.force.z }
    }

    /// Y / Q; zero for a wheel without load.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        if self.wheel_load > 0.0 { self.guiding_force / self.wheel_load } else { 0.0 }
    }
}

/// Nadal's limit of Y / Q for a flange of a contact angle (rad, its sign does not matter) and a friction coefficient:
/// beyond it the flange may climb.
///
/// M. J. Nadal (1896), EN 14363: Y/Q = (tan β - μ) / (1 + μ tan β).
#[must_use]
pub fn nadal_limit(angle: f64, friction: f64) -> f64 {
    let (sin, cos) = sine_cosine(angle.abs());
    // Both times cos β, for steep flanges.
    (sin - friction * cos) / (cos + friction * sin)
}
