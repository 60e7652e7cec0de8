//! A turn of the driver allocates nothing.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_emulator::{Pace, Port, serve};
use mdle_host::StopRequest;
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, Twist};
use mdle_scout::{Clock, Config, Configured, Scout};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_sim::{Body, Make, Simulated, World};

#[path = "../../../emulator/tests/counting/mod.rs"]
mod counting;

#[test]
fn a_turn_allocates_nothing() {
    let pace = Pace::Lockstep(Duration::from_millis(100));
    let world = World::office().unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: Some(1) };
    let body = Simulated::with(&make, &world, world.start, pace.step()).unwrap();
    let mut robot = Emulated::new(body).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let config = Config { answer: 60_000, ..Configured::read(None, port.path().to_str()).unwrap().config };
        let mut driver =
            Scout::connect(config, Clock::Stepped(pace.step()), pace.step(), &StopRequest::default()).unwrap();
        let before = counting::asked();
        // Long enough for each sonar to ping.
        let turns = (0..50)
            .map(|turn| Twist { v: MetersPerSecond(0.2), omega: RadiansPerSecond(f64::from(turn % 7) / 10.0 - 0.3) });
        let went_well = turns.map(|input| driver.exchange(&input)).all(|said| said.is_ok());
        let asked = counting::asked() - before;
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        assert_eq!((went_well, asked), (true, 0));
    });
}
