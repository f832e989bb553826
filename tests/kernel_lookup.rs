//! Lookups in made-up tables whose answers are known.

use crate::kernel_synthetic::{self, Synthetic, rigid_roll, rigid_vertical, value};
use flangeway::{AxisName, Channel, ContactTable, Coordinates, Flags, Pose, Side, Slot};
use proptest::prelude::*;

fn image() -> (Synthetic, Vec<u8>) {
    let table = Synthetic::uneven();
    let image = table.image();
    (table, image)
}

/// Point of the axes' box from fractions 0..1.
fn inside(table: &Synthetic, t: [f64; 4]) -> Coordinates {
    let [lateral, yaw, roll_offset, vertical] = std::array::from_fn(|i| {
        let axis = &table.axes[i];
        let (a, b) = (axis[0], axis[axis.len() - 1]);
        a + t[i] * (b - a)
    });
    Coordinates { lateral, yaw, roll_offset, vertical }
}

/// Exactly, where the cells' bins are powers of two; elsewhere each of the four fractions may be 2⁻²⁴ of itself short,
/// which is 0.016 steps at the most where weights are fine, and a few steps of the coarse ones, 2⁻¹⁵ of a difference each.
#[test]
fn nodes_give_the_stored_values() {
    check_nodes(&Synthetic::new(kernel_synthetic::smallest_axes(), 1), [0.0; 2]);
    check_nodes(&Synthetic::uneven(), [0.024, 1.0]);
}

/// Channels at the nodes against the records, within so many steps of those with fine weights and the others.
fn check_nodes(source: &Synthetic, [fine, coarse]: [f32; 2]) {
    let image = source.image();
    let table = ContactTable::new(&image).unwrap();
    let axis = |i: usize| table.axis(AxisName::ALL[i]).nodes().enumerate();
    let mut nodes = 0;
    for (i, lateral) in axis(0) {
        for (j, yaw) in axis(1) {
            for (k, roll_offset) in axis(2) {
                for (l, vertical) in axis(3) {
                    let at = Coordinates { lateral, yaw, roll_offset, vertical };
                    let channels = table.channels(Side::Right, &at);
                    let record = table.node_record(Side::Right, [i, j, k, l]).unwrap();
                    assert_eq!(record, source.sides[0].records[nodes]);
                    for slot in Slot::ALL {
                        for channel in Channel::ALL {
                            let scale = source.sides[0].scales[slot.index()][channel.index()];
                            let stored = scale.offset + scale.step * f32::from(record[channel.lane(slot)]);
                            let error = (channels.get(slot, channel) - stored).abs();
                            let steps = match channel {
                                Channel::Indentation | Channel::Stiffness => fine,
                                _ => coarse,
                            };
                            let rounding = if steps > 0.0 { 4.0 * f32::EPSILON * stored.abs() } else { 0.0 };
                            assert!(error <= steps * scale.step + rounding, "{error:e} in steps of {:e}", scale.step);
                        }
                    }
                    nodes += 1;
                }
            }
        }
    }
    let counts = AxisName::ALL.map(|name| table.axis(name).len());
    assert_eq!(nodes, counts.iter().product::<usize>());
    assert_eq!(table.node_record(Side::Right, [counts[0], 0, 0, 0]), None);
    assert_eq!(table.node_record(Side::Right, [0, 0, 0, counts[3]]), None);
}

#[test]
fn no_contact_for_what_is_no_number() {
    let (_, image) = image();
    let table = ContactTable::new(&image).unwrap();
    for side in Side::ALL {
        assert!(!table.contacts(side, &Pose::default()).list.is_empty(), "pose zero carries force");
        for bad in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -1e10] {
            let zero = Pose::default();
            let poses = [
                Pose { lateral: bad, ..zero },
                Pose { yaw: bad, ..zero },
                Pose { vertical: bad, ..zero },
                Pose { roll: bad, ..zero },
            ];
            for pose in poses {
                let contacts = table.contacts(side, &pose);
                assert!(contacts.list.is_empty() && contacts.flags == Flags::INVALID_INPUT, "{pose:?}");
                assert!(contacts.strongest().is_none() && contacts.total_normal_force() == 0.0);
                table.prefetch(side, &pose);
            }
        }
    }
}

