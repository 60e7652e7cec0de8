//! The arguments of `mdle locate`.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command, value_parser};

use crate::evidence::USUAL_POSE;

/// The arguments of `mdle locate`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Locate {
    /// Path of the record; `-` means standard input.
    pub(crate) log: PathBuf,
    /// Paths of the maps' YAML files.
    pub(crate) maps: Vec<PathBuf>,
    /// Pose near which the record began, as typed by the user, in the coordinates of each map.
    pub(crate) at: String,
}

impl Locate {
    /// Reads the arguments from the parsed command line.
    pub(super) fn of(matches: &ArgMatches) -> Self {
        Self {
            log: matches.get_one("log").cloned().unwrap_or_default(),
            maps: matches.get_many("maps").into_iter().flatten().cloned().collect(),
            at: matches.get_one("at").cloned().unwrap_or_default(),
        }
    }
}

/// Returns the definition of the command `mdle locate` and its arguments.
pub(super) fn locate() -> Command {
    let path = |name: &'static str| Arg::new(name).value_parser(value_parser!(PathBuf)).required(true);
    Command::new("locate")
        .about("Name the landmark at which a robot turned, by the maps of landmarks")
        .long_about(
            "Name the landmark at which a robot turned, by the maps of landmarks\n\nPrints a line for each map, the best \
             first: its name, the mean evidence for an echo, and the pose at which the record began in the axes of the map, \
             which is looked for up to 40 cm and 24 degrees off --at. The line says if the robot was not there: the evidence \
             is less than the map's least score, or the best pose is at the edge of the search.",
        )
        .arg(path("log").value_name("RECORD").help("Record of a full turn on the spot; `-` reads standard input"))
        .arg(path("maps").value_name("MAP.yaml").help("Maps that `mdle map` has made").num_args(1..))
        .arg(
            Arg::new("at")
                .long("at")
                .value_name("X,Y,DEG")
                .help("Pose near which the record began, in the axes of each map, in metres and degrees")
                .allow_hyphen_values(true)
                .default_value(USUAL_POSE),
        )
        .after_help("Exit status: 0; 1 if the robot was at none of the landmarks, or the record is damaged; 2 for wrong usage or a file that cannot be read")
}
