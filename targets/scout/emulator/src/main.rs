//! `scout-emulator`: emulates a Super Scout on a pseudo-terminal, in a simulated world.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use mdle_emulator::{Options, Pace, program};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::Body;

/// Emulate a Nomadic Super Scout on a pseudo-terminal, in a simulated world
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    options: Options,
}

fn main() -> ExitCode {
    program("the Scout", Body::Scout, &Arguments::parse().options, Pace::step, |body, _| Scout::new(body))
}