#[test]
fn outside_the_indentation_is_extrapolated_and_the_rest_clamped() {
    let (source, image) = image();
    let table = ContactTable::new(&image).unwrap();
    let delta = |at: &Coordinates| table.channels(Side::Right, at).get(Slot::Tread, Channel::Indentation);
    let inner = inside(&source, [0.3, 0.4, 0.6, 1.0]);
    for (end, next) in [(2, 1), (0, 1)] {
        let (z_end, z_next) = (source.axes[3][end], source.axes[3][next]);
        let at = |vertical: f64| Coordinates { vertical, ..inner };
        let beyond = at(z_end + 2.0 * (z_end - z_next));
        let line = f64::from(delta(&at(z_end))) + 2.0 * f64::from(delta(&at(z_end)) - delta(&at(z_next)));
        assert!((f64::from(delta(&beyond)) - line).abs() < 1e-10);
        let (edge, outside) =
            (table.channels(Side::Right, &at(z_end)).slots(), table.channels(Side::Right, &beyond).slots());
        for slot in 0..3 {
            assert_eq!(edge[slot][1..], outside[slot][1..]);
        }
    }
    // Along the other axes everything is clamped.
    for far in [-1.0, 1.0] {
        let edge = if far > 0.0 { 1.0 } else { 0.0 };
        let pairs = [
            (
                Coordinates { lateral: far, ..inner },
                Coordinates { lateral: inside(&source, [edge; 4]).lateral, ..inner },
            ),
            (Coordinates { yaw: far, ..inner }, Coordinates { yaw: inside(&source, [edge; 4]).yaw, ..inner }),
            (
                Coordinates { roll_offset: far, ..inner },
                Coordinates { roll_offset: inside(&source, [edge; 4]).roll_offset, ..inner },
            ),
        ];
        for (outside, at_edge) in pairs {
            assert_eq!(table.channels(Side::Right, &outside), table.channels(Side::Right, &at_edge));
        }
    }
}

#[test]
fn rigid_maps_are_clamped() {
    let (source, image) = image();
    let table = ContactTable::new(&image).unwrap();
    let rigid = table.rigid(Side::Right);
    let inner = inside(&source, [0.3, 0.4, 0.6, 0.5]);
    for (far, edge) in [(-1.0, 0.0), (1.0, 1.0)] {
        let edge = inside(&source, [edge; 4]);
        assert_eq!(rigid.roll(far, inner.yaw), rigid.roll(edge.lateral, inner.yaw));
        assert_eq!(rigid.roll(inner.lateral, far), rigid.roll(inner.lateral, edge.yaw));
        let vertical = |u, p, r| rigid.vertical(u, p, r);
        let (u, p, r) = (inner.lateral, inner.yaw, inner.roll_offset);
        assert_eq!(vertical(far, p, r), vertical(edge.lateral, p, r));
        assert_eq!(vertical(u, far, r), vertical(u, edge.yaw, r));
        assert_eq!(vertical(u, p, far), vertical(u, p, edge.roll_offset));
    }
}

#[test]
fn flags_name_what_was_clamped() {
    let (source, image) = image();
    let table = ContactTable::new(&image).unwrap();
    let geometry = source.sides[0].geometry;
    let flags = |at: &Coordinates| {
        let pose = table.rigid(Side::Right).pose(&geometry, at);
        table.contacts(Side::Right, &pose).flags
    };
    let inner = inside(&source, [0.3, 0.4, 0.6, 0.5]);
    assert_eq!(flags(&inner), Flags::NONE);
    assert_eq!(flags(&Coordinates { lateral: -0.013, ..inner }), Flags::CLAMPED_LATERAL);
    assert_eq!(flags(&Coordinates { lateral: 0.013, ..inner }), Flags::CLAMPED_LATERAL | Flags::CONFORMAL);
    assert_eq!(flags(&Coordinates { yaw: 0.045, ..inner }), Flags::CLAMPED_YAW);
    assert_eq!(flags(&Coordinates { roll_offset: 0.0035, ..inner }), Flags::CLAMPED_ROLL);
    assert_eq!(flags(&Coordinates { vertical: 0.0004, ..inner }), Flags::CLAMPED_VERTICAL);
    assert_eq!(flags(&Coordinates { vertical: -0.0004, ..inner }), Flags::CLAMPED_VERTICAL);
    let both = flags(&Coordinates { yaw: 0.13, ..inner });
    assert!(both.contains(Flags::ANGLE_LIMITED | Flags::CLAMPED_YAW));
    assert_eq!(both.to_string(), "clamped-yaw, angle-limited");
}

