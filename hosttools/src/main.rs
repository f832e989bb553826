//! The `flangeway` program.
fn main() {}
