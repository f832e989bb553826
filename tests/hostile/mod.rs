//! What must hold of every table that the kernel takes, however it came about. The body of the fuzz target
//! (`fuzz/fuzz_targets/table.rs`) and of the property tests in `tests/kernel_hostile.rs`.
#![allow(dead_code, unreachable_pub, reason = "each user takes a part of this")]

use flangeway::layout::{ALIGNMENT, BIN, HEADER_AT, Sections, checksum};
use flangeway::{
    Bin, Channel, ContactTable, Contacts, Header, InstructionSet, MAX_BINS, Pose, Scale, Side, Slot, bin_start,
};

/// The made-up table that damage begins with.
static INTACT: &[u8] = include_bytes!("../gates/three_contacts.fwt");

/// Numbers that break careless arithmetic.
pub const NASTY: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    1e-40,
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-3,
    1e9,
    1e30,
];

/// A stream of bytes that ends in zeros.
struct Input<'a>(&'a [u8]);

impl Input<'_> {
    fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap_or((&0, &[]));
        self.0 = rest;
        *first
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    fn below(&mut self, n: usize) -> usize {
        u32::from_le_bytes(self.bytes()) as usize % n.max(1)
    }

    /// Nasty, small as poses and tables have them, near another number, or any.
    fn number(&mut self, near: f64) -> f64 {
        match self.byte() % 8 {
            0 => NASTY[self.below(NASTY.len())],
            1 => f64::from_le_bytes(self.bytes()),
            2 => f64::from(f32::from_le_bytes(self.bytes())),
            3 => near * (1.0 + f64::from(i16::from_le_bytes(self.bytes())) / 32768.0),
            4 => near * 2.0_f64.powi(i32::from(self.byte() as i8)),
            _ => f64::from(i16::from_le_bytes(self.bytes())) * 1e-6,
        }
    }
}

/// Takes the input as a program of damage to an intact table and poses to look up in it; true if it was taken. With
/// first byte 255 the rest of the input is the image itself.
pub fn body(data: &[u8]) -> bool {
    let mut input = Input(data);
    if input.byte() == 255 {
        return look_up(&with_good_envelope(input.0.to_vec()), &mut Input(data));
    }
    let mut image = INTACT.to_vec();
    for _ in 0..1 + input.below(4) {
        damage(&mut image, &mut input);
    }
    if input.byte().is_multiple_of(2) {
        mend_bins(&mut image);
    }
    look_up(&with_good_envelope(image), &mut input)
}

/// Magic, version, length and checksum as they should be, or nothing beyond them would be reached.
pub fn with_good_envelope(mut image: Vec<u8>) -> Vec<u8> {
    if image.len() >= HEADER_AT {
        let length = u32::try_from(image.len()).unwrap_or(u32::MAX).to_le_bytes();
        image[..8].copy_from_slice(b"FWT1\x02\0\0\0");
        image[8..12].copy_from_slice(&length);
        let crc = checksum(&image).to_le_bytes();
        image[12..16].copy_from_slice(&crc);
    }
    image
}

/// One piece of damage, to a place the format gives a meaning to.
fn damage(image: &mut Vec<u8>, input: &mut Input<'_>) {
    let kind = input.byte() % 8;
    if kind == 0 {
        image.truncate(input.below(image.len() + 1));
        return;
    }
    let Some((header, sections)) = parsed(image) else {
        let at = input.below(image.len());
        if let Some(byte) = image.get_mut(at) {
            *byte = input.byte();
        }
        return;
    };
    let place = |range: &std::ops::Range<usize>, size: usize, input: &mut Input<'_>| {
        range.start + size * input.below(range.len() / size)
    };
    match kind {
        1..=3 => {
            let changed = header_damaged(header, input);
            if let Some(changed) = rewritten(image, &changed, &sections) {
                *image = changed;
            }
        }
        4 => {
            let at = place(&sections.nodes[input.below(4)], 8, input);
            let near = image.get(at..).and_then(<[u8]>::first_chunk).map_or(0.0, |bytes| f64::from_le_bytes(*bytes));
            // An end is an `f32`; other nodes are not.
            let value = input.number(near);
            let value = if input.byte().is_multiple_of(2) { value } else { f64::from(value as f32) };
            put(image, at, &value.to_le_bytes());
        }
        5 => {
            let at = place(&sections.bins[input.below(4)], 4, input);
            if input.byte().is_multiple_of(2) {
                put_single(image, at, input)
            } else {
                put(image, at, &input.bytes::<4>())
            }
        }
        6 => {
            let at = place(&sections.sides[0].rigid, 4, input);
            put_single(image, at, input);
        }
        _ => {
            // Up to a whole record, of extremes or anything.
            let at = place(&sections.sides[0].records, 2, input);
            for i in 0..1 + input.below(32) {
                let value = [i16::MIN, i16::MAX, 0, i16::from_le_bytes(input.bytes())][input.below(4)];
                put(image, at + 2 * i, &value.to_le_bytes());
            }
        }
    }
}

