//! Fuzzes the reader of maps: a map is read as a world or has an error, and rays can be cast in the world.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::map(bytes));
