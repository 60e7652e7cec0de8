//! The program `mdle`: compiles a plan, loads it, and runs it together with modules. Apart from the modules, it does
//! the same as an executable of `mdlec`.
//!
//! A program with additional modules calls [`main_with`]. mdlec builds the executables of scenarios with
//! [`scenario_files`] and [`run_scenario`], and executables that contain the engine with [`run_plan`].
#![forbid(unsafe_code)]

mod arguments;
mod elements_named;
mod embedded_plan;
mod evidence;
mod examined;
mod failure;
mod input_files;
mod link;
mod link_addresses;
mod link_text;
mod log;
mod manual;
mod map;
mod messages;
mod modules;
mod navigate;
mod new_module;
mod plans;
mod plot;
mod record;
mod recorded_files;
mod recorded_paths;
mod replay;
mod replayed;
mod replayer;
mod robot_name;
mod route;
mod run;
mod run_time;
mod safety;
mod scenario;
mod session;
mod step;
mod targets;
mod terminal;
mod test;
mod way_back;
mod way_recorder;
mod why;

use std::process::ExitCode;

use arguments::ParsedCommand;
pub use embedded_plan::{engine_targets, run_plan};
use failure::Failure;
pub use input_files::embeddable;
pub use link::{OpenRouter, RouterSettings};
pub use mdle_engine as engine;
use mdle_engine::Library;
pub use mdle_host::Program;
use mdle_runtime::Sensed;
pub use scenario::{is_scenario, run_scenario, scenario_files};

/// Runs the command line of this process. The exit status of a run is the same as for an executable; in addition, 1
/// means that the plan has errors, and 2 that the usage is wrong or a file cannot be read.
#[must_use]
pub fn main() -> ExitCode {
    main_with(|_| ())
}

/// Runs the command line of this process, as [`main`] does, with additional modules, which `add` registers. Each run
/// loads them after the module `sensors` and before the modules that options name.
#[must_use]
pub fn main_with(add: impl FnOnce(&mut Library<Sensed>)) -> ExitCode {
    main_as(add, None)
}

/// Runs the command line of this process, as [`main_with`] does. `open_router` opens links between robots that use a
/// router.
#[must_use]
pub fn main_with_router(add: impl FnOnce(&mut Library<Sensed>), open_router: OpenRouter) -> ExitCode {
    main_as(add, Some(open_router))
}

fn main_as(add: impl FnOnce(&mut Library<Sensed>), open_router: Option<OpenRouter>) -> ExitCode {
    let mut library = Library::new();
    modules::shipped(&mut library);
    add(&mut library);
    let arguments = std::env::args_os().collect();
    let run = |asked| match asked {
        ParsedCommand::Run(arguments) => run::run(*arguments, &mut library, open_router),
        ParsedCommand::Navigate(arguments) => navigate::navigate(arguments, &mut library),
        ParsedCommand::NewModule(arguments) => new_module::new_module(&arguments),
        ParsedCommand::Replay(arguments) => replay::replay(&arguments),
        ParsedCommand::Why(arguments) => why::why(&arguments),
        ParsedCommand::Log(arguments) => log::log(&arguments),
        ParsedCommand::Locate(arguments) => map::locate(&arguments),
        ParsedCommand::Map(arguments) => map::map(&arguments),
        ParsedCommand::Plot(arguments) => plot::plot(&arguments),
        ParsedCommand::Test(arguments) => test::test(&arguments, &library),
        ParsedCommand::Completions(shell) => manual::completions(shell),
        ParsedCommand::Man(words) => manual::man(&words),
    };
    arguments::parse(arguments).and_then(run).unwrap_or_else(Failure::tell)
}
