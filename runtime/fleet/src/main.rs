//! The program `mdle` with state links over a Zenoh router.

use std::process::ExitCode;

fn main() -> ExitCode {
    mdle::main_with_router(|_| (), mdle_fleet::open)
}
