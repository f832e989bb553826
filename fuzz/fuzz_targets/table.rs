//! Damages a table as the input says, makes its checksum good, and looks contacts up in it if it is taken.
#![no_main]

#[path = "../../tests/hostile/mod.rs"]
mod hostile;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    hostile::body(data);
});
