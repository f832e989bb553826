//! Images damaged on purpose, their checksum made good: the kernel refuses them, or every lookup stays finite.

use crate::hostile::{self, NASTY, lookups_stay_finite, with_good_envelope};
use crate::kernel_synthetic::{Synthetic, smallest_axes, uneven_axes};
use flangeway::{ContactTable, Pose};
use proptest::prelude::*;

/// One piece of damage.
#[derive(Debug, Clone)]
enum Damage {
    Byte(usize, u8),
    Single(usize, usize),
    Double(usize, usize),
    Zero(usize, usize),
    Swap(usize, usize, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    // Half of it in the header, axes and rigid maps, the rest anywhere.
    let place = || prop_oneof![16..1100_usize, any::<prop::sample::Index>().prop_map(|i| i.index(1 << 20))];
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(at, value)| Damage::Byte(at, value)),
        (place(), 0..NASTY.len()).prop_map(|(at, i)| Damage::Single(at, i)),
        (place(), 0..NASTY.len()).prop_map(|(at, i)| Damage::Double(at, i)),
        (place(), 1..64_usize).prop_map(|(at, n)| Damage::Zero(at, n)),
        (place(), place(), 1..16_usize).prop_map(|(a, b, n)| Damage::Swap(a, b, n)),
    ]
}

fn put(image: &mut [u8], at: usize, bytes: &[u8]) {
    let length = image.len();
    for (i, byte) in bytes.iter().enumerate() {
        image[(at + i) % length] = *byte;
    }
}

fn apply(image: &mut [u8], damage: &Damage) {
    let length = image.len();
    match *damage {
        Damage::Byte(at, value) => put(image, at, &[value]),
        Damage::Single(at, i) => put(image, at, &(NASTY[i] as f32).to_le_bytes()),
        Damage::Double(at, i) => put(image, at, &NASTY[i].to_le_bytes()),
        Damage::Zero(at, n) => put(image, at, &vec![0; n]),
        Damage::Swap(a, b, n) => (0..n).for_each(|i| image.swap((a + i) % length, (b + i) % length)),
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -0.02_f64..0.02,
        1 => -1.0_f64..1.0,
        1 => -1e3_f64..1e3,
        1 => (0..NASTY.len()).prop_map(|i| NASTY[i]),
        1 => any::<f64>(),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    (number(), number(), number(), number()).prop_map(|(lateral, yaw, vertical, roll)| Pose {
        lateral,
        yaw,
        vertical,
        roll,
    })
}

fn poses() -> impl Strategy<Value = Vec<Pose>> {
    prop::collection::vec(pose(), 20)
}

fn intact(which: usize) -> Vec<u8> {
    match which {
        0 => Synthetic::new(smallest_axes(), 1).image(),
        1 => Synthetic::new(smallest_axes(), 2).image(),
        _ => Synthetic::new(uneven_axes(), 1).image(),
    }
}

/// Damages an image, makes its checksum good; true if it was taken as a table.
fn try_damaged(mut image: Vec<u8>, damages: &[Damage], poses: &[Pose]) -> bool {
    for damage in damages {
        apply(&mut image, damage);
    }
    let image = with_good_envelope(image);
    ContactTable::new(&image).map(|table| lookups_stay_finite(&table, poses)).is_ok()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    #[test]
    fn damaged_images(
        which in 0..3_usize,
        damages in prop::collection::vec(damage(), 1..4),
        poses in poses(),
    ) {
        thread_local!(static IMAGES: [Vec<u8>; 3] = [0, 1, 2].map(intact));
        IMAGES.with(|images| try_damaged(images[which].clone(), &damages, &poses));
    }

    /// The body of the fuzz target, on bytes of every length; half of the damage to the header.
    #[test]
    fn fuzzed_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200), header in any::<bool>()) {
        let mut bytes = bytes;
        if let (true, [kind, _, _, _, _, damage, ..]) = (header, bytes.as_mut_slice()) {
            (*kind, *damage) = (0, 1);
        }
        hostile::body(&bytes);
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 20..600)) {
        prop_assert!(ContactTable::new(&bytes).is_err());
        try_damaged(bytes, &[], &[]);
    }

    #[test]
    fn any_pose_in_a_good_table(poses in poses()) {
        thread_local!(static IMAGE: Vec<u8> = intact(2));
        IMAGE.with(|image| lookups_stay_finite(&ContactTable::new(image).unwrap(), &poses));
    }
}

/// Every four bytes of header, axes and rigid maps replaced by every nasty number, one at a time.
#[test]
fn every_field_by_every_nasty_number() {
    let image = intact(1);
    let records = image.len() - 2 * 16 * 64;
    let poses: Vec<Pose> = [-0.02, -1e-3, 0.0, 3e-4, 900.0]
        .iter()
        .flat_map(|x| [Pose { lateral: *x, ..Pose::default() }, Pose { yaw: *x, vertical: *x, roll: *x, lateral: *x }])
        .collect();
    let mut taken = 0;
    let mut tried = 0;
    for at in 16..records {
        for i in 0..NASTY.len() {
            for damage in [Damage::Single(at, i), Damage::Double(at, i)] {
                tried += 1;
                taken += usize::from(try_damaged(image.clone(), &[damage], &poses));
            }
        }
    }
    println!("{tried} damaged images: {taken} taken, each with finite lookups");
    assert!(taken > 0 && taken < tried);
}

/// The committed corpus of the fuzz target.
#[test]
fn fuzz_corpus() {
    let corpus = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus")).unwrap();
    let taken: Vec<bool> = corpus.map(|file| hostile::body(&std::fs::read(file.unwrap().path()).unwrap())).collect();
    println!("{} inputs, {} taken as tables", taken.len(), taken.iter().filter(|taken| **taken).count());
    assert!(taken.contains(&true) && taken.contains(&false));
}
