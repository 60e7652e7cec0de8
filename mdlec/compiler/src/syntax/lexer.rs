//! Splits text into tokens (docs/src/reference/language.md, 2). Spaces, comments and typesetting are omitted. For each
//! parenthesis, records whether it touches a name.

use logos::{Lexer, Logos};
use mdle_runtime::SONARS;

use super::label::label_length;
use super::lexical;
use super::number::split;
use super::source::{FileText, TextRange};
use super::token::{Tok, Token};
use crate::diagnostic::Diagnostic;

/// Names of the ranges of all sonars.
const RANGES: [&str; SONARS] = [
    "r_0", "r_1", "r_2", "r_3", "r_4", "r_5", "r_6", "r_7", "r_8", "r_9", "r_10", "r_11", "r_12", "r_13", "r_14",
    "r_15",
];

/// Output of the lexer.
#[derive(Debug, Default)]
pub(super) struct Lexed<'s> {
    /// Tokens in the order of the text.
    pub(super) tokens: Vec<Token<'s>>,
    /// Doc comments, each with the number of tokens before it.
    pub(super) docs: Vec<(usize, &'s str)>,
    /// Lexical errors in the order of the text, each with the number of tokens before it.
    pub(super) errors: Vec<(usize, Diagnostic)>,
}

/// Returns the tokens of a text, its doc comments and its lexical errors.
pub(super) fn lex(source: FileText<'_>) -> Lexed<'_> {
    let mut reader = Reader {
        source,
        lexed: Lexed::default(),
        text_ends: usize::MAX,
        touches: 0,
        run: None,
        skipped: 0,
        dots: None,
    };
    let mut lexer = Tok::lexer(source.text);
    while let Some(token) = lexer.next() {
        let token = token.map(|kind| word_or_label(kind, &mut lexer));
        let place = TextRange::new(lexer.span().start, lexer.span().end);
        if place.start < reader.skipped || reader.file(token.as_ref().ok(), place) {
            continue;
        }
        match token {
            Ok(Tok::Dot) => reader.dot(place),
            Ok(kind) => reader.token(Token { kind, place }),
            Err(()) => match split(source.slice(place)) {
                ("", _) => reader.character(place),
                (number, tail) => reader.number(number, tail, place),
            },
        }
    }
    reader.end_run();
    reader.lexed
}

/// Returns the label that begins with the token `kind`, after consuming the rest of the label. If no label begins
/// there, returns the token, which is a keyword if its text is one.
fn word_or_label<'s>(kind: Tok<'s>, lexer: &mut Lexer<'s, Tok<'s>>) -> Tok<'s> {
    let kind = if let Tok::Name(word) = kind { Tok::of_word(word) } else { kind };
    let begins = matches!(kind, Tok::Name(name) if name.starts_with("Γ_") || name.starts_with("Gamma_"))
        || (kind == Tok::Command && lexer.slice() == r"\Gamma");
    let text = lexer.source().get(lexer.span().start..).filter(|_| begins);
    let Some(length) = text.and_then(label_length) else { return kind };
    lexer.bump(length.saturating_sub(lexer.slice().len()));
    Tok::Label(lexer.slice())
}

/// Collector of the tokens of a text.
struct Reader<'s> {
    source: FileText<'s>,
    lexed: Lexed<'s>,
    /// Byte offset of the brace that closes the current `\text{…}`.
    text_ends: usize,
    /// End of the last token, including the typesetting that touches it.
    touches: usize,
    /// Place of unexpected characters that have just been read and have not been reported yet.
    run: Option<TextRange>,
    /// End of a file name that was read as a string although it is not in double quotes.
    skipped: usize,
    /// State for joining the tokens of `robot1.x` into one name. Only plans of groups contain such names: `None` until
    /// `{ Group [` has been read.
    dots: Option<Dots>,
}

/// State for processing the dots in `robot1.x`.
#[derive(Default)]
struct Dots {
    /// Number of open parentheses. Outside of parentheses, a dot cannot belong to a signal, because signals occur only
    /// in conditions.
    depth: usize,
    /// The dot after the last token, if words touch both sides of the dot.
    last: Option<TextRange>,
}

