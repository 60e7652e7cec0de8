//! Writes messages that refer to places in files to standard error.

use std::io::{self, IsTerminal as _};

use codespan_reporting::diagnostic::Diagnostic;
use codespan_reporting::term::termcolor::{ColorChoice, StandardStream};
use mdle_compiler::diagnostic::{SourceId, Sources};

/// Returns a count followed by its noun: `1 turn`, `2 turns`.
pub(crate) fn counted(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Prints a report, in colours on a terminal.
pub(crate) fn write(sources: &Sources, report: Diagnostic<SourceId>) {
    let choice = if io::stderr().is_terminal() { ColorChoice::Auto } else { ColorChoice::Never };
    // If standard error is closed, the report cannot be shown anywhere.
    let _ = sources.write_report(report, &mut StandardStream::stderr(choice));
}
