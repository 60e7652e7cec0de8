//! Reasons why a plan cannot be run. Each is reported as a message on standard error, and has an exit status.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue};
use codespan_reporting::term::termcolor::{ColorChoice, StandardStream};
use mdle_compiler::diagnostic::{Diagnostic, Sources};
use mdle_compiler::load::LoadError;
use mdle_files::{FaultyFile, InputError};
use mdle_runtime::PrintableLines;

/// Exit status for a plan with errors, for a changed record, and for a plan that is not the plan of the record.
const PLAN: u8 = 1;
/// Exit status for wrong usage.
const USAGE: u8 = 2;

/// Reason why a plan cannot be run.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line is invalid, or requests help.
    Unparsed(clap::Error),
    /// Wrong usage; contains the error message.
    Usage(String),
    /// A plan or a target cannot be read.
    Input(InputError),
    /// The plan has errors, whose diagnostics were printed.
    Plan,
    /// The plan is not the plan of the record; contains the error message.
    OtherPlan(String),
    /// The reader of standard output has closed it, which is not an error.
    Closed,
    /// A test file has errors, which were printed.
    TestFile,
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl Failure {
    /// Returns the failure for an error of the command line. Removes the suggestion to write an option after `--`,
    /// because it never helps.
    pub(crate) fn unparsed(mut error: clap::Error) -> Self {
        let is_tip = |tip: &StyledStr| tip.to_string().contains("'-- ");
        let tips = match error.remove(ContextKind::Suggested) {
            Some(ContextValue::StyledStrs(tips)) => tips.into_iter().filter(|tip| !is_tip(tip)).collect(),
            Some(_) | None => Vec::new(),
        };
        if !tips.is_empty() {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        }
        Self::Unparsed(error)
    }

    /// Prints the message, if there is one, and returns the exit status.
    pub(crate) fn tell(self) -> ExitCode {
        ExitCode::from(self.tell_status())
    }

    /// Prints the message, if there is one, and returns the number of the exit status.
    pub(crate) fn tell_status(self) -> u8 {
        match self {
            Self::Unparsed(answer) => {
                // If the stream is closed, the message cannot be shown anywhere.
                let _ = answer.print();
                if answer.use_stderr() { USAGE } else { 0 }
            }
            Self::Usage(sentence) => {
                error(&sentence);
                USAGE
            }
            Self::Input(reason) => {
                let message = reason.to_string();
                let status = match reason.faulty_file() {
                    Some(FaultyFile { sources, diagnostics, target }) => {
                        print(&sources, &diagnostics);
                        if target.is_none() { PLAN } else { USAGE }
                    }
                    None => USAGE,
                };
                if message.is_empty() {
                    error("1 error");
                } else {
                    error(&message);
                }
                status
            }
            Self::Plan => PLAN,
            Self::OtherPlan(sentence) => {
                error(&sentence);
                PLAN
            }
            Self::Closed => 0,
            Self::TestFile => USAGE,
        }
    }
}

/// Returns the failure to write to standard output. A reader that closes the pipe, as `head` does, is not an error.
pub(crate) fn unprinted(error: &io::Error) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Failure::Closed;
    }
    Failure::Usage(format!("standard output cannot be written: {error}"))
}

/// Returns the failure for a file that already exists.
pub(crate) fn exists(path: &Path) -> Failure {
    Failure::Usage(format!("{} exists already\nhelp: remove it, or name another file", path.display()))
}

/// Returns the failure for a file or stream that cannot be written.
pub(crate) fn unwritten(name: &dyn Display, error: &io::Error) -> Failure {
    Failure::Usage(format!("{name} cannot be written: {error}"))
}

/// Prints a line to standard output.
///
/// # Errors
/// Fails if standard output cannot be written.
pub(crate) fn print_line(line: &str) -> Result<(), Failure> {
    writeln!(io::stdout().lock(), "{line}").map_err(|error| unprinted(&error))
}

/// Prints an error.
pub(crate) fn error(message: &str) {
    let _ = writeln!(io::stderr().lock(), "error: {}", PrintableLines(message));
}

/// Prints a warning.
pub(crate) fn warning(message: &str) {
    let _ = writeln!(io::stderr().lock(), "warning: {}", PrintableLines(message));
}

/// Prints diagnostics, in colours on a terminal.
pub(crate) fn print(sources: &Sources, diagnostics: &[Diagnostic]) {
    let choice = if io::stderr().is_terminal() { ColorChoice::Auto } else { ColorChoice::Never };
    // If standard error is closed, the message cannot be shown anywhere.
    let _ = sources.write_all(diagnostics, &mut StandardStream::stderr(choice));
}
