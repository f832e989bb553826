//! Wheel-rail contact forces from a precomputed table, in bounded time: no_std, no allocation, no panics.
//!
//! A [`ContactTable`] is checked once when it is made from its image; every [`ContactTable::contacts`] afterwards is
//! infallible and does the same work for every pose. Method: Santamaria, Vadillo, Gomez, "A comprehensive method for
//! the elastic calculation of the two-point wheel-rail contact" (*the paper*); Hertz's theory as in Johnson, Contact
//! Mechanics, chapter 4.
//!
//! ```
//! use flangeway::{ContactTable, Pose, Side};
//!
//! fn step(image: &[u8]) -> Result<f32, flangeway::TableError> {
//!     let table = ContactTable::new(image)?;
//!     let pose = Pose { lateral: 0.003, yaw: 0.001, ..Pose::default() };
//!     let right = table.contacts(Side::Right, &pose);
//!     let left = table.contacts(Side::Left, &pose);
//!     Ok(right.total_normal_force() + left.total_normal_force())
//! }
//! # assert!(step(&[]).is_err());
//! ```
//!
//! # Frame
//!
//! Everything is in the track frame: x forward, y to the right, z **down**, right-handed, with its origin on the track
//! centre line at the plane of the rail crowns. The wheelset turns by **roll** φ about x first, then by **yaw** ψ
//! about z. At pose zero the axle lies at nominal radius r0 above the crowns. All quantities in SI units.
//!
//! ```text
//! Seen from behind (x points into the page):
//!
//!     left wheel                                      right wheel
//!     .-----.                                           .-----.
//!     |     |                                           |     |
//!     |     |===================+=======================|     |  axle, at z = -r0
//!     |     |                   :                       |     |
//!     |     |                   : r0                    |     |
//!     |     '.                  :                      .'     |
//!     '-----. |                 :                      | .-----'
//!     .-----. |                 O-------> y            | .-----.   plane of the rail crowns
//!     | rail |'                 |                      '| rail |
//!                               v z
//!                               |<---------- b ---------->|   to the tape circle
//!
//! Seen from above (z points into the page):
//!
//!            x
//!            ^      left rail   |                       |   right rail
//!            |                  |                       |
//!            |                [===]-------------------[===]   wheelset
//!            |                  |                       |
//!            O------> y         |                       |
//!
//! roll > 0 turns y towards z: the right wheel goes down.
//! yaw  > 0 turns x towards y: the right wheel goes back.
//! ```
//!
//! The **contact angle** is the slope angle of the common tangent, tan α = dz/dy: negative on the right rail's gauge
//! side, positive on the left one's.
//!
//! The **canonical case** is the right wheel with yaw >= 0. The left wheel is its mirror image (lateral, yaw and roll
//! change sign), backward yaw the mirror image of forward yaw (x changes sign); tables hold canonical data only.
//!
//! # Beyond the table
//!
//! Outside its window a lookup is clamped to the edge, extrapolates the indentation alone and says so by [`Flags`]. A
//! pose that is no number gives no contact and a flag.
//!
//! # Features
//!
//! None by default. `micromath` adds `Contact::normal_fast`. `portable` leaves the processor's vector instructions
//! unused, which changes no bit of any answer; nor does the choice between SSE2 and AVX2, which a table makes by the
//! processor it is checked on (see [`InstructionSet`]).
#![no_std]
#![warn(clippy::std_instead_of_core)]
#![warn(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_lossless, clippy::cast_precision_loss)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

#[cfg(test)]
extern crate std;

pub mod creep;
pub mod layout;
pub mod wheelset;

#[cfg(any(test, all(target_arch = "arm", not(feature = "portable"))))]
#[cfg_attr(target_arch = "arm", expect(unsafe_code, reason = "an instruction by name, see there"))]
mod arm;
mod axis;
mod blend;
mod channel;
mod check;
mod contact;
mod corners;
mod displacement;
mod error;
mod flags;
mod header;
mod instructions;
#[cfg_attr(
    all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"), not(test)),
    expect(dead_code, reason = "simd has the same")
)]
mod lanes;
mod math;
mod pose;
mod rigid;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
#[expect(unsafe_code, reason = "the processor's instructions by name, see there")]
mod simd;
mod table;

pub use axis::{Axis, AxisName, Bin, BinBytes, MAX_BINS, NodeBytes, Place, bin_start};
pub use channel::{CHANNELS, CONFORMAL_LANE, Channel, Channels, LANES, RESERVED_LANE, SLOTS, Scale, Scales, Slot};
pub use contact::{Contact, Contacts};
pub use displacement::{Attitude, Displacement, displacement, pose_with};
pub use error::TableError;
pub use flags::Flags;
pub use header::{AxisCounts, ErrorFigures, Header, MAX_PARTS, Material, SideHeader};
pub use instructions::InstructionSet;
pub use math::{ANGLE_LIMIT, Angle};
pub use pose::{Canonical, POSE_LIMIT, Pose, Side, WheelGeometry};
pub use rigid::{Coordinates, RigidMap};
pub use table::ContactTable;