/// Makes the bins what nodes and counts say, as a table is not taken else: damage to those is seen beyond them.
fn mend_bins(image: &mut [u8]) {
    let Some((header, sections)) = parsed(image) else { return };
    let places = sections.bins.iter().zip(&sections.nodes).zip(sections.strides).zip(header.axes);
    let mut mended = Vec::new();
    for (((bins, nodes), strides), counts) in places {
        let nodes = image.get(nodes.clone()).unwrap_or_default().as_chunks().0;
        let nodes: Vec<f64> = nodes.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let ([first, inner @ .., last], count) = (nodes.as_slice(), usize::from(counts.bins)) else { continue };
        if count > MAX_BINS {
            continue;
        }
        let begins = |bin: &usize| *bin == 0 || inner.contains(&bin_start(*first, *last, count, *bin));
        let starts: Vec<usize> = (0..count).filter(begins).chain([count]).collect();
        let bytes: Vec<[u8; BIN]> = Bin::of_cells(&starts, strides).map(|bin| bin.to_bytes()).collect();
        mended.push((bins.start, bytes));
    }
    for (at, bytes) in mended {
        put(image, at, bytes.as_flattened());
    }
}

fn put(image: &mut [u8], at: usize, bytes: &[u8]) {
    if let Some(place) = image.get_mut(at..at + bytes.len()) {
        place.copy_from_slice(bytes);
    }
}

fn put_single(image: &mut [u8], at: usize, input: &mut Input<'_>) {
    let near = image.get(at..at + 4).and_then(<[u8]>::first_chunk).map_or(0.0, |bytes| f32::from_le_bytes(*bytes));
    let value = input.number(f64::from(near)) as f32;
    put(image, at, &value.to_le_bytes());
}

/// Header and sections of an image that still has them.
fn parsed(image: &[u8]) -> Option<(Header<'_>, Sections)> {
    let (header, rest) = postcard::take_from_bytes::<Header<'_>>(image.get(HEADER_AT..)?).ok()?;
    let length = image.len() - HEADER_AT - rest.len();
    let sections = Sections::new(length, &header.axes, header.refinement, header.sides())?;
    (sections.total == image.len()).then_some((header, sections))
}

/// The header with one of its numbers replaced.
fn header_damaged<'a>(mut header: Header<'a>, input: &mut Input<'_>) -> Header<'a> {
    let right = &mut header.right;
    let field = match input.byte() % 12 {
        0 => &mut header.gauge,
        1 => &mut header.material.young_modulus,
        2 => &mut header.material.poisson_ratio,
        3 => &mut right.geometry.nominal_radius,
        4 => &mut right.geometry.lateral_position,
        5 => {
            let index = input.below(5);
            let Some(axis) = header.axes.get_mut(index) else {
                header.refinement[input.below(2)] = input.byte() % 33;
                return header;
            };
            let count = u16::from_le_bytes(input.bytes()) % 4200;
            *(if input.byte().is_multiple_of(2) { &mut axis.nodes } else { &mut axis.bins }) = count;
            return header;
        }
        6 => {
            let boundary = &mut right.slot_boundaries[input.below(2)];
            *boundary = input.number(f64::from(*boundary)) as f32;
            return header;
        }
        7 => {
            header.left = Some(header.right);
            return header;
        }
        _ => {
            let scale = &mut right.scales[input.below(3)][input.below(10)];
            let number = if input.byte().is_multiple_of(2) { &mut scale.offset } else { &mut scale.step };
            *number = input.number(f64::from(*number)) as f32;
            return header;
        }
    };
    *field = input.number(*field);
    header
}

