//! On any bytes on the line of an ATRV, both ends read on.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_bytes;

fuzz_target!(|bytes: &[u8]| any_bytes::atrv(bytes));
