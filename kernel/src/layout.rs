//! Where everything lies in a table image; `tables/FORMAT.md` says the same in words. Writer and reader both use it.
#![deny(clippy::arithmetic_side_effects)]

use core::ops::Range;

use crc::{CRC_32_ISCSI, Crc};

use crate::channel::BLOCK;
use crate::header::AxisCounts;

/// First bytes of every image.
pub const MAGIC: [u8; 4] = *b"FWT1";
/// Version of the format.
pub const VERSION: u32 = 2;
/// Bytes of the magic.
pub const MAGIC_AT: Range<usize> = 0..4;
/// Bytes of the format version, `u32`.
pub const VERSION_AT: Range<usize> = 4..8;
/// Bytes of the image's total length, `u32`.
pub const LENGTH_AT: Range<usize> = 8..12;
/// Bytes of the checksum, `u32`.
pub const CHECKSUM_AT: Range<usize> = 12..16;
/// Bytes of the header's length, `u32`.
pub const HEADER_LENGTH_AT: Range<usize> = 16..20;
/// Where the header begins.
pub const HEADER_AT: usize = 20;
/// Longest header, bytes.
pub const HEADER_LIMIT: usize = 65_536;
/// Alignment of the sections from the image's start, bytes.
pub const ALIGNMENT: usize = 64;
/// Bytes of an axis node: its coordinate, `f64`.
pub const NODE: usize = 8;
/// Bytes of an axis bin: two `f32` and two `u32`, see [`Bin`](crate::Bin).
pub const BIN: usize = 16;
/// Bytes of a rigid contact: roll and the three coefficients of the height, `f32` each.
pub const RIGID: usize = 16;
/// Bytes of a record.
pub const RECORD: usize = 64;

/// Where a block of four lanes lies in a record, in blocks, or which one lies there: of each four the middle two change
/// places. Two records unpacked by vectors of 256 bits, which works within their halves, then have the channels' order.
#[must_use]
pub const fn stored_block(block: usize) -> usize {
    block & !3 | (block & 1) << 1 | block >> 1 & 1
}

/// Where a lane lies in a record, in lanes, or which one lies there.
#[must_use]
#[expect(clippy::arithmetic_side_effects, reason = "a block has lanes")]
pub const fn stored(lane: usize) -> usize {
    BLOCK * stored_block(lane / BLOCK) + lane % BLOCK
}

/// CRC-32C (Castagnoli, as in iSCSI) over the whole image but the checksum's own four bytes.
#[must_use]
pub fn checksum(image: &[u8]) -> u32 {
    static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);
    let mut digest = CRC.digest();
    digest.update(image.get(..CHECKSUM_AT.start).unwrap_or_default());
    digest.update(image.get(CHECKSUM_AT.end..).unwrap_or_default());
    digest.finalize()
}

/// Sections of a side, as byte ranges; empty for a left side that mirrors the right one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SideSections {
    /// Rigid contacts, `[lateral][yaw]`, [`RIGID`] bytes each.
    pub rigid: Range<usize>,
    /// Records, `[lateral][yaw][roll offset][vertical]`, 64 bytes each.
    pub records: Range<usize>,
}

/// Bytes from one node of an axis to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Strides {
    /// In the records.
    pub records: u32,
    /// In the rigid map; 0 on the axes that it does not have.
    pub rigid: u32,
}

/// All sections of an image, as byte ranges.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sections {
    /// Bins of the four axes, [`BIN`] bytes each, of each axis the last one twice.
    pub bins: [Range<usize>; 4],
    /// Nodes of the four axes, [`NODE`] bytes each.
    pub nodes: [Range<usize>; 4],
    /// Distances from node to node of the four axes.
    pub strides: [Strides; 4],
    /// Right and left side.
    pub sides: [SideSections; 2],
    /// Zero bytes that align the sections: before the axes, before each side's rigid map and its records.
    pub padding: [Range<usize>; 5],
    /// Bytes of the whole image.
    pub total: usize,
}

/// Hands out byte ranges one after the other; none once a position does not fit `u32`.
struct Cursor(Option<usize>);

impl Cursor {
    fn take(&mut self, size: usize, counts: &[usize]) -> Range<usize> {
        let start = self.0;
        let bytes = counts.iter().try_fold(size, |product, n| product.checked_mul(*n));
        self.0 = start
            .zip(bytes)
            .and_then(|(start, bytes)| start.checked_add(bytes))
            .filter(|end| u32::try_from(*end).is_ok());
        start.zip(self.0).map_or(0..0, |(start, end)| start..end)
    }

    fn align(&mut self) -> Range<usize> {
        let start = self.0;
        self.0 =
            start.and_then(|start| start.checked_next_multiple_of(ALIGNMENT)).filter(|end| u32::try_from(*end).is_ok());
        start.zip(self.0).map_or(0..0, |(start, end)| start..end)
    }
}

/// Nodes of an axis whose every interval is divided into so many parts.
#[must_use]
pub fn refined(nodes: usize, parts: u8) -> usize {
    nodes.saturating_sub(1).saturating_mul(usize::from(parts)).saturating_add(1)
}

