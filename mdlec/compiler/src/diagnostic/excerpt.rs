//! Extracts the lines that a message shows from their files. Long lines are cut to the text around the message's
//! places.

use std::collections::BTreeMap;
use std::ops::Range;

use codespan_reporting::diagnostic as report;
use codespan_reporting::files::{Error as FilesError, Files};
use codespan_reporting::term;
use codespan_reporting::term::termcolor::WriteColor;
use mdle_runtime::{Printable, PrintableLines};

use super::{Diagnostic, Severity, SourceId, Sources, most_shown};

/// Maximum length of a line that is shown whole, in bytes.
const WHOLE: usize = 240;
/// Number of bytes that a cut line shows before and after the start and the end of each place.
const AROUND: usize = 60;
/// Mark that replaces each omitted part of a line.
const CUT: &str = "…";

/// A diagnostic in the form of codespan-reporting, with the lines that it shows.
#[derive(Debug)]
pub(super) struct Excerpt<'s> {
    sources: &'s Sources,
    files: BTreeMap<SourceId, ExcerptLines>,
    report: report::Diagnostic<SourceId>,
}

/// Shown lines of one file, concatenated.
#[derive(Debug, Default)]
struct ExcerptLines {
    text: String,
    /// Lines in the order of the file.
    lines: Vec<ExcerptLine>,
}

/// A line of a file, or the shown parts of it.
#[derive(Debug)]
struct ExcerptLine {
    /// Number of the line in its file, counted from 0.
    index: usize,
    /// Byte range of the line in the excerpt.
    range: Range<usize>,
    /// Byte ranges of the file that are shown, each with its offset in the excerpt.
    kept: Vec<(Range<usize>, usize)>,
}

impl Sources {
    /// Renders the diagnostic as plain text, as on a terminal without colours.
    #[must_use]
    pub fn render(&self, diagnostic: &Diagnostic) -> String {
        let shown = Excerpt::new(self, diagnostic)
            .and_then(|excerpt| term::emit_into_string(&term::Config::default(), &excerpt, &excerpt.report));
        shown.unwrap_or_else(|_| format!("{}: {}\n", diagnostic.code, PrintableLines(&diagnostic.message)))
    }

    /// Writes the diagnostic to a terminal with colours.
    ///
    /// # Errors
    /// Fails if writing to the terminal fails.
    pub fn write(&self, diagnostic: &Diagnostic, out: &mut impl WriteColor) -> Result<(), FilesError> {
        let excerpt = Excerpt::new(self, diagnostic)?;
        term::emit_to_write_style(out, &term::Config::default(), &excerpt, &excerpt.report)
    }

    /// Writes diagnostics to a terminal, up to the maximum number. If there are more, writes the number of the
    /// remaining ones.
    ///
    /// # Errors
    /// Fails if writing a diagnostic fails; the other diagnostics are written nevertheless.
    pub fn write_all(&self, diagnostics: &[Diagnostic], out: &mut impl WriteColor) -> Result<(), FilesError> {
        let most = most_shown(diagnostics);
        let written = diagnostics.iter().take(most).map(|diagnostic| self.write(diagnostic, out));
        let failed = written.filter_map(Result::err).last();
        if diagnostics.len() > most {
            writeln!(out, "… and {} more", diagnostics.len() - most)?;
        }
        failed.map_or(Ok(()), Err)
    }

    /// Writes a report that is not a diagnostic of a plan to a terminal with colours. The labels of the report have
    /// byte ranges in these files.
    ///
    /// # Errors
    /// Fails if writing to the terminal fails.
    pub fn write_report(
        &self,
        mut report: report::Diagnostic<SourceId>,
        out: &mut impl WriteColor,
    ) -> Result<(), FilesError> {
        report.message = PrintableLines(&report.message).to_string();
        for label in &mut report.labels {
            let [start, end] = [label.range.start, label.range.end].map(|byte| self.shown_place(label.file_id, byte));
            label.range = start..end;
            label.message = PrintableLines(&label.message).to_string();
        }
        report.notes.iter_mut().for_each(|note| *note = PrintableLines(&*note).to_string());
        let excerpt = Excerpt::of(self, report)?;
        term::emit_to_write_style(out, &term::Config::default(), &excerpt, &excerpt.report)
    }

