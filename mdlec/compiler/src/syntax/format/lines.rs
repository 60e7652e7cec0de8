//! Collects formatted lines, each with its trailing comment. Trailing comments of neighbouring lines with the same
//! indentation are aligned.

/// Number of columns between neighbouring lines and their comments, counted from the longest of these lines.
const GAP: usize = 4;

/// A formatted line.
#[derive(Debug, Default)]
struct FormattedLine {
    code: String,
    /// Trailing comment; empty if there is none.
    comment: String,
    /// `true` if no text can follow on this line because it ends with a comment.
    is_closed: bool,
}

/// A formatted text under construction.
#[derive(Debug, Default)]
pub(super) struct FormattedLines {
    done: Vec<FormattedLine>,
    line: Option<FormattedLine>,
}

impl FormattedLines {
    /// Begins a line that is indented by `indent` columns.
    pub(super) fn start(&mut self, indent: usize) {
        self.done.extend(self.line.take());
        self.line = Some(FormattedLine { code: " ".repeat(indent), ..FormattedLine::default() });
    }

    /// Appends an empty line.
    pub(super) fn skip(&mut self) {
        self.done.extend(self.line.take());
        self.line = Some(FormattedLine::default());
    }

    /// Appends a word to the line.
    pub(super) fn word(&mut self, text: &str, is_glued: bool) {
        let is_first = self.is_blank();
        let code = &mut self.line.get_or_insert_default().code;
        if !is_glued && !is_first {
            code.push(' ');
        }
        code.push_str(text);
    }

    /// Appends a comment, either between words or on its own line.
    pub(super) fn append(&mut self, comment: &str, is_closed: bool) {
        if self.line.as_ref().is_some_and(|line| !line.comment.is_empty()) {
            return self.trail(comment);
        }
        self.word(comment, false);
        self.line.get_or_insert_default().is_closed = is_closed;
    }

    /// Ends the line with a trailing comment.
    pub(super) fn trail(&mut self, comment: &str) {
        let line = self.line.get_or_insert_default();
        if !line.comment.is_empty() {
            line.comment.push(' ');
        }
        line.comment.push_str(comment);
        line.is_closed = true;
    }

    /// Returns `true` if no line has begun.
    pub(super) fn is_empty(&self) -> bool {
        self.line.is_none()
    }

    /// Returns `true` if the line has no code yet.
    pub(super) fn is_blank(&self) -> bool {
        self.line.as_ref().is_none_or(|line| line.code.trim_start_matches(' ').is_empty())
    }

    /// Returns `true` if no text can follow on the line.
    pub(super) fn is_closed(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_closed)
    }

    /// Returns the number of columns of the line's code.
    pub(super) fn width(&self) -> usize {
        self.line.as_ref().map_or(0, |line| width(&line.code))
    }

    /// Returns the formatted text, with a line end after each line.
    pub(super) fn text(mut self) -> String {
        self.done.extend(self.line.take());
        let mut text = String::new();
        for run in self.done.chunk_by(are_aligned) {
            let column = GAP + run.iter().map(|line| width(&line.code)).max().unwrap_or(0);
            for line in run {
                text.push_str(&line.code);
                if is_commented(line) {
                    text.extend(std::iter::repeat_n(' ', column - width(&line.code)));
                    text.push_str(&line.comment);
                }
                text.push('\n');
            }
        }
        text
    }
}

/// Returns `true` if the comments of two neighbouring lines have to be aligned.
fn are_aligned(one: &FormattedLine, next: &FormattedLine) -> bool {
    let indent = |line: &FormattedLine| line.code.len() - line.code.trim_start_matches(' ').len();
    is_commented(one) && is_commented(next) && indent(one) == indent(next)
}

fn is_commented(line: &FormattedLine) -> bool {
    !line.comment.is_empty()
}

/// Returns the number of columns of the last line of `code`.
fn width(code: &str) -> usize {
    code.rsplit('\n').next().unwrap_or("").chars().count()
}
