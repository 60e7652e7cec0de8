//! What must not link: an index that nobody has checked.
#![no_std]
#![no_main]

use core::ffi::c_int;

/// Where the C library begins.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "no other function has this name")]
#[allow(clippy::indexing_slicing, reason = "that this is noticed is what is tested")]
extern "C" fn main() -> c_int {
    let powers = [1, 10, 100];
    powers[usize::from(mdle_bare::byte().unwrap_or(0))]
}
