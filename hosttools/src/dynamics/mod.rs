//! Vehicles on track: wheelsets and bogies with contact forces, integrated with a fixed step as a rig does.
//!
//! [`track`] leads, [`irregularity`] displaces the rails, [`source`] finds contacts (table, direct solver, rigid),
//! [`wheel_rail`] turns them into forces with the kernel's creep laws, [`wheelset`] and [`vehicle`] move by them,
//! [`body`] holds the integration scheme, [`scenario`] reads all of it from a file, and [`run`] runs it.

pub mod body;
pub mod irregularity;
pub mod record;
pub mod run;
pub mod scenario;
pub mod source;
pub mod spectrum;
pub mod suspension;
pub mod track;
pub mod vehicle;
pub mod wheel_rail;
pub mod wheelset;
