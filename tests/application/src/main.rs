//! An application with a plan that is compiled into it.

use std::process::ExitCode;

/// Rust that `build.rs` emits for `plans/round.mdle`.
mod round {
    include!(concat!(env!("OUT_DIR"), "/round.rs"));
}

fn main() -> ExitCode {
    mdle_host::run::<mdle_sim::Target, _>("Round", round::Round::new)
}
