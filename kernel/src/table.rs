//! The contact table: checked once, then every lookup is infallible and costs the same.

use core::fmt;
use core::mem::MaybeUninit;
use core::sync::atomic::{Ordering, compiler_fence};

use crate::axis::{Axis, AxisName, AxisPair, Places};
use crate::blend::{Cell, LaneScales, edges};
use crate::channel::{CONFORMAL_LANE, Channels, LANES};
use crate::check;
use crate::contact::{Contacts, Frame, Wheel};
use crate::displacement::{Attitude, Displacement, Turned, displacement};
use crate::error::TableError;
use crate::flags::Flags;
use crate::header::{Header, SideHeader};
use crate::instructions::{Avx2, Baseline, InstructionSet, Instructions, escape};
use crate::layout::{RECORD, Sections, SideSections};
use crate::math::{Two, single};
use crate::pose::{Pose, PoseSigns, Side, WheelGeometry, longitudinal_sign};
use crate::rigid::{Coordinates, RigidMap};

/// A contact table, read in place from a borrowed image.
#[derive(Clone)]
#[repr(C)]
pub struct ContactTable<'a> {
    right: SideData<'a>,
    left: SideData<'a>,
    /// Roll offset and vertical.
    section: AxisPair<'a>,
    /// Bytes from one record to the next along lateral, yaw and roll offset.
    strides: [u32; 3],
    /// Whether lookups may use AVX2.
    avx2: Option<Avx2>,
    axes: [Axis<'a>; 4],
    header: Header<'a>,
}

/// What a lookup needs of a side.
#[derive(Clone)]
struct SideData<'a> {
    /// What mirrors a pose to the right wheel.
    signs: PoseSigns,
    geometry: WheelGeometry,
    wheel: Wheel,
    rigid: RigidMap<'a>,
    /// A whole number of them.
    records: &'a [u8],
    scales: LaneScales,
}

/// Where a pose lies in the table.
struct Located<'f> {
    valid: bool,
    /// In bits 0 and 1 whether yaw and roll were limited.
    limited: u32,
    frame: &'f Frame,
    coordinates: Coordinates,
    /// The places of lateral and yaw.
    plane: Places,
}

