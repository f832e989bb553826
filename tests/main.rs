//! What crosses crates. One program, because each one is linked with all of the host tools; `cargo test --release --test
//! checks kernel_lookup` runs one file of it.

mod closed_forms;
mod committed_tables;
mod common;
mod compile_determinism;
mod creep_half_space;
mod creep_laws;
mod creep_wheelset;
mod fitted_nodes;
mod half_space_closed_forms;
mod half_space_manchester;
mod half_space_models;
mod half_space_table;
mod hostile;
mod kernel_axes;
mod kernel_format;
mod kernel_gates;
mod kernel_hostile;
mod kernel_lookup;
mod kernel_mirror;
mod kernel_synthetic;
mod locus_and_sweep;
mod manchester;
mod mirror;
mod rigid;
mod table_nodes;
mod vehicle_hunting;
mod vehicle_integration;
mod vehicle_irregularity;
mod worn_pair;

#[test]
fn every_file_is_among_the_modules() {
    common::modules::name_every_file(env!("CARGO_MANIFEST_DIR"), include_str!("main.rs"));
}
