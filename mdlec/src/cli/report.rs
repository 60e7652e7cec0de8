//! Messages on standard error, and output on standard output.

use std::env;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::sync::OnceLock;

use codespan_reporting::term::termcolor::{ColorChoice, StandardStream};
use mdle_runtime::{Printable, PrintableLines, is_printable};

use super::{Color, Failure, MessageFormat};
use mdle_compiler::diagnostic::{Code, Diagnostic, Message, Severity, Sources, Span, has_errors};

/// Format of all messages of this process. It is set once, when the command line is read: every message goes through
/// this file.
static FORMAT: OnceLock<MessageFormat> = OnceLock::new();

/// Choice of colours for messages, set together with the format.
static COLOR: OnceLock<Color> = OnceLock::new();

/// Sets the format and the colours of all messages.
pub(super) fn choose(format: MessageFormat, color: Color) {
    // There is one command line, so this is the first time.
    let _ = FORMAT.set(format);
    let _ = COLOR.set(color);
}

/// Returns `true` if messages are written as JSON.
pub(super) fn is_json() -> bool {
    FORMAT.get() == Some(&MessageFormat::Json)
}

/// Returns `true` if messages are written for cargo, which runs a build script.
fn is_build_script() -> bool {
    FORMAT.get() == Some(&MessageFormat::BuildScript)
}

/// Writes an option as the user can type it: on the command line or in a build script.
pub(super) fn option(name: &str, value: &str) -> String {
    if is_build_script() { format!(".{name}({value:?})") } else { format!("--{name} {value}") }
}

/// Maximum number of diagnostics shown as text.
const SHOWN: usize = 100;
/// Maximum number if more than that are errors of notation: such a file is probably not a plan.
const SHOWN_OF_NO_PLAN: usize = 10;

/// Prints diagnostics in their order, then their number.
///
/// Returns `true` if the plan may be used: no errors, and with `deny_warnings` no warnings.
pub(super) fn diagnostics(sources: &Sources, found: &[Diagnostic], deny_warnings: bool) -> bool {
    if is_json() {
        // A program is told all of them.
        found.iter().for_each(|diagnostic| line(&sources.message(diagnostic)));
    } else if is_build_script() && !has_errors(found) {
        found.iter().for_each(|diagnostic| warn_cargo(&sources.message(diagnostic)));
    } else {
        render(sources, found);
    }
    let count = |severity| found.iter().filter(|diagnostic| diagnostic.code.severity() == severity).count();
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    if errors > 0 && !is_json() {
        error(&number(errors, "error"));
    } else if errors == 0 && deny_warnings && warnings > 0 {
        error(&format!("{}, and `--deny-warnings` counts them as errors", number(warnings, "warning")));
    }
    errors == 0 && (warnings == 0 || !deny_warnings)
}

/// Renders diagnostics as text.
fn render(sources: &Sources, found: &[Diagnostic]) {
    let choice = match COLOR.get().unwrap_or(&Color::Auto) {
        Color::Always => ColorChoice::Always,
        Color::Auto if io::stderr().is_terminal() => ColorChoice::Auto,
        Color::Auto | Color::Never => ColorChoice::Never,
    };
    let mut out = StandardStream::stderr(choice);
    let notation = found.iter().filter(|diagnostic| diagnostic.code.is_notation()).count();
    let most = if notation > SHOWN_OF_NO_PLAN { SHOWN_OF_NO_PLAN } else { SHOWN };
    for diagnostic in found.iter().take(most) {
        // Nobody is left to be told when standard error is closed.
        let _ = sources.write(diagnostic, &mut out);
    }
    note_others(found.len(), most);
}

/// Prints the number of diagnostics that are not shown.
fn note_others(all: usize, shown: usize) {
    if all > shown {
        note(format_args!("… and {} more", all - shown));
    }
}

/// Writes a message as one line of JSON.
fn line(message: &Message<'_>) {
    // Nobody is left to be told when standard error is closed.
    let _ = writeln!(io::stderr().lock(), "{}", message.to_json());
}

/// Prints a warning for cargo, in the one line that cargo accepts.
fn warn_cargo(warning: &Message<'_>) {
    let place = warning.spans.first().map(|place| format!("{}:{}:{}: ", place.file, place.line, place.column));
    let help: String = warning.help.iter().map(|help| format!("; help: {help}")).collect();
    let text = format!("{}{}{help} [{}]", place.unwrap_or_default(), warning.message, warning.code.unwrap_or_default());
    // Nobody is left to be told when standard output is closed.
    let _ = writeln!(io::stdout().lock(), "cargo::warning={}", Printable(text));
}

/// Diagnostic for a file that is not text, with the part of the file that can be shown; its first `valid` bytes are
/// valid.
pub(super) fn not_utf8(name: &str, bytes: &[u8], valid: usize) -> (Sources, Diagnostic) {
    let mut sources = Sources::default();
    let source = sources.add(name, String::from_utf8_lossy(bytes));
    // The replacement character that stands there now is three bytes long.
    let span = Span::new(source, valid, valid + 3);
    let found = Diagnostic::new(Code::E0109, "this file is not UTF-8 text", span, "no character of UTF-8")
        .help("save it as UTF-8 in your editor, or convert it: `iconv -f latin1 -t utf-8`");
    (sources, found)
}

/// Prints an error, in the format of the diagnostics.
pub(super) fn error(message: &str) {
    if is_json() {
        return line(&Message::plain("error", message));
    }
    let _ = writeln!(io::stderr().lock(), "error: {}", PrintableLines(message));
}

/// Prints a note.
pub(super) fn note(message: impl Display) {
    if is_json() {
        return line(&Message::plain("note", &message.to_string()));
    }
    let _ = writeln!(io::stderr().lock(), "{}", PrintableLines(message));
}

/// Prints text for people to standard output, with control characters made printable; a closed pipe is not an error.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    print_exactly(&PrintableLines(text).to_string())
}

/// Prints text for programs to standard output unchanged; a closed pipe is not an error.
pub(super) fn print_exactly(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Converts the result of printing to standard output; a closed pipe is not an error.
pub(super) fn printed(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::usage(format!(
            "standard output cannot be written ({error}): make room where it goes, or send it elsewhere"
        ))),
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Prints the answer of the command line itself: the requested help or version, or a usage error.
pub(super) fn answer(answer: &clap::Error) -> Result<(), Failure> {
    // Only the arguments can have brought what a terminal would obey; beside its colours it could not be told from
    // them.
    let is_plain = |argument: OsString| argument.to_string_lossy().chars().all(is_printable);
    let result = if env::args_os().all(is_plain) {
        answer.print()
    } else {
        let text = PrintableLines(answer.render()).to_string();
        if answer.use_stderr() { write!(io::stderr(), "{text}") } else { write!(io::stdout(), "{text}") }
    };
    if answer.use_stderr() { Err(Failure { status: 2, message: None }) } else { printed(result) }
}

/// Writes a number with its noun: `1 error`, `2 errors`.
fn number(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}
