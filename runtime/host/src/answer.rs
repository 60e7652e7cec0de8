//! Prints the output of an executable that makes no run: the help text, the answer to an option, or an error in the
//! arguments.

use std::io::{ErrorKind, Write};

use clap::error::{ContextKind, ContextValue};
use mdle_runtime::PrintableLines;

use crate::run_end::{self, say};

/// Prints the help text or the error in the arguments; returns the exit status.
pub(crate) fn unparsed<'o>(error: clap::Error, out: impl FnOnce() -> Box<dyn Write + 'o>, err: &mut dyn Write) -> u8 {
    let error = with_near_option(error);
    if error.use_stderr() {
        say(err, format_args!("{}", error.render().to_string().trim_end()));
        return run_end::USAGE;
    }
    print_answer(&error.render().to_string(), &mut *out(), err)
}

/// Prints the answer that an option requests instead of a run, and returns the exit status. A reader that closes the
/// stream early causes no error; any other write error, such as a full disk, is reported.
pub(crate) fn print_answer(answer: &str, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    match write!(out, "{}", PrintableLines(answer)).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            say(err, format_args!("error: standard output cannot be written: {error}"));
            run_end::FAULT
        }
        Ok(()) | Err(_) => run_end::OVER,
    }
}

/// Removes clap's suggestion for an unknown option if more than a third of the characters differ. For example,
/// `--period` would be a useless suggestion for `--speed`, an option that only simulated robots have.
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

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    /// A stream to which every write fails.
    struct Failing(ErrorKind);

    impl Write for Failing {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_answer_that_a_full_disk_loses_is_an_error() {
        let printed = |kind| {
            let mut err = Vec::new();
            let status = print_answer("speed = 1\n", &mut Failing(kind), &mut err);
            (status, String::from_utf8(err).unwrap())
        };
        let full = "error: standard output cannot be written: no storage space\n";
        assert_eq!(printed(ErrorKind::StorageFull), (run_end::FAULT, full.to_owned()));
        assert_eq!(printed(ErrorKind::BrokenPipe), (run_end::OVER, String::new()));
    }
}
