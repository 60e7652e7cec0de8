//! The arguments of `mdle log`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

/// The arguments of `mdle log`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Log {
    /// `mdle log info`; contains the path of the record.
    Info(PathBuf),
    /// `mdle log cut`; contains the path of the record, the time of the last turn, and the path of the new record.
    Cut(PathBuf, String, PathBuf),
    /// `mdle log export`.
    Export {
        /// Path of the record.
        log: PathBuf,
        /// `Some` to write a script instead of a table. Contains the path of the plan's file, if the record does not
        /// contain the plan.
        script: Option<Option<PathBuf>>,
        /// Path of the file to write; `None` means standard output.
        file: Option<PathBuf>,
    },
}

impl Log {
    /// Reads the arguments from the parsed command line.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let path = |matches: &ArgMatches, name: &str| matches.get_one::<PathBuf>(name).cloned().unwrap_or_default();
        match matches.subcommand() {
            Some(("cut", cut)) => {
                let time = cut.get_one::<String>("time").cloned().unwrap_or_default();
                Self::Cut(path(cut, "log"), time, path(cut, "file"))
            }
            Some(("export", export)) => Self::Export {
                log: path(export, "log"),
                script: export.get_flag("script").then(|| export.get_one("plan").cloned()),
                file: export.get_one("file").cloned(),
            },
            Some((_, info)) => Self::Info(path(info, "log")),
            None => Self::Info(PathBuf::new()),
        }
    }
}

/// Returns the definition of the command `mdle log` and its arguments.
pub(crate) fn log() -> Command {
    let log = || {
        Arg::new("log")
            .value_name("LOG")
            .help("Record that `--log FILE.mcap` has written; `-` reads standard input")
            .required(true)
            .value_parser(value_parser!(PathBuf))
    };
    let file = |help: &'static str| Arg::new("file").value_name("FILE").help(help).value_parser(value_parser!(PathBuf));
    let info = Command::new("info").about("Print what a record contains").arg(log());
    let cut = Command::new("cut")
        .about("Write the first part of a record as a record of its own")
        .long_about(
            "Write the first part of a record as a record of its own\n\nIt can be replayed and explained as the whole one. A \
             part begins with the run, because the state of a plan depends on all turns before.",
        )
        .arg(log())
        .arg(
            Arg::new("time")
                .value_name("TIME")
                .help("Time of the last turn, in seconds or with a unit, as in 12.3 or 2min")
                .allow_hyphen_values(true)
                .required(true),
        )
        .arg(file("File of the new record, which must not exist").required(true));
    let export = Command::new("export")
        .about("Write the turns of a record as a table, or as a script")
        .override_usage("mdle log export --csv [OPTIONS] <LOG>\n       mdle log export --script [OPTIONS] <LOG>")
        .arg(log())
        .arg(
            Arg::new("csv")
                .long("csv")
                .action(ArgAction::SetTrue)
                .required_unless_present("script")
                .conflicts_with("script")
                .help("Write a line for each turn as CSV"),
        )
        .arg(Arg::new("script").long("script").action(ArgAction::SetTrue).help(
            "Write the interrupts that have fired and the laws that have completed, for `mdlec trace` and the debugger",
        ))
        .arg(
            Arg::new("plan")
                .long("plan")
                .value_name("FILE")
                .requires("script")
                .value_parser(value_parser!(PathBuf))
                .help("File of the plan, if the record is that of an executable"),
        )
        .arg(file("File to write, which must not exist [default: standard output]").short('o').long("output"));
    Command::new("log")
        .about("Inspect, cut and export a recorded run")
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(info)
        .subcommand(cut)
        .subcommand(export)
        .after_help(
            "Exit status: 0; 1 if the record was changed, or the plan has errors or is not that of the record; 2 for wrong usage \
             or a file that cannot be read or written",
        )
}
