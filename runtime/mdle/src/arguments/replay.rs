//! The arguments of `mdle replay`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

/// The arguments of `mdle replay`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Replay {
    /// Path of the record; `-` means standard input.
    pub(crate) log: PathBuf,
    /// Path of the plan's file; `None` to use the plan in the record.
    pub(crate) plan: Option<PathBuf>,
    /// Time of the last turn to replay, as typed by the user; `None` to replay all turns.
    pub(crate) until: Option<String>,
    /// `true` to step through the turns with commands.
    pub(crate) steps: bool,
    /// Path of the file with the step commands; `None` means standard input.
    pub(crate) commands: Option<PathBuf>,
}

impl Replay {
    /// Reads the arguments from the parsed command line.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        Self {
            log: matches.get_one("log").cloned().unwrap_or_default(),
            plan: matches.get_one("plan").cloned(),
            until: matches.get_one("until").cloned(),
            steps: matches.get_flag("step"),
            commands: matches.get_one("commands").cloned(),
        }
    }
}

/// Returns the definition of the command `mdle replay` and its arguments.
pub(crate) fn replay() -> Command {
    Command::new("replay")
        .about("Re-execute a recorded run and compare it with the record")
        .long_about(
            "Re-execute a recorded run and compare it with the record\n\nThe plan makes its turns again with the recorded \
             outputs of the robot. The first turn that differs in a bit is printed, with what differs.",
        )
        .arg(
            Arg::new("log")
                .value_name("LOG")
                .help("Record that `--log FILE.mcap` has written; `-` reads standard input")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("plan")
                .long("plan")
                .value_name("PLAN")
                .help("File of the plan to run [default: the text in the record]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("until")
                .long("until")
                .value_name("TIME")
                .help("Time of the last turn to make, in seconds or with a unit [default: that of the record]")
                .allow_hyphen_values(true),
        )
        .arg(
            Arg::new("step")
                .long("step")
                .action(ArgAction::SetTrue)
                .help("Show the turns one by one, forth and back, as commands ask for them; `help` lists these"),
        )
        .arg(
            Arg::new("commands")
                .short('c')
                .long("commands")
                .value_name("FILE")
                .requires("step")
                .help("File of commands [default: standard input]")
                .value_parser(value_parser!(PathBuf)),
        )
        .after_help(
            "Exit status: 0 if all turns are those of the record; 1 if a turn differs, the record was changed, or the plan has \
             errors or is not in its file; 2 for wrong usage or a file that cannot be read. With `--step` it is 1 also if \
             a command that was not typed was refused",
        )
}
