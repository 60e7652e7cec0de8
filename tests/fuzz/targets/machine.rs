//! Fuzzes Theorem 1: every machine has an answer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::machine(bytes));
