//! A table of real profiles, against what was stored in it and against the solver it was sampled from.

use std::collections::HashMap;

use crate::common::{self, Draws, Small};
use flangeway::{AxisName, CHANNELS, Channel, ContactTable, Coordinates, Pose, SLOTS, Side, Slot};
use flangeway_host::contact::SlotState;

fn coordinates([lateral, yaw, roll_offset, vertical]: [f64; 4]) -> Coordinates {
    Coordinates { lateral, yaw, roll_offset, vertical }
}

/// All nodes of the table by their indices.
fn nodes(table: &ContactTable<'_>) -> Vec<[usize; 4]> {
    let counts = AxisName::ALL.map(|name| table.axis(name).len());
    let total: usize = counts.iter().product();
    let index = |mut n: usize| {
        let mut node = [0; 4];
        for k in (0..4).rev() {
            (node[k], n) = (n % counts[k], n / counts[k]);
        }
        node
    };
    (0..total).map(index).collect()
}

/// Coordinates of a node.
fn place(table: &ContactTable<'_>, node: [usize; 4]) -> Coordinates {
    coordinates([0, 1, 2, 3].map(|k| table.axis(AxisName::ALL[k]).nodes().nth(node[k]).unwrap()))
}

/// Coordinates drawn from the whole table.
fn anywhere(table: &ContactTable<'_>, draws: &mut Draws) -> Coordinates {
    coordinates(AxisName::ALL.map(|name| {
        let (first, last) = table.axis(name).range();
        draws.within(first, last)
    }))
}

/// The solver's values of a slot in the order of the channels.
fn values(state: &SlotState) -> [f64; CHANNELS] {
    [
        state.indentation,
        state.stiffness,
        state.semi_axis_x,
        state.semi_axis_y,
        state.longitudinal,
        state.profile,
        state.radius_offset,
        state.angle,
        state.wheel_curvature,
        state.rail_curvature,
    ]
}

/// The lanes of a slot's geometry: all channels but indentation and stiffness.
fn geometry(table: &ContactTable<'_>, node: [usize; 4], slot: Slot) -> Vec<i16> {
    let record = table.node_record(Side::Right, node).unwrap();
    Channel::ALL[2..].iter().map(|channel| record[channel.lane(slot)]).collect()
}

/// Whether a slot's geometry at a node without contact is that of the next node with contact along the lateral axis,
/// on either side; true where there is none.
fn is_borrowed(table: &ContactTable<'_>, node: [usize; 4], slot: Slot, touches: impl Fn([usize; 4]) -> bool) -> bool {
    let at = |lateral: usize| [lateral, node[1], node[2], node[3]];
    let before = (0..node[0]).rev().map(at).find(|node| touches(*node));
    let after = (node[0] + 1..table.axis(AxisName::Lateral).len()).map(at).find(|node| touches(*node));
    let mut lenders = before.into_iter().chain(after).peekable();
    lenders.peek().is_none() || lenders.any(|lender| geometry(table, lender, slot) == geometry(table, node, slot))
}

#[test]
fn a_node_answers_what_is_stored_and_what_was_solved() {
    let Small { pair, image, .. } = Small::built_in();
    let table = ContactTable::new(image).unwrap();
    let side = table.header().side(Side::Right);
    // In steps of the quantisation, over the channels: stored against solved. Rounding alone makes it one half.
    let mut worst = [0.0_f64; CHANNELS];
    let (mut count, mut touching, mut borrowed) = (0, 0, 0);
    let solve = |node: [usize; 4]| {
        let pose = table.rigid(Side::Right).pose(&side.geometry, &place(&table, node));
        (node, pair.solve(Side::Right, &pose))
    };
    let solved: HashMap<[usize; 4], [SlotState; SLOTS]> = nodes(&table).into_iter().map(solve).collect();
    for node in nodes(&table) {
        let record = table.node_record(Side::Right, node).unwrap();
        let looked_up = table.channels(Side::Right, &place(&table, node));
        for slot in Slot::ALL {
            let touches_at = |node: [usize; 4]| solved[&node][slot.index()].stiffness > 0.0;
            let (state, touches) = (&solved[&node][slot.index()], touches_at(node));
            for channel in Channel::ALL {
                let scale = side.scales[slot.index()][channel.index()];
                let stored = scale.offset + scale.step * f32::from(record[channel.lane(slot)]);
                assert_eq!(looked_up.get(slot, channel), stored, "{slot} {channel} at node {node:?}");
                if !touches && !matches!(channel, Channel::Indentation | Channel::Stiffness) {
                    continue;
                }
                // A gap is stored as 0.3 mm at the most.
                let value = values(state)[channel.index()];
                let value = if channel == Channel::Indentation { value.max(-0.3e-3) } else { value };
                let apart = (f64::from(stored) - value).abs();
                // The dequantised value is single precision.
                let single = 1.2e-7 * (f64::from(scale.offset).abs() + value.abs());
                worst[channel.index()] = worst[channel.index()].max((apart - single) / f64::from(scale.step));
                assert!(
                    apart <= 0.5 * f64::from(scale.step) + single,
                    "{slot} {channel} at node {node:?}: stored {stored:e}, solved {value:e}, step {:e}",
                    scale.step
                );
            }
            // Without contact there is no stiffness to leak into a neighbour's, and the geometry is a neighbour's.
            if !touches {
                assert_eq!(record[Channel::Stiffness.lane(slot)], 0, "{slot} at node {node:?}");
                assert!(is_borrowed(&table, node, slot, touches_at), "{slot} at node {node:?}");
                borrowed += 1;
            }
            touching += usize::from(touches);
        }
        count += 1;
    }
    println!("{count} nodes, {touching} slots that can touch, {borrowed} that cannot; stored against solved at worst,");
    println!("in quantisation steps:");
    for channel in Channel::ALL {
        println!("  {:<20} {:.4}", channel.name(), worst[channel.index()]);
    }
    assert_eq!(count, 41 * 5 * 3 * 3);
    assert!(touching > count && borrowed > 0);
}

