//! The views of a run that the options of every executable request: the live view, two pictures and the table of poses.
//! A target that knows its world shows these views itself; for all other targets, the host creates them from the
//! robot's odometry.

mod by_odometry;

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command};

pub(crate) use by_odometry::ByOdometry;

use crate::output_format::output_format;
use crate::patience::Patience;
use crate::target_options::TargetOptions;
use crate::watch::{WATCH, is_asked_for};
use crate::whole_file::WholeFile;
use crate::{NamedFile, Refusal};

/// Names of the options that name files of views, each without and with dashes.
const FILES: [(&str, &str); 3] = [("plot", "--plot"), ("record", "--record"), ("trail", "--trail")];

/// Adds the options of the views, which every executable has, to `command`.
#[must_use]
pub fn view_options(command: Command) -> Command {
    let file = |name, value| Arg::new(name).long(name).value_name(value);
    command
        .arg(
            Arg::new(WATCH)
                .long(WATCH)
                .action(ArgAction::SetTrue)
                .help("Show the robot on its floor, the running atom and the timers in this terminal"),
        )
        .arg(
            file("plot", "FILE.svg")
                .help("Picture of the run: walls or echoes, trail, start of each atom, contacts")
                .value_parser(output_format("SVG", "svg")),
        )
        .arg(
            file("record", "FILE.svg")
                .help("Animated picture of the run, for a browser")
                .value_parser(output_format("SVG", "svg")),
        )
        .arg(
            file("trail", "FILE.csv")
                .help("File for the pose in each turn: seconds, metres, degrees")
                .value_parser(output_format("CSV", "csv")),
        )
}

/// Returns the files that the options of the views name.
pub(crate) fn files(matches: &ArgMatches) -> impl Iterator<Item = NamedFile> {
    FILES.into_iter().filter_map(|(name, option)| {
        let path = matches.get_one::<PathBuf>(name)?.clone();
        Some(NamedFile { option, path, is_written: true })
    })
}

/// Returns the views that the options request; `None` if the target shows them itself or no view is requested.
///
/// # Errors
/// Fails if the robot has no known odometry, if a file cannot be written, or if there is no terminal.
pub(crate) fn by_odometry(
    target: &TargetOptions,
    matches: &ArgMatches,
    patience: &Patience,
) -> Result<Option<ByOdometry>, Refusal> {
    let watched = is_asked_for(matches).then_some("--watch");
    let Some(option) = watched.or_else(|| files(matches).next().map(|file| file.option)) else { return Ok(None) };
    if target.draws {
        return Ok(None);
    }
    if !target.has_odometry {
        return Err(Refusal::Usage(format!(
            "{option}: the robot {} has outputs of a type of its own, without the odometry by which a run is drawn; \
             leave {option} out",
            target.name
        )));
    }
    let file = |name| matches.get_one::<PathBuf>(name).map(|path| WholeFile::at(name, path)).transpose();
    let plot = || ByOdometry::new(target.name, matches, file("plot")?, file("record")?, file("trail")?, patience);
    plot().map(Some).map_err(Refusal::Usage)
}
