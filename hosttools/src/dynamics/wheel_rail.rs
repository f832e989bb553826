//! All forces between a wheelset and its rails: contacts of both wheels, creepages, creep forces, wrench, wear.

use flangeway::creep::{self, CreepForces, Creepages, Elasticity, Friction, Patch, wear_index};
use flangeway::wheelset::{Motion, WheelLoads, Wrench, contact_wrench, creepages};
use flangeway::{Contact, Contacts, SLOTS, Side};
use nalgebra::Vector3;

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

impl Law {
    fn forces(self, patch: &Patch, elasticity: &Elasticity, creepages: &Creepages, friction: f32) -> CreepForces {
        match self {
            Self::Kalker => creep::kalker_linear(patch, elasticity, creepages),
            Self::ShenHedrickElkins => creep::shen_hedrick_elkins(patch, elasticity, creepages, friction),
            Self::Polach => creep::polach(patch, elasticity, creepages, friction),
            Self::Fastsim => creep::fastsim::<ELEMENTS, ELEMENTS>(patch, elasticity, creepages, friction),
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
        let mut total = Wrench::default();
        let mut contacts = Contacts::NONE;
        for (side, wheel) in Side::ALL.into_iter().zip(wheels) {
            wheel.touches = [None; SLOTS];
            self.source.contacts_into(side, &motion.pose, &mut contacts);
            wheel.flags = contacts.flags.bits();
            let geometry = self.source.geometry(side);
            let mut on_wheel = Wrench::default();
            for contact in &mut contacts.list {
                contact.normal_force *= self.damped(geometry.nominal_radius, motion, contact);
                let creepages = creepages(geometry, motion, contact);
                let Creepages { longitudinal: xi, lateral: eta, .. } = creepages;
                let slip = (xi * xi + eta * eta).sqrt() * motion.speed as f32;
                let patch = Patch::from(&*contact);
                let forces = self.law.forces(&patch, &self.elasticity, &creepages, self.friction.at(slip));
                let wrench = contact_wrench(geometry, &motion.pose, contact, &forces);
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

    /// What the damping makes of a normal force, of the rates of the pose alone (rolling has no part along the normal):
    ///
    /// ```text
    /// N = C δ^1.5 (1 + χ δ'),   δ' = ((0, y', z') + (φ', 0, ψ') × r)·(0, -sin α, cos α)
    /// ```
    fn damped(&self, radius: f64, motion: &Motion, contact: &Contact) -> f32 {
        let Motion { pose, rates, .. } = motion;
        let arm = contact.position.cast::<f64>() - Vector3::new(0.0, pose.lateral, pose.vertical - radius);
        let turn = Vector3::new(rates.roll, 0.0, rates.yaw);
        let velocity = Vector3::new(0.0, rates.lateral, rates.vertical) + turn.cross(&arm);
        let approach = -velocity.dot(&contact.normal().cast());
        (1.0 + self.damping * approach).clamp(0.0, 2.0) as f32
    }
}
