//! The options `--map` and `--map-at` of `mdle run` and `mdle shell`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command, value_parser};

use crate::evidence::USUAL_POSE;

/// Names of the options.
pub(super) const OPTIONS: [&str; 2] = ["--map", "--map-at"];

/// The map to create in a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MapOption {
    /// Path of the YAML file to write.
    pub(crate) file: PathBuf,
    /// Pose of the robot at the start of the run, as typed by the user, in map coordinates.
    pub(crate) at: String,
}

impl MapOption {
    /// Returns the map that the parsed command line requests; `None` if it requests no map.
    pub(super) fn of(matches: &ArgMatches) -> Option<Self> {
        let at = matches.get_one::<String>("map-at").map_or(USUAL_POSE, String::as_str).to_owned();
        matches.get_one::<PathBuf>("map").map(|file| Self { file: file.clone(), at })
    }
}

/// Adds the options `--map` and `--map-at` to `command`.
pub(super) fn with_map(command: Command) -> Command {
    let map = Arg::new("map")
        .long("map")
        .value_name("MAP.yaml")
        .help("YAML file for a map of the place, made while the robot drives, with MAP.pgm and MAP.png [default: none]")
        .value_parser(value_parser!(PathBuf));
    let at = Arg::new("map-at")
        .long("map-at")
        .value_name("X,Y,DEG")
        .help(format!(
            "Pose of the robot at the start, in the axes of the map, in metres and degrees [default: {USUAL_POSE}]"
        ))
        .allow_hyphen_values(true)
        .requires("map");
    command.args([map, at])
}

/// Removes `--map` and `--map-at` from the words of a command line, because a repetition of the run must not save the
/// map again.
pub(super) fn without_map(words: Vec<OsString>) -> Vec<OsString> {
    let mut words = words.into_iter();
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        let name = text.split_once('=').map_or(&*text, |(name, _)| name);
        if !OPTIONS.contains(&name) {
            kept.push(word);
        } else if name == text {
            // Skips the value of the option.
            words.next();
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_left_without_the_map() {
        let words = |line: &str| line.split(' ').map(OsString::from).collect::<Vec<_>>();
        let kept = without_map(words("mdle run a.mdle --map m.yaml --point 1,2 --map-at=0,0,0 --map-at -1,0,0"));
        assert_eq!(kept, words("mdle run a.mdle --point 1,2"));
    }
}
