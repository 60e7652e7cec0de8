//! The plan `Round` as rows.
#![no_std]
#![no_main]

use core::ffi::c_int;

/// The emitted plan, which `tests/compiled/bare.rs` writes to the folder `PLANS`.
mod plan {
    include!(concat!(env!("PLANS"), "/round_as_rows.rs"));
}

/// Entry point, which the C library calls.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "no other function has this name")]
extern "C" fn main() -> c_int {
    mdle_bare::run(plan::Round::new())
}
