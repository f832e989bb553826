//! What needs the program. One test program, because each one is linked with all of the host tools; `cargo test --release
//! -p flangeway-host --test program campaign` runs one file of it.

mod bad_input;
mod campaign;
mod commands;
mod common;
mod creep;
#[path = "../../tests/common/modules.rs"]
mod modules;
mod pil;
mod profile_readers;
mod profiles;
mod quickstart;
mod rig;
mod simulate;
mod truncation;
mod verify_report;

#[test]
fn every_file_is_among_the_modules() {
    modules::name_every_file(env!("CARGO_MANIFEST_DIR"), include_str!("main.rs"));
}
