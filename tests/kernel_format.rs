//! The table format: literal bytes, and that no damaged image is taken for a table.

use crate::kernel_synthetic::{self, Synthetic, smallest_axes};
use flangeway::layout::checksum;
use flangeway::{ContactTable, TableError};
use flangeway_host::image::write_image;

/// CRC-32C bit by bit, from its definition.
fn crc32c(bytes: impl Iterator<Item = u8>) -> u32 {
    !bytes.fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0x82F6_3B78 & (crc & 1).wrapping_neg()))
    })
}

#[test]
fn every_byte_of_a_tiny_image() {
    let tiny = Synthetic::new(smallest_axes(), 1);
    let image = tiny.image();
    // Prelude.
    assert_eq!(image[..12], [b'F', b'W', b'T', b'1', 2, 0, 0, 0, 0x00, 0x07, 0, 0]);
    assert_eq!(image.len(), 0x0700);
    let crc = crc32c(image[..12].iter().chain(&image[16..]).copied());
    assert_eq!(image[12..16], crc.to_le_bytes());
    assert_eq!(image[16..20], [0xd5, 0x01, 0, 0]);
    // Header, written by hand.
    let mut bytes = image[..20].to_vec();
    bytes.extend(b"\x0fflangeway tests\x04none");
    bytes.extend([7; 32]);
    for x in [1.435_f64, 2.1e11, 0.28] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([2, 1].repeat(4)); // nodes and bins of four axes
    bytes.extend([1; 2]); // parts of an interval in the rigid map
    bytes.extend([0, 0]); // samples and seed
    bytes.extend([0; 24]); // six error figures
    bytes.extend(b"\x0dmade-up wheel\x0cmade-up rail");
    bytes.extend([1; 32]);
    bytes.extend([2; 32]);
    bytes.extend(0.46_f64.to_le_bytes());
    bytes.extend(0.75_f64.to_le_bytes());
    bytes.extend((-0.02_f32).to_le_bytes());
    bytes.extend((-0.035_f32).to_le_bytes());
    for scale in tiny.sides[0].scales.as_flattened() {
        bytes.extend(scale.offset.to_le_bytes());
        bytes.extend(scale.step.to_le_bytes());
    }
    bytes.push(0); // no left side
    assert_eq!(bytes.len(), 20 + 0x01d5);
    bytes.resize(512, 0);
    // Axes: one bin each and once more, the whole of cell 0, whose node is the first of records and map; then two nodes each.
    for _ in 0..8 {
        bytes.extend([0, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
    for node in tiny.axes.iter().flatten() {
        bytes.extend(node.to_le_bytes());
    }
    assert_eq!(bytes.len(), 704);
    // Rigid map.
    for value in tiny.sides[0].rigid.as_flattened() {
        bytes.extend(value.to_le_bytes());
    }
    bytes.resize(768, 0);
    for record in &tiny.sides[0].records {
        let blocks = record.as_chunks::<4>().0;
        for lane in [0, 2, 1, 3, 4, 6, 5, 7].iter().flat_map(|&block: &usize| blocks[block]) {
            bytes.extend(lane.to_le_bytes());
        }
    }
    assert!(bytes == image, "first difference at byte {:?}", bytes.iter().zip(&image).position(|(a, b)| a != b));
    assert_eq!(tiny.image(), image, "the same parts give the same bytes");
}

/// The bins of an uneven axis, written by hand: cells of 1, 2 and 5 bins.
#[test]
fn every_bin_of_an_uneven_axis() {
    let mut axes = smallest_axes();
    axes[1] = vec![0.0, 1.0 / 128.0, 3.0 / 128.0, 8.0 / 128.0];
    let table = Synthetic::refined(axes, [4, 2], 1);
    let image = table.image();
    // Two bins of the lateral axis come first.
    let bins = image[512 + 2 * 16..].as_chunks::<16>().0;
    // Two records a node of the roll offset, two of these a node of the yaw; two rigid contacts a cell of the yaw.
    let fifth = f32::from_bits(0x3e4c_cccc);
    assert!(f64::from(fifth) < 0.2 && f64::from(fifth.next_up()) > 0.2);
    let cells = [(0.0, 1.0, 0, 0), (1.0, 0.5, 256, 32), (3.0, fifth, 512, 64)];
    for (bin, cell) in [0, 1, 1, 2, 2, 2, 2, 2, 2].into_iter().enumerate() {
        let (start, reciprocal, records, rigid): (f32, f32, u32, u32) = cells[cell];
        let words = [start.to_bits(), reciprocal.to_bits(), records, rigid].map(u32::to_le_bytes);
        assert_eq!(bins[bin].as_slice(), words.as_flattened(), "bin {bin}");
    }
}

#[test]
fn truncated_anywhere() {
    for sides in [1, 2] {
        let image = Synthetic::new(kernel_synthetic::uneven_axes(), sides).image();
        assert!(image.len() > 16_384);
        let later = (0..200).map(|i| 4096 + i * (image.len() - 4097) / 199);
        for length in (0..4096).chain(later) {
            match ContactTable::new(&image[..length]) {
                Err(TableError::NoPrelude { length: found, .. }) => assert!(found == length && length < 20),
                Err(TableError::Truncated { length: found, stated }) => {
                    assert!(found == length && stated as usize == image.len());
                }
                other => panic!("{length} bytes: {other:?}"),
            }
        }
        assert!(ContactTable::new(&image).is_ok());
        let longer = [image.as_slice(), &[0]].concat();
        assert!(matches!(ContactTable::new(&longer), Err(TableError::TrailingBytes { .. })));
    }
}

#[test]
fn one_bit_flipped_anywhere() {
    for sides in [1, 2] {
        let mut image = Synthetic::new(smallest_axes(), sides).image();
        for bit in 0..8 * image.len() {
            image[bit / 8] ^= 1 << (bit % 8);
            assert!(ContactTable::new(&image).is_err(), "bit {bit}");
            image[bit / 8] ^= 1 << (bit % 8);
        }
        assert!(ContactTable::new(&image).is_ok());
    }
}

/// An image with some bytes replaced and the checksum made good.
fn forged(image: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut image = image.to_vec();
    image[at..at + bytes.len()].copy_from_slice(bytes);
    let crc = checksum(&image);
    image[12..16].copy_from_slice(&crc.to_le_bytes());
    image
}

#[test]
fn says_what_is_wrong() {
    let image = Synthetic::new(smallest_axes(), 1).image();
    let message = |at: usize, bytes: &[u8]| ContactTable::new(&forged(&image, at, bytes)).unwrap_err().to_string();
    assert_eq!(message(0, b"\x7fELF"), "not a contact table: it begins with \"\\x7fELF\", not with \"FWT1\"");
    assert_eq!(message(4, &[1]), "table has format version 1, this program reads version 2");
    assert_eq!(message(16, &[0xff; 4]), "header length is 4294967295 bytes, at most 1772 fit");
    assert_eq!(message(16, &[0xd4]), "header at byte 20 cannot be read");
    assert_eq!(message(16, &[0xd6]), "header at byte 20 cannot be read");
    let gauge = 20 + 16 + 5 + 32;
    assert_eq!(message(gauge, &f64::NAN.to_le_bytes()), "header field gauge is NaN, plausible are 0.1 to 3");
    assert_eq!(message(gauge + 24, &[3]), "header describes a table of 2432 bytes, this one has 1792");
    assert_eq!(message(511, &[9]), "padding at byte 511 is 9, not 0");
    let node = "lateral axis: node 1 is NaN, not a number above the node before, within plausible bounds and where a bin \
                begins";
    assert_eq!(message(648, &f64::NAN.to_le_bytes()), node);
    for parts in [0, 3, 17, 32, 255] {
        let refinement = format!("rigid map has {parts} parts in an interval of the yaw axis, not 1, 2, 4, 8 or 16");
        assert_eq!(message(gauge + 24 + 8 + 1, &[parts]), refinement);
    }
    let bin = "lateral axis: bin 1 says (start 0, reciprocal 1, records 64, rigid map 0), the axis' nodes (start 0, \
               reciprocal 1, records 0, rigid map 0)";
    assert_eq!(message(512 + 16 + 8, &[64]), bin);
    assert_eq!(
        message(704, &f32::INFINITY.to_le_bytes()),
        "rigid map value at byte 704 is inf, plausible are -0.125 to 0.125"
    );
    assert_eq!(message(724, &2.0_f32.to_le_bytes()), "rigid map value at byte 724 is 2, plausible are -1 to 1");
    let lane = "record at byte 768 has 1 in lane 31, which allows no such value";
    assert_eq!(message(768 + 62, &[1, 0]), lane);
    let first_scale = 20 + 0x01d5 - 1 - 240;
    let scale = "scale of indentation (right tread) has offset 3e-5 and step 0e0: the step must be above zero \
                 and no value beyond 1e-1";
    assert_eq!(message(first_scale + 4, &[0; 4]), scale);
    for bad in [f32::NAN, f32::INFINITY, -1e-9, 1.0, 1e30, 3e38] {
        for scale in 0..30 {
            for half in [0, 4] {
                if half == 0 && (bad == -1e-9 || bad == 1.0) {
                    continue;
                }
                let image = forged(&image, first_scale + 8 * scale + half, &(bad * 1e9).to_le_bytes());
                assert!(matches!(ContactTable::new(&image), Err(TableError::Scale { .. })), "{bad} {scale} {half}");
            }
        }
    }
}

#[test]
fn writer_refuses_what_does_not_fit() {
    let mut table = Synthetic::new(smallest_axes(), 1);
    let record = table.sides[0].records.pop().unwrap();
    assert_eq!(write_image(&table.parts()).unwrap_err().to_string(), "records: 15 values, the axes need 16");
    table.sides[0].records.push(record);
    table.sides[0].rigid.push([0.0; 4]);
    assert_eq!(write_image(&table.parts()).unwrap_err().to_string(), "rigid contacts: 20 values, the axes need 16");
    table.sides[0].rigid.pop();
    table.axes[3] = vec![0.0];
    assert!(write_image(&table.parts()).unwrap_err().to_string().starts_with("vertical axis: 1 nodes"));
    table.axes[3] = vec![0.0, f64::from(0.0001_f32)];
    table.sides[0].geometry.nominal_radius = 46.0;
    let message = write_image(&table.parts()).unwrap_err().to_string();
    assert_eq!(message, "table: header field geometry.nominal_radius (right) is 46, plausible are 0.05 to 2");
}