/// Bytes of so many elements; none beyond 4 GiB.
fn stride(size: usize, counts: &[usize]) -> Option<u32> {
    let bytes = counts.iter().try_fold(size, |product, n| product.checked_mul(*n))?;
    u32::try_from(bytes).ok()
}

/// Bytes from one node of the records' axes, lateral and yaw, to the next in a rigid map that divides their intervals so;
/// none beyond 4 GiB.
#[must_use]
pub fn rigid_strides([lateral_parts, yaw_parts]: [u8; 2], yaw_nodes: usize) -> Option<[u32; 2]> {
    let row = refined(yaw_nodes, yaw_parts);
    Some([stride(RIGID, &[lateral_parts.into(), row])?, stride(RIGID, &[yaw_parts.into()])?])
}

impl Sections {
    /// Sections for a header of this length with these axes, the rigid map's parts of an interval of the first two, and
    /// one or two sides; none beyond 4 GiB.
    #[must_use]
    pub fn new(header_length: usize, axes: &[AxisCounts; 4], refinement: [u8; 2], sides: usize) -> Option<Self> {
        let mut sections = Self::default();
        let mut cursor = Cursor(HEADER_AT.checked_add(header_length));
        let [lateral, yaw, roll, vertical] = axes.map(|axis| usize::from(axis.nodes));
        let [lateral_parts, yaw_parts] = refinement;
        let (rigid_lateral, rigid_yaw) = (refined(lateral, lateral_parts), refined(yaw, yaw_parts));
        let [axes_gap, right_map_gap, right_records_gap, left_map_gap, left_records_gap] = &mut sections.padding;
        *axes_gap = cursor.align();
        for (range, axis) in sections.bins.iter_mut().zip(axes) {
            *range = cursor.take(BIN, &[usize::from(axis.bins).saturating_add(1)]);
        }
        for (range, axis) in sections.nodes.iter_mut().zip(axes) {
            *range = cursor.take(NODE, &[usize::from(axis.nodes)]);
        }
        let gaps = [(right_map_gap, right_records_gap), (left_map_gap, left_records_gap)];
        for (side, (map_gap, records_gap)) in sections.sides.iter_mut().zip(gaps).take(sides) {
            *map_gap = cursor.align();
            side.rigid = cursor.take(RIGID, &[rigid_lateral, rigid_yaw]);
            *records_gap = cursor.align();
            side.records = cursor.take(RECORD, &[lateral, yaw, roll, vertical]);
        }
        sections.total = cursor.0?;
        let records = [&[yaw, roll, vertical][..], &[roll, vertical], &[vertical], &[]];
        let [rigid_lateral, rigid_yaw] = rigid_strides(refinement, yaw)?;
        let rigid = [rigid_lateral, rigid_yaw, 0, 0];
        for ((strides, counts), rigid) in sections.strides.iter_mut().zip(records).zip(rigid) {
            *strides = Strides { records: stride(RECORD, counts)?, rigid };
        }
        Some(sections)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(n: [u16; 4]) -> [AxisCounts; 4] {
        n.map(|nodes| AxisCounts { nodes, bins: 1 })
    }

    #[test]
    fn sections_follow_each_other_aligned() {
        let s = Sections::new(100, &counts([2, 2, 2, 3]), [2, 1], 2).unwrap();
        assert_eq!(s.padding[0], 120..128);
        assert_eq!(s.bins[0], 128..160);
        assert_eq!(s.bins[3], 224..256);
        assert_eq!(s.nodes[0], 256..272);
        assert_eq!(s.nodes[3], 304..328);
        assert_eq!(s.padding[1], 328..384);
        let strides = |records, rigid| Strides { records, rigid };
        assert_eq!(s.strides, [strides(768, 64), strides(384, 16), strides(192, 0), strides(64, 0)]);
        assert_eq!(s.sides[0], SideSections { rigid: 384..480, records: 512..2048 });
        assert_eq!(s.sides[1].records, 2176..3712);
        assert_eq!(s.total, 3712);
        assert_eq!(Sections::new(100, &counts([2, 2, 2, 3]), [2, 1], 1).unwrap().total, 2048);
    }

    #[test]
    fn order_of_the_padding() {
        let s = Sections::new(100, &counts([2, 2, 2, 3]), [2, 1], 2).unwrap();
        assert_eq!(s.padding, [120..128, 328..384, 480..512, 2048..2048, 2144..2176]);
    }

    #[test]
    fn no_table_beyond_four_gibibytes() {
        assert_eq!(Sections::new(100, &counts([4097; 4]), [1; 2], 1), None);
        assert_eq!(Sections::new(100, &counts([u16::MAX; 4]), [16; 2], 2), None);
        assert_eq!(Sections::new(usize::MAX, &counts([2; 4]), [1; 2], 1), None);
    }

    #[test]
    fn checksum_skips_itself() {
        let mut image = *b"12345678....____9";
        assert_eq!(checksum(&image), checksum(b"12345678....////9"));
        image[16] = b'8';
        assert_ne!(checksum(&image), checksum(b"12345678....////9"));
    }
}
