//! Prints messages on standard error, and output on standard output.

use std::env;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::sync::OnceLock;

use codespan_reporting::term::termcolor::{ColorChoice, StandardStream};
use mdle_runtime::{PrintableLines, is_printable};

use super::{Color, CommandFailure, MessageFormat};
use mdle_compiler::diagnostic::{Diagnostic, JsonMessage, Sources, has_errors, judged};

/// Format of all messages of this process. It is set once, when the command line is read.
static FORMAT: OnceLock<MessageFormat> = OnceLock::new();

/// Choice of colours for messages, set together with the format.
static COLOR: OnceLock<Color> = OnceLock::new();

/// Sets the format and the colours of all messages.
pub(super) fn choose(format: MessageFormat, color: Color) {
    // The command line is read only once, so neither value has been set before.
    let _ = FORMAT.set(format);
    let _ = COLOR.set(color);
}

/// Returns `true` if messages are written as JSON.
pub(super) fn is_json() -> bool {
    FORMAT.get() == Some(&MessageFormat::Json)
}

/// Prints diagnostics in order, followed by their number.
///
/// Returns `true` if the plan may be used: it has no errors and, if `deny_warnings` is `true`, no warnings.
pub(super) fn diagnostics(sources: &Sources, found: &[Diagnostic], deny_warnings: bool) -> bool {
    if is_json() {
        // Programs get all diagnostics; the number of diagnostics as text is limited.
        found.iter().for_each(|diagnostic| line(&sources.message(diagnostic)));
    } else {
        render(sources, found);
    }
    let judged = judged(found, deny_warnings);
    if let Err(sentence) = &judged
        && !(is_json() && has_errors(found))
    {
        error(sentence);
    }
    judged.is_ok()
}

/// Renders diagnostics as text.
fn render(sources: &Sources, found: &[Diagnostic]) {
    let choice = match COLOR.get().unwrap_or(&Color::Auto) {
        Color::Always => ColorChoice::Always,
        Color::Auto if io::stderr().is_terminal() => ColorChoice::Auto,
        Color::Auto | Color::Never => ColorChoice::Never,
    };
    // If standard error is closed, the diagnostics cannot be shown, so a write error is ignored.
    let _ = sources.write_all(found, &mut StandardStream::stderr(choice));
}

/// Writes a message as one line of JSON.
fn line(message: &JsonMessage<'_>) {
    // If standard error is closed, the message cannot be shown, so a write error is ignored.
    let _ = writeln!(io::stderr().lock(), "{}", message.to_json());
}

/// Prints an error, in the format of the diagnostics.
pub(super) fn error(message: &str) {
    if is_json() {
        return line(&JsonMessage::plain("error", message));
    }
    let _ = writeln!(io::stderr().lock(), "error: {}", PrintableLines(message));
}

/// Prints a note.
pub(super) fn note(message: impl Display) {
    if is_json() {
        return line(&JsonMessage::plain("note", &message.to_string()));
    }
    let _ = writeln!(io::stderr().lock(), "{}", PrintableLines(message));
}

/// Prints text for people to standard output, with its control characters replaced by printable ones. A closed pipe is
/// not an error.
pub(super) fn print(text: &str) -> Result<(), CommandFailure> {
    print_exactly(&PrintableLines(text).to_string())
}

/// Prints text for programs to standard output unchanged; a closed pipe is not an error.
pub(super) fn print_exactly(text: &str) -> Result<(), CommandFailure> {
    let mut out = io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Converts the result of printing to standard output; a closed pipe is not an error.
pub(super) fn printed(result: io::Result<()>) -> Result<(), CommandFailure> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(CommandFailure::usage(format!(
            "standard output cannot be written ({error}): make room where it goes, or send it elsewhere"
        ))),
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Prints the output of clap: the requested help or version, or a usage error.
pub(super) fn answer(answer: &clap::Error) -> Result<(), CommandFailure> {
    // Control characters in clap's text can come only from the arguments. They cannot be told apart from clap's own
    // colour codes, so such a text is printed without colours.
    let is_plain = |argument: OsString| argument.to_string_lossy().chars().all(is_printable);
    let result = if env::args_os().all(is_plain) {
        answer.print()
    } else {
        let text = PrintableLines(answer.render()).to_string();
        if answer.use_stderr() { write!(io::stderr(), "{text}") } else { write!(io::stdout(), "{text}") }
    };
    if answer.use_stderr() { Err(CommandFailure::silent(2)) } else { printed(result) }
}
