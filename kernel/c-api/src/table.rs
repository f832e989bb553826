//! Tables: loading, what they say of themselves, why an image is none.

use core::ffi::{c_char, c_void};
use core::fmt::Write as _;
use core::mem::{MaybeUninit, align_of, size_of};

use flangeway::{ContactTable, Side};

use crate::pointer::{check, write};
use crate::status::Status;

/// Words of 8 bytes in a `flangeway_table`.
pub const FLANGEWAY_TABLE_WORDS: usize = 512;

/// Bytes on whose multiple the view lies inside a [`Table`].
const ALIGNMENT: usize = 64;
/// What marks a loaded table, together with its address.
const LOADED: u64 = 0x3154_5746_6465_6c21;

const _: () = assert!(
    size_of::<ContactTable<'static>>() + ALIGNMENT <= 8 * (FLANGEWAY_TABLE_WORDS - 1)
        && align_of::<ContactTable<'static>>() <= ALIGNMENT
);

/// A loaded table. Plain memory of the caller's (static, on the stack or the heap) which needs no release; it points
/// into the image and must not be moved or copied after it was loaded.
#[repr(C)]
pub struct Table {
    /// Not for the caller.
    pub words: [u64; FLANGEWAY_TABLE_WORDS],
}

/// What a table says of itself.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TableInfo {
    /// Track gauge, m.
    pub gauge: f64,
    /// Rolling radius at the tape circle, right and left wheel, m.
    pub nominal_radius: [f64; 2],
    /// Distance of the tape circle from the wheelset's centre, right and left wheel, m.
    pub lateral_position: [f64; 2],
    /// Young's modulus of wheel and rail, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio of wheel and rail.
    pub poisson_ratio: f64,
    /// Median of the measured force error, relative; zero if nobody measured.
    pub force_error_median: f64,
    /// 95 % quantile of the measured force error.
    pub force_error_p95: f64,
}

/// The tag of a table that is loaded at this address.
fn tag(table: *const Table) -> u64 {
    LOADED ^ table.addr() as u64
}

/// Where in a table its view lies: behind the tag, on a multiple of [`ALIGNMENT`].
fn place(table: *mut Table) -> *mut MaybeUninit<ContactTable<'static>> {
    let first = table.cast::<u8>().wrapping_add(size_of::<u64>());
    let aligned = first.addr().wrapping_add(ALIGNMENT - 1) & !(ALIGNMENT - 1);
    first.with_addr(aligned).cast()
}

/// The view of a loaded table.
///
/// # Safety
/// A pointer that is not null and aligned must point to a table; its image must be where it was when it was loaded, and
/// nobody may load it anew meanwhile.
#[inline(always)]
pub(crate) unsafe fn view<'a>(table: *const Table) -> Result<&'a ContactTable<'static>, Status> {
    check(table, 1)?;
    // SAFETY: not null and aligned; a table's words are plain numbers.
    let found = unsafe { table.cast::<u64>().read() };
    if found != tag(table) {
        return Err(Status::NotLoaded);
    }
    // SAFETY: the tag is written, for this address alone, after the view was.
    Ok(unsafe { &*place(table.cast_mut()).cast::<ContactTable<'static>>() })
}

/// The image as bytes.
///
/// # Safety
/// `length` bytes must be readable at a pointer that is not null, and stay so for as long as the bytes are used.
unsafe fn bytes<'a>(image: *const c_void, length: usize) -> Result<&'a [u8], Status> {
    check(image.cast::<u8>(), length)?;
    // SAFETY: not null, a length that memory can have; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(image.cast(), length) })
}

/// Checks the table image at `image` (read through once, nothing is allocated) and makes `table` a view of it.
/// `table_size` is sizeof(flangeway_table): another header than this library's is noticed.
///
/// The image needs no alignment; on a multiple of 64 bytes lookups are fastest. It must stay unchanged where it is while
/// the table is used. After an error the table is not loaded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_table_load(
    table: *mut Table,
    table_size: usize,
    image: *const c_void,
    length: usize,
) -> i32 {
    let load = || {
        check(table, 1)?;
        if table_size < size_of::<Table>() {
            return Err(Status::ShortBuffer);
        }
        // SAFETY: not null, aligned and large enough.
        unsafe { table.cast::<u64>().write(0) };
        // SAFETY: the caller's promise is the one asked for, and it lasts while the table is used.
        let image: &'static [u8] = unsafe { bytes(image, length) }?;
        let view = ContactTable::new(image)?;
        // SAFETY: the place is aligned and, by the assertion above, inside the table wherever that lies.
        unsafe { place(table).write(MaybeUninit::new(view)) };
        // SAFETY: as above.
        unsafe { table.cast::<u64>().write(tag(table)) };
        Ok(())
    };
    Status::of(load())
}

/// Writes what is wrong with the image at `image` as text into `text`, at most `capacity` bytes with the closing zero;
/// an empty text if nothing is. Returns what `flangeway_table_load` would, or FLANGEWAY_STATUS_SHORT_BUFFER if the text
/// was cut.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_table_problem(
    image: *const c_void,
    length: usize,
    text: *mut c_char,
    capacity: usize,
) -> i32 {
    let problem = || {
        check(text, capacity)?;
        if capacity == 0 {
            return Err(Status::ShortBuffer);
        }
        let mut text = Text { place: text, left: capacity };
        text.close();
        // SAFETY: the caller's promise is the one asked for.
        let image = unsafe { bytes(image, length) }?;
        let Err(error) = ContactTable::new(image) else { return Ok(()) };
        let written = write!(text, "{error}");
        text.close();
        written.map_err(|_| Status::ShortBuffer)?;
        Err(error.into())
    };
    Status::of(problem())
}

/// Text on its way into the caller's room, of which one byte is kept for the closing zero.
struct Text {
    place: *mut c_char,
    left: usize,
}

impl Text {
    fn close(&mut self) {
        // SAFETY: at least one byte is left.
        unsafe { self.place.write(0) };
    }
}

impl core::fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for byte in text.bytes() {
            if self.left == 1 {
                return Err(core::fmt::Error);
            }
            // SAFETY: more than one byte is left.
            unsafe { self.place.write(byte as c_char) };
            self.place = self.place.wrapping_add(1);
            self.left -= 1;
        }
        Ok(())
    }
}

/// Writes what a loaded table says of itself.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn flangeway_table_info(table: *const Table, info: *mut TableInfo) -> i32 {
    let tell = || {
        // SAFETY: the caller's promise.
        let header = unsafe { view(table) }?.header();
        let geometry = Side::ALL.map(|side| header.side(side).geometry);
        let told = TableInfo {
            gauge: header.gauge,
            nominal_radius: geometry.map(|g| g.nominal_radius),
            lateral_position: geometry.map(|g| g.lateral_position),
            young_modulus: header.material.young_modulus,
            poisson_ratio: header.material.poisson_ratio,
            force_error_median: header.errors.force_median.into(),
            force_error_p95: header.errors.force_p95.into(),
        };
        // SAFETY: the caller's promise.
        unsafe { write(info, told) }
    };
    Status::of(tell())
}
