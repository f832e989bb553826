//! The contact table: checked once, then every lookup is infallible and costs the same.

use core::fmt;
use core::hint::black_box;
use core::mem::MaybeUninit;

use crate::axis::{Axis, AxisName, AxisPair, Places};
use crate::blend::{Cell, LaneScales, Lanes, RECORD_BYTES, edges};
use crate::channel::{CHANNELS, CONFORMAL_LANE, Channel, LANES, SLOTS, Slot};
use crate::check;
use crate::contact::{Contacts, Frame, Wheel};
use crate::displacement::{Attitude, Displacement, displacement};
use crate::error::TableError;
use crate::flags::Flags;
use crate::header::{Header, SideHeader};
use crate::instructions::{Avx2, Baseline, InstructionSet, Instructions};
use crate::layout::{RECORD, Sections, SideSections};
use crate::math::Two;
use crate::pose::{Canonical, Pose, Side, WheelGeometry};
use crate::rigid::{Coordinates, RigidMap};

/// A contact table, read in place from a borrowed image.
#[derive(Clone)]
pub struct ContactTable<'a> {
    header: Header<'a>,
    axes: [Axis<'a>; 4],
    /// Roll offset and vertical.
    section: AxisPair<'a>,
    /// Bytes from one record to the next along lateral, yaw and roll offset.
    strides: [u32; 3],
    /// Whether lookups may use AVX2.
    avx2: Option<Avx2>,
    right: SideData<'a>,
    left: SideData<'a>,
}

/// What a lookup needs of a side.
#[derive(Clone)]
struct SideData<'a> {
    /// +1 for the right wheel, -1 for the left one.
    sign: f64,
    geometry: WheelGeometry,
    wheel: Wheel,
    rigid: RigidMap<'a>,
    records: &'a [[u8; RECORD]],
    scales: LaneScales,
}

/// Where a pose lies in the table: all but its height.
struct Located {
    valid: bool,
    canonical: Canonical,
    attitude: Attitude,
    displacement: Displacement,
    coordinates: Coordinates,
    /// The places of lateral and yaw.
    plane: Places,
}

/// A lookup before its records are read.
struct Prepared<Q> {
    located: Located,
    cell: Cell<Q>,
    flags: Flags,
}

/// How many wheels ahead [`ContactTable::contacts_many`] asks for records. Eight wheels with records in no cache, over
/// eight warm ones, in a trial with a table of 256 KiB: 2.4 with one ahead, 1.9 with two, 1.55 with three and four, 1.9 with six, 2.1 if all are asked for
/// first.
const AHEAD: usize = 4;

impl<'a> ContactTable<'a> {
    /// To be filled; nobody else sees it.
    const EMPTY: Self = Self {
        header: Header::EMPTY,
        axes: [Axis::EMPTY; 4],
        section: AxisPair::EMPTY,
        strides: [0; 3],
        avx2: None,
        right: SideData::EMPTY,
        left: SideData::EMPTY,
    };

    /// Checks an image and takes it as a table. The image is read through once (checksum and plausibility of every
    /// section), without allocation; it needs no alignment, but records straddle cache lines unless it lies on a
    /// multiple of 64 bytes.
    ///
    /// # Errors
    /// Whatever is wrong with the image, see [`TableError`].
    #[cold]
    #[inline(never)]
    pub fn new(image: &'a [u8]) -> Result<Self, TableError> {
        let mut table = Self::EMPTY;
        table.fill(image)?;
        Ok(table)
    }

    /// [`ContactTable::new`] in a place of the caller's, such as a static: a table has more than two kilobytes, which a
    /// microcontroller's stack need not hold.
    ///
    /// # Errors
    /// As [`ContactTable::new`].
    #[cold]
    #[inline(never)]
    pub fn new_in<'p>(place: &'p mut MaybeUninit<Self>, image: &'a [u8]) -> Result<&'p Self, TableError> {
        let table = place.write(Self::EMPTY);
        table.fill(image)?;
        Ok(table)
    }

