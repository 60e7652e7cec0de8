//! The program `mdle`: it compiles a plan, loads it, and runs it as an executable of `mdlec` would.
#![forbid(unsafe_code)]

mod arguments;
mod failure;
mod run;
mod targets;

use std::process::ExitCode;

use failure::Failure;

/// Runs the command line of this process. The exit status of a run is that of an executable; 1 means that the plan has
/// errors, and 2 wrong usage or a file that cannot be read.
#[must_use]
pub fn main() -> ExitCode {
    let arguments = std::env::args_os().collect();
    arguments::parse(arguments).and_then(run::run).unwrap_or_else(Failure::tell)
}
