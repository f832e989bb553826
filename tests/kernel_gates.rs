//! The made-up table that the gates on machine code use (`tests/gates/three_contacts.fwt`) is what this writes.

use crate::kernel_synthetic::Synthetic;
use flangeway::{ContactTable, Pose, Side};

/// Set to write the file anew: `WRITE=1 cargo test --test checks kernel_gates`.
const WRITE: &str = "WRITE";

#[test]
fn the_committed_image_is_current_and_has_three_contacts() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gates/three_contacts.fwt");
    let image = Synthetic::uneven().image();
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(path, &image).unwrap();
    }
    assert!(std::fs::read(path).unwrap() == image, "write it anew with {WRITE}=1");
    let table = ContactTable::new(&image).unwrap();
    let lookups = (0..200).map(|i| Pose { vertical: 1e-5 * f64::from(i), ..Pose::default() });
    assert!(lookups.map(|pose| table.contacts(Side::Right, &pose).list.len()).any(|n| n == 3));
}