/// A lookup before its records are read.
struct Prepared<Q> {
    frame: Frame,
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
        let [of_lateral, of_yaw, of_roll, _] = sections.strides;
        *strides = [of_lateral, of_yaw, of_roll].map(|strides| strides.records);
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
        let mut frame = MaybeUninit::uninit();
        self.locate(Baseline, side, pose, &mut frame).map_or(Coordinates::default(), |located| located.coordinates)
    }

    /// The integers of the record at a node (lateral, yaw, roll offset, vertical); none beyond the axes.
    #[must_use]
    pub fn node_record(&self, side: Side, node: [usize; 4]) -> Option<[i16; LANES]> {
        let counts = self.counts();
        let index = node.iter().zip(counts).try_fold(0, |index, (i, n)| (*i < n).then_some(index * n + i))?;
        self.side(side).records.as_chunks().0.get(index).map(check::lanes)
    }

    /// The channels at coordinates of the table, mirrored to the right wheel as these are. Outside the axes as in a lookup:
    /// limited to them, the indentation extrapolated along the vertical one. What is no number counts as far before an
    /// axis' first node. Nothing remarks on this here; contacts have [`Flags`].
    #[must_use]
    pub fn channels(&self, side: Side, at: &Coordinates) -> Channels {
        match self.avx2 {
            Some(avx2) => avx2.channels(self, side, at),
            None => self.channels_baseline(side, at),
        }
    }

    #[inline(never)]
    fn channels_baseline(&self, side: Side, at: &Coordinates) -> Channels {
        self.channels_by(Baseline, side, at)
    }

    /// [`ContactTable::channels`] by these instructions, which the caller was compiled for.
    #[inline(always)]
    pub(crate) fn channels_by<I: Instructions>(&self, with: I, side: Side, at: &Coordinates) -> Channels {
        let data = self.side(side);
        let plane = data.rigid.plane(with, at.lateral, at.yaw);
        let cell = plane.as_ref().and_then(|plane| self.cell(with, plane, at));
        let Some((cell, _)) = cell else { return Channels::ZERO };
        let Some(edges) = edges(data.records, &cell) else { return Channels::ZERO };
        let mut channels = *with.blend(&edges, &cell, &data.scales, &mut MaybeUninit::uninit());
        // Their scales have the side's sign.
        channels.turn_angles(data.wheel.lateral_sign);
        channels
    }

    /// Asks for the sixteen records of a pose, so that they are in the cache when the lookup comes, while the caller
    /// does other work. Where the target has no prefetch instruction that Rust can name, one byte of each is read; an
    /// in-order core waits for that, and then a lookup alone is the better choice.
    #[inline]
    pub fn prefetch(&self, side: Side, pose: &Pose) {
        if let Some(prepared) = self.prepare(Baseline, side, pose) {
            self.prefetch_cell(side, &prepared.cell);
        }
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
        let mut memory = (MaybeUninit::uninit(), MaybeUninit::uninit());
        let (frame, lanes) = escape(&mut memory);
        // Every place in a checked table has its cell.
        let Some(located) = self.locate(with, side, pose, frame) else { return *contacts = Contacts::NONE };
        let cell = self.cell(with, &located.plane, &located.coordinates);
        let Some((cell, axes)) = cell else { return *contacts = Contacts::NONE };
        let flags = Flags::of_pose(axes, located.limited, located.valid);
        self.finish(with, side, (located.frame, &cell, flags), lanes, contacts);
    }

    /// [`ContactTable::contacts_many`] in the same way.
    #[inline(always)]
    pub(crate) fn look_up_many<I: Instructions>(&self, with: I, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        let mut memory = MaybeUninit::uninit();
        let lanes = escape(&mut memory);
        let mut contacts = contacts.iter_mut();
        let mut ahead = heapless::Deque::<(Side, Option<Prepared<I::Quad>>), AHEAD>::new();
        for (side, pose) in wheels.iter().take(contacts.len()) {
            if ahead.is_full()
                && let (Some((side, one)), Some(contacts)) = (ahead.pop_front(), contacts.next())
            {
                self.finish_prepared(with, side, one.as_ref(), lanes, contacts);
            }
            let prepared = self.prepare(with, *side, pose);
            if let Some(prepared) = &prepared {
                self.prefetch_cell(*side, &prepared.cell);
            }
            // There is room.
            let _ = ahead.push_back((*side, prepared));
        }
        for ((side, one), contacts) in ahead.iter().zip(contacts) {
            self.finish_prepared(with, *side, one.as_ref(), lanes, contacts);
        }
    }

    #[inline(always)]
    fn finish_prepared<I: Instructions>(
        &self,
        with: I,
        side: Side,
        prepared: Option<&Prepared<I::Quad>>,
        lanes: &mut MaybeUninit<Channels>,
        contacts: &mut Contacts,
    ) {
        match prepared {
            Some(one) => self.finish(with, side, (&one.frame, &one.cell, one.flags), lanes, contacts),
            None => *contacts = Contacts::NONE,
        }
    }

    /// All of a lookup up to the records; every place in a checked table has its cell.
    #[inline(always)]
    fn prepare<I: Instructions>(&self, with: I, side: Side, pose: &Pose) -> Option<Prepared<I::Quad>> {
        let mut frame = MaybeUninit::uninit();
        let located = self.locate(with, side, pose, &mut frame)?;
        let (cell, axes) = self.cell(with, &located.plane, &located.coordinates)?;
        let flags = Flags::of_pose(axes, located.limited, located.valid);
        Some(Prepared { frame: *located.frame, cell, flags })
    }

    /// All of a lookup from the records on.
    #[inline(always)]
    fn finish<I: Instructions>(
        &self,
        with: I,
        side: Side,
        (frame, cell, flags): (&Frame, &Cell<I::Quad>, Flags),
        lanes: &mut MaybeUninit<Channels>,
        contacts: &mut Contacts,
    ) {
        let data = self.side(side);
        // Before the blend, which wants all registers.
        contacts.flags = flags;
        // Every cell of a checked table has its records.
        let Some(edges) = edges(data.records, cell) else { return *contacts = Contacts::NONE };
        let lanes = with.blend(&edges, cell, &data.scales, lanes);
        // Read again, so that no register holds it meanwhile.
        let valid = contacts.flags != Flags::INVALID_INPUT;
        let force = contacts.fill(with, lanes, &data.wheel, frame, valid);
        let conformal = lanes.0.get(CONFORMAL_LANE).copied().unwrap_or_default();
        // Above zero, as an integer's bits would be.
        contacts.flags |= Flags::CONFORMAL.when((conformal.to_bits().cast_signed() > 0) & force);
    }

    fn counts(&self) -> [usize; 4] {
        self.axes.each_ref().map(Axis::len)
    }

    #[inline(always)]
    fn locate<'f, I: Instructions>(
        &self,
        with: I,
        side: Side,
        pose: &Pose,
        frame: &'f mut MaybeUninit<Frame>,
    ) -> Option<Located<'f>> {
        let data = self.side(side);
        // An invalid pose costs the same: what is no number is limited like any other.
        let (pose, valid) = pose.mirrored(with, &data.signs);
        let (attitude, limited) = Attitude::by(with, pose.yaw, pose.roll);
        let turned = Turned::new(&data.geometry, &attitude);
        let displacement = Displacement::of(&pose, &turned.displacement);
        let (psi, phi, sign) = (attitude.yaw.value.abs(), attitude.roll.value, longitudinal_sign(attitude.yaw.value));
        // In memory before the registers are wanted for other things.
        let frame = frame.write(Frame::new(&data.geometry, &attitude, &displacement, turned.arm, sign));
        compiler_fence(Ordering::SeqCst);
        let (coordinates, plane) = data.rigid.locate(with, &displacement, psi, phi)?;
        Some(Located { valid, limited, frame, coordinates, plane })
    }

    /// The cell, and in bit i whether its place is clamped on axis i.
    #[inline(always)]
    fn cell<I: Instructions>(&self, with: I, plane: &Places, at: &Coordinates) -> Option<(Cell<I::Quad>, u32)> {
        let section = self.section.locate(with, Two::new([at.roll_offset, at.vertical]))?;
        let axes = plane.clamped.bits_of_both(section.clamped);
        Some((Cell::new(with, plane, &section, self.strides), axes))
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
        signs: PoseSigns::EMPTY,
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
        self.records = check::records(image, &place.records)?.as_flattened();
        self.geometry = header.geometry;
        self.scales.fill(&header.scales);
        self.turn(side);
        Ok(())
    }

    /// Makes the data, whose scales are those of the records, those of a side.
    fn turn(&mut self, side: Side) {
        self.scales.turn_angles(single(side.sign()));
        self.signs = PoseSigns::new(side);
        self.wheel = Wheel::new(&self.geometry, side);
    }
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
