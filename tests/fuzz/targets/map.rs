//! A map is read or has an error, and can be looked at.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::map(bytes));
