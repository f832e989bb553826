//! All forces between a wheelset and its rails: contacts of both wheels, creepages, creep forces, wrench, wear.

use flangeway::creep::{self, CreepForces, Creepages, Elasticity, Friction, Patch, wear_index};
use flangeway::wheelset::{Footing, Motion, Rolling, WheelLoads, Wrench};
use flangeway::{Contact, Contacts, SLOTS, Side};

use super::source::Source;

/// How creep forces follow from creepages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Kalker's linear theory, without a limit: for small creepages only
    Kalker,
    /// Kalker's linear theory with the saturation of Shen, Hedrick and Elkins
    ShenHedrickElkins,
    /// Polach's formula
    Polach,
    /// FASTSIM on 10 x 10 elements
    Fastsim,
}

/// Elements of the ellipse in [`Law::Fastsim`], along and across.
pub const ELEMENTS: usize = 10;

/// Contacts of a wheelset, rounded up to fours.
const PLACES: usize = (2 * SLOTS).next_multiple_of(4);

/// What a creep law takes of all contacts of a wheelset, and what it gives; places beyond them are empty.
struct Creep {
    patches: [Patch; PLACES],
    creepages: [Creepages; PLACES],
    friction: [f32; PLACES],
    forces: [CreepForces; PLACES],
}

impl Creep {
    const NONE: Self = Self {
        patches: [Patch { semi_axes: [0.0; 2], normal_force: 0.0 }; PLACES],
        creepages: [Creepages { longitudinal: 0.0, lateral: 0.0, spin: 0.0 }; PLACES],
        friction: [0.0; PLACES],
        forces: [CreepForces::NONE; PLACES],
    };

    /// Forces of the first `count` contacts.
    fn find(&mut self, law: Law, elasticity: &Elasticity, count: usize) {
        if law == Law::Polach {
            let fours = self.patches.as_chunks().0.iter().zip(self.creepages.as_chunks().0);
            let fours = fours.zip(self.friction.as_chunks().0).zip(self.forces.as_chunks_mut::<4>().0);
            for (((patches, creepages), friction), forces) in fours.take(count.div_ceil(4)) {
                *forces = creep::polach_four(patches, elasticity, creepages, friction);
            }
            return;
        }
        let each = self.patches.iter().zip(&self.creepages).zip(&self.friction).zip(&mut self.forces).take(count);
        for (((patch, creepages), &friction), forces) in each {
            *forces = match law {
                Law::Kalker => creep::kalker_linear(patch, elasticity, creepages),
                Law::ShenHedrickElkins => creep::shen_hedrick_elkins(patch, elasticity, creepages, friction),
                Law::Polach => creep::polach(patch, elasticity, creepages, friction),
                Law::Fastsim => creep::fastsim::<ELEMENTS, ELEMENTS>(patch, elasticity, creepages, friction),
            };
        }
    }
}

/// What is needed to find the forces at a pose.
#[derive(Debug, Clone, Copy)]
pub struct WheelRail<'a> {
    /// Where contacts come from.
    pub source: Source<'a>,
    /// Creep law.
    pub law: Law,
    /// Friction between wheel and rail.
    pub friction: Friction,
    /// Material.
    pub elasticity: Elasticity,
    /// Damping χ of the contact's approach, s/m: what track and ballast take from a wheel that bounces on its contacts,
    /// on a track that is rigid here. Hunt and Crossley's form, which pulls nowhere (J. Applied Mechanics 42, 1975).
    pub damping: f64,
}

/// One contact that carries force, with its creep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Place, normal force and ellipse.
    pub contact: Contact,
    /// Creepages.
    pub creepages: Creepages,
    /// Creep forces on the wheel.
    pub forces: CreepForces,
    /// Its part of the wheel's lateral and vertical force on the rail.
    pub loads: WheelLoads,
    /// Wear index T gamma: energy dissipated a metre of way, N.
    pub wear: f64,
}

/// One wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wheel {
    /// Its contacts by slot.
    pub touches: [Option<Touch>; SLOTS],
    /// Lateral and vertical force of the wheel on the rail.
    pub loads: WheelLoads,
    /// Bits of [`flangeway::Flags`] from the lookup.
    pub flags: u8,
}

impl Wheel {
    /// Wear index of all its contacts, N.
    #[must_use]
    pub fn wear(&self) -> f64 {
        self.touches.iter().flatten().map(|touch| touch.wear).sum()
    }

    /// Sum of its contacts' normal forces, N.
    #[must_use]
    pub fn normal_force(&self) -> f64 {
        self.touches.iter().flatten().map(|touch| f64::from(touch.contact.normal_force)).sum()
    }
}

impl WheelRail<'_> {
    /// Wrench of the rails on the wheelset about its centre, in the frame of the rails; fills in both wheels, right first.
    pub fn forces(&self, motion: &Motion, wheels: &mut [Wheel; 2]) -> Wrench {
        let rolling = Rolling::new(motion);
        let mut contacts = [const { Contacts::NONE }; 2];
        let (mut creep, mut count) = (Creep::NONE, 0);
        let mut footings = [Footing::default(); PLACES];
        for (side, contacts) in Side::ALL.into_iter().zip(&mut contacts) {
            self.source.contacts_into(side, &motion.pose, contacts);
            let geometry = self.source.geometry(side);
            for contact in &mut contacts.list {
                let footing = Footing::new(geometry, &motion.pose, contact);
                contact.normal_force *= self.damped(footing.approach(&rolling));
                let creepages = footing.creepages(&rolling);
                let Creepages { longitudinal: xi, lateral: eta, .. } = creepages;
                let slip = (xi * xi + eta * eta).sqrt() * motion.speed as f32;
                footings[count] = footing;
                creep.patches[count] = Patch::from(&*contact);
                creep.creepages[count] = creepages;
                creep.friction[count] = self.friction.at(slip);
                count += 1;
            }
        }
        creep.find(self.law, &self.elasticity, count);
        let mut found = footings.iter().zip(&creep.creepages).zip(&creep.forces);
        let mut total = Wrench::default();
        for ((side, contacts), wheel) in Side::ALL.into_iter().zip(&contacts).zip(wheels) {
            wheel.touches.iter_mut().for_each(|touch| *touch = None);
            wheel.flags = contacts.flags.bits();
            let mut on_wheel = Wrench::default();
            for (contact, ((footing, &creepages), &forces)) in contacts.iter().zip(&mut found) {
                let wrench = footing.wrench(contact.normal_force, &forces);
                on_wheel = on_wheel + wrench;
                let loads = WheelLoads::new(side, &wrench);
                let wear = wear_index(&creepages, &forces);
                wheel.touches[contact.slot.index()] = Some(Touch { contact: *contact, creepages, forces, loads, wear });
            }
            wheel.loads = WheelLoads::new(side, &on_wheel);
            total = total + on_wheel;
        }
        total
    }

    /// What the damping makes of a normal force at a rate of approach: N = C δ^1.5 (1 + χ δ'), not less than nothing.
    fn damped(&self, approach: f64) -> f32 {
        (1.0 + self.damping * approach).clamp(0.0, 2.0) as f32
    }
}
