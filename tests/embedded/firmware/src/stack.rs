//! How deep the stack grows: the part that is not in use is painted, and looked at again afterwards.

unsafe extern "C" {
    /// Where the stack may grow down to, by the linker's script.
    static mut _stack_end: u32;
}

const PAINT: u32 = 0xa5c3_5a3c;
/// Words painted below the caller: more than any of what is looked at takes.
const WORDS: usize = 16_384;
/// Words below the caller that are left alone: what this function and the loops in it may use themselves.
const OWN: usize = 32;

/// Bytes of stack that a call takes, its own frame and return address included, to within the space of
/// this function's own frame, which is counted as well.
#[inline(never)]
pub(crate) fn used_by(call: impl FnOnce()) -> u32 {
    let pointer = stack_pointer();
    let top = pointer - OWN * 4;
    let bottom = top - WORDS * 4;
    if bottom < core::ptr::addr_of!(_stack_end) as usize {
        return u32::MAX;
    }
    let word = |index: usize| (bottom + 4 * index) as *mut u32;
    for index in 0..WORDS {
        // SAFETY: between the stack's end and what is in use of it, where nothing lives.
        unsafe { word(index).write_volatile(PAINT) }
    }
    call();
    // SAFETY: as above.
    let untouched = (0..WORDS).take_while(|index| unsafe { word(*index).read_volatile() } == PAINT).count();
    if untouched == WORDS { (OWN * 4) as u32 } else { (pointer - (bottom + 4 * untouched)) as u32 }
}

/// The stack pointer.
#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: reads a register.
    unsafe { core::arch::asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) }
    pointer
}
