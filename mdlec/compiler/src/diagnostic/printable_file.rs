//! Replaces characters of a file that are not printable by their code points, and converts offsets between the original
//! text and the printable text.

use codespan_reporting::files::SimpleFile;
use mdle_runtime::{Printable, is_printable};

/// Printable form of a file whose text contains characters that are not printable.
#[derive(Debug)]
pub(super) struct PrintableFile {
    /// File with the original name and the printable text.
    pub(super) file: SimpleFile<String, String>,
    /// For each replaced character, the offset after it in the original text, and the offset after its replacement in
    /// the printable text.
    replaced: Vec<(usize, usize)>,
}

impl PrintableFile {
    /// Returns the printable form of a file; `None` if its text is already printable.
    pub(super) fn of(name: &str, text: &str) -> Option<Self> {
        let mut shown = String::new();
        let mut replaced = Vec::new();
        let mut kept = 0;
        for (place, letter) in text.char_indices().filter(|(_, letter)| !is_printable(*letter)) {
            let after = place + letter.len_utf8();
            // The renderer handles tabs and line breaks, including a carriage return before a line break.
            let is_layout = matches!(letter, '\n' | '\t') || letter == '\r' && text[after..].starts_with('\n');
            if !is_layout {
                shown += &text[kept..place];
                shown += &Printable(letter).to_string();
                kept = after;
                replaced.push((after, shown.len()));
            }
        }
        if replaced.is_empty() {
            return None;
        }
        shown += &text[kept..];
        Some(Self { file: SimpleFile::new(name.to_owned(), shown), replaced })
    }

    /// Converts an offset in the original text to an offset in the printable text.
    pub(super) fn place(&self, byte: usize) -> usize {
        let before = self.replaced.partition_point(|(text, _)| *text <= byte);
        before.checked_sub(1).map_or(byte, |last| self.replaced[last].1 + (byte - self.replaced[last].0))
    }

    /// Converts an offset in the printable text to an offset in the original text.
    pub(super) fn origin(&self, place: usize) -> usize {
        let before = self.replaced.partition_point(|(_, shown)| *shown <= place);
        before.checked_sub(1).map_or(place, |last| self.replaced[last].0 + (place - self.replaced[last].1))
    }
}

#[cfg(test)]
mod tests {
    use super::PrintableFile;

    #[test]
    fn each_place_of_a_text_has_one_where_it_is_shown() {
        let text = "größe\u{1b}[1m\tA\r\n\u{202e}\rB\n\u{7f}";
        let shown = PrintableFile::of("a", text).expect("a text with such characters");
        assert_eq!(shown.file.source(), "größeU+001B[1m\tA\r\nU+202EU+000DB\nU+007F");
        for (byte, letter) in text.char_indices() {
            let place = shown.place(byte);
            assert!(shown.file.source()[place..].starts_with([letter, 'U']), "{byte}");
            assert_eq!(shown.origin(place), byte);
        }
        assert_eq!(shown.place(text.len()), shown.file.source().len());
        assert!(PrintableFile::of("a", "größe\r\n\t∞").is_none());
    }
}
