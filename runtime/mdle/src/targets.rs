//! The robots for which this program can run plans.

use std::os::fd::AsFd as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm::Machine;
use mdle_compiler::load::{self, Loaded};
use mdle_engine::shell::Session;
use mdle_engine::tree::Desk;
use mdle_engine::{Engine, EngineAlphabet, Library, PlanFacts, StoredPlan};
use mdle_files::{Input, Target};
use mdle_host::{Call, Program, Refusal, RunTerms, Supervision};
use mdle_record::{Begin, SafetyTexts};
use mdle_runtime::{Alphabet, Plan as _, Printable, Robot, Sensed, Twist};

use crate::failure::Failure;
use crate::link::{self, LinkFile};
use crate::modules::SoundInput;
use crate::plans::{self, texts};
use crate::record::Record;
use crate::replayer::{RecordedRun, replay};
use crate::route::{Route, drive};
use crate::safety::{Guarded, SafetyFile};
use crate::session::SessionInputs;
use crate::way_recorder::WayRecorder;

/// A robot whose driver is part of this program.
#[derive(Clone, Copy)]
pub(crate) struct LinkedTarget {
    /// Name of the target.
    pub(crate) name: &'static str,
    /// Function that loads a plan.
    pub(crate) load: Load,
    /// Function that runs a plan on the outputs of a record.
    pub(crate) replay: ReplayRecord,
    /// Function that drives a route.
    pub(crate) navigate: DriveRoute,
    /// Function that checks the options of a run. It fails with a message if an option is invalid.
    pub(crate) check: fn(Program<'_>, &Call) -> Result<(), String>,
}

/// Function that loads a plan for a target. The safety rules apply to all runs of the plan.
type Load = fn(&Machine, &Input, &Arc<Target>, Option<&SafetyFile>) -> Result<Box<dyn ReadyPlan>, Failure>;

/// Function that runs the plan of a machine on the outputs of a record; plans are observed if the last argument
/// is `true`.
type ReplayRecord = fn(Machine, &Sources, &Arc<Target>, &Begin, Record, bool) -> Result<Box<dyn RecordedRun>, Failure>;

/// Function that drives a route with the modules of a library.
type DriveRoute = fn(&Route, &Arc<Target>, Call, &Library<Sensed>) -> Result<ExitCode, Failure>;

/// A plan that is ready to run.
pub(crate) trait ReadyPlan {
    /// Returns `true` if the plan reads attributes of modules.
    fn reads_modules(&self) -> bool;

    /// Returns `true` if the plan reads an attribute of `module`.
    fn reads(&self, module: &str) -> bool;

    /// Returns the texts of the safety rules; `None` if there are no rules.
    fn safety(&self) -> Option<&SafetyTexts>;

    /// Sets the link of the plan's runs to other robots.
    ///
    /// # Errors
    /// Fails if the plan names a robot that the link does not contain.
    fn link(&mut self, link: Option<LinkFile>) -> Result<(), Failure>;

    /// Sets the name of the path that runs of the plan replace with the way back after each `path` and `Follow`.
    ///
    /// # Errors
    /// Fails if the plan does not replay the path.
    fn records(&mut self, path: Option<&str>) -> Result<(), Failure>;

    /// Sets the sound for the module `heading` in runs of the plan.
    fn hears(&mut self, hearing: Option<SoundInput>);

    /// Sets the facts about the plan, which a session shows.
    fn describe(&mut self, facts: PlanFacts);

