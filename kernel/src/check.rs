//! Everything that is checked about an image, once, so that lookups cannot fail.
#![deny(clippy::arithmetic_side_effects)]

use core::ops::Range;

use crate::axis::{Axis, AxisName};
use crate::channel::{CONFORMAL_LANE, Channel, LANES, RESERVED_LANE, Slot};
use crate::error::TableError;
use crate::header::{Header, MAX_PARTS, SideHeader};
use crate::layout::{
    CHECKSUM_AT, HEADER_AT, HEADER_LENGTH_AT, HEADER_LIMIT, LENGTH_AT, MAGIC, MAGIC_AT, RECORD, RIGID, Sections,
    VERSION, VERSION_AT, checksum, stored,
};
use crate::pose::Side;

/// Largest plausible rigid roll, rad, and coefficients of the rigid height, m, m/rad, m/rad²: each term is at most 1 m at
/// the largest roll offset.
const RIGID_LIMITS: [f32; 4] = [0.125, 1.0, 8.0, 64.0];

/// Prelude, length and checksum; returns the header's bytes.
pub(crate) fn envelope(image: &[u8]) -> Result<&[u8], TableError> {
    let length = image.len();
    let no_prelude = TableError::NoPrelude { length, needed: HEADER_AT };
    let magic: [u8; 4] = word(image, MAGIC_AT).ok_or(no_prelude)?;
    if magic != MAGIC {
        return Err(TableError::Magic { found: magic });
    }
    let number = |at: Range<usize>| word(image, at).map(u32::from_le_bytes).ok_or(no_prelude);
    let found = number(VERSION_AT)?;
    if found != VERSION {
        return Err(TableError::Version { found, supported: VERSION });
    }
    let (total, stated, header) = (number(LENGTH_AT)?, number(CHECKSUM_AT)?, number(HEADER_LENGTH_AT)?);
    match usize::try_from(total) {
        Ok(total) if total == length => {}
        Ok(stated_length) if stated_length < length => {
            return Err(TableError::TrailingBytes { length, stated: total });
        }
        _ => return Err(TableError::Truncated { length, stated: total }),
    }
    let computed = checksum(image);
    if stated != computed {
        return Err(TableError::Checksum { stated, computed });
    }
    let limit = length.saturating_sub(HEADER_AT).min(HEADER_LIMIT);
    let header_end = usize::try_from(header).ok().filter(|n| *n <= limit).and_then(|n| HEADER_AT.checked_add(n));
    header_end.and_then(|end| image.get(HEADER_AT..end)).ok_or(TableError::HeaderLength { found: header, limit })
}

/// Four bytes of the image.
fn word(image: &[u8], at: Range<usize>) -> Option<[u8; 4]> {
    image.get(at)?.first_chunk().copied()
}

/// Decodes the header in place and checks every number in it.
pub(crate) fn header<'a>(bytes: &'a [u8], header: &mut Header<'a>) -> Result<(), TableError> {
    header.decode(bytes).ok_or(TableError::HeaderEncoding { offset: HEADER_AT })?;
    within("gauge", None, header.gauge, 0.1, 3.0)?;
    within("material.young_modulus", None, header.material.young_modulus, 1e6, 1e13)?;
    within("material.poisson_ratio", None, header.material.poisson_ratio, 0.0, 0.5)?;
    let e = &header.errors;
    let figures = [
        ("errors.force_rms", e.force_rms),
        ("errors.force_median", e.force_median),
        ("errors.force_p95", e.force_p95),
        ("errors.force_p99", e.force_p99),
        ("errors.force_max", e.force_max),
        ("errors.continuity", e.continuity),
    ];
    for (field, value) in figures {
        within(field, None, f64::from(value), 0.0, f64::from(f32::MAX))?;
    }
    for (axis, parts) in AxisName::ALL.into_iter().zip(header.refinement) {
        if !parts.is_power_of_two() || parts > MAX_PARTS {
            return Err(TableError::Refinement { axis, parts });
        }
    }
    side(&header.right, Side::Right)?;
    if let Some(left) = &header.left {
        side(left, Side::Left)?;
    }
    Ok(())
}

/// A number between two bounds; NaN is not.
fn within(field: &'static str, side: Option<Side>, value: f64, least: f64, largest: f64) -> Result<(), TableError> {
    if value >= least && value <= largest {
        Ok(())
    } else {
        Err(TableError::Field { field, side, value, least, largest })
    }
}

