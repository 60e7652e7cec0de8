//! Fuzzes the reader of alphabets: an alphabet has errors, or bindings in Rust can be generated for it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::alphabet(bytes));
