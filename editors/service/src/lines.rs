//! Converts between byte offsets in a text and positions of the protocol, which are lines and UTF-16 columns from 0.

use std::ops::Range;

/// A position: a line and a UTF-16 column, both counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line number, counted from 0.
    pub line: u32,
    /// Column in UTF-16 code units, counted from 0.
    pub character: u32,
}

/// Byte offsets of the starts of the lines. A line ends with `\n`, `\r\n` or `\r`.
#[derive(Debug, Clone)]
pub struct LineStarts {
    starts: Vec<usize>,
}

impl LineStarts {
    /// Finds the lines of `text`.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate().filter(|(at, byte)| match byte {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        });
        Self { starts: std::iter::once(0).chain(ends.map(|(at, _)| at + 1)).collect() }
    }

    /// Returns the position of a byte offset in `text`. An offset inside a character has the position of the character;
    /// an offset after the end of the text has the position of the end.
    #[must_use]
    pub fn position(&self, text: &str, byte: usize) -> Position {
        let byte = text.floor_char_boundary(byte);
        let line = self.starts.partition_point(|start| *start <= byte).saturating_sub(1);
        let before = self.starts.get(line).and_then(|start| text.get(*start..byte)).unwrap_or("");
        let character = before.chars().map(char::len_utf16).sum();
        Position { line: small(line), character: small(character) }
    }

    /// Returns the byte offset of a position in `text`. A position inside a character is moved to the start of the
    /// character, after the end of a line to the end of the line, and after the last line to the end of the text.
    #[must_use]
    pub fn byte(&self, text: &str, position: Position) -> usize {
        let line = self.line(text, position.line);
        let mut left = position.character as usize;
        let mut byte = line.start;
        for letter in text.get(line).unwrap_or("").chars() {
            let units = letter.len_utf16();
            if left < units || matches!(letter, '\n' | '\r') {
                break;
            }
            left -= units;
            byte += letter.len_utf8();
        }
        byte
    }

    /// Returns the byte range of a line, including its line break. If there is no such line, returns an empty range at
    /// the end of the text.
    fn line(&self, text: &str, line: u32) -> Range<usize> {
        let start = |line: usize| self.starts.get(line).copied().unwrap_or(text.len());
        start(line as usize)..start((line as usize).saturating_add(1))
    }

    /// Returns the byte range between two positions, which may be in either order.
    #[must_use]
    pub fn range(&self, text: &str, from: Position, to: Position) -> Range<usize> {
        let (from, to) = (self.byte(text, from), self.byte(text, to));
        from.min(to)..from.max(to)
    }
}

fn small(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contains a character of two UTF-16 units and four bytes, a character of one unit and two bytes, and all line
    /// breaks.
    const TEXT: &str = "a𝒜b\r\nü∞\rx\n";

    fn byte(line: u32, character: u32) -> usize {
        LineStarts::of(TEXT).byte(TEXT, Position { line, character })
    }

    #[test]
    fn columns_count_units_of_utf_16() {
        assert_eq!((0..5).map(|column| byte(0, column)).collect::<Vec<_>>(), [0, 1, 1, 5, 6]);
        assert_eq!((0..3).map(|column| byte(1, column)).collect::<Vec<_>>(), [8, 10, 13]);
    }

    #[test]
    fn positions_past_an_end_are_at_the_end() {
        assert_eq!((byte(0, 9), byte(1, 9), byte(2, 9)), (6, 13, 15));
        assert_eq!((byte(3, 0), byte(3, 7), byte(4, 0), byte(u32::MAX, u32::MAX)), (16, 16, 16, 16));
    }

    #[test]
    fn a_byte_has_the_position_that_leads_to_it() {
        let lines = LineStarts::of(TEXT);
        for at in (0..=TEXT.len()).filter(|at| TEXT.is_char_boundary(*at)) {
            let position = lines.position(TEXT, at);
            // The line break `\r\n` is a unit: no position is between its characters.
            let expected = if TEXT.get(at - at.min(1)..=at) == Some("\r\n") { at - 1 } else { at };
            assert_eq!(lines.byte(TEXT, position), expected, "{at} {position:?}");
        }
        assert_eq!(lines.position(TEXT, 3), lines.position(TEXT, 1));
        assert_eq!(lines.position(TEXT, 99), Position { line: 3, character: 0 });
    }
}
