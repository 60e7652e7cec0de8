//! Places in the text that is being parsed.

use crate::diagnostic::{SourceId, Span};

/// A text with the file that it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'s> {
    /// The file.
    pub(super) id: SourceId,
    /// Its text.
    pub(super) text: &'s str,
}

/// A stretch of the text, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    /// The first byte.
    pub(super) start: usize,
    /// The byte behind the last.
    pub(super) end: usize,
}

/// Where a token begins or the one before it ends: how many tokens and how many bytes are before that.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Location {
    /// The number of tokens.
    pub(super) token: u32,
    /// The number of bytes.
    pub(super) byte: u32,
}

impl Location {
    /// The location before this token, which begins at `byte`, or behind the token before it, which ends there.
    pub(super) fn new(token: usize, byte: usize) -> Self {
        Self { token: offset(token), byte: offset(byte) }
    }
}

/// As trees and diagnostics have it.
fn offset(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

impl Place {
    /// The stretch between these two bytes.
    pub(super) fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// Whether nothing is written there.
    pub(super) fn is_empty(self) -> bool {
        self.start == self.end
    }
}

impl<'s> Source<'s> {
    /// A text. One that ends behind 4 GB is the first of its files to messages, for places have no more bits.
    pub(super) fn new(id: SourceId, text: &'s str) -> Self {
        let fits = u32::try_from(text.len()).is_ok_and(|length| id.0.checked_add(length).is_some());
        Self { id: if fits { id } else { SourceId(0) }, text }
    }

    /// The place as trees and diagnostics have it.
    pub(super) fn span(self, place: Place) -> Span {
        Span::new(self.id, place.start, place.end)
    }

    /// The stretch between these two.
    pub(super) fn between(self, start: Location, end: Location) -> Span {
        let first = self.id.0;
        Span { start: first + start.byte, end: first + end.byte.max(start.byte) }
    }

    /// What is written there.
    pub(super) fn slice(self, place: Place) -> &'s str {
        self.text.get(place.start..place.end).unwrap_or("")
    }

    /// Whether it is the first thing of its line.
    pub(super) fn is_column_one(self, place: Place) -> bool {
        self.text.get(..place.start).is_some_and(|before| before.is_empty() || before.ends_with('\n'))
    }
}
