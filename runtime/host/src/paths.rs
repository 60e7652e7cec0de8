//! Reads the paths that the plan of a run replays, before the robot moves. Also records the path that the robot drives.

mod record;
#[cfg(test)]
mod tests;
mod text;

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Arg, ArgMatches, Command, value_parser};
use mdle_runtime::{PathStore, Setpoint, StoredPath, Twist};

pub(crate) use record::PathRecording;
use text::{APART, TextFault};

use crate::Refusal;
use crate::files::read_file;
use crate::output_format::output_format;
use crate::target_options::TargetOptions;

/// Maximum size of a path file, in bytes; at ten rows per second, such a file contains about eleven hours.
const LARGEST: u64 = 10_000_000;

/// Adds the options of a target that replays paths to `command`.
pub(crate) fn arguments(command: Command) -> Command {
    let option = |name, value| Arg::new(name).long(name).value_name(value);
    command
        .arg(
            option("paths", "FOLDER")
                .help("Folder of the paths that the plan replays [default: the current folder]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("record-path", "FILE.csv")
                .help("File for the headings and speeds driven, as a path that a plan can replay")
                .value_parser(output_format("CSV", "csv")),
        )
}

/// Returns the file that the option `--record-path` names.
pub(crate) fn recording(target: &TargetOptions, matches: &ArgMatches) -> Option<PathBuf> {
    target.fastest.and_then(|_| matches.get_one("record-path").cloned())
}

/// Checks that turns are short enough for recording a path.
///
/// # Errors
/// Fails if the turns are too long, because the path could not be replayed.
pub(crate) fn check_period(period: Duration) -> Result<(), Refusal> {
    if period <= APART {
        return Ok(());
    }
    let (apart, period) = (APART.as_secs_f64(), period.as_secs_f64());
    let sentence = format!("--record-path: a path has a row every {apart} s at least, and a turn takes {period} s");
    Err(Refusal::Usage(format!("{sentence}; choose a shorter --period")))
}

/// Reads the paths that a plan replays. The path with the name `later` may have no file yet.
///
/// # Errors
/// Fails if a file is missing or contains no path, or if its path is too fast for the robot. The message contains the
/// file, the position in the file, and the reason.
pub(crate) fn load(
    target: &TargetOptions,
    matches: &ArgMatches,
    names: &[&'static str],
    later: Option<&str>,
) -> Result<PathStore, Refusal> {
    if names.is_empty() {
        return Ok(PathStore::EMPTY);
    }
    let Some(fastest) = target.fastest else {
        return Err(Refusal::Usage(format!(
            "the plan replays paths, and the crate of the robot {} does not say how: it needs `Target::PATHS`",
            target.name
        )));
    };
    let folder = matches.get_one::<PathBuf>("paths").map(PathBuf::as_path);
    let names = names.iter().copied().filter(|name| later != Some(name) || place(folder, name).exists());
    let names: Vec<_> = names.collect();
    // A robot that records all paths that it replays needs no folder when it begins.
    if let Some(folder) = folder.filter(|folder| !folder.is_dir() && (folder.exists() || !names.is_empty())) {
        return Err(Refusal::Usage(format!("--paths {}: there is no such folder", folder.display())));
    }
    let read = |name| read(folder, name, fastest).map(|setpoints| (name, setpoints)).map_err(Refusal::Usage);
    let paths: BTreeMap<&'static str, Vec<Setpoint>> = names.into_iter().map(read).collect::<Result<_, _>>()?;
    let stored = paths.into_iter().map(|(name, setpoints)| StoredPath { name, setpoints: setpoints.leak() });
    Ok(PathStore::new(stored.collect::<Vec<_>>().leak()))
}

/// Returns the files that contain the paths that a plan replays.
pub(crate) fn files(matches: &ArgMatches, names: &[&'static str]) -> impl Iterator<Item = PathBuf> {
    // A robot that replays no paths does not have this option.
    let folder = if names.is_empty() { None } else { matches.get_one::<PathBuf>("paths").cloned() };
    names.iter().map(move |name| place(folder.as_deref(), name))
}

/// Returns the file of the path `name` of a plan. A name without an ending gets the ending `csv`.
fn place(folder: Option<&Path>, name: &str) -> PathBuf {
    let file = if Path::new(name).extension().is_some() { name.to_owned() } else { format!("{name}.csv") };
    folder.map_or_else(|| PathBuf::from(&file), |folder| folder.join(&file))
}

/// Reads the path `name` of a plan.
fn read(folder: Option<&Path>, name: &str, fastest: Twist) -> Result<Vec<Setpoint>, String> {
    let place = place(folder, name);
    let shown = place.display();
    let bytes = read_file(&place, LARGEST).map_err(|error| match (error.kind(), folder) {
        (ErrorKind::NotFound, None) => format!(
            "there is no file `{shown}` in the current folder, and the plan replays its path; \
             `--paths FOLDER` says where it is"
        ),
        (ErrorKind::NotFound, Some(_)) => {
            format!("there is no file `{shown}`, and the plan replays its path; does --paths name the right folder?")
        }
        _ => format!("the path {shown} cannot be read: {error}; expected a CSV file"),
    })?;
    setpoints(&shown.to_string(), &bytes, fastest)
}

/// Parses a path file into setpoints for a robot with the maximum speeds `fastest`. Error messages call the file
/// `file`.
///
/// # Errors
/// Returns a message with the error in the path, and its position.
pub fn setpoints(file: &str, bytes: &[u8], fastest: Twist) -> Result<Vec<Setpoint>, String> {
    let read = text::utf8(bytes).and_then(|text| text::setpoints(text, fastest));
    read.map_err(|TextFault { place, what }| match place {
        Some((line, column)) => format!("{file}:{line}:{column}: {what}"),
        None => format!("{file}: {what}"),
    })
}
