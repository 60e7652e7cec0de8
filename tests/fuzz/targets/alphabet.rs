//! An alphabet is read or has errors, and is bound as Rust.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::alphabet(bytes));
