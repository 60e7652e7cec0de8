//! Finds the open brackets of an unfinished text, and the words that follow in each bracket.

use crate::words::{Word, WordKind};

/// Kind of an open bracket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bracket {
    Plan,
    Parameters,
    Body,
    Atom,
    Condition,
    /// Arguments of the call in the enclosing bracket.
    Arguments,
}

/// A call that the user is typing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenCall<'t> {
    /// Name of the called quark or plan.
    pub name: &'t str,
    /// Number of arguments before the cursor.
    pub args: usize,
    /// `true` if the call is in a condition; `false` for a law or a plan.
    pub is_condition: bool,
}

/// An open bracket, and the data of the words that were read in it so far.
#[derive(Debug, Clone)]
pub(crate) struct OpenBracketWords<'t> {
    pub(crate) bracket: Bracket,
    /// Number of words and nested brackets read directly in the bracket.
    pub(crate) items: usize,
    pub(crate) last: &'t str,
    pub(crate) call: Option<OpenCall<'t>>,
}

impl OpenBracketWords<'_> {
    pub(crate) fn new(bracket: Bracket) -> Self {
        Self { bracket, items: 0, last: "", call: None }
    }
}

/// Updates the stack of open brackets with the next word of the text. A bracket opens or closes; any other word belongs
/// to the innermost open bracket. `touches` is `true` if the word directly follows a name.
pub(crate) fn read<'t>(stack: &mut Vec<OpenBracketWords<'t>>, word: &Word<'t>, touches: bool) {
    match word.text {
        "{" | "(" => {
            let bracket = opened(stack.last(), word.text, touches);
            if let Some(outer) = stack.last_mut() {
                outer.items += 1;
            }
            stack.push(OpenBracketWords::new(bracket));
        }
        "}" | ")" => {
            stack.pop();
            if let Some(outer) = stack.last_mut() {
                outer.last = ")";
            }
        }
        text => {
            let Some(open) = stack.last_mut() else { return };
            if text == "Atom" && open.items == 0 {
                open.bracket = Bracket::Atom;
            }
            read_in(open, word);
            open.items += usize::from(text != ",");
            open.last = text;
        }
    }
}

/// Returns the kind of the bracket that `sign` opens inside the bracket `outer`. `touches` is `true` if the bracket
/// directly follows a name.
fn opened(outer: Option<&OpenBracketWords<'_>>, sign: &str, touches: bool) -> Bracket {
    let Some(outer) = outer else { return if sign == "{" { Bracket::Plan } else { Bracket::Body } };
    match (sign, outer.bracket) {
        ("{", _) if outer.last.starts_with(|letter: char| letter.is_ascii_digit()) || outer.last == "inf" => {
            Bracket::Body
        }
        ("{", _) => Bracket::Plan,
        (_, Bracket::Plan) if outer.items == 1 && touches => Bracket::Parameters,
        (_, Bracket::Plan) if outer.items == 1 || (outer.items == 2 && outer.last == ")") => Bracket::Condition,
        (_, Bracket::Atom) if outer.items == 1 => Bracket::Condition,
        (_, _) if touches && !is_keyword(outer.last) => Bracket::Arguments,
        (_, Bracket::Condition) if outer.call.is_none() => Bracket::Condition,
        (_, Bracket::Condition | Bracket::Arguments) => Bracket::Arguments,
        (_, Bracket::Plan | Bracket::Body | Bracket::Parameters) => Bracket::Body,
        // A law in its own parentheses.
        (_, Bracket::Atom) => Bracket::Arguments,
    }
}

fn is_keyword(word: &str) -> bool {
    ["OR", "AND", "NOT", "RISING", "or", "and", "not", "rising", "after", "Atom", "ExecPlan"].contains(&word)
}

/// Updates the call that the user is typing in the bracket `open`.
fn read_in<'t>(open: &mut OpenBracketWords<'t>, word: &Word<'t>) {
    let is_condition = open.bracket == Bracket::Condition;
    let begins = |name| Some(OpenCall { name, args: 0, is_condition });
    match (word.kind, &mut open.call) {
        (WordKind::Sign, _) if matches!(word.text, "<" | ">" | "=" | ",") => open.call = None,
        (WordKind::Name, _) if is_keyword(word.text) => open.call = None,
        (WordKind::Name, _) if open.last == "after" => open.call = None,
        (WordKind::Name, None) if open.bracket != Bracket::Plan || open.items > 0 => open.call = begins(word.text),
        (WordKind::Name | WordKind::Number, Some(call))
            if open.bracket != Bracket::Plan && open.bracket != Bracket::Body =>
        {
            call.args += 1;
        }
        (WordKind::Name, Some(_)) => open.call = begins(word.text),
        (WordKind::Name | WordKind::Number | WordKind::Opaque | WordKind::Sign, _) => {}
    }
}
