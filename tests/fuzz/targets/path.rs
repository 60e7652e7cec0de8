//! Fuzzes the reader of paths: a path is read or has an error, and the times of its setpoints increase.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::path(bytes));
