//! Parses an alphabet file (docs/src/reference/language.md, 6.1) by recursive descent. After an error, parsing
//! continues after the next `;`.

mod single;

use logos::Logos;

use super::checks;
use super::token::Token;
use super::{
    AlphabetFile, Capability, Decimal, Declaration, DeclarationKind, Origin, Param, ParameterKind, TargetHead, Unit,
};
use crate::diagnostic::{Code, Diagnostic, SourceId, Span, sort};

/// Parses an alphabet. Returns the alphabet, or `None` if it has no head, with all diagnostics.
#[must_use]
pub fn read(source: SourceId, text: &str) -> (Option<AlphabetFile>, Vec<Diagnostic>) {
    let mut reader = Reader { text, source, tokens: Vec::new(), at: 0, found: Vec::new() };
    reader.lex();
    let alphabet = reader.file();
    let mut found = reader.found;
    if let Some(alphabet) = &alphabet {
        found.extend(checks::check(alphabet));
    }
    sort(&mut found);
    (alphabet, found)
}

/// Marks an error that has already been reported; the declaration that contains it is dropped.
struct Defect;

type Read<T> = Result<T, Defect>;

struct Reader<'t> {
    text: &'t str,
    source: SourceId,
    tokens: Vec<(Token, Span)>,
    at: usize,
    found: Vec<Diagnostic>,
}

impl<'t> Reader<'t> {
    fn lex(&mut self) {
        for (token, range) in Token::lexer(self.text).spanned() {
            let span = Span::new(self.source, range.start, range.end);
            match token {
                Ok(token) => self.tokens.push((token, span)),
                Err(()) => {
                    let message = format!("no alphabet has the character `{}`", &self.text[range]);
                    self.found.push(Diagnostic::new(Code::E0101, message, span, "here"));
                }
            }
        }
    }

    fn file(&mut self) -> Option<AlphabetFile> {
        let (name, mut target) = self.head().ok()?;
        let mut uses = Vec::new();
        let mut declarations = Vec::new();
        while self.at < self.tokens.len() {
            let docs = self.docs();
            let origin = if target.is_some() { Origin::Target } else { Origin::Shared(name.clone()) };
            let read = match (self.peek_word(), &mut target) {
                (Some("capability"), Some(head)) => self.capabilities().map(|more| head.capabilities.extend(more)),
                (Some("engine"), Some(head)) => self.capabilities().map(|more| head.engine.extend(more)),
                (Some("use"), Some(_)) => self.used().map(|used| uses.push(used)),
                _ => self.declaration(docs, origin).map(|declaration| declarations.push(declaration)),
            };
            if read.and_then(|()| self.require(Token::Semicolon)).is_err() {
                self.skip();
            }
        }
        Some(AlphabetFile { name, target, uses, declarations })
    }

    /// Reads `"target" NAME ":" "crate" NAME { "," "period" TIME } ";"` or `"alphabet" NAME ";"`.
    fn head(&mut self) -> Read<(String, Option<TargetHead>)> {
        self.docs();
        let head = match self.peek_word() {
            Some("alphabet") => {
                self.at += 1;
                (self.name()?.0, None)
            }
            Some("target") => {
                self.at += 1;
                let name = self.name()?.0;
                self.require(Token::Colon)?;
                self.keyword("crate")?;
                let crate_name = self.crate_name()?;
                let mut period = None;
                while self.take(Token::Comma) {
                    self.keyword("period")?;
                    period = Some(self.period()?);
                }
                (name, Some(TargetHead { crate_name, period, capabilities: Vec::new(), engine: Vec::new() }))
            }
            _ => return self.unexpected("`target NAME : crate NAME;` or `alphabet NAME;`"),
        };
        self.require(Token::Semicolon)?;
        Ok(head)
    }

    fn period(&mut self) -> Read<u64> {
        let (digits, span) = self.number()?;
        let (word, unit_span) = self.word()?;
        let unit = Unit::from_name(&word).filter(|unit| unit.kind == ParameterKind::Time);
        let exact = unit.and_then(|unit| Some(Decimal::parse(&digits)?.scaled(unit.factor, unit.exponent)));
        match exact.and_then(|exact| exact.to_nanos()).filter(|nanos| *nanos > 0) {
            Some(nanos) => Ok(nanos),
            None => self.defect(span.to(unit_span), "a period is a time above zero", "write it as `100ms`"),
        }
    }

    /// Reads `( "capability" | "engine" ) CAP { "," CAP }`.
    fn capabilities(&mut self) -> Read<Vec<Capability>> {
        self.at += 1;
        self.capability_list()
    }

    fn capability_list(&mut self) -> Read<Vec<Capability>> {
        let mut list = vec![self.capability()?];
        while self.take(Token::Comma) {
            list.push(self.capability()?);
        }
        Ok(list)
    }

    /// Reads `NAME [ "[" INT "]" ]`.
    fn capability(&mut self) -> Read<Capability> {
        let name = self.name()?.0;
        Ok(Capability { name, size: self.size()? })
    }

    fn size(&mut self) -> Read<Option<u32>> {
        if !self.take(Token::OpenBracket) {
            return Ok(None);
        }
        let (digits, span) = self.number()?;
        let Ok(size) = digits.parse() else {
            return self.defect(span, "a size is a whole number", "as in `sonar[16]`");
        };
        self.require(Token::CloseBracket)?;
        Ok(Some(size))
    }

    fn used(&mut self) -> Read<(String, Span)> {
        self.at += 1;
        self.name()
    }