    /// Runs the plan with the modules in `library`.
    fn run(&self, program: Program<'_>, call: Call, library: &Library<Sensed>) -> ExitCode;

    /// Runs the plan in a session, with the modules in `library`; `name` is the name of the plan.
    fn session(&self, name: &str, call: Call, library: &Library<Sensed>, seat: SessionInputs) -> ExitCode;
}

/// The robots whose drivers are part of this program.
const LINKED: [LinkedTarget; 3] = [
    LinkedTarget::new::<mdle_atrv::Target, mdle_atrv::alphabet::Alphabet>(),
    LinkedTarget::new::<mdle_scout::Target, mdle_scout::alphabet::Alphabet>(),
    LinkedTarget::new::<mdle_sim::Target, mdle_sim::alphabet::Alphabet>(),
];

/// Returns the names of the robots whose drivers are part of this program.
pub(crate) fn names() -> [&'static str; 3] {
    LINKED.map(|linked| linked.name)
}

/// Returns the robot with the name `name`.
///
/// # Errors
/// Fails if this program has no such robot; the message lists the known names.
pub(crate) fn linked(name: &str) -> Result<LinkedTarget, String> {
    if let Some(linked) = LINKED.iter().find(|linked| linked.name == name) {
        return Ok(*linked);
    }
    let known = names();
    Err(format!(
        "`mdle` has no target `{name}`{}\nhelp: its targets are {}; `mdlec run` builds the executable of a plan for \
         `ros2`, or for a target of your own",
        did_you_mean(name, &known),
        known.join(", ")
    ))
}

/// Returns the robot of a record in the file `log`.
///
/// # Errors
/// Fails if this program has no such robot.
pub(crate) fn of_record(begin: &Begin, log: &Path) -> Result<LinkedTarget, Failure> {
    LINKED.iter().find(|linked| linked.name == begin.target).copied().ok_or_else(|| {
        let (log, target, known) = (log.display(), &begin.target, names().join(", "));
        Failure::Usage(format!(
            "the record {log} is of the robot `{target}`, whose plans `mdle` cannot run: its robots are {known}\n\
             help: `mdle log info {log}` and `mdle log export --csv {log}` read the record of any robot"
        ))
    })
}

impl LinkedTarget {
    const fn new<T, A>() -> Self
    where
        T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
        A: EngineAlphabet<Output = Sensed, Input = Twist>,
    {
        Self {
            name: T::NAME,
            load: load::<T, A>,
            replay: replay::<A>,
            navigate: drive::<T, A>,
            check: mdle_host::check_options::<T>,
        }
    }
}

/// A plan for the target `T`.
struct PlanFor<T, A: Alphabet> {
    loaded: Arc<Loaded<A>>,
    /// Names and texts of the plan's files; the plan's own file comes first.
    files: Arc<[(String, String)]>,
    facts: PlanFacts,
    /// The target, for which further plans are compiled.
    known: Arc<Target>,
    safety: Option<Guarded<A>>,
    link: Option<LinkFile>,
    /// Sound for the module `heading`; `None` without `--ears`.
    hearing: Option<SoundInput>,
    /// Name of the path that is replaced with the way back after each `path` and `Follow`, and the maximum speeds of a
    /// path; `None` if no path is recorded.
    records: Option<(&'static str, Twist)>,
    target: std::marker::PhantomData<fn() -> T>,
}

impl<T, A: EngineAlphabet<Output = Sensed>> PlanFor<T, A> {
    /// Creates the engine for a run of the plan `name`. Further plans are accepted if `is_session` is `true`, or if the
    /// link accepts plans of other robots.
    fn loading(
        &self,
        name: &str,
        library: &Library<Sensed>,
        terms: &RunTerms,
        is_session: bool,
    ) -> Result<Engine<A>, Refusal> {
        let mut engine = self.engine(library, terms)?;
        if is_session || self.link.as_ref().is_some_and(LinkFile::takes_plans) {
            let Self { files, loaded, facts, .. } = self;
            let (files, loaded, facts) = (files.clone(), loaded.clone(), facts.clone());
            let first = StoredPlan { name: name.into(), files, loaded, facts };
            let robots = self.link.as_ref().map_or_else(Vec::new, LinkFile::robots);
            plans::begin(engine.plans_mut(), first, &self.known, robots)?;
        }
        Ok(engine)
    }

    /// Creates the engine of a run.
    fn engine(&self, library: &Library<Sensed>, terms: &RunTerms) -> Result<Engine<A>, Refusal> {
        let engine = match &self.hearing {
            Some(hearing) => Engine::new(self.loaded.plan(), &hearing.added(library, &terms.microphones), terms)?,
            None => Engine::new(self.loaded.plan(), library, terms)?,
        };
        let engine = match &self.link {
            Some(link) => engine.linked(link.open()?)?,
            None => engine,
        };
        let engine = match self.records {
            Some((path, fastest)) => engine.recording(Box::new(WayRecorder::new(path, fastest))),
            None => engine,
        };
        match &self.safety {
            Some(safety) => engine.under_rules(safety.reads(), safety.diversions()),
            None => Ok(engine),
        }
    }
}

impl<T, A> ReadyPlan for PlanFor<T, A>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>>,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    fn reads_modules(&self) -> bool {
        !self.loaded.plan().reads().is_empty()
    }

