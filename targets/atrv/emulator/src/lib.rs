//! An ATRV-mini that is not there: its language on a pseudo-terminal, its body in a simulated world.
#![forbid(unsafe_code)]

pub mod atrv;
pub mod wire;

use std::process::ExitCode;

use clap::Parser;
use mdle_emulator::{Options, program};
use mdle_simulator::Body;

use atrv::{Atrv, step};

/// Emulate an iRobot ATRV-mini on a pseudo-terminal, in a simulated world
#[derive(Debug, Parser)]
#[command(name = "atrv-emulator")]
struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Accept escaped 1B bytes in commands; without this option such a command is lost
    #[arg(long)]
    marks: bool,
}

/// Runs the robot emulator with the arguments of this process, until a signal comes. Returns its exit status.
pub fn main() -> ExitCode {
    let Arguments { options, marks } = Arguments::parse();
    program("the ATRV", Body::Atrv, &options, step, |body, step| Atrv::new(body, step, marks))
}
