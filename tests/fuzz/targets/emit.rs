//! The Rust of a plan is Rust.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::emit(&any_text::text(bytes)));
