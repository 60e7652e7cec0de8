//! Tests that the comparison is fair: both parsers read the same language.

use mdlec::diagnostic::SourceId;
use mdlec::syntax::{Arena, parse};

use crate::bare;
use crate::front_end::{one_megabyte, plans};

#[test]
fn both_parsers_accept_what_is_measured() {
    for (name, texts) in [plans(), one_megabyte()] {
        assert!(!texts.is_empty(), "{name}");
        for text in texts {
            assert_eq!(parse(SourceId(0), &text, &Arena::new()).1, []);
            assert!(bare::accepts(&text), "{text}");
        }
    }
}

#[test]
fn both_parsers_tell_headers_from_elements() {
    for text in [
        "{ A (bumper) B }",
        "{ A(bumper) B(5) }",
        "{ A (v: speed, m: bits[4]) (wait 5 OR (wait 6)) B }",
        "{ A (v: speed) B }",
        "{ A (B, bumper) }",
        "{ A ((Atom (b) stop) B)^2 }",
        "{ A ExecPlan 3 { B (bumper) } }",
        "{ A ExecPlan n { B (C, wait 5) } }",
        "{ A }",
        "{ A ExecPlan 3 { B (wait 5) C }",
        "{ (bumper) A }",
        "{ A (B }",
    ] {
        let good = parse(SourceId(0), text, &Arena::new()).1.is_empty();
        // What is empty has a meaning for the grammar, and is refused behind it.
        assert!(good == bare::accepts(text) || text == "{ A }", "{text}");
    }
}
