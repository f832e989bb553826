//! x
#![no_std]
#![no_main]
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use core::hint::black_box;
use cortex_m_semihosting::{debug, hprintln};
use flangeway::{ContactTable, Contacts, Pose, Side};

static THREE: &[u8] = include_bytes!("../../../../gates/three_contacts.fwt");

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! { hprintln!("panic"); debug::exit(debug::EXIT_FAILURE); loop {} }

#[inline(never)]
fn nops(n: u32) { for _ in 0..n { cortex_m::asm::nop() } }
#[inline(never)]
fn counted(t: &ContactTable<'_>, side: Side, pose: &Pose, c: &mut Contacts) { t.contacts_into(side, pose, c) }
#[inline(never)]
fn floor(t: &ContactTable<'_>, side: Side, pose: &Pose, c: &mut Contacts) { black_box((t, side, pose, c)); }
const R: u32 = 128;
fn time(mut f: impl FnMut()) -> u32 {
    let a = SYST::get_current();
    for _ in 0..R { f() }
    let b = SYST::get_current();
    (a.wrapping_sub(b) & 0xffffff)
}
#[entry]
fn main() -> ! {
    let mut p = cortex_m::Peripherals::take().unwrap();
    p.SYST.set_clock_source(SystClkSource::Core);
    p.SYST.set_reload(0xffffff);
    p.SYST.clear_current();
    p.SYST.enable_counter();
    hprintln!("nop1000 {}  nop 10 {}", time(|| nops(1000)), time(|| nops(10)));
    for image in [flangeway_tables::S1002_60E1_40_TABLE, THREE] {
        let t0 = SYST::get_current();
        let Ok(t) = ContactTable::new(image) else { panic!() };
        hprintln!("new {} size {}", (t0 - SYST::get_current()) & 0xffffff, core::mem::size_of_val(&t));
        let mut c = Contacts::NONE;
        for i in 0..6 {
            let pose = black_box(Pose { lateral: 0.003*i as f64, vertical: 1e-4+1e-4*i as f64, yaw: 0.001, ..Pose::default() });
            let f = time(|| floor(&t, Side::Right, &pose, &mut c));
            let n = time(|| counted(&t, Side::Right, &pose, &mut c));
            hprintln!("{} contacts {}: {}", i, c.list.len(), (n - f) * 40 / R);
        }
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
