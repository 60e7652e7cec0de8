//! The robots that this program can run plans on.

use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::fsm::Machine;
use mdle_compiler::load::{self, Loaded};
use mdle_engine::shell::Session;
use mdle_engine::tree::Desk;
use mdle_engine::{Engine, EngineAlphabet, Library};
use mdle_files::{Input, Target};
use mdle_host::{Call, Program, RunTerms, Supervision};
use mdle_runtime::{Alphabet, Robot, Sensed, Twist};

use crate::failure::Failure;
use crate::safety::{Guarded, SafetyFile};
use crate::session::Seat;

/// A robot whose driver is part of this program.
#[derive(Clone, Copy)]
pub(crate) struct LinkedTarget {
    /// Name of the target.
    pub(crate) name: &'static str,
    /// Loads a plan.
    pub(crate) load: Load,
    /// Returns the message if a run has no such options.
    pub(crate) check: fn(Program<'_>, &Call) -> Result<(), String>,
}

/// Loads a plan of a file for a target, with the safety rules of its runs.
type Load = fn(&Machine, &Input, &Target, Option<&SafetyFile>) -> Result<Box<dyn Ready>, Failure>;

/// A plan that is ready to run.
pub(crate) trait Ready {
    /// Runs the plan of this name, with these modules.
    fn run(&self, name: &str, call: Call, library: &Library<Sensed>) -> ExitCode;

    /// Runs the plan of this name in a session, with these modules.
    fn session(&self, name: &str, call: Call, library: &Library<Sensed>, seat: Seat) -> ExitCode;
}

/// The robots.
const LINKED: [LinkedTarget; 3] = [
    LinkedTarget::new::<mdle_atrv::Target, mdle_atrv::alphabet::Alphabet>(),
    LinkedTarget::new::<mdle_scout::Target, mdle_scout::alphabet::Alphabet>(),
    LinkedTarget::new::<mdle_sim::Target, mdle_sim::alphabet::Alphabet>(),
];

/// Returns the robot of this name.
///
/// # Errors
/// A sentence with the names that there are.
pub(crate) fn linked(name: &str) -> Result<LinkedTarget, String> {
    if let Some(linked) = LINKED.iter().find(|linked| linked.name == name) {
        return Ok(*linked);
    }
    let known = LINKED.map(|linked| linked.name);
    Err(format!(
        "`mdle` has no target `{name}`{}\nhelp: its targets are {}; `mdlec run` builds the executable of a plan for a \
         target of your own",
        did_you_mean(name, &known),
        known.join(", ")
    ))
}

impl LinkedTarget {
    const fn new<T, A>() -> Self
    where
        T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
        A: EngineAlphabet<Output = Sensed, Input = Twist>,
    {
        Self { name: T::NAME, load: load::<T, A>, check: mdle_host::check_options::<T> }
    }
}

/// A plan for the target `T`.
struct PlanFor<T, A: Alphabet> {
    loaded: Arc<Loaded<A>>,
    safety: Option<Guarded<A>>,
    target: std::marker::PhantomData<fn() -> T>,
}

impl<T, A> Ready for PlanFor<T, A>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>>,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    fn run(&self, name: &str, call: Call, library: &Library<Sensed>) -> ExitCode {
        let plan = || self.loaded.plan();
        let engine = |terms: &RunTerms| Engine::<A>::new(self.loaded.plan(), library, terms);
        let Some(safety) = &self.safety else { return mdle_host::run_piloted::<T, _>(name, call, &plan, engine, None) };
        let supervisor = |terms: &RunTerms| Box::new(safety.guardian(terms.period)) as _;
        let diversions = |number| safety.diversion(number);
        let supervision = Supervision { supervisor: &supervisor, diversions: &diversions, session: false };
        mdle_host::run_piloted::<T, _>(name, call, &plan, engine, Some(supervision))
    }

    fn session(&self, name: &str, call: Call, library: &Library<Sensed>, Seat { desk, is_paused }: Seat) -> ExitCode {
        let (plan, desk) = (|| self.loaded.plan(), Mutex::new(Some(desk)));
        let engine = |terms: &RunTerms| Engine::<A>::new(self.loaded.plan(), library, terms);
        let supervisor = |terms: &RunTerms| {
            let guardian = self.safety.as_ref().map(|safety| safety.guardian(terms.period));
            // A session is one run.
            let desk = desk.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_else(|| Desk::with_hub().1);
            Box::new(Session::<A>::new(desk, guardian, terms, is_paused)) as _
        };
        let diversions = |number| self.safety.as_ref().and_then(|safety| safety.diversion(number));
        let supervision = Supervision { supervisor: &supervisor, diversions: &diversions, session: true };
        mdle_host::run_piloted::<T, _>(name, call, &plan, engine, Some(supervision))
    }
}

fn load<T, A>(
    machine: &Machine,
    input: &Input,
    target: &Target,
    safety: Option<&SafetyFile>,
) -> Result<Box<dyn Ready>, Failure>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let loaded = Arc::new(load::load::<A>(machine, &input.sources, &target.alphabet)?);
    let safety = safety.map(|safety| safety.compile(target)).transpose()?;
    Ok(Box::new(PlanFor::<T, A> { loaded, safety, target: std::marker::PhantomData }))
}
