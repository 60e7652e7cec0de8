//! Places in the text that is being parsed.

use crate::diagnostic::{SourceId, Span};

/// The text of a file, with the file's identifier.
#[derive(Debug, Clone, Copy)]
pub(super) struct FileText<'s> {
    /// Identifier of the file.
    pub(super) id: SourceId,
    /// Text of the file.
    pub(super) text: &'s str,
}

/// A range of the text, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TextRange {
    /// Offset of the first byte.
    pub(super) start: usize,
    /// Offset of the first byte after the range.
    pub(super) end: usize,
}

/// A boundary between tokens, given by the number of tokens and of bytes before it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Location {
    /// Number of tokens before the boundary.
    pub(super) token: u32,
    /// Number of bytes before the boundary.
    pub(super) byte: u32,
}

impl Location {
    /// Creates the location before the token with the index `token`, which begins at `byte`, or after the previous
    /// token, which ends at `byte`.
    pub(super) fn new(token: usize, byte: usize) -> Self {
        Self { token: offset(token), byte: offset(byte) }
    }
}

/// Converts an offset to 32 bits, the size in spans and locations.
fn offset(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

impl TextRange {
    /// Creates the place between two byte offsets.
    pub(super) fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// Returns `true` if the place contains no text.
    pub(super) fn is_empty(self) -> bool {
        self.start == self.end
    }
}

impl<'s> FileText<'s> {
    /// Creates the text of a file with this identifier. Because spans have 32 bits, messages about a text that ends
    /// beyond 4 GiB point to the first file.
    pub(super) fn new(id: SourceId, text: &'s str) -> Self {
        let fits = u32::try_from(text.len()).is_ok_and(|length| id.0.checked_add(length).is_some());
        Self { id: if fits { id } else { SourceId(0) }, text }
    }

    /// Converts a place to a span for trees and diagnostics.
    pub(super) fn span(self, place: TextRange) -> Span {
        Span::new(self.id, place.start, place.end)
    }

    /// Returns the span between two locations.
    pub(super) fn between(self, start: Location, end: Location) -> Span {
        let first = self.id.0;
        Span { start: first + start.byte, end: first + end.byte.max(start.byte) }
    }

    /// Returns the text at a place.
    pub(super) fn slice(self, place: TextRange) -> &'s str {
        self.text.get(place.start..place.end).unwrap_or("")
    }

    /// Returns `true` if the place begins in the first column of its line.
    pub(super) fn is_column_one(self, place: TextRange) -> bool {
        self.text.get(..place.start).is_some_and(|before| before.is_empty() || before.ends_with('\n'))
    }
}