    /// Reads `( "control" | "interrupt" | "signal" ) NAME [ "(" … ")" ] …`.
    fn declaration(&mut self, docs: String, origin: Origin) -> Read<Declaration> {
        let kind = match self.peek_word() {
            Some("control") => DeclarationKind::Control,
            Some("interrupt") => DeclarationKind::Interrupt,
            Some("signal") => DeclarationKind::Signal,
            _ if origin == Origin::Target => {
                return self.unexpected("`capability`, `engine`, `use`, `control`, `interrupt` or `signal`");
            }
            _ => return self.unexpected("`control`, `interrupt` or `signal`"),
        };
        self.at += 1;
        let (name, span) = self.name()?;
        let params = self.params()?;
        let (unit, mut needs) = (self.unit_and_tolerance()?, Vec::new());
        let (mut completes, mut remembers, mut exclusive) = (false, false, false);
        loop {
            match self.peek_word() {
                Some("completes") => completes = true,
                Some("remembers") => remembers = true,
                Some("exclusive") => exclusive = true,
                Some("needs") => {
                    self.at += 1;
                    needs = self.capability_list()?;
                    break;
                }
                _ => break,
            }
            self.at += 1;
        }
        Ok(Declaration { docs, kind, name, params, unit, completes, remembers, exclusive, needs, origin, span })
    }

    fn params(&mut self) -> Read<Vec<Param>> {
        let mut params = Vec::new();
        if !self.take(Token::Open) || self.take(Token::Close) {
            return Ok(params);
        }
        params.push(self.param()?);
        while self.take(Token::Comma) {
            params.push(self.param()?);
        }
        self.require(Token::Close)?;
        Ok(params)
    }

    /// Reads `NAME ":" type [ UNIT ] [ "=" NUMBER ] [ "in" NUMBER ".." NUMBER ] [ "not" NUMBER ]
    /// [ "with" NAME { "," NAME } ]`. After a comma, a name without a type is another attribute.
    fn param(&mut self) -> Read<Param> {
        let name = self.name()?.0;
        self.require(Token::Colon)?;
        let (word, span) = self.name()?;
        let size = self.size()?;
        let kind = match (word.as_str(), size) {
            ("bits", Some(length)) => Some(ParameterKind::Bits(length)),
            (word, None) => ParameterKind::from_name(word),
            (_, Some(_)) => None,
        };
        let Some(kind) = kind else {
            return self.defect(
                span,
                "unknown type of argument",
                "the types are length, speed, angle, \
                angular_rate, time, voltage, number, integer, count, bits[N], sonar, robot, module and file",
            );
        };
        let unit = match self.peek_word() {
            Some(word) if !matches!(word, "in" | "not" | "with") => Some(self.unit(kind)?),
            Some(_) | None => kind.base_unit(),
        };
        let default = if self.take(Token::Equals) { Some(self.number()?.0) } else { None };
        let mut range = None;
        if self.peek_word() == Some("in") {
            self.at += 1;
            let least = self.value()?;
            self.require(Token::To)?;
            range = Some((least, self.value()?));
        }
        let mut except = None;
        if self.peek_word() == Some("not") {
            self.at += 1;
            except = Some(self.value()?);
        }
        let with = self.with(kind)?;
        Ok(Param { name, kind, unit, default, range, except, with })
    }

    /// Reads `[ "with" NAME { "," NAME } ]`, the attributes of a module.
    fn with(&mut self, kind: ParameterKind) -> Read<Vec<String>> {
        let mut with = Vec::new();
        if self.peek_word() != Some("with") {
            return Ok(with);
        }
        let (_, span) = self.word()?;
        if kind != ParameterKind::Module {
            return self.defect(span, "only a module has attributes", "`with` follows the type `module`");
        }
        with.push(self.name()?.0);
        while self.names_attribute() {
            self.at += 1;
            with.push(self.name()?.0);
        }
        Ok(with)
    }

    /// Returns `true` if a comma and another attribute follow. A name before a colon is not an attribute, but the next
    /// parameter.
    fn names_attribute(&self) -> bool {
        let token = |ahead: usize| self.tokens.get(self.at + ahead).map(|(token, _)| *token);
        token(0) == Some(Token::Comma) && token(1) == Some(Token::Word) && token(2) != Some(Token::Colon)
    }

    fn unit(&mut self, kind: ParameterKind) -> Read<Unit> {
        let (word, span) = self.word()?;
        match Unit::from_name(&word) {
            Some(unit) if unit.kind == kind => Ok(unit),
            Some(unit) => {
                let message = format!("expected a unit of {}, found one of {}", kind.words(), unit.kind.words());
                self.defect(span, &message, "")
            }
            None => self.defect(span, &format!("`{word}` is not a unit"), ""),
        }
    }

    /// Reads `"unit" UNIT "tolerance" NUMBER`.
    fn unit_and_tolerance(&mut self) -> Read<Option<(Unit, f64)>> {
        if self.peek_word() != Some("unit") {
            return Ok(None);
        }
        self.at += 1;
        let (word, span) = self.word()?;
        let Some(unit) = Unit::from_name(&word) else {
            return self.defect(span, &format!("`{word}` is not a unit"), "");
        };
        self.keyword("tolerance")?;
        Ok(Some((unit, self.value()?)))
    }

    fn docs(&mut self) -> String {
        let mut docs: Vec<&str> = Vec::new();
        while let Some((Token::Doc, span)) = self.tokens.get(self.at) {
            docs.push(self.slice(*span).trim_start_matches('/').trim());
            self.at += 1;
        }
        docs.join(" ")
    }
}
