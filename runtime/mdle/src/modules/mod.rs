//! The modules that come with `mdle`.

mod heading;
mod sensors;

use mdle_engine::Library;
use mdle_files::Settings;
use mdle_runtime::Sensed;

use crate::arguments::Run;
use heading::Heading;
use sensors::Sensors;

/// Name of the module that `--point` loads.
const HEADING: &str = "heading";

/// Adds the modules of every run.
pub(crate) fn shipped(library: &mut Library<Sensed>) {
    library.registered("sensors", Sensors::declare);
}

/// Adds the modules that the `mdle.toml` and the options name; an option replaces a module of the same name.
pub(crate) fn of_settings(settings: &Settings, Run { modules, point, .. }: &Run, library: &mut Library<Sensed>) {
    let is_replaced = |name: &str| modules.iter().any(|(other, _)| other == name) || point.is_some() && name == HEADING;
    settings
        .modules()
        .filter(|(name, _)| !is_replaced(name))
        .for_each(|(name, command)| library.process(name, command));
    if let Some(point) = *point {
        library.registered(HEADING, move |declare| Heading::declare(declare, point));
    }
    for (name, command) in modules {
        library.process(name, command);
    }
}
