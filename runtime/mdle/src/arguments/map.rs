//! The arguments of `mdle map`.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command, value_parser};

use crate::evidence::USUAL_POSE;

/// The arguments of `mdle map`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct MakeMap {
    /// Path of the record; `-` means standard input.
    pub(crate) log: PathBuf,
    /// Path of the YAML file to write. The image is written to the same folder.
    pub(crate) file: PathBuf,
    /// Pose of the robot at the start of the record, as typed by the user, in map coordinates.
    pub(crate) at: String,
    /// Path of a PNG file to write in addition; `None` if no PNG is requested.
    pub(crate) png: Option<PathBuf>,
}

impl MakeMap {
    /// Reads the arguments from the parsed command line.
    pub(super) fn of(matches: &ArgMatches) -> Self {
        let path = |name: &str| matches.get_one::<PathBuf>(name).cloned().unwrap_or_default();
        let at = matches.get_one::<String>("at").cloned().unwrap_or_default();
        Self { log: path("log"), file: path("file"), at, png: matches.get_one::<PathBuf>("png").cloned() }
    }
}

/// Returns the definition of the command `mdle map` and its arguments.
pub(super) fn map() -> Command {
    let path = |name: &'static str| Arg::new(name).value_parser(value_parser!(PathBuf)).required(true);
    Command::new("map")
        .about("Make the map of a place from the sonars of a recorded run")
        .long_about(
            "Make the map of a place from the sonars of a recorded run\n\nThe map is an evidence grid of 150 by 150 cells of \
             one inch around the origin of its axes, in the format of ROS: a YAML file and a grey image beside it, in which \
             black is occupied.",
        )
        .arg(path("log").value_name("RECORD").help("Record of a run; `-` reads standard input"))
        .arg(path("file").value_name("MAP.yaml").help("YAML file to write; the image is written beside it, as MAP.pgm"))
        .arg(
            Arg::new("at")
                .long("at")
                .value_name("X,Y,DEG")
                .help("Pose of the robot at the start of the record, in the axes of the map, in metres and degrees")
                .allow_hyphen_values(true)
                .default_value(USUAL_POSE),
        )
        .arg(
            Arg::new("png")
                .long("png")
                .value_name("FILE")
                .help("PNG to write as well, with the same image [default: none]")
                .value_parser(value_parser!(PathBuf)),
        )
        .after_help("Exit status: 0; 1 if the record is damaged, 2 for wrong usage or a file that cannot be read or written")
}
