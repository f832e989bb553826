//! Whether there is AVX2, and lookups compiled for it: what is inlined into them may use its instructions, and vectors
//! of 128 bits get their three-operand forms.

use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};

use crate::contact::Contacts;
use crate::pose::{Pose, Side};
use crate::table::ContactTable;

/// That the processor, and the operating system for the vectors' upper halves, has AVX2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// Asks the processor (Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 14.7.1).
    pub(crate) fn found() -> Option<Self> {
        let there = cfg!(target_feature = "avx2") || (!cfg!(miri) && ask());
        there.then_some(Self(()))
    }

    #[inline(always)]
    pub(crate) fn contacts_into(self, table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
        // SAFETY: `self` says that there is AVX2. The same below.
        unsafe { contacts_into(self, table, side, pose, contacts) }
    }

    #[inline(always)]
    pub(crate) fn contacts_many(self, table: &ContactTable<'_>, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
        unsafe { contacts_many(self, table, wheels, contacts) }
    }
}

#[target_feature(enable = "avx2")]
fn contacts_into(avx2: Avx2, table: &ContactTable<'_>, side: Side, pose: &Pose, contacts: &mut Contacts) {
    table.look_up(Some(avx2), side, pose, contacts);
}

#[target_feature(enable = "avx2")]
fn contacts_many(avx2: Avx2, table: &ContactTable<'_>, wheels: &[(Side, Pose)], contacts: &mut [Contacts]) {
    table.look_up_many(Some(avx2), wheels, contacts);
}

#[allow(unused_unsafe, reason = "asking is safe from Rust 1.93 on")]
fn ask() -> bool {
    // Leaf 1: ECX bit 27, the operating system has enabled XGETBV; bit 28, AVX. Leaf 7: EBX bit 5, AVX2.
    const SAVED_AND_AVX: u32 = 3 << 27;
    const AVX2: u32 = 1 << 5;
    // XCR0: the system saves the lower (bit 1) and upper (bit 2) halves of the vectors.
    const HALVES: u64 = 3 << 1;
    #[target_feature(enable = "xsave")]
    fn saved() -> u64 {
        unsafe { _xgetbv(0) }
    }
    // SAFETY: every x86-64 processor has CPUID, and XGETBV is called only where it says so.
    unsafe {
        __cpuid(0).eax >= 7
            && __cpuid(1).ecx & SAVED_AND_AVX == SAVED_AND_AVX
            && saved() & HALVES == HALVES
            && __cpuid_count(7, 0).ebx & AVX2 != 0
    }
}
