//! A comparison is fair if what is measured is read without an error.

use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::{Arena, parse};

use crate::front_end::{one_megabyte, plans};

#[test]
fn the_measured_texts_have_no_errors() {
    for (name, texts) in [plans(), one_megabyte()] {
        assert!(!texts.is_empty(), "{name}");
        for text in texts {
            assert_eq!(parse(SourceId(0), &text, &Arena::new()).1, []);
        }
    }
}
