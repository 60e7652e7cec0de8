//! The modules that come with `mdle`.

mod heading;
mod sensors;

use mdle_engine::Library;
use mdle_runtime::Sensed;

use crate::arguments::Run;
use heading::Heading;
use sensors::Sensors;

/// Adds the modules of every run.
pub(crate) fn shipped(library: &mut Library<Sensed>) {
    library.registered("sensors", Sensors::declare);
}

/// Adds the modules that options name.
pub(crate) fn of_options(Run { modules, point, .. }: &Run, library: &mut Library<Sensed>) {
    if let Some(point) = *point {
        library.registered("heading", move |declare| Heading::declare(declare, point));
    }
    for (name, command) in modules {
        library.process(name, command);
    }
}
