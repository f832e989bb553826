//! What needs the program. One test program, because each one is linked with all of the host tools; `cargo test --release
//! -p flangeway-host --test program campaign` runs one file of it.

mod bad_input;
mod campaign;
mod commands;
mod common;
mod creep;
mod pil;
mod profile_readers;
mod profiles;
mod quickstart;
mod rig;
mod simulate;
mod truncation;
mod verify_report;

/// A file that is named nowhere would never be compiled.
#[test]
fn every_file_is_among_the_modules() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let module = path.file_stem().unwrap().to_str().unwrap();
        let is_one = path.join("mod.rs").exists() || path.extension().is_some_and(|e| e == "rs") && module != "main";
        let named = include_str!("main.rs").lines().any(|line| line == format!("mod {module};"));
        assert_eq!(named, is_one, "{}", path.display());
    }
}