    /// Converts a diagnostic to a report of codespan-reporting, with offsets in the files as they are shown.
    fn report(&self, diagnostic: &Diagnostic) -> report::Diagnostic<SourceId> {
        let severity = match diagnostic.code.severity() {
            Severity::Error => report::Severity::Error,
            Severity::Warning => report::Severity::Warning,
        };
        let labels = diagnostic.labels.iter().map(|label| {
            let style = if label.primary { report::LabelStyle::Primary } else { report::LabelStyle::Secondary };
            let (source, range) = self.range(label.span);
            let range = self.shown_place(source, range.start)..self.shown_place(source, range.end);
            report::Label::new(style, source, range).with_message(PrintableLines(&label.text).to_string())
        });
        report::Diagnostic::new(severity)
            .with_code(diagnostic.code.name())
            .with_message(PrintableLines(&diagnostic.message).to_string())
            .with_labels(labels.collect())
            .with_notes(diagnostic.help.iter().map(|help| format!("help: {}", PrintableLines(&help.text))).collect())
    }
}

impl<'s> Excerpt<'s> {
    /// Extracts the lines that `diagnostic` shows from the files in `sources`.
    fn new(sources: &'s Sources, diagnostic: &Diagnostic) -> Result<Self, FilesError> {
        Self::of(sources, sources.report(diagnostic))
    }

    /// Extracts the lines that `report` shows. The offsets in its labels refer to the files as they are shown.
    fn of(sources: &'s Sources, mut report: report::Diagnostic<SourceId>) -> Result<Self, FilesError> {
        let mut places: BTreeMap<SourceId, BTreeMap<usize, Vec<usize>>> = BTreeMap::new();
        for label in &report.labels {
            let file = sources.shown_file(label.file_id)?;
            let lines = places.entry(label.file_id).or_default();
            let [first, last] = [label.range.start, label.range.end].map(|byte| file.line_index((), byte));
            let (first, last) = (first?, last?);
            // A single line between two shown lines is shown as well.
            for line in first..=last.saturating_add(1) {
                lines.entry(line).or_default();
            }
            lines.entry(first).or_default().push(label.range.start);
            lines.entry(last).or_default().push(label.range.end);
        }
        let mut files = BTreeMap::new();
        for (source, places) in places {
            let file = sources.shown_file(source)?;
            let mut lines = ExcerptLines::default();
            for (index, places) in places {
                // The line after the last label may be missing.
                if let Ok(range) = file.line_range((), index) {
                    lines.add(index, file.source(), range, &places);
                }
            }
            files.insert(source, lines);
        }
        for label in &mut report.labels {
            if let Some(lines) = files.get(&label.file_id) {
                label.range = lines.place(label.range.start)..lines.place(label.range.end);
            }
        }
        Ok(Self { sources, files, report })
    }

    fn lines(&self, source: SourceId) -> Result<&ExcerptLines, FilesError> {
        self.files.get(&source).ok_or(FilesError::FileMissing)
    }
}

impl ExcerptLines {
    /// Adds the line at `range` of a file, cut around `places`.
    fn add(&mut self, index: usize, source: &str, range: Range<usize>, places: &[usize]) {
        let start = self.text.len();
        let line = source.get(range.clone()).unwrap_or_default().trim_end_matches('\n');
        let mut kept = Vec::new();
        let mut end = 0;
        for stretch in stretches(line, places.iter().map(|place| place.saturating_sub(range.start))) {
            if stretch.start > end {
                self.text += CUT;
            }
            end = stretch.end;
            kept.push((range.start + stretch.start..range.start + stretch.end, self.text.len()));
            self.text += &line[stretch];
        }
        if end < line.len() {
            self.text += CUT;
        }
        self.text.push('\n');
        self.lines.push(ExcerptLine { index, range: start..self.text.len(), kept });
    }

    /// Returns the offset in the excerpt for an offset in the file.
    fn place(&self, byte: usize) -> usize {
        let kept = self.lines.iter().flat_map(|line| &line.kept).rev().find(|(range, _)| range.start <= byte);
        kept.map_or(0, |(range, at)| at + byte.min(range.end).saturating_sub(range.start))
    }

    /// Returns the offset in the file for an offset in the excerpt.
    fn origin(&self, place: usize) -> usize {
        let kept = self.lines.iter().flat_map(|line| &line.kept).rev().find(|(_, at)| *at <= place);
        kept.map_or(0, |(range, at)| range.end.min(range.start + (place - at)))
    }
}

/// Returns the byte ranges of a line that are shown. They are in order, and do not overlap.
fn stretches(line: &str, places: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    if line.len() <= WHOLE {
        return std::iter::once(0..line.len()).collect();
    }
    let mut places: Vec<_> = places.collect();
    places.sort_unstable();
    if places.is_empty() {
        places.push(0);
    }
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for place in places {
        let from = line.floor_char_boundary(place.saturating_sub(AROUND));
        let to = line.ceil_char_boundary(place.saturating_add(AROUND));
        // A part that is not longer than the mark of a cut is shown.
        match stretches.last_mut() {
            Some(last) if from <= last.end + CUT.len() => last.end = to,
            None if from <= CUT.len() => stretches.push(0..to),
            Some(_) | None => stretches.push(from..to),
        }
    }
    if let Some(last) = stretches.last_mut().filter(|last| last.end + CUT.len() >= line.len()) {
        last.end = line.len();
    }
    stretches
}

