//! Uses the indentation of lines to determine the ends of braces that are never closed.

use std::collections::BTreeMap;

use super::source::FileText;
use super::token::{Tok, Token};

/// The braces that end before a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BraceEnd {
    /// All open braces end, because another plan begins at this indentation.
    OfPlan,
    /// The brace that opens at the token with this index ends, and so do all brackets inside it.
    OfBrace(usize),
}

/// An open brace.
struct OpenBrace {
    brace: usize,
    /// Indentation of the brace's line, in characters.
    indentation: usize,
    /// `true` if a line inside the brace is indented more than the brace's line.
    is_deeper: bool,
}

/// Returns the tokens before which a brace must be closed. Such a token begins a line that is not indented more than
/// the line of the brace, while a line between these two lines is indented more.
pub(super) fn ends(source: FileText<'_>, tokens: &[Token<'_>]) -> BTreeMap<usize, BraceEnd> {
    let mut ends = BTreeMap::new();
    let mut open: Vec<OpenBrace> = Vec::new();
    let mut indentation = 0;
    for (at, token) in tokens.iter().enumerate() {
        let first_of_line = indentation_of(source, token.place.start);
        if let Some(here) = first_of_line {
            indentation = here;
            let closes = token.kind == Tok::RBrace;
            while let Some(inner) = open.last_mut() {
                let is_behind = here < inner.indentation || here == inner.indentation && !closes;
                if !is_behind || !inner.is_deeper {
                    inner.is_deeper |= here > inner.indentation;
                    break;
                }
                // If several braces end here, the outermost is kept.
                ends.insert(at, BraceEnd::OfBrace(inner.brace));
                open.pop();
            }
        }
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no braces")]
        match token.kind {
            Tok::LBrace => open.push(OpenBrace { brace: at, indentation, is_deeper: false }),
            Tok::RBrace => drop(open.pop()),
            _ => {}
        }
    }
    ends
}

/// Returns the number of characters that precede a place in its line; `None` unless all of them are spaces or tabs.
fn indentation_of(source: FileText<'_>, start: usize) -> Option<usize> {
    let before = source.text.get(..start)?;
    let line = before.rsplit('\n').next().unwrap_or(before);
    line.chars().all(char::is_whitespace).then(|| line.chars().count())
}