#[test]
fn the_indentation_is_linear_along_each_axis_inside_a_cell() {
    let Small { image, .. } = Small::built_in();
    let table = ContactTable::new(image).unwrap();
    let mut draws = Draws::new(6);
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        let at = anywhere(&table, &mut draws);
        let x = [at.lateral, at.yaw, at.roll_offset, at.vertical];
        let k = draws.below(4);
        let axis = table.axis(AxisName::ALL[k]);
        let cell = axis.locate(x[k]).cell;
        let end = |i: usize| axis.nodes().nth(cell + i).unwrap();
        let t = draws.within(0.0, 1.0);
        let delta = |t: f64| {
            let mut x = x;
            x[k] = end(0) + t * (end(1) - end(0));
            let channels = table.channels(Side::Right, &coordinates(x));
            Slot::ALL.map(|slot| f64::from(channels.get(slot, Channel::Indentation)))
        };
        let (first, inside, last) = (delta(0.0), delta(t), delta(1.0));
        for slot in 0..SLOTS {
            let line = first[slot] + t * (last[slot] - first[slot]);
            worst = worst.max((inside[slot] - line).abs());
        }
    }
    println!("indentation inside a cell: within {worst:.1e} m of the straight line between its ends");
    // Deltas are a millimetre at the most, sums of 16 terms in single precision.
    assert!(worst < 1e-9);
}

#[test]
fn the_force_is_c_delta_to_the_three_halves() {
    let Small { image, .. } = Small::built_in();
    let table = ContactTable::new(image).unwrap();
    let geometry = table.header().side(Side::Right).geometry;
    let mut draws = Draws::new(7);
    let mut found = [0; SLOTS];
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        let side = Side::ALL[draws.below(2)];
        let pose = common::on_side(side, &table.rigid(Side::Right).pose(&geometry, &anywhere(&table, &mut draws)));
        let channels = table.channels(side, &table.coordinates(side, &pose));
        let contacts = table.contacts(side, &pose);
        for contact in contacts.iter() {
            let value = |channel: Channel| f64::from(channels.get(contact.slot, channel));
            let expected = value(Channel::Stiffness) * value(Channel::Indentation).powf(1.5);
            worst = worst.max((f64::from(contact.normal_force) / expected - 1.0).abs());
            found[contact.slot.index()] += 1;
        }
        let above_zero = |slot, channel| channels.get(slot, channel) > 0.0;
        let carrying = Slot::ALL
            .into_iter()
            .filter(|slot| above_zero(*slot, Channel::Indentation) && above_zero(*slot, Channel::Stiffness));
        assert!(contacts.iter().map(|contact| contact.slot).eq(carrying), "{pose:?}");
    }
    println!("contacts in tread, flange root, flange: {found:?}; N against C delta^1.5 within {worst:.1e}");
    assert!(worst < 4e-7 && found.iter().all(|n| *n > 0));
}

#[test]
fn nodes_lie_where_the_recipe_put_them() {
    let Small { recipe, image, .. } = Small::built_in();
    let table = ContactTable::new(image).unwrap();
    let grid = &recipe.grid;
    let ranges = [grid.lateral_m, grid.yaw_rad, grid.roll_rad, grid.vertical_m].map(|axis| axis.range);
    for (name, [first, last]) in AxisName::ALL.into_iter().zip(ranges) {
        let (low, high) = table.axis(name).range();
        assert!((low - first).abs() <= 1e-7 * first.abs() && (high - last).abs() <= 1e-7 * last.abs(), "{name}");
    }
    // A pose of the right wheel has the coordinates that its own displacement gives.
    let pose = Pose { lateral: 0.002, yaw: 0.003, vertical: 2e-4, roll: 1e-4 };
    let at = table.coordinates(Side::Right, &pose);
    let geometry = table.header().side(Side::Right).geometry;
    let back = table.rigid(Side::Right).pose(&geometry, &at);
    let apart = [back.lateral - pose.lateral, back.vertical - pose.vertical, back.roll - pose.roll];
    assert!(apart.iter().all(|d| d.abs() < 1e-15), "{apart:?}");
}
