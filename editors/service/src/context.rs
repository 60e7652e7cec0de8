//! Determines the context of the cursor in an unfinished text, and thus the words that may follow.

use std::ops::Range;

pub use crate::brackets::OpenCall;
use crate::brackets::{Bracket, OpenBracketWords, read};
use crate::words::{Word, WordKind, words};

/// Kind of word that may follow at the cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// A plan or `use`, outside any bracket.
    Plan,
    /// An element of a plan.
    Element,
    /// An operand of a condition.
    Operand,
    /// A law of an atom.
    Law,
    /// A label, the operand of `after`.
    Label,
    /// The type of a parameter.
    Type,
    /// The unit of the number that the cursor touches.
    Unit,
    /// An argument, or a word that follows the call.
    Argument,
    /// No word: the cursor is in a comment or a text, or where the user chooses a name.
    Nothing,
}

/// The context of the cursor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Context<'t> {
    /// Kind of word that may follow.
    pub expected: Expected,
    /// Byte range of the word that ends at the cursor; completion replaces it.
    pub typed: Range<usize>,
    /// Innermost call that encloses the cursor.
    pub call: Option<OpenCall<'t>>,
    /// Labels of the plan that contains the cursor.
    pub labels: Vec<&'t str>,
}

/// Returns the context of the cursor at `byte`, determined by the text before it; the labels in the result are those of
/// the whole plan.
#[must_use]
pub fn context(text: &str, byte: usize) -> Context<'_> {
    let mut stack: Vec<OpenBracketWords<'_>> = Vec::new();
    let mut found: Option<Context<'_>> = None;
    let mut labels = Vec::new();
    let mut before: Option<Word<'_>> = None;
    for word in words(text) {
        // A bracket that ends at the cursor is complete; a name is still being typed.
        let is_at_cursor = word.range.start >= byte || (word.range.end >= byte && word.kind != WordKind::Sign);
        if found.is_none() && is_at_cursor {
            found = Some(at_cursor(&stack, &word, byte));
            if stack.is_empty() {
                break;
            }
        }
        if stack.is_empty() {
            if found.is_some() {
                break;
            }
            labels.clear();
        }
        if word.kind == WordKind::Opaque {
            continue;
        }
        if let (":", Some(name)) = (word.text, before.as_ref().filter(|name| name.kind == WordKind::Name))
            && stack.last().is_some_and(|open| open.bracket != Bracket::Parameters)
        {
            labels.push(name.text);
        }
        let touches =
            before.as_ref().is_some_and(|before| before.kind == WordKind::Name && before.range.end == word.range.start);
        read(&mut stack, &word, touches);
        before = Some(word);
    }
    let mut found = found.unwrap_or_else(|| {
        let end = Word { kind: WordKind::Sign, text: "", range: byte..byte };
        at_cursor(&stack, &end, byte)
    });
    found.labels = labels;
    found
}

/// Returns the context of the cursor if the cursor is before, in, or at the end of `word`.
fn at_cursor<'t>(stack: &[OpenBracketWords<'t>], word: &Word<'t>, byte: usize) -> Context<'t> {
    let is_in = word.range.start < byte;
    let typed = if is_in && word.kind == WordKind::Name { word.range.start..byte } else { byte..byte };
    let call = call(stack);
    let expected = match word.kind {
        WordKind::Opaque if is_in && (word.range.end > byte || word.text.starts_with("//")) => Expected::Nothing,
        WordKind::Number if is_in => Expected::Unit,
        WordKind::Name | WordKind::Number | WordKind::Opaque | WordKind::Sign => expected(stack),
    };
    let typed = if expected == Expected::Unit { unit_at(word, byte) } else { typed };
    Context { expected, typed, call, labels: Vec::new() }
}

/// Returns the byte range of a number's unit, up to the cursor.
fn unit_at(number: &Word<'_>, byte: usize) -> Range<usize> {
    let digits = number.text.find(|letter: char| letter.is_alphabetic()).unwrap_or(number.text.len());
    (number.range.start + digits).min(byte)..byte
}

