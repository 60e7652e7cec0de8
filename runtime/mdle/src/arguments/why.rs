//! The arguments of `mdle why`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

/// The arguments of `mdle why`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Why {
    /// Path of the record; `-` means standard input.
    pub(crate) log: PathBuf,
    /// Path of the plan's file; `None` to use the plan in the record.
    pub(crate) plan: Option<PathBuf>,
    /// The question about the record.
    pub(crate) question: Question,
    /// `true` if the answer is JSON.
    pub(crate) is_json: bool,
}

/// A question about a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Question {
    /// Asks why the current atom ran at a certain time; contains the time, as typed by the user.
    At(String),
    /// Asks why an atom or behavior did not begin; contains the text that names it.
    Not(String),
}

impl Why {
    /// Reads the arguments from the parsed command line.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let text = |name: &str| matches.get_one::<String>(name).cloned();
        Self {
            log: matches.get_one("log").cloned().unwrap_or_default(),
            plan: matches.get_one("plan").cloned(),
            question: text("not").map_or_else(|| Question::At(text("time").unwrap_or_default()), Question::Not),
            is_json: matches.get_flag("json"),
        }
    }
}

/// Returns the definition of the command `mdle why` and its arguments.
pub(crate) fn why() -> Command {
    Command::new("why")
        .about("Explain what a recorded run did at a time, or why it did not do something")
        .override_usage("mdle why [OPTIONS] <LOG> <TIME>\n       mdle why [OPTIONS] <LOG> --not <ATOM>")
        .long_about(
            "Explain what a recorded run did at a time, or why it did not do something\n\nThe plan makes its turns again \
             with the recorded outputs of the robot. The answer has the condition of every scope around the atom with the \
             values of its operands, what each lacked, and the transition that came next.",
        )
        .arg(
            Arg::new("log")
                .value_name("LOG")
                .help("Record that `--log FILE.mcap` has written; `-` reads standard input")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("time")
                .value_name("TIME")
                .help("Time of the run, in seconds or with a unit, as in 12.3 or 2min")
                .required_unless_present("not")
                .allow_hyphen_values(true)
                .conflicts_with("not"),
        )
        .arg(Arg::new("not").long("not").value_name("ATOM").help(
            "Explain why this atom or behavior did not begin: a law, as in 'go 20 0', the name of a law or of a behavior, or a \
             line",
        ))
        .arg(
            Arg::new("plan")
                .long("plan")
                .value_name("PLAN")
                .help("File of the plan that ran, for the record of an executable [default: the text in the record]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print a JSON object"))
        .after_help(
            "Exit status: 0; 1 if the record was changed, or the plan has errors or is not that of the record; 2 for wrong \
             usage, a time outside the record, or a file that cannot be read",
        )
}
