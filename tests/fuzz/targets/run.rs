//! Fuzzes the interpreters: all machines of a plan print the same trace.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::run(&any_text::text(bytes)));
