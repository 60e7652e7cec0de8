//! Parses strings as printed in the paper (docs/src/reference/language.md, 3.2). There, commas separate elements, and
//! plans before `σ_null` have no braces.

use std::borrow::Cow;

use super::header::{self, Begins};
use super::lexer::{Lexed, lex};
use super::source::{FileText, TextRange};
use super::token::{Tok, Token};

/// Name that is given to a plan that is printed without a name.
const NAME: &str = "Plan";

/// Removes commas between elements, and inserts the braces of a plan around a string that precedes `σ_null`.
pub(super) fn read(lexed: &mut Lexed<'_>) {
    let is_printed = |token: &Token<'_>| matches!(token.kind, Tok::Comma | Tok::SigmaNull);
    if !lexed.tokens.iter().any(is_printed) {
        return;
    }
    let (commas, plans) = found(&lexed.tokens);
    if commas.is_empty() && plans.is_empty() {
        return;
    }
    let (mut commas, mut plans) = (commas.into_iter().peekable(), plans.into_iter().peekable());
    let old = std::mem::take(&mut lexed.tokens);
    let mut moved = Vec::with_capacity(old.len());
    for (at, token) in old.iter().enumerate() {
        moved.push(lexed.tokens.len());
        if plans.peek().is_some_and(|plan| plan.0 == at) {
            head(&old, at, &mut lexed.tokens);
        }
        if commas.next_if_eq(&at).is_none() {
            lexed.tokens.push(*token);
        }
        if plans.next_if(|plan| plan.1 == at).is_some() {
            let end = token.place.end;
            lexed.tokens.push(Token { kind: Tok::RBrace, place: TextRange::new(end, end) });
        }
    }
    let end = lexed.tokens.len();
    let at = |before: usize| moved.get(before).copied().unwrap_or(end);
    lexed.docs.iter_mut().for_each(|(before, _)| *before = at(*before));
    lexed.errors.iter_mut().for_each(|(before, _)| *before = at(*before));
}

/// Returns the text with braces and a name for each plan that has no braces.
pub(super) fn with_braces(source: FileText<'_>) -> Cow<'_, str> {
    let tokens = lex(source).tokens;
    let (_, plans) = found(&tokens);
    if plans.is_empty() {
        return Cow::Borrowed(source.text);
    }
    let (mut text, mut copied) = (String::new(), 0);
    for (first, last) in plans {
        let mut new = Vec::new();
        head(&tokens, first, &mut new);
        let (Some(start), Some(end)) = (tokens.get(first), tokens.get(last)) else { continue };
        let opening = if new.len() > 2 { format!("{{ {NAME} (null) ") } else { format!("{{ {NAME} ") };
        text += source.slice(TextRange::new(copied, start.place.start));
        text += &opening;
        text += source.slice(TextRange::new(start.place.start, end.place.end));
        text += " }";
        copied = end.place.end;
    }
    text += source.slice(TextRange::new(copied, source.text.len()));
    Cow::Owned(text)
}

/// Appends the brace and the name that a plan without braces lacks. If the next group looks like a condition, also
/// appends the null interrupt.
fn head<'s>(tokens: &[Token<'s>], at: usize, new: &mut Vec<Token<'s>>) {
    let start = tokens.get(at).map_or(0, |token| token.place.start);
    let mut push = |kind| new.push(Token { kind, place: TextRange::new(start, start) });
    [Tok::LBrace, Tok::Name(NAME)].into_iter().for_each(&mut push);
    if !header::is_element(behind(tokens, at)) {
        [Tok::LParen, Tok::Null, Tok::RParen].into_iter().for_each(push);
    }
}

/// Content of an open bracket.
#[derive(Clone, Copy, PartialEq)]
enum Inside {
    /// The braces of a plan or a loop; they contain elements.
    Braces,
    /// Parentheses that contain elements or formal notation.
    Parentheses,
    /// Parentheses that contain arguments or parameters.
    Others,
}

