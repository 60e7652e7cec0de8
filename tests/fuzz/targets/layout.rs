//! Fuzzes the formatter: the canonical layout of a text has the same tree and comments.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mdle_tests::any_text;

fuzz_target!(|bytes: &[u8]| any_text::layout(&any_text::text(bytes)));