impl<'s> Reader<'s> {
    /// Reports a file name without double quotes, such as `'home.csv'` or `C:\home.csv`, and reads it as a string.
    /// Returns `false` if no such name begins with this token.
    fn file(&mut self, token: Option<&Tok<'s>>, place: TextRange) -> bool {
        let (start, name, end) = match token {
            None => match quoted(self.source.text, place) {
                Some((name, end)) => (place.start, name, end),
                None => return false,
            },
            Some(Tok::Command) => match drive(self.source.text, place) {
                Some((start, name)) => (start, name, start + name.len()),
                None => return false,
            },
            Some(_) => return false,
        };
        self.end_run();
        let whole = TextRange::new(start, end);
        self.lexed.tokens.retain(|token| token.place.start < start);
        self.report(lexical::file(self.source, whole, name));
        self.push(Tok::Str(name), whole);
        self.skipped = end;
        true
    }

    fn token(&mut self, token: Token<'s>) {
        self.end_run();
        let TextRange { start, end } = token.place;
        if let Some(dot) = self.dots.as_mut().and_then(|dots| dots.last.take()) {
            if matches!(token.kind, Tok::Name(_)) {
                return self.join(end);
            }
            self.report(lexical::characters(self.source, dot));
        }
        self.count(token.kind);
        #[allow(clippy::wildcard_enum_match_arm, reason = "only what the parser must not see is named")]
        match token.kind {
            Tok::RBrace if start == self.text_ends => self.typesetting(token.place),
            Tok::Text => self.text(token.place),
            Tok::Doc(text) => self.lexed.docs.push((self.lexed.tokens.len(), text)),
            Tok::Command => self.report(lexical::command(self.source, token.place)),
            Tok::TypesetRange => self.range(token.place),
            Tok::Comment => self.report(lexical::comment(self.source, token.place)),
            Tok::LBracket if self.begins_group() => {
                self.dots = Some(Dots::default());
                self.push(token.kind, token.place);
            }
            Tok::Name("here") if self.after_frame() => self.push(Tok::Here, token.place),
            Tok::LParen if start == self.touches && self.after_name() && !self.after_law_of_formation() => {
                self.push(Tok::TouchParen, token.place)
            }
            Tok::Str(text) => {
                if end - start != text.len() + 2 {
                    self.report(lexical::string(self.source, token.place));
                }
                self.push(token.kind, token.place);
            }
            kind => self.push(kind, token.place),
        }
    }

    /// Counts the open parentheses in plans that follow the head of a group.
    fn count(&mut self, kind: Tok<'s>) {
        let Some(dots) = &mut self.dots else { return };
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no parentheses")]
        match kind {
            Tok::LParen => dots.depth += 1,
            Tok::RParen => dots.depth = dots.depth.saturating_sub(1),
            Tok::LBrace | Tok::RBrace => dots.depth = 0,
            _ => {}
        }
    }

    /// Processes a dot. In a file with a group, it may be between a robot and its signal.
    fn dot(&mut self, place: TextRange) {
        let is_name = self.touches == place.start && self.after_name();
        let rest = self.source.text.get(place.end..).unwrap_or("");
        let behind = rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
        let is_signal = behind.len() < rest.len() && !behind.trim_start().starts_with(':');
        match self.dots.as_mut().filter(|dots| is_name && is_signal && dots.depth > 0) {
            Some(dots) => dots.last = Some(place),
            None => self.character(place),
        }
    }

    /// Joins the name that ends at `end` and the name before the dot.
    fn join(&mut self, end: usize) {
        let Some(token) = self.lexed.tokens.last_mut() else { return };
        token.place.end = end;
        token.kind = Tok::Name(self.source.slice(token.place));
        self.touches = end;
    }

    /// Returns `true`, and marks `Group` as a keyword, if the last tokens are `{ Group`.
    fn begins_group(&mut self) -> bool {
        let [.., Token { kind: Tok::LBrace, .. }, word @ Token { kind: Tok::Name("Group"), .. }] =
            self.lexed.tokens.as_mut_slice()
        else {
            return false;
        };
        word.kind = Tok::Group;
        true
    }

    fn push(&mut self, kind: Tok<'s>, place: TextRange) {
        self.touches = place.end;
        self.lexed.tokens.push(Token { kind, place });
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.lexed.errors.push((self.lexed.tokens.len(), diagnostic));
    }

    fn after_name(&self) -> bool {
        matches!(self.lexed.tokens.last(), Some(Token { kind: Tok::Name(_), .. }))
    }

