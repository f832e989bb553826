//! Flangeway's host library: from profiles and a recipe to a contact table, and everything that checks it.

pub mod commands;
pub mod compile;
pub mod contact;
pub mod contacts;
pub mod curve;
pub mod error;
pub mod halfspace;
pub mod hertz;
pub mod image;
pub mod naive;
pub mod pair;
pub mod poses;
pub mod profile;
pub mod profile_noise;
pub mod progress;
pub mod recipe;
pub mod report;
pub mod rig;
pub mod rigid;
pub mod semi_hertzian;
pub mod spline;
pub mod verify;
