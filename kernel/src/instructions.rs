//! Which of the processor's instructions lookups are made of. All give the same bits.

use core::mem::MaybeUninit;
use core::ops::{Add, Mul, Sub};

use crate::axis::{BinBytes, Cells};
use crate::blend::{Cell, Edges, LaneScales, running_sums};
use crate::channel::{Channels, SLOTS};
use crate::contact::Contact;
use crate::math::{Four, Quad, Two};

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
pub(crate) use crate::simd::{Avx2, escape, opaque};
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
use crate::{
    contact::Contacts,
    pose::{Pose, Side},
    rigid::Coordinates,
    table::ContactTable,
};

/// Memory that the compiler must take for known to others: what is written to it before a fence is there at the fence.
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
#[inline(always)]
pub(crate) fn escape<T>(place: &mut T) -> &mut T {
    core::hint::black_box(place)
}

/// The same slice, whose address the compiler must take for any.
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
#[inline(always)]
pub(crate) const fn opaque<T>(list: &[T]) -> &[T] {
    list
}

/// Instructions that a table's lookups are made of; every set gives the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Those that the build may use on every processor it is made for: on x86-64 SSE2.
    Baseline,
    /// AVX2, on x86-64. Fewer instructions, but some processors power the upper halves of the vectors down after about a
    /// millisecond without them, and are slower for some microseconds when they are wanted again.
    Avx2,
}

impl InstructionSet {
    pub(crate) const fn of(avx2: Option<Avx2>) -> Self {
        match avx2 {
            Some(_) => Self::Avx2,
            None => Self::Baseline,
        }
    }
}

impl core::fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "AVX2",
        })
    }
}

/// A set of instructions, as the parts of a lookup are made of it.
pub(crate) trait Instructions: Copy {
    /// Four `f64` that take the same operations.
    type Quad: Quads<Self>;

    /// Blended lanes of a cell's records in their units, written to a place.
    fn blend<'p>(
        self,
        edges: &Edges<'_>,
        cell: &Cell<Self::Quad>,
        scales: &LaneScales,
        place: &'p mut MaybeUninit<Channels>,
    ) -> &'p Channels;

    /// What the bins of two axes say.
    fn cells(self, a: &BinBytes, b: &BinBytes) -> Cells;

    /// The integer parts of numbers from 0 to 15, and the sum of their products with the first two of these.
    fn integer_parts(self, numbers: Two, factors: &[u32; 4]) -> (u32, Two);

    /// The first eight numbers of the slots' contacts, given number by number for all slots, as [`Eight`]s.
    fn transposed(self, numbers: [[Four; 4]; 2]) -> [impl Eight; SLOTS];
}

/// The first eight numbers of a contact.
pub(crate) trait Eight {
    fn write(self, contact: &mut Contact);
}

/// See [`Instructions::Quad`].
pub(crate) trait Quads<I>: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Four times the same.
    fn all(with: I, x: f64) -> Self;
    /// Four little-endian `f32`.
    fn of_singles(with: I, bytes: &[u8; 16]) -> Self;
    fn join(with: I, halves: [Two; 2]) -> Self;
    /// The same, which the compiler must take for any four numbers where they are one vector: otherwise it may take the
    /// vector apart again for what is made of it.
    fn held(self) -> Self;
    fn halves(self) -> [Two; 2];
    /// Whether all are numbers at most this large.
    fn all_within(self, limit: f64) -> bool;
    /// See [`running_sums`].
    fn running_sums(with: I, plane: Two, roll: f64) -> [Self; 2];
}

/// [`InstructionSet::Baseline`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Baseline;

impl Instructions for Baseline {
    type Quad = Quad;

    #[inline(always)]
    fn blend<'p>(
        self,
        edges: &Edges<'_>,
        cell: &Cell,
        scales: &LaneScales,
        place: &'p mut MaybeUninit<Channels>,
    ) -> &'p Channels {
        #[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
        return crate::simd::blend_128(edges, cell, scales, place);
        #[cfg(all(target_arch = "arm", not(feature = "portable")))]
        return crate::arm::blend(edges, cell, scales, place);
        #[cfg(any(
            not(any(target_arch = "arm", all(target_arch = "x86_64", target_feature = "sse2"))),
            feature = "portable"
        ))]
        return crate::blend::portable(edges, cell, scales, place);
    }

    #[inline(always)]
    fn cells(self, a: &BinBytes, b: &BinBytes) -> Cells {
        Cells::new(a, b)
    }

    #[inline(always)]
    fn integer_parts(self, numbers: Two, [of_a, of_b, ..]: &[u32; 4]) -> (u32, Two) {
        let ([a, b], whole) = numbers.integer_parts();
        (a * of_a + b * of_b, whole)
    }

    #[inline(always)]
    fn transposed(self, [first, second]: [[Four; 4]; 2]) -> [impl Eight; SLOTS] {
        let ([a, b, c, _], [d, e, f, _]) = (Four::transpose(first), Four::transpose(second));
        [[a, d], [b, e], [c, f]]
    }
}

impl Eight for [Four; 2] {
    #[inline(always)]
    fn write(self, contact: &mut Contact) {
        let [first, second] = self;
        [contact.normal_force, contact.indentation, contact.position.x, contact.position.y] = first.numbers();
        [contact.position.z, contact.angle, contact.rolling_radius, contact.wheel_coordinate] = second.numbers();
    }
}

impl Quads<Baseline> for Quad {
    #[inline(always)]
    fn all(_: Baseline, x: f64) -> Self {
        Self::all(x)
    }

    #[inline(always)]
    fn of_singles(_: Baseline, bytes: &[u8; 16]) -> Self {
        Self::of_singles(bytes)
    }

    #[inline(always)]
    fn held(self) -> Self {
        self
    }

    #[inline(always)]
    fn join(_: Baseline, halves: [Two; 2]) -> Self {
        Self::join(halves)
    }

    #[inline(always)]
    fn halves(self) -> [Two; 2] {
        Self::halves(self)
    }

    #[inline(always)]
    fn all_within(self, limit: f64) -> bool {
        Self::all_within(self, limit)
    }

    #[inline(always)]
    fn running_sums(_: Baseline, plane: Two, roll: f64) -> [Self; 2] {
        running_sums(plane, roll)
    }
}

/// AVX2, which this build does not have.
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
#[derive(Debug, Clone, Copy)]
pub(crate) enum Avx2 {}

#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
impl Avx2 {
    pub(crate) const fn found() -> Option<Self> {
        None
    }

    pub(crate) fn contacts_into(self, _: &ContactTable<'_>, _: Side, _: &Pose, _: &mut Contacts) {
        match self {}
    }

    pub(crate) fn contacts_many(self, _: &ContactTable<'_>, _: &[(Side, Pose)], _: &mut [Contacts]) {
        match self {}
    }

    pub(crate) fn channels(self, _: &ContactTable<'_>, _: Side, _: &Coordinates) -> Channels {
        match self {}
    }
}
