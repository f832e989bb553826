//! Which of the processor's instructions lookups are made of. All give the same bits.

#[cfg(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable")))]
pub(crate) use crate::simd::Avx2;
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", not(feature = "portable"))))]
use crate::{
    contact::Contacts,
    pose::{Pose, Side},
    table::ContactTable,
};

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
}