/// Returns the commas between elements, and the plans without braces, each given by the indices of its first token and
/// its `σ_null`.
fn found(tokens: &[Token<'_>]) -> (Vec<usize>, Vec<(usize, usize)>) {
    let (mut commas, mut plans, mut open) = (Vec::new(), Vec::new(), Vec::new());
    // Index at which the text outside of all plans begins.
    let mut first = 0;
    // Index of the last token in the header of the plan that has begun last.
    let (mut header, mut names) = (None, None);
    let before = |at: usize, back: usize| at.checked_sub(back).and_then(|at| tokens.get(at)).map(|token| token.kind);
    for (at, token) in tokens.iter().enumerate() {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens say nothing")]
        match token.kind {
            Tok::LBrace => {
                open.push(Inside::Braces);
                header = header::end(tokens, at, &mut names).or(header);
            }
            Tok::LParen | Tok::TouchParen => {
                let is_head = before(at, 2) == Some(Tok::LBrace) && matches!(before(at, 1), Some(Tok::Name(_)));
                let is_list = is_head && header::begins(behind(tokens, at)) != Begins::Others;
                let touches = token.kind == Tok::TouchParen && !is_head;
                open.push(if is_list || touches { Inside::Others } else { Inside::Parentheses });
            }
            Tok::RParen | Tok::RBrace => {
                open.pop();
                if open.is_empty() && token.kind == Tok::RBrace {
                    first = at + 1;
                }
            }
            Tok::Str(_) if open.is_empty() && before(at, 1) == Some(Tok::Use) => first = at + 1,
            Tok::Assign if open.is_empty() && matches!(before(at, 1), Some(Tok::Label(_))) => first = at + 1,
            Tok::SigmaNull if open.is_empty() => {
                if tokens.get(first).is_some_and(|token| token.kind == Tok::LParen) && is_string(tokens, first, at) {
                    plans.push((first, at));
                }
                first = at + 1;
            }
            Tok::Comma
                if header.is_none_or(|last| at != last + 1)
                    && ends_element([before(at, 2), before(at, 1)], open.is_empty())
                    && begins_element(tokens, at, open.last().copied()) =>
            {
                commas.push(at);
            }
            _ => {}
        }
    }
    (commas, plans)
}

/// Returns `true` if there are only groups in parentheses, with or without powers, between two tokens.
fn is_string(tokens: &[Token<'_>], first: usize, end: usize) -> bool {
    let mut depth = 0_usize;
    tokens.get(first..end).unwrap_or(&[]).iter().all(|token| {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no brackets")]
        match token.kind {
            Tok::LParen | Tok::TouchParen => depth += 1,
            Tok::RParen => depth = depth.saturating_sub(1),
            _ => {}
        }
        let is_power = matches!(token.kind, Tok::Caret | Tok::Number(_) | Tok::Infinity | Tok::Comma);
        depth > 0 || token.kind == Tok::RParen || is_power
    })
}

/// Returns `true` if the second of two tokens ends an element. The angle of `FRAME`, the count of `ExecPlan`, and the
/// brace of a plan outside all plans do not end an element.
fn ends_element([before, last]: [Option<Tok<'_>>; 2], is_outside: bool) -> bool {
    let is_word = matches!(before, Some(Tok::Frame | Tok::ExecPlan));
    match last {
        Some(Tok::RBrace) => !is_outside,
        Some(Tok::RParen) => true,
        Some(Tok::Name(_) | Tok::Number(_) | Tok::Infinity) => !is_word,
        _ => false,
    }
}

/// Returns `true` if an element follows a comma. In parentheses, a condition may follow the comma. Therefore, a name or
/// a group that may be a condition is not treated as an element.
fn begins_element(tokens: &[Token<'_>], comma: usize, inside: Option<Inside>) -> bool {
    let kind = |ahead: usize| tokens.get(comma + ahead).map(|token| token.kind);
    let Some(next) = kind(1).filter(|_| inside != Some(Inside::Others)) else { return false };
    #[allow(clippy::wildcard_enum_match_arm, reason = "no element begins with any other token")]
    match next {
        Tok::LBrace | Tok::ExecPlan | Tok::Frame | Tok::Label(_) => true,
        Tok::Name(_) => inside == Some(Inside::Braces) || kind(2) == Some(Tok::Colon),
        Tok::LParen => inside == Some(Inside::Braces) || header::is_element(behind(tokens, comma + 1)),
        _ => false,
    }
}

/// Returns the kinds of the tokens after the token at `at`.
fn behind<'s>(tokens: &[Token<'s>], at: usize) -> impl Iterator<Item = Tok<'s>> {
    tokens.get(at + 1..).unwrap_or(&[]).iter().map(|token| token.kind)
}
