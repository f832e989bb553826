//! The contact table: checked once, then every lookup is infallible and costs the same.

use core::fmt;
use core::hint::black_box;

use crate::axis::{Axis, AxisName};
use crate::blend::{Cell, blend, record};
use crate::channel::{CHANNELS, CONFORMAL_LANE, Channel, LANES, SLOTS, Scale, Slot};
use crate::check;
use crate::contact::{Contacts, Frame, rebuild, select};
use crate::displacement::{Attitude, Displacement, displacement};
use crate::error::TableError;
use crate::flags::Flags;
use crate::header::{Header, SideHeader};
use crate::layout::{RECORD, Sections};
use crate::pose::{Canonical, Pose, Side, WheelGeometry};
use crate::rigid::{Coordinates, RigidMaps};

/// A contact table, read in place from a borrowed image.
#[derive(Clone)]
pub struct ContactTable<'a> {
    header: Header<'a>,
    axes: [Axis<'a>; 7],
    right: SideData<'a>,
    left: SideData<'a>,
}

/// What a lookup needs of a side.
#[derive(Clone)]
struct SideData<'a> {
    geometry: WheelGeometry,
    rigid: RigidMaps<'a>,
    records: &'a [[u8; RECORD]],
    offsets: [f32; LANES],
    steps: [f32; LANES],
}

/// Where a pose lies in the table.
struct Located {
    valid: bool,
    canonical: Canonical,
    attitude: Attitude,
    displacement: Displacement,
    coordinates: Coordinates,
}

impl<'a> ContactTable<'a> {
    /// Checks an image and takes it as a table. The image is read through once (checksum and plausibility of every
    /// section), without allocation; it needs no alignment, but records straddle cache lines unless it lies on a
    /// multiple of 64 bytes.
    ///
    /// # Errors
    /// Whatever is wrong with the image, see [`TableError`].
    pub fn new(image: &'a [u8]) -> Result<Self, TableError> {
        let bytes = check::envelope(image)?;
        let header = check::header(bytes)?;
        let sections = Sections::new(bytes.len(), &header.axes, header.sides());
        let sections = match sections {
            Some(sections) if sections.total == image.len() => sections,
            other => return Err(TableError::Sections { needed: other.map(|s| s.total), length: image.len() }),
        };
        check::padding(image, &sections)?;
        let axes = check::axes(image, &header, &sections)?;
        let [right_sections, left_sections] = &sections.sides;
        let side = |header: &SideHeader<'_>, place: &crate::layout::SideSections| {
            let [_, _, _, _, lateral, yaw, roll] = axes;
            let roll_map = check::rigid_roll(image, &place.rigid_roll)?;
            let vertical_map = check::rigid_vertical(image, &place.rigid_vertical)?;
            let rigid = RigidMaps::new(lateral, yaw, roll, roll_map, vertical_map)
                .ok_or(TableError::Sections { needed: Some(sections.total), length: image.len() })?;
            let records = check::records(image, &place.records)?;
            Ok(SideData::new(header, rigid, records))
        };
        let right = side(&header.right, right_sections)?;
        let left = match &header.left {
            Some(left) => side(left, left_sections)?,
            None => right.clone(),
        };
        Ok(Self { header, axes, right, left })
    }

    /// The header.
    #[must_use]
    pub const fn header(&self) -> &Header<'a> {
        &self.header
    }

    /// One of the table's axes.
    #[must_use]
    pub const fn axis(&self, name: AxisName) -> &Axis<'a> {
        let [lateral, yaw, roll, vertical, rigid_lateral, rigid_yaw, rigid_roll] = &self.axes;
        match name {
            AxisName::Lateral => lateral,
            AxisName::Yaw => yaw,
            AxisName::RollOffset => roll,
            AxisName::Vertical => vertical,
            AxisName::RigidLateral => rigid_lateral,
            AxisName::RigidYaw => rigid_yaw,
            AxisName::RigidRollOffset => rigid_roll,
        }
    }

    /// The rigid maps of a side, for canonical coordinates.
    #[must_use]
    pub const fn rigid(&self, side: Side) -> &RigidMaps<'a> {
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
        self.locate(side, pose).coordinates
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
        let side = self.side(side);
        slots(&side.scaled(&self.cell(at).0)).0
    }

    /// Brings the records of a pose into the cache by reading one byte of each of the sixteen.
    ///
    /// Safe Rust has no prefetch instruction. A core that runs on past outstanding loads overlaps the sixteen with each
    /// other and with what follows; an in-order core waits for each, and then a lookup alone is the better choice.
    #[inline]
    pub fn prefetch(&self, side: Side, pose: &Pose) {
        let (cell, _) = self.cell(&self.locate(side, pose).coordinates);
        let records = self.side(side).records;
        for edge in cell.edges {
            for index in [edge, edge + 1] {
                black_box(record(records, index).first().copied());
            }
        }
    }

    /// Contacts of a wheel: at most one a slot, those that carry force.
    #[must_use]
    pub fn contacts(&self, side: Side, pose: &Pose) -> Contacts {
        let data = self.side(side);
        let located = self.locate(side, pose);
        let (cell, mut flags) = self.cell(&located.coordinates);
        let (channels, conformal) = slots(&data.scaled(&cell));
        let frame = Frame {
            geometry: &data.geometry,
            canonical: &located.canonical,
            attitude: &located.attitude,
            displacement: &located.displacement,
        };
        let [tread, root, flange] = &channels;
        let candidates = [
            rebuild(Slot::Tread, tread, &frame),
            rebuild(Slot::FlangeRoot, root, &frame),
            rebuild(Slot::Flange, flange, &frame),
        ];
        let force = candidates.iter().map(|c| c.normal_force).fold(0.0, f32::max);
        flags |= Flags::ANGLE_LIMITED.when(located.attitude.yaw.limited | located.attitude.roll.limited);
        flags |= Flags::CONFORMAL.when((conformal > 0.0) & (force > 0.0) & located.valid);
        flags |= Flags::INVALID_INPUT.when(!located.valid);
        select(candidates, located.valid, flags)
    }

    fn counts(&self) -> [usize; 4] {
        let [lateral, yaw, roll, vertical, ..] = &self.axes;
        [lateral.len(), yaw.len(), roll.len(), vertical.len()]
    }

    #[inline]
    fn locate(&self, side: Side, pose: &Pose) -> Located {
        let data = self.side(side);
        let valid = pose.is_valid();
        // An invalid pose takes the same way as any other, from pose zero.
        let pose = if valid { *pose } else { Pose::default() };
        let canonical = pose.canonical(side);
        let attitude = Attitude::new(canonical.pose.yaw, canonical.pose.roll);
        let displacement = Displacement::new(&data.geometry, &canonical.pose, &attitude);
        let coordinates = data.rigid.coordinates(&displacement, attitude.yaw.value, attitude.roll.value);
        Located { valid, canonical, attitude, displacement, coordinates }
    }

    #[inline]
    fn cell(&self, at: &Coordinates) -> (Cell, Flags) {
        let [lateral, yaw, roll, vertical, ..] = &self.axes;
        let places =
            [lateral.locate(at.lateral), yaw.locate(at.yaw), roll.locate(at.roll_offset), vertical.locate(at.vertical)];
        let [u, psi, phi, zeta] = &places;
        let flags = Flags::CLAMPED_LATERAL.when(u.clamped)
            | Flags::CLAMPED_YAW.when(psi.clamped)
            | Flags::CLAMPED_ROLL.when(phi.clamped)
            | Flags::CLAMPED_VERTICAL.when(zeta.clamped);
        (Cell::new(&places, self.counts()), flags)
    }
}

