//! Firmware to copy for a loop of your own: a timer's interrupt takes the newest pose once a millisecond, looks both wheels
//! up and leaves an answer; the rest of the time is the main loop's, which here sends a line of JSON a second.
//!
//! What to change: as in `main.rs`; the step; `pose`, which is where your sensors or your vehicle model are read; what
//! becomes of the contacts.
#![no_std]
#![no_main]

mod register;
mod uart;

use core::cell::Cell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;

use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::{SCB, SYST, syst::SystClkSource};
use cortex_m::{Peripherals, singleton};
use cortex_m_rt::{entry, exception};
use flangeway::{ContactTable, Contacts, Pose, Side};
use flangeway_mps2 as _; // your board's peripheral access crate
use panic_halt as _;

use uart::Uart;

/// The table, which stays in flash.
static TABLE: &[u8] = flangeway_tables::S1002_60E1_40_TABLE;

/// Steps a second.
const RATE: u32 = 1000;
/// Ticks of the 25 MHz timer in a step. With QEMU's `-icount shift=0` a tick is 40 instructions.
const TICKS: u32 = 25_000_000 / RATE;

/// Lamps of the board, a bit each, and its clock of 10 ms.
const LAMPS: usize = 0x4002_8000;
const HUNDREDTHS: usize = 0x4002_8014;

/// What the interrupt works with. Nobody else has it once the interrupt is on.
struct FixedStep {
    table: &'static ContactTable<'static>,
    contacts: [Contacts; 2],
    answer: Answer,
}

/// What the main loop sees of it.
#[derive(Clone, Copy, Default)]
struct Answer {
    steps: u32,
    /// Normal force of both wheels, N.
    normal_force: f32,
    /// Most ticks from a step's beginning to its answer.
    ticks: u32,
    /// Steps that began late, since the one before took too long.
    late: u32,
}

/// Where the interrupt finds its state at its first step.
static START: Mutex<Cell<Option<FixedStep>>> = Mutex::new(Cell::new(None));
/// The newest answer.
static ANSWER: Mutex<Cell<Option<Answer>>> = Mutex::new(Cell::new(None));

#[entry]
fn main() -> ! {
    if start().is_some() {
        report(Uart::start())
    }
    loop {
        cortex_m::asm::wfi();
    }
}

fn start() -> Option<()> {
    let mut timer = Peripherals::take()?.SYST;
    // Checked once, in static memory. From here on nothing can fail.
    let place = singleton!(: MaybeUninit<ContactTable<'static>> = MaybeUninit::uninit())?;
    let table = ContactTable::new_in(place, TABLE).ok()?;
    let state = FixedStep { table, contacts: [Contacts::NONE; 2], answer: Answer::default() };
    interrupt::free(|all| START.borrow(all).set(Some(state)));
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(TICKS - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
    Some(())
}

/// A step.
#[exception]
fn SysTick() {
    static mut STATE: Option<FixedStep> = None;
    if STATE.is_none() {
        *STATE = interrupt::free(|all| START.borrow(all).take());
    }
    if let Some(FixedStep { table, contacts, answer }) = STATE {
        let pose = pose(answer.steps);
        // The same number of instructions for every pose.
        for (side, contacts) in Side::ALL.into_iter().zip(&mut *contacts) {
            table.contacts_into(side, &pose, contacts);
        }
        answer.normal_force = contacts.iter().flat_map(Contacts::iter).map(|contact| contact.normal_force).sum();
        answer.steps += 1;
        // A lamp shows that it runs: half a second on, half a second off.
        register::write(LAMPS, (answer.steps / (RATE / 2)) & 1);
        // The timer counts down from the step's beginning, and is pending again when that was missed.
        answer.ticks = answer.ticks.max(TICKS - 1 - SYST::get_current());
        answer.late += u32::from(SCB::is_pendst_pending());
        interrupt::free(|all| ANSWER.borrow(all).set(Some(*answer)));
    }
}

/// The newest pose: here made up, 4 mm to either side twice a second, pressed in by 0.1 mm.
fn pose(step: u32) -> Pose {
    let along = f64::from(step % (RATE / 2)) / f64::from(RATE / 2);
    Pose { lateral: 4e-3 * (1.0 - 4.0 * (along - 0.5).abs()), vertical: 1e-4, ..Pose::default() }
}

/// The main loop.
fn report(mut uart: Uart) -> ! {
    let mut next = RATE;
    loop {
        // Without work of its own it may sleep here, `cortex_m::asm::wfi()`. The emulator keeps exact time only when it does
        // not: asleep, its clock follows the host's.
        if let Some(answer) = interrupt::free(|all| ANSWER.borrow(all).get())
            && answer.steps >= next
        {
            next += RATE;
            let Answer { steps, normal_force, ticks, late } = answer;
            let hundredths = register::read(HUNDREDTHS);
            // Sending does not fail.
            let _ = writeln!(
                uart,
                "{{\"steps\": {steps}, \"hundredths\": {hundredths}, \"late\": {late}, \"ticks_max\": {ticks}, \
                 \"ticks_a_step\": {TICKS}, \"normal_force\": {}}}",
                normal_force as u32
            );
        }
    }
}

impl Write for Uart {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| self.send(byte));
        Ok(())
    }
}
