//! Sources of commands: a terminal, a file or a pipe.

use std::io::{self, BufRead, Read as _};

use rustyline::completion::Completer;
use rustyline::error::ReadlineError;
use rustyline::highlight::Highlighter;
use rustyline::hint::Hinter;
use rustyline::validate::{ValidationContext, ValidationResult, Validator};
use rustyline::{Config, Context, Editor, ExternalPrinter, Helper};

use crate::tree::Hub;

/// Maximum length of a line, in bytes.
const LONGEST: u64 = 1 << 16;
/// Error message about a line that is not UTF-8.
const NO_TEXT: &str = "the line is not UTF-8 text";

/// Lines of commands.
pub trait Lines {
    /// Returns the next line; a terminal shows the current folder `here`.
    fn next(&mut self, here: &str) -> Typed;
}

/// A line, or the reason why there is no line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Typed {
    /// A line with its number, counted from 1.
    Line(usize, String),
    /// A line that cannot be used: its number, and a sentence with the reason.
    Unusable(usize, String),
    /// There are no more lines.
    End,
}

/// Lines from a file or a pipe. A line that ends with `\` continues on the next line.
#[derive(Debug)]
pub struct FileLines<R> {
    from: R,
    number: usize,
}

impl<R: BufRead> FileLines<R> {
    /// Creates a source of the lines of a reader.
    pub fn new(from: R) -> Self {
        Self { from, number: 0 }
    }

    /// Returns the next line without its line break; `None` at the end.
    fn line(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut line = Vec::new();
        self.number += 1;
        self.from.by_ref().take(LONGEST).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        if line.len() as u64 == LONGEST && !line.ends_with(b"\n") {
            self.from.skip_until(b'\n')?;
            return Err(io::Error::other(format!("the line is longer than {LONGEST} bytes")));
        }
        while line.last().is_some_and(|byte| matches!(byte, b'\n' | b'\r')) {
            line.pop();
        }
        Ok(Some(line))
    }
}

impl<R: BufRead> Lines for FileLines<R> {
    fn next(&mut self, _: &str) -> Typed {
        let mut text = String::new();
        loop {
            let (begins, line) = (text.is_empty(), self.line());
            let line = match line {
                Ok(None) if begins => return Typed::End,
                Ok(None) => {
                    return Typed::Unusable(self.number - 1, "the input ends in the middle of a command".into());
                }
                Ok(Some(line)) => line,
                Err(error) if error.kind() == io::ErrorKind::Other => {
                    return Typed::Unusable(self.number, error.to_string());
                }
                Err(_) => return Typed::End,
            };
            let Ok(line) = String::from_utf8(line) else {
                return Typed::Unusable(self.number, NO_TEXT.to_owned());
            };
            match continued(&line) {
                Some(part) if (text.len() + part.len()) as u64 <= LONGEST => {
                    text.push_str(part);
                    text.push(' ');
                }
                Some(_) => return Typed::Unusable(self.number, format!("the command is longer than {LONGEST} bytes")),
                None => return Typed::Line(self.number, text + &line),
            }
        }
    }
}

/// Returns the line without its `\` if the command continues on the next line. A comment does not continue.
fn continued(line: &str) -> Option<&str> {
    line.strip_suffix('\\').filter(|part| !part.trim_start().starts_with('#'))
}

/// Function that prints whole lines above the line that is being typed.
pub type PrintAbove = dyn FnMut(&str) -> io::Result<()> + Send;

/// Lines that a user types at a terminal, with completion of paths. Ctrl-C and Ctrl-D end them.
pub struct TerminalLines {
    editor: Editor<ShellCompletion, rustyline::history::MemHistory>,
    number: usize,
}

impl TerminalLines {
    /// Returns the lines that are typed at the terminal of this process, and a function that prints above the line that
    /// is being typed.
    ///
    /// # Errors
    /// Fails if the terminal cannot be used.
    pub fn open(hub: Hub) -> io::Result<(Self, Box<PrintAbove>)> {
        let history = rustyline::history::MemHistory::new();
        let editor = Editor::with_history(Config::builder().build(), history);
        let mut editor = editor.map_err(io::Error::other)?;
        editor.set_helper(Some(ShellCompletion { hub, here: "/".to_owned() }));
        let mut printer = editor.create_external_printer().map_err(io::Error::other)?;
        let print = move |text: &str| printer.print(text.to_owned()).map_err(io::Error::other);
        Ok((Self { editor, number: 0 }, Box::new(print)))
    }
}

