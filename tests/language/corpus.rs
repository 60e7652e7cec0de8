//! Tests that every text of the fuzzing corpus, and every plan of this repository, has the properties that any text
//! must have.
//!
//! libFuzzer runs the same functions (`tests/fuzz`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_benchmarks::front_end::{one_megabyte, plans};
use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::{Arena, parse};
use mdle_tests::repository::root;
use mdle_tests::{any_bytes, any_file, any_text, texts};

/// Asserts that every text of the corpus has this property.
fn assert_holds(property: fn(&str)) {
    let texts = texts::kept();
    assert!(texts.len() > 200, "{} texts", texts.len());
    for (from, text) in texts {
        let holds = std::panic::catch_unwind(|| property(&text));
        assert!(holds.is_ok(), "{from}\n{text}");
    }
}

#[test]
fn they_have_trees_or_errors() {
    assert_holds(any_text::parse);
}

#[test]
fn they_keep_their_trees_when_they_are_laid_out() {
    assert_holds(any_text::layout);
}

#[test]
fn they_have_plans_or_errors() {
    assert_holds(any_text::check);
}

#[test]
fn their_rust_is_rust() {
    assert_holds(any_text::emit);
}

#[test]
fn all_machines_do_the_same() {
    assert_holds(any_text::run);
}

#[test]
fn texts_of_the_benchmarks_have_no_errors() {
    for (name, texts) in [plans(), one_megabyte()] {
        assert!(!texts.is_empty(), "{name}");
        for text in texts {
            assert_eq!(parse(SourceId(0), &text, &Arena::new()).1, []);
        }
    }
}

/// Returns the inputs of robots' lines from the fuzzing corpus, and long inputs that could make a reader keep more
/// bytes than it needs.
fn lines() -> Vec<Vec<u8>> {
    let kept = fs::read_dir(root().join("tests/fuzz/lines")).unwrap();
    let kept = kept.map(|entry| fs::read(entry.unwrap().path()).unwrap());
    let mut endless = vec![vec![0x10; 5000], vec![0x1B; 5000], [0x1B, 0x01].repeat(2500)];
    endless.extend(endless.clone().into_iter().map(|bytes| [&[9, 0x1B, 0x02][..], &bytes].concat()));
    kept.chain(endless).collect()
}

#[test]
fn both_ends_of_a_line_read_on() {
    let lines = lines();
    assert!(lines.len() > 30, "{} lines", lines.len());
    for line in lines {
        let holds = std::panic::catch_unwind(|| {
            any_bytes::scout(&line);
            any_bytes::atrv(&line);
        });
        assert!(holds.is_ok(), "{line:02X?}");
    }
}

/// A function that panics if the bytes of a file do not have a property.
type Property = fn(&[u8]);

#[test]
fn files_that_are_no_plans_are_read_or_refused() {
    let properties: [(&str, Property); 8] = [
        ("alphabet", any_file::alphabet),
        ("machine", any_file::machine),
        ("script", any_file::script),
        ("world", any_file::world),
        ("map", any_file::map),
        ("path", any_file::path),
        ("configuration", any_file::configuration),
        ("record", any_file::record),
    ];
    for (folder, property) in properties {
        let kept = fs::read_dir(root().join("tests/fuzz/files").join(folder)).unwrap();
        let kept: Vec<_> = kept.map(|entry| entry.unwrap().path()).collect();
        assert!(kept.len() > 1, "{folder}");
        for path in kept {
            let bytes = fs::read(&path).unwrap();
            assert!(std::panic::catch_unwind(|| property(&bytes)).is_ok(), "{}", path.display());
        }
    }
}
