//! Values of a scenario file that are more than numbers: its world, the faults of its link, and paths.

use std::path::Path;
use std::time::Duration;

use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::link::Faults;
use mdle_host::{Quantity, Target as _, setpoints};
use mdle_runtime::{Nanos, Setpoint};
use mdle_sim::{Sim, World};

use super::file::{At, LinkText, RobotText, ScenarioError};
use crate::input_files::InputFiles;

/// Maximum size of a path file or a world file, in bytes.
const LARGEST: u64 = 10_000_000;

/// Returns the world that `text` describes by its name or its file, and the name of the world.
pub(super) fn world(text: Option<&At<String>>, files: &InputFiles) -> Result<(World, String), ScenarioError> {
    let Some(text) = text else {
        let world = World::parse("the empty floor", "");
        let world =
            world.map_err(|error| ScenarioError { place: None, message: error.to_string(), help: String::new() });
        return Ok((world?, "empty".to_owned()));
    };
    let refused = |message: String| ScenarioError::at(text.span(), message);
    let name = text.get_ref();
    let file = files.path.with_file_name(name);
    let world = match World::named(name).filter(|_| !files.exists(&file)) {
        Some(world) => world,
        None if !files.exists(&file) => {
            let worlds = World::names().collect::<Vec<_>>();
            let near = did_you_mean(name, &worlds);
            let message = format!("there is no world or file `{name}`{near}");
            return Err(refused(message).help(format!("the worlds are {}", worlds.join(", "))));
        }
        None => {
            let shown = file.display().to_string();
            let text =
                files.text(&file, LARGEST).map_err(|error| refused(format!("{shown} cannot be read: {error}")))?;
            World::parse(&shown, &text)
        }
    };
    let world = world.map_err(|error| {
        let message = error.to_string();
        let (message, help) = message.split_once("\nhelp: ").unwrap_or((&message, ""));
        refused(message.to_owned()).help(help)
    })?;
    if !world.things.is_empty() {
        return Err(refused("a world with things that move is for one robot".to_owned()).help("leave them out"));
    }
    Ok((world, name.clone()))
}

/// Returns the faults of the scenario's link.
pub(super) fn faults(text: &LinkText) -> Result<Faults, ScenarioError> {
    let share = |share: &Option<At<f64>>| {
        let Some(text) = share else { return Ok(0.0) };
        let is_share = (0.0..=1.0).contains(text.get_ref());
        is_share
            .then_some(*text.get_ref())
            .ok_or_else(|| ScenarioError::at(text.span(), "expected a number from 0 to 1"))
    };
    let latency = text.latency.as_ref().map(latency).transpose()?.unwrap_or_default();
    Ok(Faults { latency, loss: share(&text.loss)?, duplication: share(&text.duplication)? })
}

/// Parses a time, or a minimum and a maximum with `..` between them.
fn latency(text: &At<String>) -> Result<(Nanos, Nanos), ScenarioError> {
    let (least, most) = text.get_ref().split_once("..").unwrap_or((text.get_ref(), text.get_ref()));
    let time = |part: &str| {
        let read = Quantity::duration(part.trim(), "s", Duration::ZERO, Duration::from_secs(60));
        let read = read.map_err(|sentence| ScenarioError::at(text.span(), sentence));
        read.map(|time| Nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)))
    };
    let (least, most) = (time(least)?, time(most)?);
    if most < least {
        return Err(ScenarioError::at(text.span(), "the least latency comes first, as in `0ms..200ms`"));
    }
    Ok((least, most))
}

/// Returns the name of the path to record, which must be a path that the plan replays.
pub(super) fn recorded(text: &At<String>, replayed: &[&'static str]) -> Result<&'static str, ScenarioError> {
    let name = text.get_ref();
    replayed.iter().copied().find(|path| path == name).ok_or_else(|| {
        let near = did_you_mean(name, replayed);
        ScenarioError::at(text.span(), format!("the plan replays no path `{name}`{near}"))
    })
}

/// Reads the paths that a plan replays. The file of a path that the run records may be missing.
pub(super) fn paths(
    text: &RobotText,
    files: &InputFiles,
    names: &[&'static str],
    records: Option<&'static str>,
) -> Result<Vec<(&'static str, Vec<Setpoint>)>, ScenarioError> {
    let folder = files.named(text.paths.as_ref().map_or(Path::new(""), |own| own.get_ref()));
    let place = text.paths.as_ref().map_or(text.file.span(), At::span);
    let Some(fastest) = Sim::PATHS.map(|replays| replays.fastest) else { return Ok(Vec::new()) };
    let mut paths = Vec::new();
    for name in names {
        let file =
            folder.join(if Path::new(name).extension().is_some() { (*name).to_owned() } else { format!("{name}.csv") });
        if !files.exists(&file) && records == Some(name) {
            continue;
        }
        let shown = file.display().to_string();
        let bytes = files.read(&file, LARGEST).map_err(|error| {
            let message = format!("the path {shown} cannot be read: {error}");
            ScenarioError::at(place.clone(), message).help("the plan replays it; `paths = \"FOLDER\"` says where it is")
        })?;
        let read = setpoints(&shown, &bytes, fastest).map_err(|sentence| ScenarioError::at(place.clone(), sentence))?;
        paths.push((*name, read));
    }
    Ok(paths)
}