impl Lines for TerminalLines {
    fn next(&mut self, here: &str) -> Typed {
        self.number += 1;
        if let Some(helper) = self.editor.helper_mut() {
            here.clone_into(&mut helper.here);
        }
        match self.editor.readline(&format!("{here} > ")) {
            Ok(lines) => {
                let line = lines.replace("\\\n", " ");
                let _ = self.editor.add_history_entry(line.as_str());
                Typed::Line(self.number, line)
            }
            // The bytes typed so far are lost, and the next bytes begin a new line.
            Err(ReadlineError::Io(error)) if error.kind() == io::ErrorKind::InvalidData => {
                Typed::Unusable(self.number, NO_TEXT.to_owned())
            }
            Err(ReadlineError::Eof | ReadlineError::Interrupted) => Typed::End,
            Err(_) => Typed::End,
        }
    }
}

/// Completion of commands and paths.
struct ShellCompletion {
    hub: Hub,
    here: String,
}

impl Completer for ShellCompletion {
    type Candidate = String;

    fn complete(&self, line: &str, place: usize, _: &Context<'_>) -> rustyline::Result<(usize, Vec<String>)> {
        let typed = line.get(..place).unwrap_or(line);
        let begin = typed.rfind(char::is_whitespace).map_or(0, |space| space + 1);
        let word = typed.get(begin..).unwrap_or_default();
        if begin == 0 {
            let names = super::command::COMMANDS.iter().map(|(name, ..)| (*name).to_owned());
            return Ok((0, names.filter(|name| name.starts_with(word)).collect()));
        }
        if word.starts_with('/') {
            return Ok((begin, self.hub.complete(word)));
        }
        let folder = format!("{}/", self.here.trim_end_matches('/'));
        let paths = self.hub.complete(&format!("{folder}{word}"));
        Ok((begin, paths.iter().filter_map(|path| path.strip_prefix(&folder)).map(str::to_owned).collect()))
    }
}

impl Hinter for ShellCompletion {
    type Hint = String;
}
impl Highlighter for ShellCompletion {}
impl Validator for ShellCompletion {
    fn validate(&self, typed: &mut ValidationContext<'_>) -> rustyline::Result<ValidationResult> {
        let is_complete = continued(typed.input()).is_none();
        Ok(if is_complete { ValidationResult::Valid(None) } else { ValidationResult::Incomplete })
    }
}
impl Helper for ShellCompletion {}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<Typed> {
        let mut input = FileLines::new(text);
        let lines = std::iter::from_fn(|| Some(input.next("/")).filter(|typed| *typed != Typed::End));
        lines.take(100).collect()
    }

    #[test]
    fn a_file_is_read_line_by_line() {
        let line = |number, text: &str| Typed::Line(number, text.to_owned());
        assert_eq!(lines(b"a b\r\n\nc"), [line(1, "a b"), line(2, ""), line(3, "c")]);
        assert_eq!(lines(b"set x \\\n 3\nls"), [line(2, "set x   3"), line(3, "ls")]);
        assert_eq!(lines(b" # a comment \\\nls"), [line(1, " # a comment \\"), line(2, "ls")]);
        assert_eq!(lines(b""), []);
    }

    #[test]
    fn what_is_no_line_is_refused_and_the_next_is_read() {
        let unusable = |number, text: &str| Typed::Unusable(number, text.to_owned());
        let line = |number, text: &str| Typed::Line(number, text.to_owned());
        assert_eq!(lines(b"\xFF\xFE\nls\n"), [unusable(1, "the line is not UTF-8 text"), line(2, "ls")]);
        assert_eq!(lines(b"set x \\"), [unusable(1, "the input ends in the middle of a command")]);
        let mut long = vec![b'a'; 200_000];
        long.extend(b"\nls");
        assert_eq!(lines(&long), [unusable(1, "the line is longer than 65536 bytes"), line(2, "ls")]);
    }
}
