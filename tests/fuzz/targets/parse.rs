//! Fuzzes the parser: a text has a tree or errors.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::parse(&any_text::text(bytes)));