    fn reads(&self, module: &str) -> bool {
        self.loaded.plan().reads().iter().any(|read| read.module == module)
    }

    fn safety(&self) -> Option<&SafetyTexts> {
        self.safety.as_ref().map(Guarded::texts)
    }

    fn link(&mut self, link: Option<LinkFile>) -> Result<(), Failure> {
        let plan = self.loaded.plan();
        match (&link, plan.robots().first()) {
            (Some(link), _) => link.check(plan.robots())?,
            (None, Some(robot)) => return Err(link::missing(robot)),
            (None, None) => {}
        }
        self.link = link;
        Ok(())
    }

    fn records(&mut self, path: Option<&str>) -> Result<(), Failure> {
        let (Some(path), Some(replays)) = (path, T::PATHS) else { return Ok(()) };
        let plan = self.loaded.plan();
        let Some(name) = plan.paths().iter().copied().find(|name| *name == path) else {
            let near = did_you_mean(path, plan.paths());
            let path = Printable(path);
            return Err(Failure::Usage(format!("--records {path}: the plan replays no path `{path}`{near}")));
        };
        self.records = Some((name, replays.fastest));
        Ok(())
    }

    fn hears(&mut self, hearing: Option<SoundInput>) {
        self.hearing = hearing;
    }

    fn describe(&mut self, facts: PlanFacts) {
        self.facts = facts;
    }

    fn run(&self, program: Program<'_>, call: Call, library: &Library<Sensed>) -> ExitCode {
        let plan = || self.loaded.plan();
        let engine = |terms: &RunTerms| self.loading(program.plan, library, terms, false);
        let Some(safety) = &self.safety else {
            return mdle_host::run_piloted::<T, _>(program, call, &plan, engine, None);
        };
        let supervisor = |terms: &RunTerms| Box::new(safety.guardian(terms.period)) as _;
        let diversions = |number| safety.diversion(number);
        let supervision = Supervision { supervisor: &supervisor, diversions: &diversions, session: None };
        mdle_host::run_piloted::<T, _>(program, call, &plan, engine, Some(supervision))
    }

    fn session(&self, name: &str, call: Call, library: &Library<Sensed>, seat: SessionInputs) -> ExitCode {
        let SessionInputs { desk, is_paused, stream } = seat;
        let (plan, desk) = (|| self.loaded.plan(), Mutex::new(Some(desk)));
        let engine = |terms: &RunTerms| self.loading(name, library, terms, true);
        let supervisor = |terms: &RunTerms| {
            let guardian = self.safety.as_ref().map(|safety| safety.guardian(terms.period));
            // A session has only one run, so the desk is still there.
            let desk = desk.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_else(|| Desk::with_hub().1);
            Box::new(Session::<A>::new(desk, guardian, terms, is_paused)) as _
        };
        let diversions = |number| self.safety.as_ref().and_then(|safety| safety.diversion(number));
        let supervision =
            Supervision { supervisor: &supervisor, diversions: &diversions, session: Some(stream.as_fd()) };
        mdle_host::run_piloted::<T, _>(name, call, &plan, engine, Some(supervision))
    }
}

fn load<T, A>(
    machine: &Machine,
    input: &Input,
    target: &Arc<Target>,
    safety: Option<&SafetyFile>,
) -> Result<Box<dyn ReadyPlan>, Failure>
where
    T: mdle_host::Target<Robot: Robot<Output = Sensed, Input = Twist>> + 'static,
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let loaded = Arc::new(load::load::<A>(machine, &input.sources, &target.alphabet)?);
    let safety = safety.map(|safety| safety.compile(target, false)).transpose()?;
    Ok(Box::new(PlanFor::<T, A> {
        loaded,
        files: texts(input).into(),
        facts: PlanFacts::default(),
        known: Arc::clone(target),
        safety,
        link: None,
        hearing: None,
        records: None,
        target: std::marker::PhantomData,
    }))
}
