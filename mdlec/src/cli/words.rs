//! Reorders the words of the command line so that clap accepts them.

use std::env;
use std::ffi::OsString;

use clap::{Arg, Command};

/// Returns the words of this process's command line, in which global options that stand before the command have been
/// moved after it. Clap would refuse a command that follows such an option, because it expects a plan there.
pub(super) fn words(cli: &Command) -> Vec<OsString> {
    ordered(env::args_os().collect(), cli)
}

fn ordered(words: Vec<OsString>, cli: &Command) -> Vec<OsString> {
    let options: Vec<_> = cli.get_arguments().filter(|arg| arg.is_global_set()).filter_map(Arg::get_long).collect();
    let mut first = 1;
    while let Some(option) = words.get(first).and_then(|word| word.to_str()?.strip_prefix("--")) {
        match option.split_once('=') {
            Some((name, _)) if options.contains(&name) => first += 1,
            None if options.contains(&option) => first += 2,
            Some(_) | None => break,
        }
    }
    let is_word = words.get(first).is_some_and(|word| !word.to_string_lossy().starts_with('-'));
    let mut words = words;
    if first > 1
        && is_word
        && let Some(moved) = words.get_mut(1..=first)
    {
        moved.rotate_right(1);
    }
    words
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::super::Cli;
    use super::*;

    #[test]
    fn options_of_all_commands_may_come_first() {
        let cases = [
            ("mdlec --color never check a.mdle", "mdlec check --color never a.mdle"),
            ("mdlec --color=never --message-format json fmt -", "mdlec fmt --color=never --message-format json -"),
            ("mdlec --color never a.mdle --target sim", "mdlec a.mdle --color never --target sim"),
            ("mdlec check --color never a.mdle", "mdlec check --color never a.mdle"),
            ("mdlec --target sim a.mdle", "mdlec --target sim a.mdle"),
            ("mdlec --color", "mdlec --color"),
            ("mdlec --color never", "mdlec --color never"),
            ("mdlec --color never --help", "mdlec --color never --help"),
            ("mdlec", "mdlec"),
        ];
        let split = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        for (given, expected) in cases {
            assert_eq!(ordered(split(given), &Cli::command()), split(expected), "{given}");
        }
    }
}
