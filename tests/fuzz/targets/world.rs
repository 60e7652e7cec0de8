//! Fuzzes the parser of worlds: a world is read or has an error, and rays can be cast in it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::world(bytes));
