//! Why an image is not a contact table.

use core::fmt;

use crate::axis::{AxisName, Bin};
use crate::channel::{Channel, Slot};
use crate::pose::Side;

/// Why [`ContactTable::new`](crate::ContactTable::new) refused an image. Offsets count bytes from the image's start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// The image ends inside its prelude.
    NoPrelude {
        /// Bytes in the image.
        length: usize,
        /// Bytes of the prelude.
        needed: usize,
    },
    /// The first four bytes are not `FWT1`.
    Magic {
        /// What they are.
        found: [u8; 4],
    },
    /// A format version that this kernel does not read.
    Version {
        /// The version found.
        found: u32,
        /// The version this kernel reads.
        supported: u32,
    },
    /// The image is shorter than it says.
    Truncated {
        /// Bytes in the image.
        length: usize,
        /// Bytes it says it has.
        stated: u32,
    },
    /// The image is longer than it says.
    TrailingBytes {
        /// Bytes in the image.
        length: usize,
        /// Bytes it says it has.
        stated: u32,
    },
    /// The checksum does not fit the bytes.
    Checksum {
        /// CRC-32C in the prelude.
        stated: u32,
        /// CRC-32C of the bytes.
        computed: u32,
    },
    /// The header's length is out of bounds.
    HeaderLength {
        /// Length in the prelude, bytes.
        found: u32,
        /// Most it can be, bytes.
        limit: usize,
    },
    /// The header is not what postcard can read as a header, or does not end where it should.
    HeaderEncoding {
        /// Where the header begins.
        offset: usize,
    },
    /// A header field is not a number or not plausible.
    Field {
        /// The field's name.
        field: &'static str,
        /// The side it belongs to, if there are two.
        side: Option<Side>,
        /// Its value.
        value: f64,
        /// Least plausible value.
        least: f64,
        /// Largest plausible value.
        largest: f64,
    },
    /// A scale is not a number, has no positive step, or reaches beyond its channel's plausible values.
    Scale {
        /// The side.
        side: Side,
        /// The slot.
        slot: Slot,
        /// The channel.
        channel: Channel,
        /// Its offset.
        offset: f32,
        /// Its step.
        step: f32,
        /// Largest plausible magnitude.
        limit: f32,
    },
    /// The sections the header describes do not have the image's length.
    Sections {
        /// Bytes the header's counts need; none if beyond the format's 4 GiB.
        needed: Option<usize>,
        /// Bytes in the image.
        length: usize,
    },
    /// An axis has fewer than two nodes or bins outside 1 to 4096.
    AxisCount {
        /// The axis.
        axis: AxisName,
        /// Its nodes.
        nodes: u16,
        /// Its bins.
        bins: u16,
    },
    /// An axis node is no number, beyond plausible values, not above the one before, or lies where no bin begins.
    AxisNode {
        /// The axis.
        axis: AxisName,
        /// The node's index.
        index: usize,
        /// Its value, m or rad.
        value: f32,
    },
    /// An axis bin says of its cell what nodes and counts do not.
    AxisBin {
        /// The axis.
        axis: AxisName,
        /// The bin's index.
        index: usize,
        /// What it says.
        found: Bin,
        /// What it should say.
        needed: Bin,
    },
    /// The rigid map divides an axis' intervals into other than 1, 2, 4, 8 or 16 parts.
    Refinement {
        /// The axis.
        axis: AxisName,
        /// Parts of an interval.
        parts: u8,
    },
    /// A value of a rigid map is not a number or not plausible.
    RigidValue {
        /// Where it is.
        offset: usize,
        /// Its value, m or rad.
        value: f32,
        /// Largest plausible magnitude.
        limit: f32,
    },
    /// A record's conformal share is negative or its reserved lane is not zero.
    RecordLane {
        /// Where the record begins.
        offset: usize,
        /// The lane.
        lane: usize,
        /// Its value.
        value: i16,
    },
    /// A byte between two sections is not zero.
    Padding {
        /// Where it is.
        offset: usize,
        /// Its value.
        value: u8,
    },
}

impl core::error::Error for TableError {}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoPrelude { length, needed } => {
                write!(f, "table is truncated: {length} bytes, the prelude alone has {needed}")
            }
            Self::Magic { found } => {
                write!(f, "not a contact table: it begins with \"{}\", not with \"FWT1\"", found.escape_ascii())
            }
            Self::Version { found, supported } => {
                write!(f, "table has format version {found}, this program reads version {supported}")
            }
            Self::Truncated { length, stated } => {
                write!(f, "table is truncated: {length} bytes, its prelude says {stated}")
            }
            Self::TrailingBytes { length, stated } => {
                write!(f, "table is followed by other bytes: {length} bytes, its prelude says {stated}")
            }
            Self::Checksum { stated, computed } => {
                write!(f, "table is damaged: its checksum is {computed:08x}, its prelude says {stated:08x}")
            }
            Self::HeaderLength { found, limit } => write!(f, "header length is {found} bytes, at most {limit} fit"),
            Self::HeaderEncoding { offset } => write!(f, "header at byte {offset} cannot be read"),
            Self::Field { field, side, value, least, largest } => {
                write!(f, "header field {field}")?;
                if let Some(side) = side {
                    write!(f, " ({side})")?;
                }
                write!(f, " is {value}, plausible are {least} to {largest}")
            }
            Self::Scale { side, slot, channel, offset, step, limit } => write!(
                f,
                "scale of {channel} ({side} {slot}) has offset {offset:e} and step {step:e}: the step must be above \
                 zero and no value beyond {limit:e}"
            ),
            Self::Sections { needed: Some(needed), length } => {
                write!(f, "header describes a table of {needed} bytes, this one has {length}")
            }
            Self::Sections { needed: None, .. } => write!(f, "header describes a table beyond 4 GiB"),
            Self::AxisCount { axis, nodes, bins } => {
                write!(
                    f,
                    "{axis} axis has {nodes} nodes in {bins} bins: at least 2 nodes and 1 to 4096 bins are needed, \
                     none narrower than 2.4e-7 of the largest node"
                )
            }
            Self::AxisNode { axis, index, value } => write!(
                f,
                "{axis} axis: node {index} is {value}, not a number above the node before, within plausible bounds and \
                 where a bin begins"
            ),
            Self::AxisBin { axis, index, found, needed } => {
                write!(f, "{axis} axis: bin {index} says {found}, the axis' nodes {needed}")
            }
            Self::Refinement { axis, parts } => {
                write!(f, "rigid map has {parts} parts in an interval of the {axis} axis, not 1, 2, 4, 8 or 16")
            }
            Self::RigidValue { offset, value, limit } => {
                write!(f, "rigid map value at byte {offset} is {value}, plausible are -{limit} to {limit}")
            }
            Self::RecordLane { offset, lane, value } => {
                write!(f, "record at byte {offset} has {value} in lane {lane}, which allows no such value")
            }
            Self::Padding { offset, value } => write!(f, "padding at byte {offset} is {value}, not 0"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn plain_words() {
        let text = TableError::Truncated { length: 812, stated: 4096 }.to_string();
        assert_eq!(text, "table is truncated: 812 bytes, its prelude says 4096");
        let text = TableError::Magic { found: *b"PK\x03\x04" }.to_string();
        assert_eq!(text, "not a contact table: it begins with \"PK\\x03\\x04\", not with \"FWT1\"");
    }
}
