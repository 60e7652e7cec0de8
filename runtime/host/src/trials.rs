//! Robots for runs that another program makes and judges, such as `mdle test`.

use std::fmt;
use std::time::Duration;

use mdle_runtime::PathStore;

use crate::call::Call;
use crate::target_options::TargetOptions;
use crate::{Program, Refusal, StopRequest, Target, arguments, paths};

/// Option that makes a target return robots that differ only in a seed.
const SEVERAL: &str = "--runs=1";

/// Robots that the options of a run describe, and the limits of such a run.
pub struct Trials<R> {
    /// Period of a turn.
    pub period: Duration,
    /// Time of the run at which it ends; `None` if no option limits it.
    pub timeout: Option<Duration>,
    robot: MakeRobot<R>,
}

/// A function that creates the robot for a seed. Without a seed, it creates a robot without random errors.
type MakeRobot<R> = Box<dyn Fn(Option<u64>) -> Result<R, String> + Send + Sync>;

impl<R> fmt::Debug for Trials<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { period, timeout, .. } = self;
        write!(f, "Trials {{ period: {period:?}, timeout: {timeout:?} }}")
    }
}

impl<R> Trials<R> {
    /// Creates the robot for a seed; without a seed, the robot has no random errors.
    ///
    /// # Errors
    /// Returns a message if the robot cannot be created.
    pub fn robot(&self, seed: Option<u64>) -> Result<R, String> {
        (self.robot)(seed)
    }
}

/// Returns the robots of the target `T` that the options of `call` describe. The robots can replay the paths in
/// `names`.
///
/// # Errors
/// Returns a message if an option, a world or a path is invalid, or if the target's robots cannot be started over.
pub fn trials<T: Target>(
    program: Program<'_>,
    call: &Call,
    names: &[&'static str],
) -> Result<Trials<T::Robot>, String> {
    let target = TargetOptions::of::<T>();
    let parsed = |more: Option<&'static str>| {
        let command = arguments::command(&target, program, call);
        let words = call.arguments().cloned().chain(more.map(Into::into));
        command.try_get_matches_from(words).map_err(|error| error.render().to_string())
    };
    let matches = parsed(None)?;
    let options = arguments::options(&target, &matches);
    let store = paths::load(&target, &matches, names, None).map_err(sentence)?;
    let Some(observation) = T::OBSERVATION else { return Err(not_simulated(T::NAME)) };
    let several = parsed(Some(SEVERAL))?;
    let batch = (observation.batch)(&several, options.period).map_err(sentence)?;
    let batch = batch.ok_or_else(|| not_simulated(T::NAME))?;
    let period = options.period;
    let robot = move |seed| {
        let robot = match seed {
            Some(seed) => (batch.robot)(seed),
            None => T::connect(&matches, period, &StopRequest::default()).map_err(sentence),
        };
        robot.map(|robot| with_paths::<T>(robot, store))
    };
    Ok(Trials { period, timeout: options.timeout, robot: Box::new(robot) })
}

/// Gives a robot the paths that its plan replays, and returns the robot.
fn with_paths<T: Target>(mut robot: T::Robot, store: PathStore) -> T::Robot {
    if let Some(replays) = T::PATHS {
        (replays.take)(&mut robot, store);
    }
    robot
}

fn not_simulated(name: &str) -> String {
    format!("the robot {name} cannot be started over")
}

fn sentence(refusal: Refusal) -> String {
    match refusal {
        Refusal::Usage(sentence) | Refusal::Fault(sentence) | Refusal::Ended(Err(sentence)) => sentence,
        Refusal::Ended(Ok(())) => "the run was asked to end before it began".to_owned(),
    }
}
