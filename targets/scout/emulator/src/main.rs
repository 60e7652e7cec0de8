//! `scout-emulator`: a Super Scout on a pseudo-terminal, in a simulated world, for those who have none at hand.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use mdle_emulator::{Options, Pace, program};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::Body;

/// A Super Scout that is not there: its language on a pseudo-terminal, its body in a simulated world.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    options: Options,
}

fn main() -> ExitCode {
    program("the Scout", Body::Scout, &Arguments::parse().options, Pace::step, |body, _| Scout::new(body))
}
