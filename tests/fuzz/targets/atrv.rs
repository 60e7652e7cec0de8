//! Fuzzes the serial protocol of an ATRV: after any bytes, the driver and the emulator still read messages.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_bytes;

fuzz_target!(|bytes: &[u8]| any_bytes::atrv(bytes));
