//! The command line of `mdlec`: runs the command that the arguments name, and returns its exit status.

mod analyze;
mod arguments;
mod bind;
mod build;
mod check;
mod clean;
mod compiled;
mod dap;
mod decompile;
mod draw;
mod each;
mod emit;
mod emulator;
mod endings;
mod engine;
mod everywhere;
mod executable;
mod explain;
mod fmt;
mod lists;
mod lsp;
mod manual;
mod matrices;
mod mistyped;
mod new_target;
mod progress;
mod report;
mod scenario;
mod trace;
mod version;
mod words;

use std::process::ExitCode;

use arguments::{
    Analyze, Bare, Bind, Build, CheckArguments, Cli, Color, Command, Completions, Decompile, Draw, EmulatorArguments,
    ExecutableArguments, Fmt, Man, MessageFormat, NewTarget, RunArguments, Trace, TraceMachine,
};
use clap::{CommandFactory as _, FromArgMatches as _, ValueEnum as _};
use emit::{Emit, EmitKind};
use mdle_compiler::diagnostic::{Diagnostic, Sources};
use mdle_files::{FaultyFile, InputError};

use crate::link::LinkError;

/// Message and exit status of a command that failed.
#[derive(Debug)]
struct CommandFailure {
    status: u8,
    /// Diagnostics of a file that was read, which are printed before the message.
    found: Option<Box<(Sources, Vec<Diagnostic>)>>,
    /// Message to print; `None` if it was printed already.
    message: Option<String>,
}

impl From<InputError> for CommandFailure {
    /// Converts an input error to a failure. The exit status is 1 for a plan with errors, and 2 for all other errors.
    fn from(error: InputError) -> Self {
        let message = Some(error.to_string()).filter(|message| !message.is_empty());
        let (status, found) = match error.faulty_file() {
            Some(FaultyFile { sources, diagnostics, target }) => {
                (if target.is_none() { 1 } else { 2 }, Some(Box::new((sources, diagnostics))))
            }
            None => (2, None),
        };
        Self { status, found, message }
    }
}

impl From<LinkError> for CommandFailure {
    fn from(error: LinkError) -> Self {
        Self::of(error.exit_status(), error.to_string())
    }
}

impl CommandFailure {
    /// Returns the failure for wrong usage, or for a file that cannot be read or written. The exit status is 2.
    fn usage(message: impl Into<String>) -> Self {
        Self::of(2, message)
    }

    /// Returns a failure with this message and exit status.
    fn of(status: u8, message: impl Into<String>) -> Self {
        Self { status, found: None, message: Some(message.into()) }
    }

    /// Returns a failure with this exit status and no message, for a command that has printed its errors.
    const fn silent(status: u8) -> Self {
        Self { status, found: None, message: None }
    }

    /// Failure for a plan with errors that have already been printed. The exit status is 1.
    const PLAN: Self = Self::silent(1);

    /// Prints the message, if there is one, and returns the exit status.
    fn print(&self) -> u8 {
        if let Some((sources, found)) = self.found.as_deref() {
            report::diagnostics(sources, found, false);
        }
        if let Some(message) = &self.message {
            report::error(message);
        }
        self.status
    }
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    let command = Cli::command().color(match color_of_help() {
        Color::Auto => clap::ColorChoice::Auto,
        Color::Always => clap::ColorChoice::Always,
        Color::Never => clap::ColorChoice::Never,
    });
    let parsed = command
        .clone()
        .try_get_matches_from(words::words(&command))
        .and_then(|matches| Cli::from_arg_matches(&matches));
    let done = match parsed {
        Ok(cli) => run(cli),
        Err(answer) => {
            let failure = mistyped::command()
                .or_else(|| mistyped::option(&answer))
                .or_else(|| mistyped::robot(&answer))
                .or_else(|| mistyped::emulator(&answer));
            match failure.filter(|_| answer.use_stderr()) {
                Some(failure) => Err(failure),
                None => report::answer(&mistyped::with_tip(answer)),
            }
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(failure.print()),
    }
}

/// Returns the argument of `--color`. This function is needed for help and for usage errors, because clap returns no
/// parsed arguments for them.
fn color_of_help() -> Color {
    let mut words = std::env::args().take_while(|word| word != "--").skip_while(|word| !word.starts_with("--color"));
    let value = words.next().and_then(|word| match word.split_once('=') {
        Some(("--color", value)) => Some(value.to_owned()),
        Some(_) => None,
        None => words.next(),
    });
    value.and_then(|value| Color::from_str(&value, false).ok()).unwrap_or(Color::Auto)
}

/// Runs the command of `cli`.
fn run(cli: Cli) -> Result<(), CommandFailure> {
    report::choose(cli.message_format, cli.color);
    match cli.command {
        None => match mistyped::command() {
            Some(failure) => Err(failure),
            None => build::bare(&cli.bare),
        },
        Some(Command::Build(options)) => build::build(&options).map(drop),
        Some(Command::Run(options)) => executable::run(&options),
        Some(Command::Check(check)) => check::check(&check),
        Some(Command::Fmt(fmt)) => fmt::fmt(&fmt),
        Some(Command::Trace(trace)) => trace::trace(&trace),
        Some(Command::Analyze(analyze)) => analyze::analyze(&analyze),
        Some(Command::Draw(draw)) => draw::draw(&draw),
        Some(Command::Decompile(decompile)) => decompile::decompile(&decompile),
        Some(Command::Explain(explain)) => explain::explain(explain.code.as_deref()),
        Some(Command::Targets) => lists::print_targets(),
        Some(Command::Bind(bind)) => bind::bind(&bind),
        Some(Command::NewTarget(new_target)) => new_target::new_target(&new_target),
        Some(Command::Emulator(emulator)) => emulator::emulator(&emulator),
        Some(Command::Clean) => clean::clean(),
        Some(Command::Completions(completions)) => manual::completions(&completions),
        Some(Command::Dap) => dap::dap(),
        Some(Command::Lsp) => lsp::lsp(),
        Some(Command::Man(man)) => manual::man(&man),
        Some(Command::Quarks(quarks)) => lists::print_quarks(quarks.target.as_deref()),
    }
}
