//! Fuzzes code generation: the code that is emitted for a plan is valid Rust syntax.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::emit(&any_text::text(bytes)));