/// Lines of the excerpt, with the line numbers and columns of the files as written.
impl<'a> Files<'a> for Excerpt<'_> {
    type FileId = SourceId;
    type Name = Printable<&'a str>;
    type Source = &'a str;

    fn name(&'a self, id: SourceId) -> Result<Printable<&'a str>, FilesError> {
        Ok(Printable(self.sources.name(id)))
    }

    fn source(&'a self, id: SourceId) -> Result<&'a str, FilesError> {
        self.lines(id).map(|lines| lines.text.as_str())
    }

    fn line_index(&'a self, id: SourceId, byte: usize) -> Result<usize, FilesError> {
        let lines = &self.lines(id)?.lines;
        let after = lines.partition_point(|line| line.range.start <= byte);
        after.checked_sub(1).and_then(|line| lines.get(line)).map(|line| line.index).ok_or(FilesError::FileMissing)
    }

    fn line_range(&'a self, id: SourceId, line: usize) -> Result<Range<usize>, FilesError> {
        let lines = &self.lines(id)?.lines;
        let found = lines.binary_search_by_key(&line, |line| line.index).ok().and_then(|place| lines.get(place));
        let missing = FilesError::LineTooLarge { given: line, max: lines.last().map_or(0, |last| last.index) };
        found.map(|line| line.range.clone()).ok_or(missing)
    }

    fn column_number(&'a self, id: SourceId, line: usize, byte: usize) -> Result<usize, FilesError> {
        self.sources.column(id, line, self.lines(id)?.origin(byte))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Code, Diagnostic, Sources, Span};
    use super::{AROUND, WHOLE};

    /// Renders a message about the first occurrence of `first` and the last of `last` in a plan, without trailing
    /// spaces.
    fn shown(text: &str, first: &str, last: &str) -> String {
        let mut sources = Sources::default();
        let source = sources.add("long.mdle", text);
        let [from, to] = [first, last].map(|part| text.find(part).unwrap());
        let label = |at: usize, length: usize| Span::new(source, at, at + length);
        let diagnostic =
            Diagnostic::new(Code::E0201, "no", label(to, last.len()), "here").also(label(from, first.len()), "there");
        let column = sources.message(&diagnostic).spans[0].column;
        let lines: Vec<_> = sources.render(&diagnostic).lines().map(|line| line.trim_end().to_owned()).collect();
        assert!(lines[1].ends_with(&format!(":{column}")), "{lines:?}");
        lines.join("\n")
    }

    #[test]
    fn a_long_line_is_cut_around_its_places() {
        let text =
            format!("{{ P {}\u{1b} ∞stöp {}∞rötate {} }}\n", "größe ".repeat(60), "a".repeat(500), "ω".repeat(300));
        insta::assert_snapshot!(shown(&text, "stöp", "rötate"), @r#"
        error[E0201]: no
          ┌─ long.mdle:1:874
          │
        1 │ …e größe größe größe größe größe größe U+001B ∞stöp aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa…aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa∞rötate ωωωωωωωωωωωωωωωωωωωωωωωωωωωωωω…
          │                                                ----                                                                                                                       ^^^^^^ here
          │                                                │
          │                                                there
        "#);
    }

    #[test]
    fn a_long_place_is_shown_from_both_ends() {
        let text = format!("before\n{{ P\n{} }}\n\tafter\n", "( stop ) ".repeat(2000));
        let all = text[text.find('(').unwrap()..text.find('\n').unwrap() + 5000].to_owned();
        insta::assert_snapshot!(shown(&text, "before\n{ P", &all), @r#"
        error[E0201]: no
          ┌─ long.mdle:3:1
          │
        1 │ ╭ before
        2 │ │ { P
          │ ╰───' there
        3 │   ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop…top ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop ) ( stop…
          │   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ here
        "#);
    }

    #[test]
    fn a_line_is_cut_only_where_that_makes_it_shorter() {
        for length in [WHOLE - 1, WHOLE, WHOLE + 1, 2 * WHOLE] {
            for place in 0..length {
                let line = format!("{}x{}", "ä".repeat(place), "b".repeat(length - place));
                let text = format!("first\n{line}\nlast");
                let shown = shown(&text, "x", "x");
                let line_shown = shown.lines().nth(3).unwrap();
                let carets = shown.lines().nth(4).unwrap();
                let caret = carets.chars().position(|letter| letter == '^').unwrap();
                assert_eq!(line_shown.chars().nth(caret), Some('x'), "{shown}");
                assert!(line_shown.len() <= line.len() + 8 && line_shown.len() <= WHOLE + 2 * AROUND, "{shown}");
            }
        }
    }
}
