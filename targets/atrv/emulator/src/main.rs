//! `atrv-emulator`: emulates an ATRV-mini on a pseudo-terminal, in a simulated world.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    mdle_atrv_emulator::main()
}
