//! `atrv-emulator`: an ATRV-mini on a pseudo-terminal, in a simulated world, for those who have none at hand.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Options, program};
use mdle_sim::Body;

/// An ATRV-mini that is not there: its language on a pseudo-terminal, its body in a simulated world.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Understand values of 1B that are marked in commands; without it such a command is lost.
    #[arg(long)]
    marks: bool,
}

fn main() -> ExitCode {
    let Arguments { options, marks } = Arguments::parse();
    program("the ATRV", Body::Atrv, &options, step, |body, step| Atrv::new(body, step, marks))
}
