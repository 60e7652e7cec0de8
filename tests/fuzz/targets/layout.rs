//! The canonical layout of a text is the same text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::layout(&any_text::text(bytes)));
