//! A checked document in the form that the features use, with text, syntax tree and alphabet.

use std::ops::Range;

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::diagnostic::{SourceId, Sources, Span};
use mdle_compiler::syntax::tree::{File, Plan};
use mdle_compiler::syntax::{Files, Loader, arena_for, parse, parse_with};

/// A document with its syntax tree, and the syntax trees of the files that it uses.
#[derive(Debug)]
pub struct View<'v> {
    /// Identifier of the document among `sources`.
    pub source: SourceId,
    /// Text of the document.
    pub text: &'v str,
    /// Syntax tree of the document itself.
    pub file: &'v File<'v>,
    /// Plans of the document, and of the files that it uses.
    pub files: &'v Files<'v>,
    /// Alphabet of the robot.
    pub alphabet: &'v Alphabet,
    /// Texts of the document and of the files that it uses.
    pub sources: &'v Sources,
}

impl View<'_> {
    /// Returns the plans of the document itself.
    #[must_use]
    pub fn own(&self) -> &[Plan<'_>] {
        self.files.plans.get(..self.files.own).unwrap_or(&[])
    }

    /// Returns the byte range of a span in the document itself; `None` for a span in another file.
    #[must_use]
    pub fn range(&self, span: Span) -> Option<Range<usize>> {
        let (source, range) = self.sources.range(span);
        (source == self.source).then_some(range)
    }

    /// Returns `true` if the span is in the document, and contains the byte offset or ends there.
    #[must_use]
    pub fn contains(&self, span: Span, byte: usize) -> bool {
        self.range(span).is_some_and(|range| range.start <= byte && byte <= range.end)
    }

    /// Returns the text of a span; spaces and line breaks become single spaces.
    #[must_use]
    pub fn words(&self, span: Span) -> String {
        self.sources.slice(span).split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Parses the document `source`, and calls `feature` with it. `loader` reads the files that the document uses;
/// `sources` returns their texts.
pub fn view<L: Loader, T>(
    source: SourceId,
    loader: &mut L,
    sources: fn(&L) -> &Sources,
    alphabet: &Alphabet,
    feature: impl FnOnce(&View<'_>) -> T,
) -> T {
    let text = sources(loader).text(source).to_owned();
    let arena = arena_for(&text);
    let (file, _) = parse(source, &text, &arena);
    let (files, _) = parse_with(source, &text, &arena, loader);
    let sources = sources(loader);
    feature(&View { source, text: &text, file: &file, files: &files, alphabet, sources })
}
