//! `mdle`, which runs plans without building them.

use std::process::ExitCode;

fn main() -> ExitCode {
    mdle::main()
}
