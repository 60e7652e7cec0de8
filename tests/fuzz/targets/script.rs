//! Fuzzes the parser of scripts: a script is read or has an error, and a plan can be run on it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::script(bytes));
