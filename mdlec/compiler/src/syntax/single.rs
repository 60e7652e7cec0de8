//! Recognizes a text that is a single law or condition. Files in other formats contain such texts.

use super::tree::{Condition, ConditionNode, Element, Primary};
use super::{Arena, arena_for, parse};
use crate::diagnostic::SourceId;

/// Returns `true` if a text is exactly one law with its arguments, and can therefore be inserted into an atom.
#[must_use]
pub fn is_law(text: &str) -> bool {
    is_alone(text, "{ P (Atom (null) ", ") }", |element| match element {
        Element { primary: Primary::Atom(atom), marks: None, .. } => atom.condition.node == ConditionNode::Null,
        _ => false,
    })
}

/// Returns the operands of the outermost OR of a condition, as written; `None` if the text is not exactly one
/// condition.
#[must_use]
pub fn operands(text: &str) -> Option<Vec<&str>> {
    const BEFORE: &str = "{ P (Atom (";
    let mut ranges = Vec::new();
    let is_condition = is_alone(text, BEFORE, ") stop) }", |element| {
        let Element { primary: Primary::Atom(atom), marks: None, .. } = element else { return false };
        let operands: &[Condition<'_>] = if let ConditionNode::Or(operands) = atom.condition.node {
            operands
        } else {
            std::slice::from_ref(&atom.condition)
        };
        ranges = operands.iter().map(|operand| operand.span.within(SourceId(0))).collect();
        atom.control.name == "stop" && atom.control.args.is_empty()
    });
    let alone = ranges.len() == 1;
    let operand = |range: &std::ops::Range<usize>| {
        // The range of a single operand may include the parentheses of the template, so the whole text is returned.
        if alone {
            Some(text.trim())
        } else {
            text.get(range.start.checked_sub(BEFORE.len())?..range.end - BEFORE.len())
        }
    };
    if is_condition { ranges.iter().map(operand).collect() } else { None }
}

/// Inserts a text between `before` and `behind`. Returns `true` if the result is a plan with one element that `is_good`
/// accepts, both on one line and with a line break after the text. In this case, no comment or bracket in the text
/// extends beyond the end of the text.
fn is_alone(text: &str, before: &str, behind: &str, mut is_good: impl FnMut(&Element<'_>) -> bool) -> bool {
    text.chars().all(mdle_runtime::is_printable)
        && ["", "\n"].iter().all(|end| {
            let whole = [before, text, end, behind].concat();
            let arena: Arena = arena_for(&whole);
            let (file, found) = parse(SourceId(0), &whole, &arena);
            match (file.plans.as_slice(), found.as_slice()) {
                ([plan], []) if file.uses.is_empty() => {
                    plan.label.is_none() && matches!(plan.elements, [only] if is_good(only))
                }
                _ => false,
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_a_name_with_arguments_and_nothing_else() {
        for good in
            ["stop", " go 20 0 ", "go(20cm/s, 0)", "path \"a) b // c\"", "goAvoid(heading module)", "go /* 20 */ 1 0"]
        {
            assert!(is_law(good), "{good}");
        }
        for bad in [
            "",
            "stop) (Atom (null) stop",
            "stop)^3 (",
            "stop) } //",
            "stop) } { Q (Atom (null) stop",
            "stop) use \"x\" (Atom (null) stop",
            "stop // x",
            "stop /* x",
            "stop stop) (",
            "path \"a",
            "go\n20 0",
            "path \"\u{202e}\"",
            "stop\u{7}",
            "Atom (null) stop",
            "20",
        ] {
            assert!(!is_law(bad), "{bad}");
        }
    }

    #[test]
    fn a_condition_is_split_at_its_outermost_or() {
        let good = [
            ("bumper", &["bumper"][..]),
            ("null", &["null"]),
            ("(bumper)", &["(bumper)"]),
            (" a OR (b or c) OR d AND e ", &["a", "(b or c)", "d AND e"]),
            ("a OR(b)", &["a", "(b)"]),
            ("NOT (a OR b)", &["NOT (a OR b)"]),
            ("((a OR b))", &["a", "b"]),
            ("at \"x OR y\" OR r3 < 1", &["at \"x OR y\"", "r3 < 1"]),
            ("after s1 (a OR b) OR RISING c", &["after s1 (a OR b)", "RISING c"]),
        ];
        for (text, expected) in good {
            assert_eq!(operands(text).as_deref(), Some(expected), "{text}");
        }
        for bad in [
            "",
            "a) stop) (Atom (b",
            "a) OR (b",
            "a OR",
            "a //",
            "a) stop) } //",
            "a /*",
            "a, 5",
            "\n a",
            "a) b) (Atom (c",
        ] {
            assert_eq!(operands(bad), None, "{bad}");
        }
    }
}
