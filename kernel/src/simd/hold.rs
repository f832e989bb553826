//! Where values are made, in registers or in memory: empty `asm!` that the compiler must take for any instruction.
//!
//! It would keep what a value is made of for later, take a vector apart, read a record once where reading it twice costs
//! nothing, and so need more registers than there are. None of this changes a value; what each is worth is counted in
//! instructions (`.ci/gates`).

#[cfg(not(miri))]
use core::arch::asm;
use core::arch::x86_64::{__m128d, __m256i};

// SAFETY of every block in this file: no instruction at all, so values and memory stay as they are.

/// Memory that the compiler must take for known to others: what is written to it before a fence is there at the fence.
/// As `black_box` of a reference, which would be written to memory itself.
#[inline(always)]
pub(crate) fn escape<T>(place: &mut T) -> &mut T {
    #[cfg(not(miri))]
    unsafe {
        asm!("/* {} */", in(reg) core::ptr::from_mut(place), options(nostack, preserves_flags));
    }
    place
}

/// The same slice, whose address the compiler must take for any: it keeps it in a register.
#[inline(always)]
#[cfg_attr(not(miri), expect(clippy::pointers_in_nomem_asm_block, reason = "no instruction at all"))]
pub(crate) fn opaque<T>(list: &[T]) -> &[T] {
    #[cfg(miri)]
    return list;
    #[cfg(not(miri))]
    unsafe {
        let mut start = list.as_ptr();
        asm!("/* {} */", inout(reg) start, options(nomem, nostack, preserves_flags, pure));
        core::slice::from_raw_parts(start, list.len())
    }
}

/// The same vector, made here and not later.
#[inline(always)]
pub(super) fn made(vector: __m128d) -> __m128d {
    let mut vector = vector;
    #[cfg(not(miri))]
    unsafe {
        asm!("/* {} */", inout(xmm_reg) vector, options(nomem, nostack, preserves_flags));
    }
    vector
}

/// The same vector, which is not taken apart.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn held(vector: __m256i) -> __m256i {
    let mut vector = vector;
    #[cfg(not(miri))]
    unsafe {
        asm!("/* {} */", inout(ymm_reg) vector, options(pure, nomem, nostack, preserves_flags));
    }
    vector
}

/// The same vector, made here; what is read from memory afterwards is read again.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn settled(vector: __m256i) -> __m256i {
    let mut vector = vector;
    #[cfg(not(miri))]
    unsafe {
        asm!("/* {} */", inout(ymm_reg) vector, options(nostack, preserves_flags));
    }
    vector
}