impl fmt::Debug for ContactTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ContactTable").field("header", &self.header).field("axes", &self.axes).finish_non_exhaustive()
    }
}

impl<'a> SideData<'a> {
    fn new(header: &SideHeader<'_>, rigid: RigidMaps<'a>, records: &'a [[u8; RECORD]]) -> Self {
        // Lanes without a scale keep their integers.
        let (mut offsets, mut steps) = ([0.0; LANES], [1.0; LANES]);
        let lanes = offsets.iter_mut().zip(steps.iter_mut());
        for ((offset, step), scale) in lanes.zip(header.scales.as_flattened()) {
            (*offset, *step) = (scale.offset, scale.step);
        }
        Self { geometry: header.geometry, rigid, records, offsets, steps }
    }

    /// Blended lanes in their units.
    #[inline]
    fn scaled(&self, cell: &Cell) -> [f32; LANES] {
        let mut lanes = blend(self.records, cell);
        for ((lane, offset), step) in lanes.iter_mut().zip(&self.offsets).zip(&self.steps) {
            *lane = Scale { offset: *offset, step: *step }.value(*lane);
        }
        lanes
    }
}

/// The lanes as slots of channels, and the conformal share.
#[inline]
fn slots(lanes: &[f32; LANES]) -> ([[f32; CHANNELS]; SLOTS], f32) {
    let mut slots = [[0.0; CHANNELS]; SLOTS];
    for (channel, lane) in slots.as_flattened_mut().iter_mut().zip(lanes) {
        *channel = *lane;
    }
    let [.., conformal, _] = lanes;
    (slots, *conformal)
}

// The record is laid out as the lanes are taken apart.
const _: () = assert!(CONFORMAL_LANE == LANES - 2 && Channel::RailCurvature.lane(Slot::Flange) + 1 == CONFORMAL_LANE);
