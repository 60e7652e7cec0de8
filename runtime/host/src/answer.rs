//! Prints the output of an executable that makes no run: help, the answer that an option asks for, or an error in the
//! arguments.

use std::io::Write;

use clap::error::{ContextKind, ContextValue};
use mdle_runtime::PrintableLines;

use crate::run_end::{self, say};

/// Prints help, or the error in the arguments; returns the exit status.
pub(crate) fn unparsed<'o>(error: clap::Error, out: impl FnOnce() -> Box<dyn Write + 'o>, err: &mut dyn Write) -> u8 {
    let error = with_near_option(error);
    if error.use_stderr() {
        say(err, format_args!("{}", error.render().to_string().trim_end()));
        return run_end::USAGE;
    }
    print_answer(&error.render().to_string(), &mut *out())
}

/// Prints the answer that an option asks for instead of a run, and returns the exit status. Write errors are ignored,
/// because the reader may close the stream early.
pub(crate) fn print_answer(answer: &str, out: &mut dyn Write) -> u8 {
    let _ = write!(out, "{}", PrintableLines(answer)).and_then(|()| out.flush());
    run_end::OVER
}

/// Removes clap's proposal for an unknown option unless at most a third of the letters differ: `--period`, for example,
/// is no help for `--speed`, which only simulated robots have.
fn with_near_option(mut error: clap::Error) -> clap::Error {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.trim_start_matches('-').split('=').next().unwrap_or_default(),
        Some(_) | None => "",
    };
    let (given, proposed) = (text(ContextKind::InvalidArg), text(ContextKind::SuggestedArg));
    if !proposed.is_empty() && strsim::damerau_levenshtein(given, proposed) > (given.chars().count() / 3).max(1) {
        let _ = error.remove(ContextKind::SuggestedArg);
        let _ = error.remove(ContextKind::Usage);
    }
    error
}