fn side(header: &SideHeader<'_>, side: Side) -> Result<(), TableError> {
    let radius = header.geometry.nominal_radius;
    within("geometry.nominal_radius", Some(side), radius, 0.05, 2.0)?;
    within("geometry.lateral_position", Some(side), header.geometry.lateral_position, 0.05, 2.0)?;
    let [first, second] = header.slot_boundaries.map(f64::from);
    within("slot_boundaries[0]", Some(side), first, -0.5, 0.5)?;
    within("slot_boundaries[1]", Some(side), second, -0.5, first)?;
    for (slot, scales) in Slot::ALL.into_iter().zip(&header.scales) {
        for (channel, scale) in Channel::ALL.into_iter().zip(scales) {
            let limit = match channel {
                // A wheel keeps at least half its radius.
                Channel::RadiusOffset => channel.limit().min(crate::math::single(0.5 * radius)),
                _ => channel.limit(),
            };
            let plausible = |q: i16| scale.value(f32::from(q)).abs() <= limit;
            let good = scale.offset.abs() <= limit && scale.step > 0.0 && plausible(i16::MIN) && plausible(i16::MAX);
            if !good {
                let (offset, step) = (scale.offset, scale.step);
                return Err(TableError::Scale { side, slot, channel, offset, step, limit });
            }
        }
    }
    Ok(())
}

/// The four axes, in place.
pub(crate) fn axes<'a>(
    image: &'a [u8],
    header: &Header<'_>,
    sections: &Sections,
    axes: &mut [Axis<'a>; 4],
) -> Result<(), TableError> {
    for (name, axis) in AxisName::ALL.into_iter().zip(axes) {
        let missing = TableError::Sections { needed: Some(sections.total), length: image.len() };
        let counts = header.axes.get(name.index()).copied().unwrap_or_default();
        if counts.nodes < 2 || counts.bins == 0 {
            return Err(TableError::AxisCount { axis: name, nodes: counts.nodes, bins: counts.bins });
        }
        let nodes = sections.nodes.get(name.index()).ok_or(missing)?;
        let bins = sections.bins.get(name.index()).ok_or(missing)?;
        let strides = sections.strides.get(name.index()).copied().ok_or(missing)?;
        *axis = Axis::new(name, chunks(image, nodes), chunks(image, bins), strides)?;
    }
    Ok(())
}

/// A section as elements of `N` bytes.
pub(crate) fn chunks<'a, const N: usize>(image: &'a [u8], section: &Range<usize>) -> &'a [[u8; N]] {
    image.get(section.clone()).unwrap_or_default().as_chunks().0
}

/// The rigid map of a side.
pub(crate) fn rigid<'a>(image: &'a [u8], section: &Range<usize>) -> Result<&'a [[u8; RIGID]], TableError> {
    let map = chunks(image, section);
    let values = section.clone().step_by(4).zip(map.as_flattened().as_chunks().0).zip(RIGID_LIMITS.iter().cycle());
    for ((offset, bytes), limit) in values {
        let value = f32::from_le_bytes(*bytes);
        if value.is_nan() || value.abs() > *limit {
            return Err(TableError::RigidValue { offset, value, limit: *limit });
        }
    }
    Ok(map)
}

/// The records of a side.
pub(crate) fn records<'a>(image: &'a [u8], section: &Range<usize>) -> Result<&'a [[u8; RECORD]], TableError> {
    let records = chunks(image, section);
    for (offset, record) in section.clone().step_by(RECORD).zip(records) {
        let lanes = lanes(record);
        for (lane, most) in [(CONFORMAL_LANE, i16::MAX), (RESERVED_LANE, 0)] {
            let value = lanes.get(lane).copied().unwrap_or_default();
            if value < 0 || value > most {
                return Err(TableError::RecordLane { offset, lane, value });
            }
        }
    }
    Ok(records)
}

/// The integers of a record, in the channels' order.
pub(crate) fn lanes(record: &[u8; RECORD]) -> [i16; LANES] {
    let mut lanes = [0; LANES];
    for (lane, value) in lanes.iter_mut().enumerate() {
        *value = i16::from_le_bytes(record.as_chunks().0.get(stored(lane)).copied().unwrap_or_default());
    }
    lanes
}

/// All padding is zero.
pub(crate) fn padding(image: &[u8], sections: &Sections) -> Result<(), TableError> {
    for gap in &sections.padding {
        for (offset, value) in gap.clone().zip(image.get(gap.clone()).unwrap_or_default()) {
            if *value != 0 {
                return Err(TableError::Padding { offset, value: *value });
            }
        }
    }
    Ok(())
}
