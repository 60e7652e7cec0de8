//! Determines the meaning of a parenthesis after a plan's own name (docs/src/reference/language.md, 3.1). It can begin
//! the parameters, the condition, or the first element. The grammar could decide this only at the end of the
//! parenthesis.

use std::collections::BTreeSet;

use super::token::{Tok, Token};
use crate::alphabet::ParameterKind;

/// Meaning of the content that follows a parenthesis in a header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Begins<'s> {
    /// The parenthesis contains parameters.
    Parameters,
    /// The parenthesis does not contain parameters.
    Others,
    /// The content can be a parameter with an unknown type, as in `(v: spead)`; or, if a plan is called `spead`, a use
    /// of that plan with a label.
    Either(&'s str),
}

/// Sets the kinds of the parentheses in the headers of all plans. The brackets must be balanced.
pub(super) fn mark(tokens: &mut [Token<'_>]) {
    let mut plans = None;
    for brace in 0..tokens.len() {
        if let Some(name) = name_of(tokens, brace).filter(|_| is(tokens, brace, Tok::LBrace)) {
            mark_header(tokens, name + 1, &mut plans);
        }
    }
}

/// Sets the kind of the parenthesis at `at`; if this parenthesis contains parameters, also sets the kind of the next
/// one. `plans` caches the names of the file's plans.
fn mark_header<'s>(tokens: &mut [Token<'s>], at: usize, plans: &mut Option<BTreeSet<&'s str>>) {
    for (at, kind) in groups(tokens, at, plans).into_iter().flatten() {
        set(tokens, at, kind);
    }
}

/// Returns the index of the last token in the header of the plan whose opening brace is at `brace`; `None` for the
/// brace of a loop, or for a plan without a name.
pub(super) fn end<'s>(tokens: &[Token<'s>], brace: usize, plans: &mut Option<BTreeSet<&'s str>>) -> Option<usize> {
    let name = name_of(tokens, brace)?;
    let mut groups = groups(tokens, name + 1, plans).into_iter().flatten().filter(|(_, kind)| *kind != Tok::LParen);
    Some(groups.next_back().map_or(name, |(at, _)| end_of_group(tokens, at)))
}

/// Returns the index of the name of the plan whose opening brace is at `brace`. The name is the next token; in the plan
/// of a group, it is the token after the robots. Returns `None` for the brace of a loop, and for a plan without a name.
fn name_of(tokens: &[Token<'_>], brace: usize) -> Option<usize> {
    let mut name = brace + 1;
    if is(tokens, name, Tok::Group) {
        name += tokens.get(name..)?.iter().position(|token| token.kind == Tok::RBracket)? + 1;
    }
    (is_name(tokens, name) && !is_loop(tokens, brace)).then_some(name)
}

/// Returns the parentheses, at most two, that follow a plan's name at `at`. Each is returned with the kind of its
/// token.
fn groups<'s>(tokens: &[Token<'s>], at: usize, plans: &mut Option<BTreeSet<&'s str>>) -> [Option<(usize, Tok<'s>)>; 2] {
    if !is_parenthesis(tokens, at) {
        return [None; 2];
    }
    let mut condition = at;
    let has_parameters = match begins(behind(tokens, at)) {
        Begins::Parameters => true,
        Begins::Others => false,
        Begins::Either(name) => !plans.get_or_insert_with(|| names(tokens)).contains(name),
    };
    let parameters = has_parameters.then_some((at, Tok::ParamParen));
    if has_parameters {
        condition = end_of_group(tokens, at) + 1;
        if !is_parenthesis(tokens, condition) {
            return [parameters, None];
        }
    }
    let kind = if is_element(behind(tokens, condition)) { Tok::LParen } else { Tok::ConditionParen };
    [parameters, Some((condition, kind))]
}

/// Returns the names of all plans.
pub(super) fn names<'s>(tokens: &[Token<'s>]) -> BTreeSet<&'s str> {
    let named = tokens.windows(2).filter_map(|pair| match pair {
        [Token { kind: Tok::LBrace, .. }, Token { kind: Tok::Name(name), .. }] => Some(*name),
        [Token { kind: Tok::RBracket, .. }, Token { kind: Tok::Name(name), .. }] => Some(*name),
        _ => None,
    });
    named.collect()
}

