//! Recognizes misspelled commands, and options of other commands, which clap reports in another way.

use std::env;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, CommandFactory as _};

use super::words::words;
use super::{Cli, Failure};
use crate::alphabet;

/// Returns the error for a first argument that resembles a command and is not a file, so that clap took it for a plan.
pub(super) fn command() -> Option<Failure> {
    let cli = Cli::command();
    let word = words(&cli).into_iter().nth(1).and_then(|word| word.into_string().ok());
    let word = word.filter(|word| !word.starts_with('-') && !word.contains(['.', '/']))?;
    let names: Vec<_> = cli.get_subcommands().map(Command::get_name).collect();
    if names.contains(&word.as_str()) || Path::new(&word).exists() {
        return None;
    }
    let near = alphabet::nearest(&word, names.iter().copied())?;
    Some(Failure::usage(format!(
        "there is no command `{word}`; did you mean `mdlec {near}`?\nhelp: `mdlec --help` lists all commands"
    )))
}

/// Returns the error for an option of other commands than the given one; `answer` is the error of clap.
pub(super) fn option(answer: &clap::Error) -> Option<Failure> {
    let Some(ContextValue::String(given)) = answer.get(ContextKind::InvalidArg) else { return None };
    if answer.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let cli = Cli::command();
    let command = env::args().skip(1).find_map(|word| cli.find_subcommand(word))?.get_name();
    let is_given = |option: &Arg| {
        let long = option.get_long().is_some_and(|long| given.strip_prefix("--") == Some(long));
        long || option.get_short().is_some_and(|short| given.strip_prefix('-') == Some(short.encode_utf8(&mut [0; 4])))
    };
    let owners = cli.get_subcommands().filter(|command| command.get_arguments().any(is_given));
    let owners: Vec<_> = owners.map(|command| format!("`mdlec {}`", command.get_name())).collect();
    let owners = match owners.split_last() {
        Some((only, [])) => only.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        // Such as `--run`.
        None if cli.get_arguments().any(is_given) => {
            "`mdlec` without a command; `mdlec run PLAN` does the same".to_owned()
        }
        None => return None,
    };
    Some(Failure::usage(format!(
        "`mdlec {command}` has no option `{given}`: it belongs to {owners}\nhelp: `mdlec {command} --help` lists the options"
    )))
}
