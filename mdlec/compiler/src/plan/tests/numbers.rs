//! Tests that numbers in arguments are compared as written.

use crate::compile;
use crate::diagnostic::SourceId;
use crate::samples::alphabet;

#[test]
fn counts_are_compared_exactly() {
    let found = |count: &str| {
        let text = format!("{{ Main Leg({count}) }}\n{{ Leg (n: count) (Atom (wait 1) stop) }}");
        let (_, found) = compile(SourceId(0), &text, &alphabet(None), None);
        found.into_iter().map(|found| format!("{}: {}", found.code, found.message)).collect::<Vec<_>>()
    };
    assert_eq!(found("9007199254740992"), [""; 0]);
    assert_eq!(found("9007199254740993"), ["E0304: expected a count, found `9007199254740993`"]);
    assert_eq!(found("1e16"), ["E0304: expected a count, found `1e16`"]);
}