#[test]
fn at_most_three_contacts_those_with_force() {
    let (source, image) = image();
    let table = ContactTable::new(&image).unwrap();
    let mut seen = [0; 4];
    for i in 0..4000 {
        let t = std::array::from_fn(|k| f64::from(i * [7, 11, 13, 17][k] % 101) / 100.0);
        let at = inside(&source, t);
        let pose = table.rigid(Side::Right).pose(&source.sides[0].geometry, &at);
        let contacts = table.contacts(Side::Right, &pose);
        let channels = table.channels(Side::Right, &table.coordinates(Side::Right, &pose));
        let expected: Vec<Slot> =
            Slot::ALL.into_iter().filter(|slot| channels.get(*slot, Channel::Indentation) > 0.0).collect();
        assert_eq!(contacts.iter().map(|contact| contact.slot).collect::<Vec<_>>(), expected);
        let strongest = contacts.iter().map(|contact| contact.normal_force).fold(0.0, f32::max);
        assert_eq!(contacts.strongest().map_or(0.0, |contact| contact.normal_force), strongest);
        seen[contacts.list.len()] += 1;
    }
    println!("poses with 0, 1, 2, 3 contacts: {seen:?}");
    assert!(seen.iter().all(|n| *n > 0));
}

#[test]
fn two_sides_answer_from_their_own_data() {
    let source = Synthetic::new(kernel_synthetic::uneven_axes(), 2);
    let image = source.image();
    let table = ContactTable::new(&image).unwrap();
    assert_eq!(table.header().sides(), 2);
    for (side, data) in Side::ALL.into_iter().zip(&source.sides) {
        assert_eq!(table.header().side(side).geometry, data.geometry);
        assert_eq!(table.node_record(side, [1, 2, 0, 1]).unwrap(), data.records[((4 + 2) * 3) * 3 + 1]);
    }
    let at = inside(&source, [0.3, 0.4, 0.6, 0.5]);
    assert_ne!(table.channels(Side::Left, &at), table.channels(Side::Right, &at));
    assert_eq!(table.axis(AxisName::Yaw).nodes().count(), 4);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn multilinear_functions_to_the_quantisation(t in prop::array::uniform4(0.0_f64..=1.0)) {
        thread_local!(static TABLE: (Synthetic, Vec<u8>) = image());
        TABLE.with(|(source, image)| {
            let table = ContactTable::new(image).unwrap();
            let at = inside(source, t);
            let n = source.normalised(&at);
            let channels = table.channels(Side::Right, &at);
            for slot in Slot::ALL {
                for channel in Channel::ALL {
                    let step = f64::from(source.sides[0].scales[slot.index()][channel.index()].step);
                    let difference = f64::from(channels.get(slot, channel)) - value(slot, channel, n, 0.0);
                    // Half a step from rounding the nodes; a hundredth from f32 and the fine weights, or what the
                    // coarse weights leave where nodes lie 8,000 steps apart.
                    let force = matches!(channel, Channel::Indentation | Channel::Stiffness);
                    let most = if force { 0.515 } else { 1.5 };
                    prop_assert!(difference.abs() < most * step, "{slot} {channel}: {} steps", difference / step);
                }
            }
            Ok(())
        })?;
    }

    #[test]
    fn rigid_maps_and_coordinates(t in prop::array::uniform4(0.0_f64..=1.0), side in 0..2_usize) {
        thread_local!(static TABLE: (Synthetic, Vec<u8>) = image());
        TABLE.with(|(source, image)| {
            let table = ContactTable::new(image).unwrap();
            let at = inside(source, t);
            let rigid = table.rigid(Side::Right);
            let (u, p, r) = (at.lateral, at.yaw, at.roll_offset);
            prop_assert!((rigid.roll(u, p) - rigid_roll(u, p)).abs() < 1e-10);
            prop_assert!((rigid.vertical(u, p, r) - rigid_vertical(u, p, r)).abs() < 1e-9);
            let canonical = rigid.pose(&source.sides[0].geometry, &at);
            let side = Side::ALL[side];
            let sign = side.sign();
            let pose = Pose {
                lateral: sign * canonical.lateral,
                yaw: sign * canonical.yaw,
                roll: sign * canonical.roll,
                ..canonical
            };
            let back = table.coordinates(side, &pose);
            prop_assert!((back.lateral - u).abs() < 1e-16 && back.yaw == p);
            prop_assert!((back.roll_offset - r).abs() < 1e-16 && (back.vertical - at.vertical).abs() < 1e-15);
            Ok(())
        })?;
    }

    #[test]
    fn indentation_is_linear_along_an_axis_inside_a_cell(
        t in prop::array::uniform4(0.0_f64..=1.0),
        axis in 0..4_usize,
        (low, high) in (0.0_f64..0.5, 0.5_f64..1.0),
    ) {
        thread_local!(static TABLE: (Synthetic, Vec<u8>) = image());
        TABLE.with(|(source, image)| {
            let table = ContactTable::new(image).unwrap();
            let at = inside(source, t);
            let x = [at.lateral, at.yaw, at.roll_offset, at.vertical];
            let cell = table.axis(AxisName::ALL[axis]).locate(x[axis]).cell;
            let (a, b) = (source.axes[axis][cell], source.axes[axis][cell + 1]);
            let delta = |t: f64| {
                let mut x = x;
                x[axis] = a + t * (b - a);
                let [lateral, yaw, roll_offset, vertical] = x;
                let at = Coordinates { lateral, yaw, roll_offset, vertical };
                f64::from(table.channels(Side::Right, &at).get(Slot::FlangeRoot, Channel::Indentation))
            };
            let middle = 0.5 * (low + high);
            let line = 0.5 * (delta(low) + delta(high));
            prop_assert!((delta(middle) - line).abs() < 1e-10, "{} against {line}", delta(middle));
            Ok(())
        })?;
    }

    #[test]
    fn contacts_follow_their_equations(t in prop::array::uniform4(0.0_f64..=1.0), backward in any::<bool>()) {
        thread_local!(static TABLE: (Synthetic, Vec<u8>) = image());
        TABLE.with(|(source, image)| {
            let table = ContactTable::new(image).unwrap();
            let geometry = source.sides[0].geometry;
            let mut pose = table.rigid(Side::Right).pose(&geometry, &inside(source, t));
            if backward {
                pose.yaw = -pose.yaw;
            }
            let channels = table.channels(Side::Right, &table.coordinates(Side::Right, &pose)).slots();
            for contact in &table.contacts(Side::Right, &pose) {
                let [delta, c, k, k_across, e, s, radius_offset, angle, wheel, rail] =
                    channels[contact.slot.index()].map(f64::from);
                let close = |a: f32, b: f64, tolerance: f64| (f64::from(a) - b).abs() <= tolerance * b.abs();
                prop_assert!(close(contact.normal_force, c * delta.powf(1.5), 3e-7));
                prop_assert!(close(contact.semi_axes[0], k * delta.sqrt(), 3e-7));
                prop_assert!(close(contact.semi_axes[1], k_across * delta.sqrt(), 3e-7));
                prop_assert!(close(contact.indentation, delta, 0.0) && close(contact.angle, angle, 0.0));
                prop_assert!(close(contact.wheel_curvature, wheel, 0.0) && close(contact.rail_curvature, rail, 0.0));
                prop_assert!(close(contact.wheel_coordinate, s, 0.0));
                prop_assert!(close(contact.rolling_radius, 0.46 + radius_offset, 1e-7));
                let r = geometry.nominal_radius + radius_offset;
                let wheel_frame = [if backward { -e } else { e }, geometry.lateral_position + s, (r * r - e * e).sqrt()];
                let expected = to_track_frame(&pose, geometry.nominal_radius, wheel_frame);
                for (found, expected) in contact.position.iter().zip(expected) {
                    prop_assert!((f64::from(*found) - expected).abs() < 1.5e-7, "{found} {expected}");
                }
            }
            Ok(())
        })?;
    }
}

/// (0, y, z - r0) + Rz(yaw) Rx(roll) p, by matrices.
fn to_track_frame(pose: &Pose, r0: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sr, cr) = pose.roll.sin_cos();
    let (sy, cy) = pose.yaw.sin_cos();
    let (y, z) = (cr * y - sr * z, sr * y + cr * z);
    let (x, y) = (cy * x - sy * y, sy * x + cy * y);
    [x, y + pose.lateral, z + pose.vertical - r0]
}
