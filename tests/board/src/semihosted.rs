//! Entry point on the microcontroller. Its files are on the host, a computer with a debugger or with QEMU: the robot
//! senses what the file `sensed` contains, and the output goes to `board.out`.
#![allow(unsafe_code, reason = "semihosting and the linker's symbols have addresses only")]

use core::fmt::{self, Write};
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, entry, exception};
use cortex_m_semihosting::{debug, nr, syscall};
use mdle_board::{Input, Output, Robot, at_rest, record, run};
use mdle_runtime::{Machine, Nanos};
use static_cell::StaticCell;

use crate::lab_tour::LabTour;

/// The plan with its machine. It is static, like the robot's output, to keep it off the stack.
static MACHINE: StaticCell<Machine<LabTour>> = StaticCell::new();
static SENSED: StaticCell<Output> = StaticCell::new();

/// Word with which `cortex-m-rt` fills the unused stack.
const PAINT: u32 = cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static mut _stack_end: u32;
    static mut _stack_start: u32;
}

#[entry]
fn main() -> ! {
    let mut robot = Recorded(File::open("sensed\0", nr::open::R_BINARY));
    let mut out = File::open("board.out\0", nr::open::W_TRUNC);
    let mut begin = [0; record::BEGIN];
    let is_complete =
        robot.0.read(&mut begin) && run(&MACHINE, LabTour::new, sensed(&begin), &mut robot, &mut out).is_ok();
    let mut stack = File::open("board.stack\0", nr::open::W_TRUNC);
    let is_complete = writeln!(stack, "stack {}", deepest()).is_ok() && is_complete;
    end(if is_complete { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE })
}

/// Returns the robot's output before the first cycle.
#[inline(never)]
fn sensed(begin: &record::Begin) -> &'static mut Output {
    SENSED.init_with(|| at_rest(record::shape(begin)))
}

/// A robot whose cycles are read from a record.
struct Recorded(File);

impl Robot for Recorded {
    fn sense(&mut self, y: &mut Output) -> Option<Nanos> {
        let mut turn = [0; record::TURN];
        if !self.0.read(&mut turn) {
            return None;
        }
        let (t, pings) = record::turn(&turn, y);
        for _ in 0..pings {
            let mut ping = [0; record::PING];
            if !self.0.read(&mut ping) {
                return None;
            }
            record::ping(&ping, y);
        }
        record::hear(y);
        Some(t)
    }

    fn drive(&mut self, _: Input) {}
}

/// A file on the host.
struct File(usize);

impl File {
    /// Opens a file. `name` must end with a zero byte.
    fn open(name: &str, mode: usize) -> Self {
        // SAFETY: the name outlives the call.
        Self(unsafe { syscall!(OPEN, name.as_ptr(), mode, name.len().saturating_sub(1)) })
    }

    /// Fills `bytes` from the file; returns `false` if the file ends before `bytes` is full.
    fn read(&mut self, bytes: &mut [u8]) -> bool {
        // SAFETY: at most `bytes.len()` bytes are written to `bytes`.
        unsafe { syscall!(READ, self.0, bytes.as_mut_ptr(), bytes.len()) == 0 }
    }
}

impl fmt::Write for File {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // SAFETY: the text outlives the call.
        match unsafe { syscall!(WRITE, self.0, text.as_ptr(), text.len()) } {
            0 => Ok(()),
            _ => Err(fmt::Error),
        }
    }
}

/// Returns the peak size of the stack, in bytes.
fn deepest() -> usize {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut at = end;
    // SAFETY: both pointers are inside the stack, every word of which was painted.
    while at < start && unsafe { at.read_volatile() } == PAINT {
        at = at.wrapping_add(1);
    }
    start.addr().saturating_sub(at.addr())
}

/// Ends the emulator with this exit status.
fn end(status: debug::ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    end(debug::EXIT_FAILURE)
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    end(debug::EXIT_FAILURE)
}
