//! The modules that come with `mdle`.

mod audio;
mod ears;
mod heading;
mod map;
mod sensors;

use mdle_engine::Library;
use mdle_files::{NamedProcess, Settings};
use mdle_host::Microphones;
use mdle_runtime::Sensed;

use crate::arguments::RunArguments;
use crate::failure::Failure;
pub(crate) use audio::AudioSource;
use ears::EarsModule;
use heading::Heading;
pub(crate) use map::{MapRun, Saved};
use sensors::Sensors;

/// Name of the module that `--point` and `--ears` load.
pub(crate) const HEADING: &str = "heading";

/// Registers the modules of every run.
pub(crate) fn shipped(library: &mut Library<Sensed>) {
    library.registered("sensors", Sensors::declare);
}

/// Registers the modules that the `mdle.toml` and the options name. If both name a module with the same name, the
/// option's module is used.
///
/// # Errors
/// Fails if a name in the `mdle.toml` is not a module name, or is already taken.
pub(crate) fn of_settings(
    settings: &Settings,
    arguments: &RunArguments,
    library: &mut Library<Sensed>,
) -> Result<(), Failure> {
    let RunArguments { modules, point, .. } = arguments;
    for NamedProcess { place, name, command } in only_of_settings(settings, arguments) {
        library.admits(name).map_err(|refusal| Failure::Usage(format!("{place}: {refusal}")))?;
        library.process(name, command);
    }
    if let Some(point) = *point {
        library.registered(HEADING, move |declare| Heading::declare(declare, point));
    }
    for (name, command) in modules {
        library.process(name, command);
    }
    Ok(())
}

/// Returns the modules that the `mdle.toml` names and that no option replaces.
pub(crate) fn only_of_settings<'s>(
    settings: &'s Settings,
    arguments: &RunArguments,
) -> impl Iterator<Item = NamedProcess<'s>> {
    let RunArguments { modules, point, ears, .. } = arguments;
    let is_replaced = move |name: &str| {
        modules.iter().any(|(other, _)| other == name) || (point.is_some() || ears.is_some()) && name == HEADING
    };
    settings.modules().filter(move |module| !is_replaced(module.name))
}

/// The sound of a run, and the radius, in metres, of the head with the two ears.
#[derive(Debug, Clone)]
pub(crate) struct SoundInput {
    pub(crate) source: AudioSource,
    pub(crate) radius: f64,
}

impl SoundInput {
    /// Returns `library` with the module `heading`, which listens to the run's sound.
    pub(crate) fn added(&self, library: &Library<Sensed>, microphones: &Microphones) -> Library<Sensed> {
        let mut library = library.clone();
        let Self { source, radius } = self.clone();
        if let AudioSource::Robot = source {
            microphones.listen(radius);
        }
        let microphones = microphones.clone();
        library.background(HEADING, move |declare| EarsModule::declare(declare, source.begin(&microphones), radius));
        library
    }
}
