//! The arguments of `mdle completions` and `mdle man`.

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use clap_complete::Shell;

/// Returns the definition of the command `mdle completions` and its arguments.
pub(crate) fn completions() -> Command {
    Command::new("completions")
        .about("Print a script that completes the commands and options of mdle in a shell")
        .long_about(
            "Print a script that completes the commands and options of mdle in a shell\n\nFor bash: `mdle completions bash > \
             ~/.local/share/bash-completion/completions/mdle`.",
        )
        .arg(
            Arg::new("shell")
                .value_name("SHELL")
                .help("Shell to write the script for")
                .required(true)
                .value_parser(value_parser!(Shell)),
        )
}

/// Returns the shell for which completions are requested.
pub(crate) fn shell(matches: &ArgMatches) -> Shell {
    matches.get_one("shell").copied().unwrap_or(Shell::Bash)
}

/// Returns the definition of the command `mdle man` and its arguments.
pub(crate) fn man() -> Command {
    Command::new("man")
        .about("Print the manual page of mdle or of a command")
        .long_about(
            "Print the manual page of mdle or of a command\n\nThe format is roff: `mdle man log cut > mdle.1`, then `man \
             ./mdle.1`.",
        )
        .arg(
            Arg::new("command")
                .value_name("COMMAND")
                .help("Words of the command to describe [default: mdle itself]")
                .action(ArgAction::Append)
                .num_args(0..),
        )
}

/// Returns the words of the command whose manual page is requested.
pub(crate) fn words(matches: &ArgMatches) -> Vec<String> {
    matches.get_many("command").into_iter().flatten().cloned().collect()
}
