//! The arguments of `mdle run` and `mdle shell` for the plan and for its compilation.

use std::path::PathBuf;

use clap::{Arg, ArgAction, Command, value_parser};

use super::module_options::{module, point};

/// Adds the arguments for the plan and for its compilation to a command.
pub(super) fn with_plan(command: Command) -> Command {
    command
        .arg(
            Arg::new("file")
                .value_name("PLAN")
                .help("Plan to run, or a scenario of several robots (FILE.toml); `-` reads standard input")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("target")
                .long("target")
                .value_name("TARGET")
                .help("Robot to run on: atrv, scout or sim [default: the target of the `mdle.toml` beside the plan]"),
        )
        .arg(
            Arg::new("plan")
                .long("plan")
                .value_name("NAME")
                .help("Plan of the file to run [default: the only plan that no other plan uses]"),
        )
        .arg(
            Arg::new("safety")
                .long("safety")
                .value_name("FILE")
                .help("File of safety rules, which lie between the plan and the robot [default: none]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("link")
                .long("link")
                .value_name("FILE")
                .help("File of the link to other robots: their addresses, and a key [default: none]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("records").long("records").value_name("PATH").help(
                "Name of a path of the plan that the way back of each `path` and `Follow` replaces [default: none]",
            ),
        )
        .arg(
            Arg::new("module")
                .long("module")
                .value_name("NAME=COMMAND")
                .help("Child process to load as a module, which speaks lines of JSON; may be repeated")
                .action(ArgAction::Append)
                .value_parser(module),
        )
        .arg(
            Arg::new("point")
                .long("point")
                .value_name("X,Y")
                .help("Point to which the module `heading` publishes bearing and range, in metres or as in `3m,50cm`")
                .allow_hyphen_values(true)
                .value_parser(point),
        )
        .arg(
            Arg::new("deny-warnings").long("deny-warnings").action(ArgAction::SetTrue).help("Treat warnings as errors"),
        )
}
