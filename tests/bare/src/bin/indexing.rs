//! Executable that must not link, because it contains an index that may be out of bounds.
#![no_std]
#![no_main]

use core::ffi::c_int;

/// Entry point, called by the C library.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "no other function has this name")]
#[allow(clippy::indexing_slicing, reason = "that this is noticed is what is tested")]
extern "C" fn main() -> c_int {
    let powers = [1, 10, 100];
    powers[usize::from(mdle_bare::byte().unwrap_or(0))]
}
