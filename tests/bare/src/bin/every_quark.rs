//! Runs the plan `EveryQuark`.
#![no_std]
#![no_main]

use core::ffi::c_int;

/// The emitted plan, which `tests/compiled/bare.rs` writes to the folder `PLANS`.
mod plan {
    include!(concat!(env!("PLANS"), "/every_quark.rs"));
}

/// Entry point, called by the C library.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "no other function has this name")]
extern "C" fn main() -> c_int {
    mdle_bare::run(plan::EveryQuark::new())
}
