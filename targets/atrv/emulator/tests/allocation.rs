//! A turn of the driver allocates nothing.
#![allow(unsafe_code, reason = "an allocator is unsafe to write, and this one only counts")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv::{Atrv, Clock, Config, Configured};
use mdle_atrv_emulator::atrv::{Atrv as Emulated, step};
use mdle_emulator::{Pace, Port, serve};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, Twist};
use mdle_sim::{Body, Make, Simulated, World};

thread_local! {
    /// How often this thread has asked for memory.
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.set(ASKED.get() + 1);
        // SAFETY: the caller's promise is handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_turn_allocates_nothing() {
    let pace = Pace::Lockstep(Duration::from_millis(100));
    let world = World::office().unwrap();
    let make = Make { body: Body::Atrv, without: Vec::new(), seed: Some(1) };
    let body = Simulated::with(&make, &world, world.start, step(pace)).unwrap();
    let mut robot = Emulated::new(body, step(pace), false).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let config = Config { answer: 60_000, ..Configured::read(None, port.path().to_str()).unwrap().config };
        let mut driver = Atrv::connect(config, Clock::Stepped(pace.step()), pace.step()).unwrap();
        let before = ASKED.get();
        // Long enough for it to be asked for its brake, and for filler.
        let turns = (0..50)
            .map(|turn| Twist { v: MetersPerSecond(0.2), omega: RadiansPerSecond(f64::from(turn % 7) / 10.0 - 0.3) });
        let went_well = turns.map(|input| driver.exchange(&input)).all(|said| said.is_ok());
        let asked = ASKED.get() - before;
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        assert_eq!((went_well, asked), (true, 0));
    });
}
