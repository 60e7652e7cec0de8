//! The parts of a target that do not depend on its types.

use std::any::TypeId;
use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::{Robot, Sensed, Twist};

use crate::{NamedFile, Refusal, Target, Time};

/// The parts of [`Target`] that do not depend on its types.
#[derive(Clone, Copy)]
pub(crate) struct TargetOptions {
    pub(crate) name: &'static str,
    pub(crate) period: Duration,
    pub(crate) arguments: fn(Command) -> Command,
    pub(crate) time: fn(&ArgMatches) -> Result<Time, String>,
    pub(crate) files: fn(&ArgMatches) -> Vec<NamedFile>,
    pub(crate) answer: fn(&ArgMatches) -> Result<Option<String>, Refusal>,
    pub(crate) accepts: fn(&ArgMatches, &[&str]) -> Result<(), Refusal>,
    /// Maximum speeds of a path; `None` if the target does not replay paths.
    pub(crate) fastest: Option<Twist>,
    /// `true` if a record can contain the robot's outputs and inputs.
    pub(crate) records: bool,
    /// `true` if the robot's outputs contain the odometry that views of a run show.
    pub(crate) has_odometry: bool,
    /// `true` if the robot shows and draws its run itself.
    pub(crate) draws: bool,
}

impl TargetOptions {
    /// Returns the options of the target `T`.
    pub(crate) fn of<T: Target>() -> Self {
        let has_odometry = TypeId::of::<<T::Robot as Robot>::Output>() == TypeId::of::<Sensed>();
        Self {
            name: T::NAME,
            period: T::PERIOD,
            arguments: T::arguments,
            time: T::time,
            files: T::files,
            answer: T::answer,
            accepts: T::accepts,
            fastest: T::PATHS.map(|replays| replays.fastest),
            records: has_odometry && TypeId::of::<<T::Robot as Robot>::Input>() == TypeId::of::<Twist>(),
            has_odometry,
            draws: T::OBSERVATION.is_some_and(|observation| observation.draws),
        }
    }
}
