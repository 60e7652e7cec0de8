//! `atrv-emulator`: emulates an ATRV-mini on a pseudo-terminal, in a simulated world.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Options, program};
use mdle_sim::Body;

/// Emulate an iRobot ATRV-mini on a pseudo-terminal, in a simulated world
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Accept escaped 1B bytes in commands; without this option such a command is lost
    #[arg(long)]
    marks: bool,
}

fn main() -> ExitCode {
    let Arguments { options, marks } = Arguments::parse();
    program("the ATRV", Body::Atrv, &options, step, |body, step| Atrv::new(body, step, marks))
}