    #[inline(never)]
    fn fill(&mut self, image: &'a [u8]) -> Result<(), TableError> {
        let Self { header, axes, section, strides, avx2, right, left } = self;
        *avx2 = Avx2::found();
        let bytes = check::envelope(image)?;
        check::header(bytes, header)?;
        let sections = Sections::new(bytes.len(), &header.axes, header.refinement, header.sides());
        let wrong = |needed| TableError::Sections { needed, length: image.len() };
        let sections = sections.ok_or(wrong(None))?;
        if sections.total != image.len() {
            return Err(wrong(Some(sections.total)));
        }
        check::padding(image, &sections)?;
        check::axes(image, header, &sections, axes)?;
        let [right_sections, left_sections] = &sections.sides;
        let [lateral, yaw, roll, vertical] = &*axes;
        let plane = [lateral, yaw, roll];
        right.fill(image, Side::Right, &header.right, right_sections, plane, header.refinement)?;
        match &header.left {
            Some(side) => left.fill(image, Side::Left, side, left_sections, plane, header.refinement)?,
            // The right side's data serve both.
            None => {
                left.clone_from(right);
                left.turn(Side::Left);
            }
        }
        *section = AxisPair::new([*roll, *vertical]);
        let records = [yaw.len() * roll.len() * vertical.len(), roll.len() * vertical.len(), vertical.len()];
        // Sections are below 4 GiB, so strides fit.
        *strides = records.map(|stride| u32::try_from(stride).unwrap_or_default().wrapping_mul(RECORD_BYTES));
        Ok(())
    }

