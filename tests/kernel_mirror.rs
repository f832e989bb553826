//! Left is the mirror of right, backward yaw the mirror of forward yaw, to the last bit.

use crate::kernel_synthetic::Synthetic;
use flangeway::{Contact, ContactTable, Contacts, Pose, Side};
use proptest::prelude::*;

/// Poses in the table and well beyond it.
fn pose() -> impl Strategy<Value = Pose> {
    (-0.02_f64..0.02, -0.06_f64..0.06, -0.002_f64..0.002, -0.006_f64..0.006)
        .prop_map(|(lateral, yaw, vertical, roll)| Pose { lateral, yaw, vertical, roll })
}

/// All numbers of a contact with its position's x and y and its angle turned by signs.
fn numbers(contact: &Contact, x_sign: f32, y_sign: f32) -> [u32; 13] {
    // Adding zero makes -0 and 0 the same.
    [
        contact.normal_force,
        contact.indentation,
        x_sign * contact.position.x,
        y_sign * contact.position.y,
        contact.position.z,
        y_sign * contact.angle,
        contact.rolling_radius,
        contact.wheel_coordinate,
        contact.semi_axes[0],
        contact.semi_axes[1],
        contact.wheel_curvature,
        contact.rail_curvature,
        contact.slot.index() as f32,
    ]
    .map(|x| (x + 0.0).to_bits())
}

fn mirrored(a: &Contacts, b: &Contacts, x_sign: f32, y_sign: f32) -> bool {
    a.flags == b.flags && a.iter().map(|c| numbers(c, 1.0, 1.0)).eq(b.iter().map(|c| numbers(c, x_sign, y_sign)))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    #[test]
    fn to_the_last_bit(pose in pose()) {
        thread_local!(static IMAGE: Vec<u8> = Synthetic::uneven().image());
        IMAGE.with(|image| {
            let table = ContactTable::new(image).unwrap();
            let right = table.contacts(Side::Right, &pose);
            let across = Pose { lateral: -pose.lateral, yaw: -pose.yaw, vertical: pose.vertical, roll: -pose.roll };
            let left = table.contacts(Side::Left, &across);
            prop_assert!(mirrored(&right, &left, 1.0, -1.0), "{right:?} {left:?}");
            let backward = table.contacts(Side::Right, &Pose { yaw: -pose.yaw, ..pose });
            prop_assert!(pose.yaw == 0.0 || mirrored(&right, &backward, -1.0, 1.0), "{right:?} {backward:?}");
            Ok(())
        })?;
    }
}
