//! Flangeway's host library: from profiles and a recipe to a contact table, and everything that checks it.

pub mod error;
pub mod image;
pub mod profile;
