//! Creep forces of the cases' contacts: the motions that they are computed for, and the host's numbers.

use flangeway::creep::{CreepForces, Creepages, Elasticity, Patch, fastsim, polach};
use flangeway::wheelset::{Motion, Rates, contact_wrench, creepages};
use flangeway::{Contact, Pose, WheelGeometry};
use rand::{Rng, RngExt};

/// Bytes of a law's numbers: creepages and forces (`f32`), wrench (`f64`).
pub(crate) const NUMBERS: usize = 6 * 4 + 6 * 8;

/// What is no creepage and no friction, or hardly one.
const STRANGE: [f32; 8] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, 1e-40, -1.0, 0.0, 5.0];

/// What creep forces depend on beside the contact and the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CreepCase {
    pub(crate) motion: Motion,
    /// Added to the motion's creepages: none, or something strange.
    pub(crate) added: Creepages,
    pub(crate) friction: f32,
}

/// A law of creep forces.
pub(crate) type Law = fn(&Patch, &Elasticity, &Creepages, f32) -> CreepForces;
/// The laws, in the order of the firmware's answers.
pub(crate) const LAWS: [Law; 2] = [polach, fastsim::<10, 10>];

impl CreepCase {
    /// A motion of one of eight kinds: rolling with small slip (three of them), at rest, locked and sliding, with a number
    /// of the motion, a creepage or the friction that is strange.
    pub(crate) fn new(pose: Pose, geometry: &WheelGeometry, index: usize, random: &mut impl Rng) -> Self {
        let mut within = |limit: f64| limit * (2.0 * random.random::<f64>() - 1.0);
        let rates = Rates { lateral: within(0.1), yaw: within(0.02), vertical: within(0.05), roll: within(0.02) };
        let speed = 40.0 + within(39.0);
        let spin = speed / geometry.nominal_radius * (1.0 + within(0.005));
        let motion = Motion { pose, rates, speed, spin, track_curvature: within(3e-3) };
        let mut case = Self { motion, added: Creepages::default(), friction: 0.3 };
        let (kind, which) = (index % 8, index / 8);
        let strange = STRANGE[which % STRANGE.len()];
        match kind {
            3 => case.motion = Motion { pose, ..Motion::default() },
            4 => case.motion.spin = 0.0,
            5 => {
                *[&mut case.motion.speed, &mut case.motion.rates.yaw, &mut case.motion.spin][which % 3] = strange.into()
            }
            6 => {
                let Creepages { longitudinal, lateral, spin } = &mut case.added;
                *[longitudinal, lateral, spin][which % 3] = strange;
            }
            7 => case.friction = strange,
            _ => {}
        }
        case
    }

    /// The motion's numbers beside the pose, the added creepages, the friction.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let Self { motion: Motion { rates, speed, spin, track_curvature, .. }, added, friction } = self;
        let doubles = [rates.lateral, rates.yaw, rates.vertical, rates.roll, *speed, *spin, *track_curvature];
        let singles = [added.longitudinal, added.lateral, added.spin, *friction];
        [doubles.map(f64::to_le_bytes).as_flattened(), singles.map(f32::to_le_bytes).as_flattened()].concat()
    }

    /// A contact's numbers by a law, as the firmware writes them.
    pub(crate) fn numbers(
        &self,
        geometry: &WheelGeometry,
        elasticity: &Elasticity,
        contact: &Contact,
        law: Law,
    ) -> Vec<u8> {
        let c = creepages(geometry, &self.motion, contact);
        let creepages = Creepages {
            longitudinal: c.longitudinal + self.added.longitudinal,
            lateral: c.lateral + self.added.lateral,
            spin: c.spin + self.added.spin,
        };
        let f = law(&contact.into(), elasticity, &creepages, self.friction);
        let w = contact_wrench(geometry, &self.motion.pose, contact, &f);
        let singles = [c.longitudinal, c.lateral, c.spin, f.longitudinal, f.lateral, f.spin_moment];
        let doubles = [w.force.x, w.force.y, w.force.z, w.moment.x, w.moment.y, w.moment.z];
        [singles.map(f32::to_le_bytes).as_flattened(), doubles.map(f64::to_le_bytes).as_flattened()].concat()
    }
}
