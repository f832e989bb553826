//! Left is the mirror of right, and backward yaw the mirror of forward yaw: in the direct solver, and in the kernel
//! with a table of real profiles to the last bit.

use crate::common::{self, Draws};
use flangeway::{Contact, ContactTable, Contacts, Pose, Side};
use flangeway_host::contacts::{ContactRow, solved};
use flangeway_host::pair::Pair;
use flangeway_host::rigid::two_wheels;
use flangeway_host::verify::height_for_load;

/// A pose with force: at a load from 5 to 150 kN on the right wheel.
fn loaded(pair: &Pair, draws: &mut Draws) -> Pose {
    let (lateral, yaw) = (draws.within(-0.006, 0.009), draws.within(-0.024, 0.024));
    let roll = two_wheels(pair, lateral, yaw).unwrap().roll + draws.within(-1e-3, 1e-3);
    let pose = Pose { lateral, yaw, vertical: 0.0, roll };
    let canonical = pose.canonical(Side::Right).pose;
    let vertical = height_for_load(&mut pair.column(Side::Right, &canonical), draws.within(5e3, 150e3)).unwrap();
    Pose { vertical, ..pose }
}

fn across(pose: &Pose) -> Pose {
    Pose { lateral: -pose.lateral, yaw: -pose.yaw, roll: -pose.roll, ..*pose }
}

fn backward(pose: &Pose) -> Pose {
    Pose { yaw: -pose.yaw, ..*pose }
}

/// Every number of a solved contact, its x, y and angle turned by signs.
fn row_numbers(row: &ContactRow, x_sign: f64, y_sign: f64) -> [f64; 11] {
    let [x, y, z] = row.position;
    let ([a, b], [wheel, rail]) = (row.semi_axes, row.curvatures);
    [
        x_sign * x,
        y_sign * y,
        z,
        y_sign * row.angle,
        row.indentation,
        row.normal_force,
        row.rolling_radius,
        a,
        b,
        wheel,
        rail,
    ]
}

/// Every number of a looked-up contact, to the bit; adding zero makes -0 and 0 the same.
fn bits(contact: &Contact, x_sign: f32, y_sign: f32) -> [u32; 13] {
    let c = contact;
    [
        x_sign * c.position.x,
        y_sign * c.position.y,
        c.position.z,
        y_sign * c.angle,
        c.indentation,
        c.normal_force,
        c.rolling_radius,
        c.wheel_coordinate,
        c.semi_axes[0],
        c.semi_axes[1],
        c.wheel_curvature,
        c.rail_curvature,
        c.slot.index() as f32,
    ]
    .map(|x| (x + 0.0).to_bits())
}

#[test]
fn in_the_direct_solver() {
    let pair = Pair::build(&common::built_in()).unwrap();
    let mut draws = Draws::new(4);
    let (mut contacts, mut worst) = (0, 0.0_f64);
    for _ in 0..500 {
        let pose = loaded(&pair, &mut draws);
        let right = solved(&pair, 7, Side::Right, &pose);
        assert!(!right.is_empty());
        let left = solved(&pair, 7, Side::Left, &across(&pose));
        let back = solved(&pair, 7, Side::Right, &backward(&pose));
        for (other, x_sign, y_sign) in [(left, 1.0, -1.0), (back, -1.0, 1.0)] {
            assert_eq!(right.len(), other.len(), "{pose:?}");
            for (a, b) in right.iter().zip(&other) {
                assert_eq!((a.slot, &a.remarks), (b.slot, &b.remarks));
                for (a, b) in row_numbers(a, 1.0, 1.0).into_iter().zip(row_numbers(b, x_sign, y_sign)) {
                    worst = worst.max((a - b).abs() / a.abs().max(f64::MIN_POSITIVE));
                    assert!((a - b).abs() <= 1e-15 * a.abs(), "{pose:?}: {a:e} {b:e}");
                }
            }
            contacts += other.len();
        }
    }
    println!("direct solver: {contacts} contacts, largest relative difference of mirror images {worst:.1e}");
}

#[test]
fn in_the_kernel_to_the_last_bit() {
    let small = common::Small::built_in();
    let table = ContactTable::new(&small.image).unwrap();
    let same = |a: &Contacts, b: &Contacts, x_sign: f32, y_sign: f32| {
        a.flags == b.flags && a.iter().map(|c| bits(c, 1.0, 1.0)).eq(b.iter().map(|c| bits(c, x_sign, y_sign)))
    };
    let mut draws = Draws::new(5);
    let mut seen = [0; 4];
    for i in 0..20_000 {
        // Loaded poses, and poses anywhere in and around the table.
        let pose = if i % 20 == 0 {
            loaded(&small.pair, &mut draws)
        } else {
            let rigid = two_wheels(&small.pair, 0.0, 0.0).unwrap();
            Pose {
                lateral: draws.within(-0.015, 0.015),
                yaw: draws.within(-0.03, 0.03),
                vertical: rigid.vertical + draws.within(-2e-3, 1e-3),
                roll: draws.within(-3e-3, 3e-3),
            }
        };
        let right = table.contacts(Side::Right, &pose);
        let left = table.contacts(Side::Left, &across(&pose));
        assert!(same(&right, &left, 1.0, -1.0), "{pose:?}: {right:?} {left:?}");
        let back = table.contacts(Side::Right, &backward(&pose));
        assert!(same(&right, &back, -1.0, 1.0), "{pose:?}: {right:?} {back:?}");
        seen[right.list.len()] += 1;
    }
    println!("kernel: poses with 0, 1, 2, 3 contacts {seen:?}, all mirrored to the last bit");
    assert!(seen[..3].iter().all(|n| *n > 0));
}