    /// The header.
    #[must_use]
    pub const fn header(&self) -> &Header<'a> {
        &self.header
    }

    /// The instructions that lookups are made of: the fastest that the processor has.
    #[must_use]
    pub const fn instruction_set(&self) -> InstructionSet {
        InstructionSet::of(self.avx2)
    }

    /// Has lookups made of other instructions, or of [`InstructionSet::Baseline`] where the processor does not have them.
    /// Answers stay the same to the last bit.
    pub fn set_instruction_set(&mut self, set: InstructionSet) {
        self.avx2 = match set {
            InstructionSet::Baseline => None,
            InstructionSet::Avx2 => Avx2::found(),
        };
    }

    /// One of the table's axes.
    #[must_use]
    pub const fn axis(&self, name: AxisName) -> &Axis<'a> {
        let [lateral, yaw, roll, vertical] = &self.axes;
        match name {
            AxisName::Lateral => lateral,
            AxisName::Yaw => yaw,
            AxisName::RollOffset => roll,
            AxisName::Vertical => vertical,
        }
    }

    /// The rigid map of a side, for canonical coordinates.
    #[must_use]
    pub const fn rigid(&self, side: Side) -> &RigidMap<'a> {
        &self.side(side).rigid
    }

    #[inline]
    const fn side(&self, side: Side) -> &SideData<'a> {
        match side {
            Side::Right => &self.right,
            Side::Left => &self.left,
        }
    }

    /// Displacement of a wheel's tape-circle point at rail level, mirrored to the right wheel with yaw >= 0.
    #[must_use]
    pub fn displacement(&self, side: Side, pose: &Pose) -> Displacement {
        displacement(&self.side(side).geometry, &pose.canonical(side).pose)
    }

    /// Coordinates of a pose in the table, mirrored to the right wheel with yaw >= 0 and not clamped to the table.
    #[must_use]
    pub fn coordinates(&self, side: Side, pose: &Pose) -> Coordinates {
        self.locate(Baseline, side, pose).coordinates
    }

    /// The integers of the record at a node (lateral, yaw, roll offset, vertical); none beyond the axes.
    #[must_use]
    pub fn node_record(&self, side: Side, node: [usize; 4]) -> Option<[i16; LANES]> {
        let counts = self.counts();
        let index = node.iter().zip(counts).try_fold(0, |index, (i, n)| (*i < n).then_some(index * n + i))?;
        self.side(side).records.get(index).map(check::lanes)
    }

    /// The channels at coordinates of the table, `[slot][channel]`, in the units of [`Channel`].
    #[must_use]
    pub fn channels(&self, side: Side, at: &Coordinates) -> [[f32; CHANNELS]; SLOTS] {
        match self.avx2 {
            Some(avx2) => avx2.channels(self, side, at),
            None => self.channels_by(Baseline, side, at),
        }
    }

    /// [`ContactTable::channels`] by these instructions, which the caller was compiled for.
    #[inline(always)]
    pub(crate) fn channels_by<I: Instructions>(
        &self,
        with: I,
        side: Side,
        at: &Coordinates,
    ) -> [[f32; CHANNELS]; SLOTS] {
        let side = self.side(side);
        let plane = side.rigid.plane(at.lateral, at.yaw);
        let (cell, _) = self.cell(with, &plane, at);
        with.blend(side.records, &cell, &side.scales).map_or([[0.0; CHANNELS]; SLOTS], |lanes| slots(&lanes))
    }

    /// Asks for the sixteen records of a pose, so that they are in the cache when the lookup comes, while the caller
    /// does other work. Where the target has no prefetch instruction that Rust can name, one byte of each is read; an
    /// in-order core waits for that, and then a lookup alone is the better choice.
    #[inline]
    pub fn prefetch(&self, side: Side, pose: &Pose) {
        self.prefetch_cell(side, &self.prepare(Baseline, side, pose).cell);
    }

    #[inline(always)]
    fn prefetch_cell<Q>(&self, side: Side, cell: &Cell<Q>) {
        for edge in edges(self.side(side).records, cell).into_iter().flatten() {
            edge.as_chunks::<RECORD>().0.iter().for_each(prefetch);
        }
    }

    /// Contacts of a wheel: at most one a slot, those that carry force.
    #[inline]
    #[must_use]
    pub fn contacts(&self, side: Side, pose: &Pose) -> Contacts {
        let mut contacts = Contacts::NONE;
        self.contacts_into(side, pose, &mut contacts);
        contacts
    }

    /// [`ContactTable::contacts`] into a place of the caller's, which saves a copy.
    #[cfg_attr(target_arch = "arm", inline)]
    pub fn contacts_into(&self, side: Side, pose: &Pose, contacts: &mut Contacts) {
        match self.avx2 {
            Some(avx2) => avx2.contacts_into(self, side, pose, contacts),
            None => self.contacts_into_baseline(side, pose, contacts),
        }
    }

    /// By itself, so that choosing saves no registers for it.
    #[cfg_attr(target_arch = "arm", inline)]
    #[cfg_attr(not(target_arch = "arm"), inline(never))]
    fn contacts_into_baseline(&self, side: Side, pose: &Pose, contacts: &mut Contacts) {
        self.look_up(Baseline, side, pose, contacts);
    }

    /// Contacts of several wheels, as [`ContactTable::contacts`] gives them: records are asked for four wheels before they
    /// are blended. Fills as many places as there are wheels and places for.
    pub fn contacts_many(&self, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        match self.avx2 {
            Some(avx2) => avx2.contacts_many(self, wheels, contacts),
            None => self.contacts_many_baseline(wheels, contacts),
        }
    }

    #[inline(never)]
    fn contacts_many_baseline(&self, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        self.look_up_many(Baseline, wheels, contacts);
    }

    /// [`ContactTable::contacts_into`] by these instructions, which the caller was compiled for.
    #[inline(always)]
    pub(crate) fn look_up<I: Instructions>(&self, with: I, side: Side, pose: &Pose, contacts: &mut Contacts) {
        self.finish(with, side, &self.prepare(with, side, pose), contacts);
    }

    /// [`ContactTable::contacts_many`] in the same way.
    #[inline(always)]
    pub(crate) fn look_up_many<I: Instructions>(&self, with: I, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        let mut contacts = contacts.iter_mut();
        let mut ahead = heapless::Deque::<_, AHEAD>::new();
        for (side, pose) in wheels.iter().take(contacts.len()) {
            if ahead.is_full()
                && let (Some((side, one)), Some(contacts)) = (ahead.pop_front(), contacts.next())
            {
                self.finish(with, side, &one, contacts);
            }
            let one = self.prepare(with, *side, pose);
            self.prefetch_cell(*side, &one.cell);
            // There is room.
            let _ = ahead.push_back((*side, one));
        }
        for ((side, one), contacts) in ahead.iter().zip(contacts) {
            self.finish(with, *side, one, contacts);
        }
    }

    /// All of a lookup before the records are read.
    #[inline(always)]
    fn prepare<I: Instructions>(&self, with: I, side: Side, pose: &Pose) -> Prepared<I::Quad> {
        let located = self.locate(with, side, pose);
        let (cell, flags) = self.cell(with, &located.plane, &located.coordinates);
        Prepared { located, cell, flags }
    }

    /// The rest of it.
    #[inline(always)]
    fn finish<I: Instructions>(&self, with: I, side: Side, prepared: &Prepared<I::Quad>, contacts: &mut Contacts) {
        let data = self.side(side);
        let Prepared { located, cell, flags } = prepared;
        // Through memory that the compiler cannot see through: it would interleave the blend's parts with what follows,
        // and spill more registers than it saves.
        let Some(lanes) = with.blend(data.records, cell, &data.scales) else { return *contacts = Contacts::NONE };
        let lanes = black_box(&lanes);
        let frame = Frame {
            wheel: &data.wheel,
            longitudinal_sign: located.canonical.longitudinal_sign,
            attitude: &located.attitude,
            place: [located.displacement.lateral + data.geometry.lateral_position, located.displacement.vertical],
            arm: data.geometry.lateral_position - located.attitude.inwards(&data.geometry),
        };
        let force = contacts.fill(with, lanes, &frame, located.valid);
        let conformal = lanes.0.get(CONFORMAL_LANE).copied().unwrap_or_default();
        let remarks = *flags
            | Flags::ANGLE_LIMITED.when(located.attitude.yaw.limited | located.attitude.roll.limited)
            | Flags::CONFORMAL.when((conformal > 0.0) & force);
        contacts.flags = remarks.when(located.valid) | Flags::INVALID_INPUT.when(!located.valid);
    }

    fn counts(&self) -> [usize; 4] {
        self.axes.each_ref().map(Axis::len)
    }

    #[inline(always)]
    fn locate<I: Instructions>(&self, with: I, side: Side, pose: &Pose) -> Located {
        let data = self.side(side);
        // An invalid pose costs the same: what is no number is limited like any other.
        let (canonical, valid) = (pose.mirrored(data.sign), pose.is_valid());
        let attitude = Attitude::by(with, canonical.pose.yaw, canonical.pose.roll);
        let displacement = Displacement::new(&data.geometry, &canonical.pose, &attitude);
        let (coordinates, plane) = data.rigid.locate(with, &displacement, attitude.yaw.value, attitude.roll.value);
        Located { valid, canonical, attitude, displacement, coordinates, plane }
    }

    #[inline(always)]
    fn cell<I: Instructions>(&self, with: I, plane: &Places, at: &Coordinates) -> (Cell<I::Quad>, Flags) {
        let section = self.section.locate(Two::new([at.roll_offset, at.vertical]));
        // The flags of the four axes are the lowest four bits, in the axes' order.
        let flags = Flags::of_axes(plane.clamped | section.clamped << 2);
        (Cell::new(with, plane, &section, self.strides), flags)
    }
}