/// Determines whether parameters begin after a parenthesis. Parameters begin with a name, a colon, and a type or a name
/// that must be a type. A string whose first element has a label begins in the same way.
pub(super) fn begins<'s>(mut behind: impl Iterator<Item = Tok<'s>>) -> Begins<'s> {
    match (behind.next(), behind.next()) {
        (Some(Tok::Name(_)), Some(Tok::Colon)) => {}
        // As in `(bumper, v: speed)`: a condition is before the parameters, or a parameter has no type.
        (Some(Tok::Name(_)), Some(Tok::Comma)) => {
            let next = [behind.next(), behind.next(), behind.next()];
            let is_typed =
                matches!(next, [Some(Tok::Name(_)), Some(Tok::Colon), Some(Tok::Name(kind))] if is_type(kind));
            return if is_typed { Begins::Parameters } else { Begins::Others };
        }
        _ => return Begins::Others,
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens cannot begin an element")]
    match behind.next() {
        Some(Tok::Name(name)) if is_type(name) => Begins::Parameters,
        Some(Tok::Name(name)) => match [behind.next(), behind.next(), behind.next()] {
            // A colon is missing between the second name and its type.
            [Some(Tok::Comma), Some(Tok::Name(_)), Some(Tok::Name(kind))] if is_type(kind) => Begins::Parameters,
            [Some(Tok::LBracket), ..] | [Some(Tok::Comma), Some(Tok::Name(_)), Some(Tok::Colon)] => Begins::Parameters,
            // A list of parameters cannot have a loop count.
            [Some(Tok::RParen), Some(Tok::Caret), ..] => Begins::Others,
            [Some(Tok::RParen), ..] => Begins::Either(name),
            _ => Begins::Others,
        },
        Some(Tok::LParen | Tok::LBrace | Tok::ExecPlan | Tok::Frame | Tok::Label(_)) => Begins::Others,
        _ => Begins::Parameters,
    }
}

/// Returns `true` if a name is the name of a parameter type.
fn is_type(name: &str) -> bool {
    name == "bits" || ParameterKind::NAMES.contains(&name)
}

/// Returns `true` if a group contains, at any depth, a token that cannot be part of a condition: an element, a colon,
/// or a comma that is not between arguments. `behind` contains the tokens after the group's opening parenthesis.
pub(super) fn is_element<'s>(behind: impl Iterator<Item = Tok<'s>>) -> bool {
    let mut depth = 1_usize;
    // Depth of the outermost parenthesis that contains arguments, and `true` if arguments may begin with the next
    // token.
    let (mut arguments, mut takes) = (None, false);
    for token in behind {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens say nothing")]
        match token {
            Tok::LParen | Tok::TouchParen => {
                depth += 1;
                if takes && arguments.is_none() {
                    arguments = Some(depth);
                }
            }
            Tok::RParen if depth == 1 => return false,
            Tok::RParen => {
                takes = arguments.is_some();
                arguments = arguments.filter(|outermost| *outermost < depth);
                depth -= 1;
                continue;
            }
            Tok::Comma if arguments.is_none() => return true,
            Tok::Colon | Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::RBrace | Tok::Caret | Tok::Frame => {
                return true;
            }
            _ => {}
        }
        takes = matches!(token, Tok::Name(_) | Tok::Number(_) | Tok::Infinity | Tok::Str(_));
    }
    false
}

/// Returns `true` if the brace belongs to an `ExecPlan`. The first name in such a brace is not the name of a plan.
fn is_loop(tokens: &[Token<'_>], brace: usize) -> bool {
    let before = |back: usize| brace.checked_sub(back).and_then(|at| tokens.get(at)).map(|token| token.kind);
    match (before(2), before(1)) {
        (_, Some(Tok::ExecPlan)) => true,
        (Some(Tok::ExecPlan), Some(Tok::Number(_) | Tok::Infinity | Tok::Name(_))) => true,
        (_, Some(_) | None) => false,
    }
}

/// Returns the index of the token that closes the group opened at `at`.
fn end_of_group(tokens: &[Token<'_>], at: usize) -> usize {
    let mut depth = 0_usize;
    for (offset, token) in tokens.get(at..).unwrap_or(&[]).iter().enumerate() {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens say nothing")]
        match token.kind {
            Tok::LParen | Tok::TouchParen | Tok::ParamParen => depth += 1,
            Tok::RParen if depth == 1 => return at + offset,
            Tok::RParen => depth -= 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Returns the kinds of the tokens after the token at `at`.
fn behind<'s>(tokens: &[Token<'s>], at: usize) -> impl Iterator<Item = Tok<'s>> {
    tokens.get(at + 1..).unwrap_or(&[]).iter().map(|token| token.kind)
}

fn is(tokens: &[Token<'_>], at: usize, kind: Tok<'_>) -> bool {
    tokens.get(at).is_some_and(|token| token.kind == kind)
}

fn is_name(tokens: &[Token<'_>], at: usize) -> bool {
    matches!(tokens.get(at), Some(Token { kind: Tok::Name(_), .. }))
}

fn is_parenthesis(tokens: &[Token<'_>], at: usize) -> bool {
    is(tokens, at, Tok::LParen) || is(tokens, at, Tok::TouchParen)
}

fn set<'s>(tokens: &mut [Token<'s>], at: usize, kind: Tok<'s>) {
    if let Some(token) = tokens.get_mut(at) {
        token.kind = kind;
    }
}
