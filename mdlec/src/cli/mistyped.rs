//! Recognizes misspelled commands, and options that only other commands have. The errors that clap reports for them are
//! less helpful.

use std::env;
use std::path::Path;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, CommandFactory as _};

use super::words::words;
use super::{Cli, CommandFailure};
use crate::link;
use mdle_compiler::{alphabet, builtin};

/// Names of commands, each with its synonyms.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("run", &["simulate", "start", "exec", "execute", "launch", "play"]),
    ("build", &["compile", "make"]),
    ("check", &["lint", "verify", "validate", "test"]),
    ("fmt", &["format", "indent"]),
    ("draw", &["plot", "picture", "graph", "render"]),
    ("quarks", &["laws", "interrupts", "signals", "atoms"]),
    ("targets", &["robots", "list"]),
    ("new-target", &["new", "init", "create"]),
    ("emulator", &["emulate"]),
];

/// Returns the error for a first argument that resembles a command and is not a file. Without this function, clap would
/// take such an argument for the file of a plan. Returns `None` for any other first argument.
pub(super) fn command() -> Option<CommandFailure> {
    let cli = Cli::command();
    let word = words(&cli).into_iter().nth(1).and_then(|word| word.into_string().ok());
    let word = word.filter(|word| !word.starts_with('-') && !word.contains(['.', '/']))?;
    let names: Vec<_> = cli.get_subcommands().map(Command::get_name).collect();
    if names.contains(&word.as_str()) || Path::new(&word).exists() {
        return None;
    }
    let meant = || SYNONYMS.iter().find(|(_, words)| words.contains(&word.as_str())).map(|(command, _)| *command);
    let near = meant().or_else(|| alphabet::nearest(&word, names.iter().copied()))?;
    Some(CommandFailure::usage(format!(
        "there is no command `{word}`; did you mean `mdlec {near}`?\nhelp: `mdlec --help` lists all commands"
    )))
}

/// Returns the error for an option that the given command does not have, but other commands have. `answer` is the error
/// of clap.
pub(super) fn option(answer: &clap::Error) -> Option<CommandFailure> {
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
    let owners = cli.get_subcommands();
    let owners: Vec<_> =
        owners.filter_map(|owner| Some((owner, owner.get_arguments().find(|arg| is_given(arg))?))).collect();
    let is_ambiguous = owners.windows(2).any(|pair| pair[0].1.get_value_names() != pair[1].1.get_value_names());
    let owner = |(owner, option): &(&Command, &Arg)| {
        let about = if is_ambiguous { format!(" ({})", meaning(option)) } else { String::new() };
        format!("`mdlec {}`{about}", owner.get_name())
    };
    let owners: Vec<_> = owners.iter().map(owner).collect();
    let owners = match owners.split_last() {
        Some((only, [])) => only.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        // An option of `mdlec` without a command, such as `--run`.
        None if cli.get_arguments().any(is_given) => {
            "`mdlec` without a command; `mdlec run PLAN` does the same".to_owned()
        }
        None => return None,
    };
    Some(CommandFailure::usage(format!(
        "`mdlec {command}` has no option `{given}`: it belongs to {owners}\nhelp: `mdlec {command} --help` lists the options"
    )))
}

/// Returns the help of an option as a phrase for the middle of a sentence, without its values and its default.
fn meaning(option: &Arg) -> String {
    let help = option.get_help().map(ToString::to_string).unwrap_or_default();
    let mut phrase = help.split([':', ';', '[']).next().unwrap_or_default().trim_end().to_owned();
    if let Some(first) = phrase.get_mut(..1) {
        first.make_ascii_lowercase();
    }
    phrase
}

/// Returns the error for a robot that is named without `--target`; `answer` is the error of clap.
pub(super) fn robot(answer: &clap::Error) -> Option<CommandFailure> {
    let (given, cli) = (unexpected(answer)?, Cli::command());
    let command = env::args().skip(1).find_map(|word| cli.find_subcommand(word))?;
    command.get_arguments().find(|argument| argument.get_long() == Some("target"))?;
    let robots = builtin::alphabets().iter().filter(|alphabet| alphabet.target).map(|alphabet| alphabet.name);
    let (name, robot) = (command.get_name(), alphabet::nearest(given, robots)?);
    Some(CommandFailure::usage(format!(
        "`mdlec {name}` does not expect `{given}` here\nhelp: a robot is named with an option: `--target {robot}`"
    )))
}

/// Returns the error for `mdlec emulator` with a robot that has no emulator; `answer` is the error of clap.
pub(super) fn emulator(answer: &clap::Error) -> Option<CommandFailure> {
    let Some(ContextValue::String(given)) = answer.get(ContextKind::InvalidValue) else { return None };
    let cli = Cli::command();
    let command = env::args().skip(1).find_map(|word| cli.find_subcommand(word))?;
    let is_robot = builtin::alphabets().iter().any(|alphabet| alphabet.target && alphabet.name == given);
    (command.get_name() == "emulator" && is_robot).then(|| {
        CommandFailure::usage(format!(
            "`{given}` has no emulator: it is simulated by each executable\nhelp: `mdlec run PLAN --target {given}` runs a \
             plan on it; emulators are for {}",
            link::emulators().collect::<Vec<_>>().join(" and ")
        ))
    })
}

/// Returns the argument that clap did not expect; `None` for other errors.
fn unexpected(answer: &clap::Error) -> Option<&str> {
    match answer.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(given)) if answer.kind() == ErrorKind::UnknownArgument => Some(given),
        Some(_) | None => None,
    }
}

/// Replaces clap's tip that an unknown option can be passed as a value. The tip is wrong here, because no option or
/// argument of mdlec has a value that looks like an option.
pub(super) fn with_tip(mut answer: clap::Error) -> clap::Error {
    let Some(given) = unexpected(&answer).filter(|given| given.starts_with('-')).map(str::to_owned) else {
        return answer;
    };
    let cli = Cli::command();
    let command = env::args().skip(1).find_map(|word| cli.find_subcommand(word));
    let letter = given.strip_prefix('-').filter(|rest| rest.chars().count() == 1);
    let mut longs = command.unwrap_or(&cli).get_arguments().filter_map(Arg::get_long);
    let long = letter.and_then(|letter| longs.find(|long| long.starts_with(letter)));
    let tip = match (command.map(Command::get_name), long) {
        (_, Some(long)) => Some(format!("the option is written '--{long}'")),
        (Some("fmt"), None) => Some("each file is rewritten in place, without an option".to_owned()),
        (Some("emulator"), None) => Some(format!("options of the emulator follow '--', as in '-- {given}'")),
        (Some("run") | None, None) => Some(format!("options of the executable follow '--', as in '-- {given}'")),
        (Some(_), None) => None,
    };
    let is_replaced = answer.remove(ContextKind::Suggested).is_some();
    if let Some(tip) = tip.filter(|_| is_replaced) {
        answer.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(tip)]));
    }
    answer
}
