//! `scout-emulator`: emulates a Super Scout on a pseudo-terminal, in a simulated world.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    mdle_scout_emulator::main()
}