impl fmt::Debug for ContactTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ContactTable").field("header", &self.header).field("axes", &self.axes).finish_non_exhaustive()
    }
}

impl<'a> SideData<'a> {
    /// To be filled.
    const EMPTY: Self = Self {
        sign: 0.0,
        geometry: SideHeader::EMPTY.geometry,
        wheel: Wheel::EMPTY,
        rigid: RigidMap::EMPTY,
        records: &[],
        scales: LaneScales::NONE,
    };

    /// Checks a side's sections and fills the data in place.
    #[inline(never)]
    fn fill(
        &mut self,
        image: &'a [u8],
        side: Side,
        header: &SideHeader<'_>,
        place: &SideSections,
        axes: [&Axis<'a>; 3],
        refinement: [u8; 2],
    ) -> Result<(), TableError> {
        let rigid = RigidMap::new(axes.map(|axis| *axis), refinement, check::rigid(image, &place.rigid)?);
        // The section was laid out for it, and ends with the image.
        let length = image.len();
        self.rigid = rigid.ok_or(TableError::Sections { needed: Some(length), length })?;
        self.records = check::records(image, &place.records)?;
        self.geometry = header.geometry;
        self.turn(side);
        self.scales.fill(&header.scales);
        Ok(())
    }

    /// Makes the data those of a side.
    fn turn(&mut self, side: Side) {
        self.sign = side.sign();
        self.wheel = Wheel::new(&self.geometry, side);
    }
}

/// The lanes as slots of channels.
fn slots(lanes: &Lanes) -> [[f32; CHANNELS]; SLOTS] {
    let mut slots = [[0.0; CHANNELS]; SLOTS];
    for (slot, values) in Slot::ALL.into_iter().zip(&mut slots) {
        for (channel, value) in Channel::ALL.into_iter().zip(values) {
            *value = lanes.0.get(channel.lane(slot)).copied().unwrap_or_default();
        }
    }
    slots
}

/// Asks for a record's cache line.
#[inline(always)]
fn prefetch(record: &[u8; RECORD]) {
    #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
    crate::simd::prefetch(record);
    // Elsewhere by reading a byte.
    #[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
    core::hint::black_box(record.first().copied());
}
