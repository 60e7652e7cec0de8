//! A Super Scout that is not there: its language on a pseudo-terminal, its body in a simulated world.
#![forbid(unsafe_code)]

pub mod scout;
pub mod wire;

use std::process::ExitCode;

use clap::Parser;
use mdle_emulator::{Options, Pace, program};
use mdle_simulator::Body;

use scout::Scout;

/// Emulate a Nomadic Super Scout on a pseudo-terminal, in a simulated world
#[derive(Debug, Parser)]
#[command(name = "scout-emulator")]
struct Arguments {
    #[command(flatten)]
    options: Options,
}

/// Runs the robot emulator with the arguments of this process, until a signal comes. Returns its exit status.
pub fn main() -> ExitCode {
    program("the Scout", Body::Scout, &Arguments::parse().options, Pace::step, |body, _| Scout::new(body))
}
