//! Fuzzes the parser of a robot's configuration: a file is read or has an error, and a configuration that is shown can
//! be read back unchanged.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::configuration(bytes));
