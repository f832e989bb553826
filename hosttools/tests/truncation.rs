//! A table of real profiles, cut off or with one bit flipped: never taken for a table, by the kernel or the program.

use crate::common::{Folder, table};
use flangeway::{ContactTable, TableError};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Every length of the first 4 KiB, and 200 later ones.
fn lengths(total: usize) -> impl Iterator<Item = usize> {
    (0..4096).chain((0..200).map(move |i| 4096 + i * (total - 1 - 4096) / 199))
}

#[test]
fn cut_off_at_any_length() {
    let image = table();
    assert!(image.len() > 8192 && ContactTable::new(image).is_ok());
    let mut count = 0;
    for length in lengths(image.len()) {
        match ContactTable::new(&image[..length]) {
            Err(TableError::NoPrelude { .. } | TableError::Truncated { .. }) => count += 1,
            other => panic!("{length} of {} bytes: {other:?}", image.len()),
        }
    }
    println!("{count} lengths below {} bytes refused", image.len());
}

#[test]
fn one_bit_flipped() {
    let image = table();
    let mut generator = Pcg64::seed_from_u64(11);
    let first = (0..8 * 1024).map(|bit| (bit / 8, bit % 8));
    let anywhere = (0..image.len()).map(|byte| (byte, generator.random_range(0..8)));
    let flips: Vec<(usize, usize)> = first.chain(anywhere).collect();
    let accepted: Vec<&(usize, usize)> = flips
        .par_iter()
        .filter(|(byte, bit)| {
            let mut damaged = image.to_vec();
            damaged[*byte] ^= 1 << bit;
            ContactTable::new(&damaged).is_ok()
        })
        .collect();
    println!("{} flips of one bit in {} bytes, {} taken for a table", flips.len(), image.len(), accepted.len());
    assert!(accepted.is_empty(), "{accepted:?}");
}

#[test]
fn the_program_refuses_damaged_tables() {
    let image = table();
    let mut damaged: Vec<(String, Vec<u8>)> =
        [0, 1, 19, 20, 63, 64, 511, 512, 1000, 4095, image.len() / 2, image.len() - 1]
            .into_iter()
            .map(|length| (format!("{length} bytes"), image[..length].to_vec()))
            .collect();
    for byte in [0, 5, 9, 13, 17, 100, 700, 1500, 2500, 4500, image.len() / 2, image.len() - 1] {
        let mut flipped = image.to_vec();
        flipped[byte] ^= 0x10;
        damaged.push((format!("bit flipped in byte {byte}"), flipped));
    }
    let commands = ["inspect table.fwt --json", "lookup table.fwt --poses poses.csv -o out.csv"];
    for (what, bytes) in damaged {
        let folder = Folder::new();
        folder.write("table.fwt", bytes);
        for command in commands {
            let output = folder.run(command);
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{what}: {said}");
            assert!(said.starts_with("flangeway: table.fwt: ") && said.lines().count() == 1, "{what}: {said}");
            assert!(output.stdout.is_empty() && !folder.path("out.csv").exists(), "{what}");
        }
    }
}
