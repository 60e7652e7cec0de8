//! Text in which nothing is wrong, to its tree: one token after the other, and nothing kept that only a message would need.
//!
//! Most texts are like that, so this decides how fast the compiler reads. It gives up at the first defect; what is to be said
//! about that, and what is left of the tree, is not its business.

use bumpalo::Bump;
use logos::{Lexer, Logos};

use super::brackets::MAX_DEPTH;
use super::foreign;
use super::header::{Begins, begins, is_element};
use super::nodes::{Docs, Nodes};
use super::source::{Location, Source};
use super::token::Tok;
use super::tree::File;
use super::without_recovery;

/// The tree of a text, if nothing is wrong with that.
pub(super) fn read<'s>(source: Source<'s>, arena: &'s Bump) -> Option<File<'s>> {
    // Then every number of bytes or tokens in it is one of 32 bits.
    u32::try_from(source.text.len()).ok()?;
    let docs = Docs::default();
    let mut tokens = Tokens::new(source.text, &docs);
    let mut nodes = Nodes::new(source, arena, &[], &docs);
    without_recovery::FileParser::new().parse(&mut nodes, &mut tokens).ok()?;
    let is_flawless = !tokens.is_defective && nodes.empty.is_empty() && !nodes.file.plans.is_empty();
    is_flawless.then_some(nodes.file)
}

/// The tokens of a text as the grammar takes them, read when it asks for them; they end at the first defect.
struct Tokens<'t, 's> {
    lexer: Lexer<'s, Tok<'s>>,
    docs: &'t Docs<'s>,
    /// How many tokens there have been.
    read: u32,
    /// How many brackets are open.
    depth: usize,
    header: Header,
    /// The end of the last token, if that is a name.
    name_ends: usize,
    /// `true` if the last token is a parenthesis.
    is_after_paren: bool,
    /// `true` if files are used, whose plans may have any name.
    uses: bool,
    /// `true` if the last token is `FRAME`.
    is_frame: bool,
    is_defective: bool,
}

/// How far the header of a plan has been read.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Header {
    /// No header.
    Outside,
    /// Behind `ExecPlan`: neither a brace here nor one behind the count begins a plan.
    Count,
    /// Behind an `ExecPlan` and its count.
    Loop,
    /// Behind the brace of a plan.
    Brace,
    /// Behind its name.
    Name,
    /// In its parameters.
    Params,
    /// Behind its parameters.
    Condition,
}

impl<'t, 's> Tokens<'t, 's> {
    fn new(text: &'s str, docs: &'t Docs<'s>) -> Self {
        Self {
            lexer: Tok::lexer(text),
            docs,
            read: 0,
            depth: 0,
            header: Header::Outside,
            name_ends: usize::MAX,
            is_after_paren: false,
            uses: false,
            is_frame: false,
            is_defective: false,
        }
    }

    /// Whether the token that has just been read is sound; a parenthesis is made what it is.
    fn is_sound(&mut self, token: &mut Tok<'s>) -> bool {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are sound by themselves")]
        match token {
            Tok::Str(text) => self.lexer.slice().len() == text.len() + 2,
            Tok::Name("here") if self.is_frame => {
                *token = Tok::Here;
                true
            }
            // Typesetting that goes together with a brace is rare, and not worth the trouble.
            Tok::Text | Tok::Command | Tok::Comment => false,
            Tok::LParen => match self.parenthesis() {
                Some(parenthesis) => {
                    *token = parenthesis;
                    self.open()
                }
                None => false,
            },
            Tok::LBrace => self.open(),
            Tok::RParen | Tok::RBrace => {
                self.depth = self.depth.saturating_sub(1);
                true
            }
            _ => true,
        }
    }

    /// Returns `true` if a name is probably a word of another language, or a misspelled keyword.
    fn is_foreign(&self, name: &str) -> bool {
        foreign::is_word(name) || self.is_after_paren && foreign::is_like_atom(name)
    }

    /// The end of the tokens at a defect.
    fn defect<T>(&mut self) -> Option<T> {
        self.is_defective = true;
        None
    }

    /// Takes in an opening bracket; false if brackets nest too deep.
    fn open(&mut self) -> bool {
        self.depth += 1;
        self.depth <= MAX_DEPTH
    }

    /// What the parenthesis is that has just been read: in a header a copy of the lexer runs ahead to see. `None` where that
    /// depends on the names of all plans.
    fn parenthesis(&mut self) -> Option<Tok<'s>> {
        let ahead = || self.lexer.clone().map_while(Result::ok).filter(|token| !matches!(token, Tok::Doc(_)));
        let begins = if self.header == Header::Name { begins(ahead()) } else { Begins::Others };
        Some(match self.header {
            Header::Name if begins == Begins::Parameters => Tok::ParamParen,
            Header::Name if begins != Begins::Others => return None,
            Header::Name | Header::Condition if is_element(ahead()) => Tok::LParen,
            Header::Name | Header::Condition => Tok::ConditionParen,
            Header::Outside | Header::Count | Header::Loop | Header::Brace | Header::Params => {
                if self.lexer.span().start == self.name_ends { Tok::TouchParen } else { Tok::LParen }
            }
        })
    }

    /// How far the header has been read after this token.
    fn header_behind(&self, token: Tok<'s>) -> Header {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens end a header, if there is one")]
        match (token, self.header) {
            (Tok::ParamParen, _) => Header::Params,
            (Tok::RParen, Header::Params) => Header::Condition,
            (_, Header::Params) => Header::Params,
            (Tok::LBrace, Header::Count | Header::Loop) => Header::Outside,
            (Tok::LBrace, _) => Header::Brace,
            (Tok::ExecPlan, _) => Header::Count,
            (Tok::Name(_), Header::Brace) => Header::Name,
            (Tok::Name(_) | Tok::Number(_) | Tok::Infinity, Header::Count) => Header::Loop,
            _ => Header::Outside,
        }
    }
}

impl<'s> Iterator for Tokens<'_, 's> {
    type Item = (Location, Tok<'s>, Location);

    fn next(&mut self) -> Option<Self::Item> {
        let mut token = loop {
            match self.lexer.next()? {
                Ok(Tok::Doc(text)) => self.docs.borrow_mut().push((self.read as usize, text)),
                Ok(token) => break token,
                Err(()) => return self.defect(),
            }
        };
        if !self.is_sound(&mut token) {
            return self.defect();
        }
        self.uses |= token == Tok::Use;
        if let Tok::Name(name) = token
            && !self.uses
            && self.is_foreign(name)
        {
            return self.defect();
        }
        self.is_after_paren = matches!(token, Tok::LParen | Tok::TouchParen);
        // Most tokens are in no header, and begin none.
        if self.header != Header::Outside || matches!(token, Tok::LBrace | Tok::ExecPlan) {
            self.header = self.header_behind(token);
        }
        let place = self.lexer.span();
        self.name_ends = if matches!(token, Tok::Name(_)) { place.end } else { usize::MAX };
        self.is_frame = token == Tok::Frame;
        let start = Location { token: self.read, byte: place.start as u32 };
        self.read += 1;
        Some((start, token, Location { token: self.read, byte: place.end as u32 }))
    }
}
