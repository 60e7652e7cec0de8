//! Environment and settings of a run.

use std::io::Write;
use std::time::Duration;

use clap::ArgMatches;
use mdle_runtime::PathStore;

use crate::Program;
use crate::arguments::SharedOptions;
use crate::call::Call;
use crate::cycle::RunLimits;
use crate::required::Required;
use crate::signals::Signals;
use crate::turn_watch::TurnWatch;

/// Environment of a run: time, signals and output. Tests provide their own environment.
pub(crate) struct Surroundings<'e, I, O> {
    /// Source of real time.
    pub(crate) instants: I,
    /// Signals that end the run.
    pub(crate) signals: Signals,
    /// Watchdog that limits the time of each turn.
    pub(crate) watch: TurnWatch,
    /// Function that opens standard output.
    pub(crate) out: O,
    /// Standard error.
    pub(crate) err: &'e mut dyn Write,
    /// Clock of the progress line of a fast run; `None` if standard error is not a terminal.
    pub(crate) elapsed: Option<Box<dyn FnMut() -> Duration + 'e>>,
}

/// Options of a run, and words for its reports.
pub(crate) struct RunSettings<'a> {
    /// Plan's name and version.
    pub(crate) program: Program<'a>,
    /// Words with which the program was called.
    pub(crate) call: &'a Call,
    /// All options, including the target's own options.
    pub(crate) matches: &'a ArgMatches,
    /// Options that all targets have.
    pub(crate) options: &'a SharedOptions,
}

impl RunSettings<'_> {
    /// Returns the limits of the run.
    pub(crate) fn limits(&self) -> RunLimits {
        RunLimits { timeout: self.options.timeout, turns: self.options.turns }
    }
}

/// Data of the plan, as far as the options determine them.
pub(crate) struct PlanData {
    /// Paths that the plan can replay.
    pub(crate) store: PathStore,
    /// Names of the paths in `store`.
    pub(crate) paths: Vec<&'static str>,
    /// Causes by which the plan must end.
    pub(crate) required: Required,
}