    /// Returns `true` if the last token is the law of a formation, as in `formation line 1m goAvoid`. The law and its
    /// arguments are then arguments of the formation.
    fn after_law_of_formation(&self) -> bool {
        let is_word = |token: &&Token<'_>| !matches!(token.kind, Tok::LParen | Tok::TouchParen | Tok::Comma);
        let mut words = self.lexed.tokens.iter().rev().filter(is_word).map(|token| token.kind);
        self.dots.is_some()
            && matches!(words.next(), Some(Tok::Name(_)))
            && matches!((words.next(), words.next()), (Some(Tok::Number(_)), Some(Tok::Name(_))))
            && words.next() == Some(Tok::Name("formation"))
    }

    fn after_frame(&self) -> bool {
        matches!(self.lexed.tokens.last(), Some(Token { kind: Tok::Frame, .. }))
    }

    /// Reports and removes text that touches a number and is not a unit. Text that does not touch the number is a name.
    fn number(&mut self, number: &'s str, tail: &'s str, place: TextRange) {
        self.end_run();
        let unit = tail.trim_start();
        if unit.len() < tail.len() {
            // Like a unit without `/`, the unit becomes a name, so that the error message about the quark can show its
            // arguments.
            let (end, start) = (place.start + number.len(), place.end - unit.len());
            self.push(Tok::Number(number), TextRange::new(place.start, end));
            self.push(Tok::Name(unit), TextRange::new(start, place.end));
            return;
        }
        self.report(lexical::number(self.source, number, tail, place));
        self.push(Tok::Number(number), place);
    }

    /// Reports a range with its number in braces, as in `r_{7}`, and reads it as `r_7`.
    fn range(&mut self, place: TextRange) {
        let digits = self.source.slice(place).trim_matches(|c: char| !c.is_ascii_digit());
        let name = RANGES.into_iter().find(|range| range.strip_prefix("r_") == Some(digits)).unwrap_or("r");
        self.report(lexical::range(self.source, place, digits));
        self.push(Tok::Name(name), place);
    }

    /// Removes the braces of `\text{…}`, which do not separate a name from its parenthesis.
    fn text(&mut self, place: TextRange) {
        match text_end(self.source.text, place.end) {
            Some(end) => self.text_ends = end,
            None => self.report(lexical::text(self.source, place)),
        }
        self.typesetting(place);
    }

    fn typesetting(&mut self, place: TextRange) {
        if place.start == self.touches {
            self.touches = place.end;
        }
    }

    /// Extends a series of neighbouring unexpected characters, which are reported together.
    fn character(&mut self, place: TextRange) {
        match &mut self.run {
            Some(run) if run.end == place.start => run.end = place.end,
            Some(_) | None => {
                self.end_run();
                self.run = Some(place);
            }
        }
    }

    fn end_run(&mut self) {
        if let Some(run) = self.run.take() {
            self.report(lexical::characters(self.source, run));
        }
    }
}

/// Returns the text in quotes other than double quotes, and the offset of its end.
fn quoted(text: &str, opener: TextRange) -> Option<(&str, usize)> {
    let closers: &[char] = match text.get(opener.start..opener.end)? {
        "'" | "‘" | "`" => &['\'', '’', '`', '‘'],
        "“" | "”" | "„" => &['“', '”'],
        _ => return None,
    };
    let line = text.get(opener.end..)?.lines().next()?;
    let length = line.find(closers)?;
    let (name, closer) = (line.get(..length)?, line.get(length..)?.chars().next()?);
    let is_name = !name.is_empty() && !name.contains(['"', '(', ')', '{', '}']);
    is_name.then_some((name, opener.end + length + closer.len_utf8()))
}

/// Returns the start and the text of the Windows path whose first backslash is at `backslash`.
fn drive(text: &str, backslash: TextRange) -> Option<(usize, &str)> {
    let start = backslash.start.checked_sub(2)?;
    let is_drive = text.get(start..backslash.start)?.starts_with(|c: char| c.is_ascii_alphabetic());
    let is_word = text.get(..start)?.ends_with([' ', '(', '\t']);
    let rest = text.get(start..)?;
    let path = rest.split(|c: char| c.is_whitespace() || "(){}\"".contains(c)).next()?;
    (is_drive && is_word && path.get(1..2) == Some(":")).then_some((start, path))
}

/// Returns the byte offset of the brace that closes the `\text{` that ends at `from`; `None` if there is no such brace,
/// or if another brace opens before it.
fn text_end(text: &str, from: usize) -> Option<usize> {
    let mut bytes = text.bytes().enumerate().skip(from);
    while let Some((at, byte)) = bytes.next() {
        match byte {
            b'\\' => drop(bytes.next()),
            b'}' => return Some(at),
            b'{' => return None,
            _ => {}
        }
    }
    None
}
