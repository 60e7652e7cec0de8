//! The parts of a target that have none of its types.

use std::any::TypeId;
use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::{Robot, Sensed, Twist};

use crate::{NamedFile, Refusal, Target, Time};

/// The parts of [`Target`] that have none of its types.
#[derive(Clone, Copy)]
pub(crate) struct TargetOptions {
    pub(crate) name: &'static str,
    pub(crate) period: Duration,
    pub(crate) arguments: fn(Command) -> Command,
    pub(crate) time: fn(&ArgMatches) -> Result<Time, String>,
    pub(crate) files: fn(&ArgMatches) -> Vec<NamedFile>,
    pub(crate) answer: fn(&ArgMatches) -> Result<Option<String>, Refusal>,
    pub(crate) accepts: fn(&ArgMatches, &[&str]) -> Result<(), Refusal>,
    /// Maximum speeds of a path; `None` if the target replays no paths.
    pub(crate) fastest: Option<Twist>,
    /// `true` if a record can hold the robot's outputs and inputs.
    pub(crate) records: bool,
    /// Returns `true` if the robot shows its run on standard output itself.
    pub(crate) screen: fn(&ArgMatches) -> bool,
    /// Gives the terminal back.
    pub(crate) leave_screen: fn(),
}

impl TargetOptions {
    /// Returns the options of the target `T`.
    pub(crate) fn of<T: Target>() -> Self {
        Self {
            name: T::NAME,
            period: T::PERIOD,
            arguments: T::arguments,
            time: T::time,
            files: T::files,
            answer: T::answer,
            accepts: T::accepts,
            fastest: T::PATHS.map(|replays| replays.fastest),
            records: TypeId::of::<<T::Robot as Robot>::Output>() == TypeId::of::<Sensed>()
                && TypeId::of::<<T::Robot as Robot>::Input>() == TypeId::of::<Twist>(),
            screen: |matches| T::OBSERVATION.is_some_and(|observation| (observation.screen)(matches)),
            leave_screen: T::OBSERVATION.map_or(|| {}, |observation| observation.leave_screen),
        }
    }
}
