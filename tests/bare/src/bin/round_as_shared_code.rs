//! The plan `Round` as code that alike atoms share.
#![no_std]
#![no_main]

use core::ffi::c_int;

/// Rust that mdlec emits: `tests/bare.rs` writes it to the folder in `PLANS`.
mod plan {
    include!(concat!(env!("PLANS"), "/round_as_shared_code.rs"));
}

/// Entry point, which the C library calls.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "no other function has this name")]
extern "C" fn main() -> c_int {
    mdle_bare::run(plan::Round::new())
}