/// The image with another header, its sections filled with what the old ones held.
fn rewritten(image: &[u8], header: &Header<'_>, old: &Sections) -> Option<Vec<u8>> {
    let mut buffer = [0; 4096];
    let bytes = postcard::to_slice(header, &mut buffer).ok()?;
    let new = Sections::new(bytes.len(), &header.axes, header.refinement, header.sides())?;
    if new.total > 1 << 20 {
        return None;
    }
    let mut out = vec![0; new.total];
    put(&mut out, 16, &u32::try_from(bytes.len()).ok()?.to_le_bytes());
    put(&mut out, HEADER_AT, bytes);
    let axes = old.nodes.iter().zip(&new.nodes).chain(old.bins.iter().zip(&new.bins));
    let sides = new.sides.iter().take(header.sides()).flat_map(|to| {
        let from = &old.sides[0];
        [(&from.rigid, &to.rigid), (&from.records, &to.records)]
    });
    for (from, to) in axes.chain(sides) {
        let length = from.len().min(to.len());
        put(&mut out, to.start, image.get(from.start..from.start + length)?);
    }
    debug_assert!(new.sides[0].records.start.is_multiple_of(ALIGNMENT));
    Some(out)
}

/// Looks poses up in an image if it is taken as a table; true if it was.
fn look_up(image: &[u8], input: &mut Input<'_>) -> bool {
    let Ok(table) = ContactTable::new(image) else { return false };
    scales_make_sense(&table);
    let mut poses = vec![Pose::default()];
    for _ in 0..4 {
        let [lateral, yaw, vertical, roll] = std::array::from_fn(|_| input.number(0.01));
        poses.push(Pose { lateral, yaw, vertical, roll });
    }
    lookups_stay_finite(&table, &poses);
    true
}

/// No scale of a table that was taken reaches beyond what its channel can be.
fn scales_make_sense(table: &ContactTable<'_>) {
    for side in Side::ALL {
        for (slot, scales) in Slot::ALL.into_iter().zip(&table.header().side(side).scales) {
            for (channel, Scale { offset, step }) in Channel::ALL.into_iter().zip(scales) {
                let reach = offset.abs().max((offset + step * 32767.0).abs()).max((offset - step * 32768.0).abs());
                assert!(*step > 0.0 && reach <= channel.limit(), "{side} {slot} {channel}: {offset} {step}");
            }
        }
    }
}

/// Every lookup of a table that was taken is finite and within what its bounds allow, by every entry.
pub fn lookups_stay_finite(table: &ContactTable<'_>, poses: &[Pose]) {
    let wheels: Vec<(Side, Pose)> = poses.iter().flat_map(|pose| Side::ALL.map(|side| (side, *pose))).collect();
    let mut many = vec![Contacts::NONE; wheels.len()];
    table.contacts_many(&wheels, &mut many);
    // With the instructions that every processor has.
    let mut plain = table.clone();
    plain.set_instruction_set(InstructionSet::Baseline);
    for ((side, pose), of_many) in wheels.iter().zip(&many) {
        table.prefetch(*side, pose);
        let contacts = table.contacts(*side, pose);
        assert!(contacts == *of_many, "{contacts:?} {of_many:?}");
        let by_plain = plain.contacts(*side, pose);
        assert!(contacts == by_plain, "{contacts:?} {by_plain:?}");
        assert!(contacts.total_normal_force().is_finite());
        for c in &contacts {
            let numbers = [c.indentation, c.angle, c.rolling_radius, c.semi_axes[0], c.semi_axes[1]];
            let finite = numbers.iter().chain(c.position.iter()).all(|x| x.is_finite());
            assert!(finite && c.normal_force > 0.0 && c.rolling_radius > 0.0 && c.angle.abs() < 1.7, "{c:?}");
            assert!(c.wheel_curvature.abs() <= 1.01e6 && c.rail_curvature.abs() <= 1.01e6, "{c:?}");
            // Extrapolated over 1024 cells at most; blends may exceed the ends of a scale by their rounding.
            assert!(c.wheel_coordinate.abs() <= 0.501 && c.indentation <= 210.0, "{c:?}");
        }
    }
}
