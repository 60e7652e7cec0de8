//! Stores the files that messages show. Spans are offsets in the concatenation of all files.

use std::cell::Cell;
use std::ops::Range;

use codespan_reporting::files::{Error as FilesError, Files, SimpleFile, column_index};

use super::printable_file::PrintableFile;
use super::{SourceId, Span};

/// The files that spans refer to.
#[derive(Debug, Default)]
pub struct Sources {
    /// Files in ascending order of their offsets.
    files: Vec<(SourceId, SourceFile)>,
    /// Place that was looked up last, with its line and column.
    last: Cell<Option<LineAndColumn>>,
}

/// A file as written and, if that differs, as shown.
#[derive(Debug)]
struct SourceFile {
    written: SimpleFile<String, String>,
    shown: Option<PrintableFile>,
}

/// A place with its line and column. Here, both are counted from 1.
#[derive(Debug, Clone, Copy)]
struct LineAndColumn {
    source: SourceId,
    byte: usize,
    line: usize,
    column: usize,
}

impl Sources {
    /// Maximum total size of all files, in bytes, including one byte between each two files. The limit exists because
    /// offsets have 32 bits.
    const ROOM: u32 = u32::MAX;

    /// Adds a file; `name` is the name that messages show. There must be [room](Self::refusal) for the file.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> SourceId {
        let (id, name, text) = (self.next(), name.into(), text.into());
        let shown = PrintableFile::of(&name, &text);
        self.files.push((id, SourceFile { written: SimpleFile::new(name, text), shown }));
        id
    }

    /// Returns the offset of the next file that is added. One byte separates two files, so that the end of a file does
    /// not belong to the next file.
    fn next(&self) -> SourceId {
        SourceId(self.files.last().map_or(0, |(last, file)| Span::new(*last, 0, file.written.source().len() + 1).end))
    }

    /// Returns the reason why a file of `length` bytes cannot be added; `None` if there is room for it.
    #[must_use]
    pub fn refusal(&self, name: &str, length: usize) -> Option<String> {
        let room = Self::ROOM - self.next().0;
        let is_small = u32::try_from(length).is_ok_and(|length| length < room);
        (!is_small).then(|| {
            format!(
                "`{name}` has {length} bytes, and there is room for {}: a plan, the files that it uses and the alphabets \
                 can have {} in all",
                room.saturating_sub(1),
                Self::ROOM
            )
        })
    }

    /// Returns the file that contains this offset; `None` if there are no files.
    fn file(&self, byte: u32) -> Option<&(SourceId, SourceFile)> {
        let behind = self.files.partition_point(|(id, _)| id.0 <= byte);
        self.files.get(behind.checked_sub(1)?)
    }

    /// Returns the file of a span, and the byte range of the span in that file.
    #[must_use]
    pub fn range(&self, span: Span) -> (SourceId, Range<usize>) {
        let source = self.file(span.start).map_or(SourceId(0), |(id, _)| *id);
        (source, span.within(source))
    }

    /// Returns the line and the column of a byte; both are counted from 1, and columns count characters.
    ///
    /// If the byte is in the same line as the place that was looked up last, the search starts from that place, because
    /// a file may consist of one line with a mistake in every word.
    pub(super) fn line_and_column(&self, source: SourceId, byte: usize) -> (usize, usize) {
        let known = self.place_near(source, byte).or_else(|| {
            let at = self.written(source)?.location((), byte).ok()?;
            Some(LineAndColumn { source, byte, line: at.line_number, column: at.column_number })
        });
        self.last.set(known);
        known.map_or((1, 1), |known| (known.line, known.column))
    }

    /// Returns the place of a byte if it is in the same line as the place that was looked up last; `None` if it is in
    /// another line.
    fn place_near(&self, source: SourceId, byte: usize) -> Option<LineAndColumn> {
        let last = self.last.get().filter(|last| last.source == source)?;
        let line = self.written(source)?.line_index((), byte).ok();
        let line = line.map(|line| line + 1).filter(|line| *line == last.line)?;
        let between = self.text(source).get(last.byte.min(byte)..last.byte.max(byte))?.chars().count();
        let column = if byte < last.byte { last.column.checked_sub(between)? } else { last.column + between };
        Some(LineAndColumn { source, byte, line, column })
    }

    /// Returns the name of the file that contains a span, and the number of the line in which the span begins, counted
    /// from 1; 0 if the line is not known.
    #[must_use]
    pub fn line(&self, span: Span) -> (&str, usize) {
        let (source, range) = self.range(span);
        let line = self.written(source).and_then(|file| file.line_index((), range.start).ok());
        (self.name(source), line.map_or(0, |line| line + 1))
    }

    /// Returns the text of a span; empty if the file is not known.
    #[must_use]
    pub fn slice(&self, span: Span) -> &str {
        let (source, range) = self.range(span);
        self.text(source).get(range).unwrap_or("")
    }

    /// Returns the text of a file; empty if the file is not known.
    #[must_use]
    pub fn text(&self, source: SourceId) -> &str {
        self.written(source).map_or("", |file| file.source().as_str())
    }

    /// Returns the name of a file; empty if the file is not known.
    #[must_use]
    pub fn name(&self, source: SourceId) -> &str {
        self.written(source).map_or("", |file| file.name().as_str())
    }

    fn written(&self, source: SourceId) -> Option<&SimpleFile<String, String>> {
        self.file(source.0).map(|(_, file)| &file.written)
    }

    /// Returns the file as it is shown.
    pub(super) fn shown_file(&self, source: SourceId) -> Result<&SimpleFile<String, String>, FilesError> {
        let (_, file) = self.file(source.0).ok_or(FilesError::FileMissing)?;
        Ok(file.shown.as_ref().map_or(&file.written, |shown| &shown.file))
    }

    /// Returns the offset in the shown text for an offset in the file.
    pub(super) fn shown_place(&self, source: SourceId, byte: usize) -> usize {
        let shown = self.file(source.0).and_then(|(_, file)| file.shown.as_ref());
        shown.map_or(byte, |shown| shown.place(byte))
    }

    /// Returns the column, in the file as written, for the byte offset `byte` in the file as shown. Columns count
    /// characters from 1; `line` counts from 0.
    pub(super) fn column(&self, source: SourceId, line: usize, byte: usize) -> Result<usize, FilesError> {
        let (_, file) = self.file(source.0).ok_or(FilesError::FileMissing)?;
        let byte = file.shown.as_ref().map_or(byte, |shown| shown.origin(byte));
        Ok(column_index(file.written.source(), file.written.line_range((), line)?, byte) + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Diagnostic;
    use super::*;

    /// Name for a file that only messages mention.
    const NAME: &str = "long.mdle";

    #[test]
    fn places_among_all_files_are_numbers_of_32_bits() {
        let mut sources = Sources::default();
        assert_eq!(sources.refusal(NAME, u32::MAX as usize - 1), None);
        assert!(sources.refusal(NAME, u32::MAX as usize).is_some());
        let first = sources.add("first.mdle", "a".repeat(1_000));
        let room = u32::MAX as usize - 1 - 1_001;
        assert_eq!(sources.refusal(NAME, room), None);
        assert_eq!(
            sources.refusal(NAME, room + 1).as_deref(),
            Some(
                "`long.mdle` has 4294966294 bytes, and there is room for 4294966293: a plan, the files that it uses and the \
                 alphabets can have 4294967295 in all"
            )
        );
        // Even if the files use up all offsets, a span can refer to the last place.
        let last = Span::new(SourceId(1_001), 0, room);
        assert_eq!((last.end, last.within(SourceId(1_001))), (u32::MAX - 1, 0..room));
        assert_eq!(sources.file(500).map(|(id, _)| *id), Some(first));
    }

    #[test]
    fn lines_and_columns_do_not_depend_on_what_was_asked_before() {
        let mut sources = Sources::default();
        let files = ["größe\n\n  stöp, α und ω\n", "noch\neins ∞"].map(|text| sources.add("a", text));
        let places: Vec<_> = files
            .iter()
            .flat_map(|source| {
                let text = sources.text(*source);
                (0..=text.len()).filter(|byte| text.is_char_boundary(*byte)).map(|byte| (*source, byte))
            })
            .collect();
        for before in &places {
            for (source, byte) in &places {
                sources.line_and_column(before.0, before.1);
                let at = sources.written(*source).unwrap().location((), *byte).unwrap();
                assert_eq!(sources.line_and_column(*source, *byte), (at.line_number, at.column_number));
            }
        }
    }

    #[test]
    fn places_stay_where_unprintable_characters_are_shown() {
        let mut sources = Sources::default();
        let text = "{ P\r\n  \"\u{1b}[2J\u{202e}\" stöp\t\u{7}x }\n";
        let source = sources.add("a\u{1b}\u{2066}.mdle", text);
        let at = text.find("stöp").unwrap();
        let found =
            Diagnostic::new(super::super::Code::E0201, "no `\u{1b}`", Span::new(source, at, at + 5), "\u{7}here")
                .also(Span::new(source, text.find('x').unwrap(), text.find('x').unwrap() + 1), "\u{202e}")
                .help("a\rb");
        let place = &sources.message(&found).spans[0];
        assert_eq!((place.line, place.column, place.end_column), (2, 11, 15));
        let shown: Vec<_> = sources.render(&found).lines().map(|line| line.trim_end().to_owned()).collect();
        insta::assert_snapshot!(shown.join("\n"), @r#"
        error[E0201]: no `U+001B`
          ┌─ aU+001BU+2066.mdle:2:11
          │
        2 │   "U+001B[2JU+202E" stöp    U+0007x }
          │                     ^^^^          - U+202E
          │                     │
          │                     U+0007here
          │
          = help: aU+000Db
        "#);
    }
}
