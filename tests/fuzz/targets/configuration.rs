//! A configuration is read or has an error, and is shown as it is.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::configuration(bytes));
