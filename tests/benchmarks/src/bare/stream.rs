//! The tokens of a text as the grammar takes them, one after another, each parenthesis with its kind.

use logos::{Lexer, Logos};

use super::token::Tok;

/// Text that is no token.
#[derive(Debug)]
pub(crate) struct NoToken;

/// Reads tokens when it is asked for them.
pub(super) struct Stream<'s> {
    lexer: Lexer<'s, Tok<'s>>,
    header: Header,
    /// The end of the last token, if that is a name.
    name_ends: usize,
}

/// Position in the header of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Header {
    /// No header.
    Outside,
    /// After `ExecPlan`: no brace before the end of its count begins a header.
    Count,
    /// After an `ExecPlan` and its count.
    Loop,
    /// After the brace of a plan.
    Brace,
    /// After the name of a plan.
    Name,
    /// In the parameters of a plan.
    Params,
    /// After the parameters of a plan.
    Condition,
}

impl<'s> Stream<'s> {
    /// The tokens of this text.
    pub(super) fn new(text: &'s str) -> Self {
        Self { lexer: Tok::lexer(text), header: Header::Outside, name_ends: usize::MAX }
    }

    /// Returns the kind of the parenthesis that has just been read.
    fn parenthesis(&mut self, start: usize) -> Tok<'s> {
        let kind = match self.header {
            Header::Name if is_params(self.lexer.clone()) => Tok::ParamParen,
            Header::Name | Header::Condition if is_element(self.lexer.clone()) => Tok::LParen,
            Header::Name | Header::Condition => Tok::ConditionParen,
            Header::Params => Tok::LParen,
            Header::Outside | Header::Count | Header::Loop | Header::Brace => {
                if start == self.name_ends {
                    Tok::TouchParen
                } else {
                    Tok::LParen
                }
            }
        };
        self.header = if kind == Tok::ParamParen { Header::Params } else { Header::Outside };
        kind
    }
}

impl<'s> Iterator for Stream<'s> {
    type Item = Result<(usize, Tok<'s>, usize), NoToken>;

    fn next(&mut self) -> Option<Self::Item> {
        let Ok(token) = self.lexer.next()? else { return Some(Err(NoToken)) };
        let place = self.lexer.span();
        let kind = if token == Tok::LParen { self.parenthesis(place.start) } else { token };
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are treated alike")]
        match (kind, self.header) {
            (Tok::Name(_), Header::Brace) => self.header = Header::Name,
            (Tok::Name(_) | Tok::Number(_) | Tok::Infinity, Header::Count) => self.header = Header::Loop,
            (Tok::RParen, Header::Params) => self.header = Header::Condition,
            (Tok::LBrace, Header::Count | Header::Loop) => self.header = Header::Outside,
            (Tok::LBrace, _) => self.header = Header::Brace,
            (Tok::ExecPlan, _) => self.header = Header::Count,
            (_, Header::Outside | Header::Params) => {}
            _ => self.header = Header::Outside,
        }
        self.name_ends = if matches!(kind, Tok::Name(_)) { place.end } else { usize::MAX };
        Some(Ok((place.start, kind, place.end)))
    }
}

/// Returns `true` if parameters follow: a name and a colon.
fn is_params<'s>(mut ahead: Lexer<'s, Tok<'s>>) -> bool {
    matches!((ahead.next(), ahead.next()), (Some(Ok(Tok::Name(_))), Some(Ok(Tok::Colon))))
}

/// Returns `true` if the group that has just been opened contains a token that no condition contains.
fn is_element<'s>(ahead: Lexer<'s, Tok<'s>>) -> bool {
    let mut depth = 1_usize;
    for token in ahead {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens say nothing")]
        match token {
            Ok(Tok::LParen) => depth += 1,
            Ok(Tok::RParen) if depth == 1 => return false,
            Ok(Tok::RParen) => depth -= 1,
            Ok(Tok::Comma) if depth == 1 => return true,
            Ok(Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::RBrace | Tok::Caret | Tok::Frame) => return true,
            _ => {}
        }
    }
    false
}
