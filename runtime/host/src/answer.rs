//! Prints the output of an executable that makes no run: the help text, the answer to an option, or an error in the
//! arguments.

use std::io::{ErrorKind, Write};

use clap::error::{ContextKind, ContextValue};
use mdle_quantity::nearest;
use mdle_runtime::PrintableLines;

use crate::run_end::{self, say};

/// Prints the help text or the error in the arguments; returns the exit status. `others` are the options that the
/// program has parsed itself.
pub(crate) fn unparsed<'o>(
    error: clap::Error,
    others: &[String],
    out: impl FnOnce() -> Box<dyn Write + 'o>,
    err: &mut dyn Write,
) -> u8 {
    let error = with_near_option(error, others);
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

/// Replaces clap's suggestion for an unknown option if an option of `others` is nearer. Removes it if more than a third
/// of the characters differ. For example, `--period` would be a useless suggestion for `--speed`, an option that only
/// simulated robots have.
fn with_near_option(mut error: clap::Error, others: &[String]) -> clap::Error {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.split('=').next().and_then(|name| name.strip_prefix("--")),
        Some(_) | None => None,
    };
    let is_unknown = error.kind() == clap::error::ErrorKind::UnknownArgument;
    let Some(given) = text(ContextKind::InvalidArg).filter(|_| is_unknown) else { return error };
    let proposed = text(ContextKind::SuggestedArg);
    let near = nearest(given, others.iter().filter_map(|other| other.strip_prefix("--")).chain(proposed));
    if near == proposed {
        return error;
    }
    let near = near.map(|near| ContextValue::String(format!("--{near}")));
    let _ = error.remove(ContextKind::Usage);
    let _ = error.remove(ContextKind::SuggestedArg);
    if let Some(near) = near {
        let _ = error.insert(ContextKind::SuggestedArg, near);
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
