//! Fuzzes the reader of records: a record is read or has an error, and keeps its turns when it is written again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_file;

fuzz_target!(|bytes: &[u8]| any_file::record(bytes));
