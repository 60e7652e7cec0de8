//! The arguments of `mdle plot`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::output_format;

/// The arguments of `mdle plot`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Plot {
    /// Path of the record; `-` means standard input.
    pub(crate) log: PathBuf,
    /// Path of the SVG file to write.
    pub(crate) file: PathBuf,
    /// Path of the plan's file; `None` to use the plan in the record.
    pub(crate) plan: Option<PathBuf>,
    /// `true` to draw a chart over time instead of the path.
    pub(crate) is_over_time: bool,
    /// Names of the signals in the chart.
    pub(crate) signals: Vec<String>,
}

impl Plot {
    /// Reads the arguments from the parsed command line.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let path = |name: &str| matches.get_one::<PathBuf>(name).cloned();
        let signals: Vec<String> = matches.get_many("signal").into_iter().flatten().cloned().collect();
        Self {
            log: path("log").unwrap_or_default(),
            file: path("file").unwrap_or_default(),
            plan: path("plan"),
            is_over_time: matches.get_flag("over-time") || !signals.is_empty(),
            signals,
        }
    }
}

/// Returns the definition of the command `mdle plot` and its arguments.
pub(crate) fn plot() -> Command {
    let path = |name: &'static str| Arg::new(name).value_parser(value_parser!(PathBuf));
    Command::new("plot")
        .about("Draw a recorded run as an SVG picture")
        .long_about(
            "Draw a recorded run as an SVG picture\n\nThe picture has the path by odometry in the colours of the atoms, the \
             places where they began, and the echoes of the sonars. With `--over-time` it has a band for each stay in an \
             atom, and signals as curves below.",
        )
        .arg(path("log").value_name("LOG").required(true).help("Record that `--log FILE.mcap` has written; `-` reads standard input"))
        .arg(
            Arg::new("file")
                .value_parser(output_format("SVG", "svg"))
                .value_name("FILE")
                .required(true)
                .help("SVG file to write, which must not exist"),
        )
        .arg(Arg::new("over-time").long("over-time").action(ArgAction::SetTrue).help("Draw atoms and signals over time"))
        .arg(
            Arg::new("signal")
                .long("signal")
                .value_name("NAME")
                .value_delimiter(',')
                .action(ArgAction::Append)
                .help("Signals to draw over time: v, omega, x, y, theta, battery, or r0 to r15"),
        )
        .arg(
            path("plan")
                .long("plan")
                .value_name("PLAN")
                .help("File of the plan that ran, for the record of an executable [default: the text in the record]"),
        )
        .after_help("Exit status: 0; 1 if the record was changed, or the plan has errors or is not that of the record; 2 for wrong usage or a \
             file that cannot be read or written",
        )
}
