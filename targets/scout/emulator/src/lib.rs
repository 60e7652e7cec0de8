//! Robot emulator of a Super Scout. It speaks the robot's protocol on a pseudo-terminal, and moves the body in a
//! simulated world.
#![forbid(unsafe_code)]

pub mod scout;
pub mod wire;

use std::process::ExitCode;

use mdle_emulator::{EmulatorOptions, Pace, program};
use mdle_host::clap::Command;
use mdle_simulator::Body;

use scout::Scout;

/// Runs the robot emulator with the arguments of this process until a signal arrives; returns the exit status.
pub fn main() -> ExitCode {
    let about = "Emulate a Nomadic Super Scout on a pseudo-terminal, in a simulated world";
    let matches = EmulatorOptions::arguments(Command::new("scout-emulator").about(about)).get_matches();
    program("the Scout", Body::Scout, &EmulatorOptions::of(&matches), Pace::step, |body, _| Scout::new(body))
}
