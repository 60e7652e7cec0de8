//! Tests that the codes of diagnostics are well-formed, and that a test causes each code.

use std::collections::BTreeSet;

use mdle_compiler::diagnostic::{Code, Severity};
use mdle_tests::repository::{TextFile, files};

/// Codes that no test can cause, each with the reason.
const UNTESTED: &[(Code, &str)] = &[];

#[test]
fn codes_are_a_letter_and_four_digits_with_a_title() {
    let mut names = BTreeSet::new();
    for code in Code::ALL {
        let name = code.name();
        let (letter, digits) = name.split_at(1);
        assert!(["E", "W"].contains(&letter), "{name}");
        assert!(digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit()), "{name}");
        assert_eq!(code.severity() == Severity::Warning, letter == "W", "{name}");
        assert!(!code.title().trim().is_empty() && !code.title().ends_with('.'), "{name}: {:?}", code.title());
        assert!(names.insert(name), "{name} is there twice");
    }
    assert!(!names.is_empty());
    assert!(Code::ALL.is_sorted_by_key(|code| code.name()), "in the order of their numbers");
}

#[test]
fn no_code_is_without_a_test() {
    let tests: Vec<_> = files(&[".snap", ".rs"]).iter().filter_map(what_is_tested).collect();
    for code in Code::ALL {
        let is_tested = tests.iter().any(|test| test.contains(code.name()));
        let reason = UNTESTED.iter().find(|(untested, _)| untested == code);
        assert!(is_tested || reason.is_some(), "no snapshot and no test holds {code}, {}", code.title());
        assert!(!is_tested || reason.is_none(), "{code} is tested: take it from the list of those that are not");
    }
}

/// Returns the tests in a file: the whole text of a snapshot or of a test file, or the part of any other file from its
/// tests on. Returns `None` if there are no tests.
fn what_is_tested(file: &TextFile) -> Option<String> {
    let is_test = file.path.starts_with("tests/")
        || file.path.contains("/tests/")
        || file.path.ends_with("/tests.rs")
        || file.path.ends_with(".snap");
    match is_test {
        true => Some(file.text.clone()),
        false => file.text.split_once("#[cfg(test)]").map(|(_, tests)| tests.to_owned()),
    }
}
