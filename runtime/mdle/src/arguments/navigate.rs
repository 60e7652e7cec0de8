//! The arguments of `mdle navigate`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command, value_parser};

/// The arguments of `mdle navigate`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Navigate {
    /// Path of the graph: a file whose plans are the edges of the graph.
    pub(crate) graph: PathBuf,
    /// Landmark at which the robot begins.
    pub(crate) from: String,
    /// Destination landmark, preceded by the landmarks to pass on the way, separated by commas.
    pub(crate) to: String,
    /// Name or folder of the target; `None` for the target that the `mdle.toml` beside the graph names.
    pub(crate) target: Option<String>,
    /// Path of the landmark file; `None` for the file `landmarks.toml` beside the graph.
    pub(crate) landmarks: Option<PathBuf>,
    /// Program name and arguments of this call, without the options of the run.
    pub(crate) words: Vec<OsString>,
    /// The options of the run.
    pub(crate) options: Vec<OsString>,
}

impl Navigate {
    /// Reads the arguments from the parsed command line.
    pub(super) fn of(matches: &ArgMatches, words: Vec<OsString>, options: Vec<OsString>) -> Self {
        let text = |name: &str| matches.get_one::<String>(name).cloned();
        let path = |name: &str| matches.get_one::<PathBuf>(name).cloned();
        Self {
            graph: path("graph").unwrap_or_default(),
            from: text("from").unwrap_or_default(),
            to: text("to").unwrap_or_default(),
            target: text("target"),
            landmarks: path("landmarks"),
            words,
            options,
        }
    }
}

/// Returns the definition of the command `mdle navigate` and its arguments.
pub(super) fn navigate() -> Command {
    let path = |name: &'static str| Arg::new(name).value_parser(value_parser!(PathBuf));
    Command::new("navigate")
        .about("Drive from one landmark to another, by the plans of a graph")
        .long_about(
            "Drive from one landmark to another, by the plans of a graph\n\nA plan with the label `Γ_a^b` is an edge from the \
             landmark `a` to the landmark `b`. The route has as few edges as possible. The options of the run follow the \
             landmarks: `mdle run GRAPH --target sim --help` lists them.",
        )
        .override_usage("mdle navigate [OPTIONS] <GRAPH> <FROM> <TO> [OPTIONS OF THE RUN]")
        .arg(path("graph").value_name("GRAPH").help("File of plans whose labels name landmarks").required(true))
        .arg(Arg::new("from").value_name("FROM").help("Landmark at which the robot is").required(true))
        .arg(Arg::new("to").value_name("TO").help("Landmark to which the robot is to go; several are visited in order, as `a,b,c`").required(true))
        .arg(
            Arg::new("target")
                .long("target")
                .value_name("TARGET")
                .help("Robot to run on [default: the target of the `mdle.toml` beside the graph]"),
        )
        .arg(
            path("landmarks")
                .long("landmarks")
                .value_name("FILE")
                .help("File of the landmarks' frames [default: the `landmarks.toml` beside the graph]"),
        )
        .after_help(
            "Exit status: that of the run; 1 if there is no route, the graph has errors, or a plan on the route never ends; 2 for wrong usage or \
             a file that cannot be read; 3 if a plan on the route was ended by its own condition, as by the bumper",
        )
}
