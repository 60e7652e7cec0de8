//! `mdlec completions` and `mdlec man`: shell completions and manual pages of the command line.

use std::io;

use clap::CommandFactory as _;

use super::{Cli, CommandFailure, Completions, Man, report};
use mdle_compiler::alphabet::did_you_mean;

/// Prints the completions for a shell.
pub(super) fn completions(options: &Completions) -> Result<(), CommandFailure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Cli::command(), "mdlec", &mut script);
    report::print_exactly(&String::from_utf8_lossy(&script))
}

/// Prints the manual page of mdlec or of one of its commands.
pub(super) fn man(options: &Man) -> Result<(), CommandFailure> {
    let mut mdlec = Cli::command();
    mdlec.build();
    let page = match &options.command {
        None => mdlec,
        Some(name) => command(&mdlec, name)?.clone(),
    };
    let mut text = Vec::new();
    let page = clap_mangen::Man::new(page).source(concat!("mdlec ", env!("CARGO_PKG_VERSION")));
    page.render(&mut text).map_err(|error: io::Error| CommandFailure::usage(error.to_string()))?;
    report::print_exactly(&String::from_utf8_lossy(&text))
}

/// Returns the command with this name, or an error if there is none.
fn command<'c>(mdlec: &'c clap::Command, name: &str) -> Result<&'c clap::Command, CommandFailure> {
    mdlec.find_subcommand(name).ok_or_else(|| {
        let names: Vec<_> = mdlec.get_subcommands().map(clap::Command::get_name).collect();
        let near = did_you_mean(name, &names);
        CommandFailure::usage(format!(
            "there is no command `{name}`{near}\nhelp: the commands are {}",
            names.join(", ")
        ))
    })
}
