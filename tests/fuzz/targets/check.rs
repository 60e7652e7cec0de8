//! Fuzzes the compiler: for every robot, a text has plans or errors.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::check(&any_text::text(bytes)));
