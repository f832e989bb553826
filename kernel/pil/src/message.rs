//! What host and board say to each other.

use flangeway::{Contact, Contacts, Pose, SLOTS, Side};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Host to board.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Begins a session, whose number the host has not used before. The board forgets the one before and answers with
    /// its identity.
    Hello {
        /// Number of the session.
        session: u32,
    },
    /// Asks for the contacts of a pose.
    Step(Step),
}

/// A pose to be looked up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Number of the session.
    pub session: u32,
    /// Number of the step in it, one more than that before; any number begins.
    pub sequence: u32,
    /// Wheels: bit 0 the right one, bit 1 the left one.
    pub sides: u8,
    /// Lateral, yaw, vertical, roll of the wheelset, m and rad.
    pub pose: [f64; 4],
}

impl Step {
    /// The wheelset's pose.
    #[must_use]
    pub const fn pose(&self) -> Pose {
        let [lateral, yaw, vertical, roll] = self.pose;
        Pose { lateral, yaw, vertical, roll }
    }
}

/// Sides of a step's bits, the right one first.
pub fn sides(bits: u8) -> impl Iterator<Item = Side> {
    Side::ALL.into_iter().enumerate().filter(move |(i, _)| bits >> i & 1 == 1).map(|(_, side)| side)
}

/// Board to host.
#[expect(clippy::large_enum_variant, reason = "nothing to box it in")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// To a hello.
    #[serde(borrow)]
    Identity(Identity<'a>),
    /// To a step.
    Step(StepAnswer),
    /// A frame came that was damaged: ask again.
    Damaged,
    /// A step of a session that the board does not know, because it was started meanwhile: say hello first.
    UnknownSession {
        /// The session that was asked for.
        session: u32,
    },
    /// A frame of another version than this frame's came.
    OtherVersion,
}

/// What a board is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity<'a> {
    /// The session that was begun.
    pub session: u32,
    /// Checksum of the board's table (`FORMAT.md`).
    pub table_checksum: u32,
    /// Length of the board's table, bytes.
    pub table_length: u32,
    /// What the board counts.
    pub unit: Unit,
    /// Name of the board, up to 32 bytes.
    pub board: &'a str,
}

/// What a board counts while it looks a step up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Nothing: the count is zero.
    Nothing,
    /// Instructions.
    Instructions,
    /// Cycles of the processor's clock.
    Cycles,
}

/// The contacts of a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepAnswer {
    /// Number of the session.
    pub session: u32,
    /// Number of the step.
    pub sequence: u32,
    /// What the lookups took, in the board's unit.
    pub count: u32,
    /// The wheels that were asked for, the right one first.
    pub wheels: Vec<WheelAnswer, 2>,
}

/// The contacts of a wheel.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct WheelAnswer {
    /// [`flangeway::Flags`].
    pub flags: u8,
    /// Contacts that carry force.
    pub contacts: Vec<ContactNumbers, SLOTS>,
}

/// A contact in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ContactNumbers {
    /// Slot, in the order of [`flangeway::Slot::ALL`].
    pub slot: u8,
    /// Normal force, indentation, position x, y, z, contact angle, rolling radius, wheel coordinate, semi-axes along x
    /// and across, curvatures of wheel and rail; SI units.
    pub numbers: [f32; 12],
}

impl From<&Contact> for ContactNumbers {
    fn from(contact: &Contact) -> Self {
        let Contact { normal_force, indentation, position, angle, rolling_radius, wheel_coordinate, .. } = *contact;
        let ([x, y, z], [a, b]) = (position.into(), contact.semi_axes);
        let (wheel, rail) = (contact.wheel_curvature, contact.rail_curvature);
        Self {
            slot: contact.slot.index() as u8,
            numbers: [normal_force, indentation, x, y, z, angle, rolling_radius, wheel_coordinate, a, b, wheel, rail],
        }
    }
}

impl From<&Contacts> for WheelAnswer {
    fn from(contacts: &Contacts) -> Self {
        // As many places as a wheel has.
        Self { flags: contacts.flags.bits(), contacts: contacts.iter().map(ContactNumbers::from).collect() }
    }
}

impl WheelAnswer {
    /// Whether every number is the same to the last bit.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        let same = |(a, b): (&ContactNumbers, &ContactNumbers)| {
            a.slot == b.slot && a.numbers.map(f32::to_bits) == b.numbers.map(f32::to_bits)
        };
        self.flags == other.flags
            && self.contacts.len() == other.contacts.len()
            && self.contacts.iter().zip(&other.contacts).all(same)
    }
}
