//! `mdle completions` and `mdle man`: print shell completions and manual pages.

use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

use clap::Command;
use clap_complete::Shell;
use mdle_compiler::alphabet::did_you_mean;

use crate::arguments::command;
use crate::failure::Failure;

/// Prints the completions for a shell.
pub(crate) fn completions(shell: Shell) -> Result<ExitCode, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command(), "mdle", &mut script);
    print(&script)
}

/// Prints the manual page of `mdle`, or of the command that these words name.
pub(crate) fn man(words: &[String]) -> Result<ExitCode, Failure> {
    let mut mdle = command();
    mdle.build();
    let page = words.iter().try_fold(&mdle, |command, word| subcommand(command, word))?.clone();
    let mut text = Vec::new();
    let page = clap_mangen::Man::new(page).source(concat!("mdle ", env!("CARGO_PKG_VERSION")));
    page.render(&mut text).map_err(|error| Failure::Usage(error.to_string()))?;
    print(&text)
}

/// Returns the subcommand `name` of `command`.
fn subcommand<'c>(command: &'c Command, name: &str) -> Result<&'c Command, Failure> {
    command.find_subcommand(name).ok_or_else(|| {
        let names: Vec<_> = command.get_subcommands().map(Command::get_name).collect();
        let (of, near) = (command.get_bin_name().unwrap_or("mdle"), did_you_mean(name, &names));
        let help = if names.is_empty() { format!("`{of}` has none") } else { format!("they are {}", names.join(", ")) };
        Failure::Usage(format!("`{of}` has no command `{name}`{near}\nhelp: {help}"))
    })
}

/// Prints a text to standard output. A closed pipe is not an error.
fn print(text: &[u8]) -> Result<ExitCode, Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Usage(format!("standard output cannot be written: {error}")))
        }
        Ok(()) | Err(_) => Ok(ExitCode::SUCCESS),
    }
}
