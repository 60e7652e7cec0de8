//! The program `mdle`, which runs plans without building executables.

use std::process::ExitCode;

fn main() -> ExitCode {
    mdle::main()
}
