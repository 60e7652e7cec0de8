//! `mdlec`, the compiler of MDLe plans.

use std::process::ExitCode;

fn main() -> ExitCode {
    mdlec::cli::main()
}