/// Returns the innermost call that encloses the cursor. If the innermost bracket contains arguments, the call is in the
/// enclosing bracket.
fn call<'t>(stack: &[OpenBracketWords<'t>]) -> Option<OpenCall<'t>> {
    let open = stack.last()?;
    match (open.bracket, stack.len().checked_sub(2).and_then(|outer| stack.get(outer))) {
        (Bracket::Arguments, Some(outer)) => match &outer.call {
            // All words in the parentheses are arguments, including the first.
            Some(call) => Some(OpenCall { args: call.args + open.items, ..call.clone() }),
            None => open.call.clone(),
        },
        _ => open.call.clone(),
    }
}

fn expected(stack: &[OpenBracketWords<'_>]) -> Expected {
    let Some(open) = stack.last() else { return Expected::Plan };
    let outer = stack.len().checked_sub(2).and_then(|outer| stack.get(outer));
    match open.bracket {
        _ if open.last == "after" => Expected::Label,
        Bracket::Plan if open.items == 0 => Expected::Nothing,
        Bracket::Plan | Bracket::Body => Expected::Element,
        Bracket::Parameters if open.last == ":" => Expected::Type,
        Bracket::Parameters => Expected::Nothing,
        Bracket::Atom if open.call.is_none() && open.items >= 2 => Expected::Law,
        Bracket::Atom if open.items < 2 => Expected::Nothing,
        Bracket::Condition if open.call.is_none() => Expected::Operand,
        Bracket::Arguments
            if open.items == 0 && outer.is_some_and(|outer| outer.bracket == Bracket::Atom && outer.call.is_none()) =>
        {
            Expected::Law
        }
        Bracket::Atom | Bracket::Condition | Bracket::Arguments => Expected::Argument,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the kind of word that may follow at the cursor, which a `|` marks in the text.
    fn at(text: &str) -> Expected {
        let byte = text.find('|').unwrap_or(text.len());
        context(&text.replace('|', ""), byte).expected
    }

    fn call_at(text: &str) -> String {
        let byte = text.find('|').unwrap_or(text.len());
        let text = text.replace('|', "");
        context(&text, byte).call.map(|call| format!("{} {}", call.name, call.args)).unwrap_or_default()
    }

    #[test]
    fn the_brackets_decide_which_words_may_follow() {
        for (text, expected) in [
            ("|", Expected::Plan),
            ("{ P | }", Expected::Element),
            ("{ | }", Expected::Nothing),
            ("{ P (|", Expected::Operand),
            ("{ P (bum|per) }", Expected::Operand),
            ("{ P (bumper OR |", Expected::Operand),
            ("{ P (NOT (| ", Expected::Operand),
            ("{ P (bumper) Le|", Expected::Element),
            ("{ P (Atom (|", Expected::Operand),
            ("{ P (Atom (bumper) |", Expected::Law),
            ("{ P (Atom (bumper) (|", Expected::Law),
            ("{ P (Atom (bumper) (go |", Expected::Argument),
            ("{ P (Atom (bumper) (go 20|", Expected::Unit),
            ("{ P (Atom (wait 2m|", Expected::Unit),
            ("{ P a: (Atom (bumper) stop) (Atom (after |", Expected::Label),
            ("{ P(x: |", Expected::Type),
            ("{ P // |\n }", Expected::Nothing),
            ("{ P // c\n | }", Expected::Element),
            ("{ P ExecPlan 3 { |", Expected::Element),
        ] {
            assert_eq!(at(text), expected, "{text}");
        }
    }

    #[test]
    fn a_call_counts_the_arguments_before_the_cursor() {
        for (text, call) in [
            ("{ P (Atom (bumper) (go |", "go 0"),
            ("{ P (Atom (bumper) (go 20 |", "go 1"),
            ("{ P (Atom (bumper) go(20, |", "go 1"),
            ("{ P (Atom (bumper) go (20 |", "go 1"),
            ("{ P (Atom (wait |", "wait 0"),
            ("{ P (Atom (bumper OR atIsection |", "atIsection 0"),
            ("{ P Leg(0deg, |", "Leg 1"),
            ("{ P |", ""),
        ] {
            assert_eq!(call_at(text), call, "{text}");
        }
    }

    #[test]
    fn labels_are_those_of_the_plan_around_the_cursor() {
        let text = "{ A x: Leg } { B(p: speed) y: Leg (Atom (after ) stop) z: Leg } { C w: Leg }";
        assert_eq!(context(text, text.find("after ").unwrap_or(0) + 6).labels, ["y", "z"]);
    }
}
