//! Interface to the target and the plan of an executable, independent of their types.

use std::marker::PhantomData;
use std::os::fd::BorrowedFd;
use std::time::Duration;

use clap::ArgMatches;
use mdle_runtime::{PathStore, Plan, Robot};

use crate::drive::{Drive, PilotOnRobot};
use crate::helm::{Helm, Supervised};
use crate::pilot::{MakePilot, Pilot, RunTerms};
use crate::position::Texts;
use crate::runs::BatchRuns;
use crate::target_options::TargetOptions;
use crate::{Microphones, Pace, Refusal, Replays, StopRequest, Supervision, Target, Time};

/// Suggestion in the error message for a robot without microphones.
const NO_EARS: &str = "give `--ears FILE.wav`, or `--ears -` for the pipe of a recorder";

/// The target and the plan of an executable.
pub(crate) trait Executable: Sync {
    /// Returns the options of the target, with their defaults.
    fn target(&self) -> TargetOptions;
    /// Returns the stream to which a session writes reports and messages; `None` if there is no session.
    fn session(&self) -> Option<BorrowedFd<'_>>;
    /// Creates a plan whose texts can be read.
    fn plan(&self) -> Box<dyn Texts + '_>;
    /// Connects to the robot with [`Target::connect`]. Returns it with the plan that will drive it and the paths that
    /// the plan replays.
    ///
    /// # Errors
    /// Fails if [`Target::connect`] fails.
    fn connect(
        &self,
        matches: &ArgMatches,
        period: Duration,
        request: &StopRequest,
        store: PathStore,
    ) -> Result<Box<dyn Drive + '_>, Refusal>;
    /// Returns the runs of a batch, created with [`Observation::batch`]; `None` if the options request a single run.
    ///
    /// # Errors
    /// Fails if an option is invalid, or if a fault has occurred.
    fn batch(&self, matches: &ArgMatches, period: Duration, store: PathStore)
    -> Result<Option<BatchRuns<'_>>, Refusal>;
}

/// Executable of a plan for the target `T`. The pilot `B` computes the inputs of each run.
pub(crate) struct PlanOnTarget<'p, 's, T, P, B: Pilot> {
    /// Function that creates the plan.
    plan: &'p (dyn Fn() -> P + Sync),
    /// Function that creates the pilot of a run.
    pilot: &'p MakePilot<'p, B>,
    supervision: Option<Supervision<'s, B>>,
    target: PhantomData<fn() -> T>,
}

impl<'p, 's, T: Target, P, B> PlanOnTarget<'p, 's, T, P, B>
where
    B: Pilot<Plan: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>> + 'p,
{
    pub(crate) fn new(plan: &'p (dyn Fn() -> P + Sync), pilot: &'p MakePilot<'p, B>) -> Self {
        Self { plan, pilot, supervision: None, target: PhantomData }
    }

    /// Sets the supervisor that acts between the pilot and the robot.
    pub(crate) fn supervised(self, supervision: Option<Supervision<'s, B>>) -> Self {
        Self { supervision, ..self }
    }

    /// Returns the robot with the pilot that drives it, its supervisor, and the paths that the plan replays.
    ///
    /// # Errors
    /// Fails if a module needs sound and the robot has no microphones.
    fn drive(
        &self,
        mut robot: T::Robot,
        pilot: B,
        store: PathStore,
        terms: &RunTerms,
    ) -> Result<Box<dyn Drive + '_>, Refusal> {
        if let Some(radius) = terms.microphones.head() {
            let name = T::NAME;
            let none = || Refusal::Usage(format!("the robot `{name}` has no microphones of its own: {NO_EARS}"));
            T::EARS.ok_or_else(none)?(&mut robot, terms.microphones.clone(), radius).map_err(Refusal::Usage)?;
        }
        let speed = T::PATHS.map(|Replays { take, speed, .. }| {
            take(&mut robot, store);
            speed
        });
        let observer = T::OBSERVATION.map(|observation| observation.observer);
        let supervised = self.supervision.map(|Supervision { supervisor, diversions, .. }| Supervised {
            supervisor: supervisor(terms),
            diversions: Box::new(diversions),
        });
        let helm = Helm::new(pilot, supervised);
        Ok(Box::new(PilotOnRobot::new(robot, observer, speed, helm).with_settings(T::SETTINGS)))
    }
}

impl<'p, 's, T: Target, P: Plan, B> Executable for PlanOnTarget<'p, 's, T, P, B>
where
    B: Pilot<Plan: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>> + 'p,
{
    fn target(&self) -> TargetOptions {
        TargetOptions::of::<T>()
    }

    fn session(&self) -> Option<BorrowedFd<'_>> {
        self.supervision.and_then(|supervision| supervision.session)
    }

    fn plan(&self) -> Box<dyn Texts + '_> {
        Box::new((self.plan)())
    }

    fn connect(
        &self,
        matches: &ArgMatches,
        period: Duration,
        request: &StopRequest,
        store: PathStore,
    ) -> Result<Box<dyn Drive + '_>, Refusal> {
        // The pilot is created first: if that fails, the robot is not opened.
        let time = T::time(matches).map_err(Refusal::Usage)?;
        let terms = RunTerms { time, period, request: request.clone(), microphones: Microphones::default() };
        let pilot = (self.pilot)(&terms)?;
        let robot = T::connect(matches, period, request)?;
        self.drive(robot, pilot, store, &terms)
    }

    fn batch(
        &self,
        matches: &ArgMatches,
        period: Duration,
        store: PathStore,
    ) -> Result<Option<BatchRuns<'_>>, Refusal> {
        let Some(observation) = T::OBSERVATION else { return Ok(None) };
        let batch = (observation.batch)(matches, period)?;
        if batch.is_some() && self.session().is_some() {
            return Err(Refusal::Usage("a session is one run: leave --runs out".to_owned()));
        }
        let drive = move |robot| {
            let (time, request) = (Time::Stepped(Pace::Max), StopRequest::default());
            let terms = RunTerms { time, period, request, microphones: Microphones::default() };
            match (self.pilot)(&terms).and_then(|pilot| self.drive(robot, pilot, store, &terms)) {
                Ok(drive) => Ok(drive),
                Err(Refusal::Usage(sentence) | Refusal::Fault(sentence) | Refusal::Ended(Err(sentence))) => {
                    Err(sentence)
                }
                Err(Refusal::Ended(Ok(()))) => Err("the run was asked to end before it began".to_owned()),
            }
        };
        Ok(batch.map(|batch| BatchRuns::of(batch, drive)))
    }
}
