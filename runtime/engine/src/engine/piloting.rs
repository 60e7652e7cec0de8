//! The engine of a run: creates, loads and replaces the plans and modules of a robot.

mod turn;

use std::time::Duration;

use mdle_compiler::load::LoadedPlan;
use mdle_host::{RunTerms, Time, claim_for_worker};
use mdle_record::RecordedChange;
use mdle_runtime::{ModuleRead, Nanos, Plan as _};

use super::loading::{Loading, NewModule};
use super::modules::{Modules, Service};
use crate::fork::Threads;
use crate::library::Library;
use crate::link::StateLink;
use crate::module::{Candidate, Declare, PLAN, ROBOT, Refusal};
use crate::plans::{EngineAlphabet, NoTrial, Plans, When, reads};
use crate::recorder::Recorder;
use crate::replay::{History, Repeats};

/// Number of worker threads in real time.
const WORKERS: usize = 2;

/// Runs the plans and modules of one robot.
pub struct Engine<A: EngineAlphabet> {
    plans: Plans<A>,
    modules: Modules<A::Output>,
    loading: Loading<A::Output>,
    /// Time from a turn's output to the deadline of the modules' turns; `None` in stepped time.
    patience: Option<Duration>,
    /// Module attributes that safety rules read; `None` without rules.
    rules_read: Option<&'static [ModuleRead]>,
    messages: Vec<String>,
    /// History of this run, for the record; `None` if the run is not recorded.
    history: Option<History>,
    /// State of the recorded run that is replayed; `None` if no run is replayed.
    repeats: Option<Repeats>,
    link: Option<StateLink>,
    recorder: Option<Box<dyn Recorder<A::Output>>>,
}

impl<A: EngineAlphabet> Engine<A> {
    /// Creates an engine for a run with this plan and these modules. Modules make their turns on worker threads in real
    /// time, and on the caller's thread in stepped time.
    ///
    /// # Errors
    /// Fails if a module is refused, or publishes an attribute of another kind than the plan expects (exit status 2);
    /// if the system cannot create threads; or if the run is asked to end before it begins.
    pub fn new(
        plan: LoadedPlan<A>,
        library: &Library<A::Output>,
        terms: &RunTerms,
    ) -> Result<Self, mdle_host::Refusal> {
        let (threads, service, patience) = match terms.time {
            Time::Wall => (Threads::Workers(WORKERS, claim_for_worker), Service::WhenReady, Some(terms.period)),
            Time::Stepped(_) => (Threads::Sequential, Service::WhenDue, None),
        };
        let no_threads = |error| mdle_host::Refusal::Fault(format!("the system gives no threads: {error}"));
        let (plans, modules) = (Plans::new(plan), Modules::new(threads, service).map_err(no_threads)?);
        let loading = Loading::new(library.clone(), terms.request.clone()).map_err(no_threads)?;
        let mut engine = Self {
            plans,
            modules,
            loading,
            patience,
            rules_read: None,
            messages: Vec::new(),
            history: None,
            repeats: None,
            link: None,
            recorder: None,
        };
        engine.load_plan_module();
        for candidate in library.candidates(&terms.request) {
            let loaded = candidate.and_then(|candidate| engine.modules.load(candidate));
            loaded.map_err(|refusal| {
                let is_ended = refusal == Refusal::Ended;
                if is_ended {
                    mdle_host::Refusal::Ended(Ok(()))
                } else {
                    mdle_host::Refusal::Usage(refusal.to_string())
                }
            })?;
        }
        reads::check_kinds(engine.plans.reads(), engine.modules.board()).map_err(mdle_host::Refusal::Usage)?;
        engine.messages.extend(engine.modules.unpublished().map(|(_, sentence)| format!("warning: {sentence}")));
        engine.read_modules();
        engine.modules.prepare();
        Ok(engine)
    }

    /// Prepares the engine for safety rules that read the module attributes `reads`; from now on, outputs contain these
    /// attributes. `diversions` are the plans that the rules start.
    ///
    /// # Errors
    /// Fails if no module publishes one of the attributes, or an attribute that one of the plans reads, or if an
    /// attribute has another kind (exit status 2).
    pub fn under_rules(
        self,
        reads: &'static [ModuleRead],
        diversions: impl IntoIterator<Item = LoadedPlan<A>>,
    ) -> Result<Self, mdle_host::Refusal> {
        let board = self.modules.board();
        reads::check("a safety rule", reads, board).map_err(mdle_host::Refusal::Usage)?;
        for plan in diversions {
            let reader = format!("the plan {} of a safety rule", plan.name(0));
            reads::check(&reader, plan.reads(), board).map_err(mdle_host::Refusal::Usage)?;
        }
        let mut engine = Self { rules_read: Some(reads), ..self };
        engine.read_modules();
        engine.modules.prepare();
        Ok(engine)
    }

    /// Prepares the engine to replay a recorded run. [`Engine::repeat`] supplies the recorded values of modules.
    /// `rules_read` lists the module attributes that safety rules read, if the run had rules. The engine has no modules
    /// except the module of the plans.
    #[must_use]
    pub fn repeating(self, rules_read: Option<&'static [ModuleRead]>) -> Self {
        Self { rules_read, repeats: Some(Repeats::default()), ..self }
    }

    /// Repeats a change of the recorded run before the next turn. Some changes have to be repeated by the caller: armed
    /// plans (with [`Plans::replace`]), changes of safety rules, and recorded paths, which are part of outputs.
    pub fn repeat(&mut self, change: &RecordedChange) {
        match change {
            RecordedChange::Cancelled => self.plans.cancel(),
            // The record contains only changes that were carried out.
            RecordedChange::RolledBack(why) => drop(self.rollback(why)),
            RecordedChange::Trial(time) => self.plans.set_trial(*time),
            RecordedChange::Attribute { .. }
            | RecordedChange::Vanished(_)
            | RecordedChange::Published { .. }
            | RecordedChange::Files(_)
            | RecordedChange::Armed { .. }
            | RecordedChange::Limit { .. }
            | RecordedChange::SafetyReset
            | RecordedChange::Skipped
            | RecordedChange::Late
            | RecordedChange::Back
            | RecordedChange::Peer { .. }
            | RecordedChange::Path { .. } => {
                if let Some(repeats) = &mut self.repeats {
                    repeats.repeat(change, self.modules.board_mut());
                }
            }
        }
    }

    /// Attaches a state link: the robot sends its state to other robots, and plans read the states of other robots.
    ///
    /// # Errors
    /// Fails if a module whose attributes the robot shares is not loaded (exit status 2).
    pub fn linked(self, link: StateLink) -> Result<Self, mdle_host::Refusal> {
        let checked = self.modules.check_loaded(link.shares());
        checked.map_err(|refusal| {
            mdle_host::Refusal::Usage(format!("the state link is to share attributes of a module: {refusal}"))
        })?;
        let mut engine = Self { link: Some(link), ..self };
        engine.read_modules();
        engine.modules.prepare();
        Ok(engine)
    }

    /// Returns the names of the other robots to which plans can be sent.
    pub fn recipients(&self) -> &[String] {
        self.link.as_ref().map_or(&[], StateLink::recipients)
    }

    /// Sends a plan to the robot `to`; `plan` contains the plan's name, its text, and the moment at which it takes
    /// over. The robot's answer becomes a message to the operator.
    ///
    /// # Errors
    /// Returns a sentence with the reason if the plan cannot be sent.
    pub fn send_plan(&mut self, to: &str, plan: (&str, &str, When), now: Nanos) -> Result<(), String> {
        match &mut self.link {
            Some(link) => link.send_plan(to, plan, now),
            None => Err("this robot has no state link".to_owned()),
        }
    }

    /// Updates the list of attributes for which modules have to make turns: attributes that plans and safety rules
    /// read, and attributes that the robot shares with other robots.
    fn read_modules(&mut self) {
        let Self { plans, modules, rules_read, link, .. } = self;
        let shares = link.as_ref().map_or(&[][..], StateLink::shares);
        modules.plan_reads(plans.reads().chain(rules_read.unwrap_or_default()).chain(shares));
    }

    /// Attaches a path recorder. It records the path that the robot drives under certain laws, so that plans can replay
    /// it.
    #[must_use]
    pub fn recording(self, recorder: Box<dyn Recorder<A::Output>>) -> Self {
        Self { recorder: Some(recorder), ..self }
    }

    /// Returns the plans.
    pub fn plans(&self) -> &Plans<A> {
        &self.plans
    }

    /// Returns the plans, so that requests can be made at a turn break.
    pub fn plans_mut(&mut self) -> &mut Plans<A> {
        &mut self.plans
    }

    /// Returns the modules.
    pub fn modules(&self) -> &Modules<A::Output> {
        &self.modules
    }

    /// Returns the modules, so that requests can be made at a turn break.
    pub fn modules_mut(&mut self) -> &mut Modules<A::Output> {
        &mut self.modules
    }

    /// Returns the names of the modules in the library.
    pub fn library(&self) -> impl Iterator<Item = &str> {
        self.loading.library().names()
    }

    /// Starts to load a module of the library, which is created on its own thread; returns the number of the request.
    /// [`Engine::progress`] returns the result.
    ///
    /// # Errors
    /// Fails with a sentence if the module cannot be loaded now.
    pub fn load(&mut self, name: &str) -> Result<u32, String> {
        self.begin_loading(NewModule::OfLibrary(name.to_owned()))
    }

    /// Starts to load a child process as a module with this name, as [`Engine::load`] does for a module of the library;
    /// `/bin/sh` interprets the command line.
    ///
    /// # Errors
    /// Fails with a sentence if the module cannot be loaded now.
    pub fn load_process(&mut self, name: &str, command: &str) -> Result<u32, String> {
        self.begin_loading(NewModule::Process(name.to_owned(), command.to_owned()))
    }

    fn begin_loading(&mut self, module: NewModule) -> Result<u32, String> {
        if [PLAN, ROBOT].contains(&module.name()) {
            return Err(Refusal::Reserved(module.name().to_owned()).to_string());
        }
        if self.modules.names().any(|(loaded, _)| loaded == module.name()) {
            return Err(Refusal::NameTaken(module.name().to_owned()).to_string());
        }
        self.loading.begin(module)
    }

    /// Adds a message to the operator, which is reported with the next turn.
    pub fn tell(&mut self, message: String) {
        self.messages.push(message);
    }

    /// Continues requests at a turn break: arms a plan that has been compiled, loads a module that has been created,
    /// and updates modules' copies of changed attributes. Returns the number and the result of a finished request to
    /// load a module; `None` if no such request is finished.
    pub fn progress(&mut self) -> Option<(u32, Result<(), Refusal>)> {
        self.plans.arm();
        let made = self.loading.next();
        let loaded =
            made.map(|(number, candidate)| (number, candidate.and_then(|candidate| self.load_made(candidate))));
        self.modules.drop_later(self.plans.take_spent());
        self.read_modules();
        self.modules.prepare();
        loaded
    }

    /// Loads a module that was created while the robot was driving. Reports attributes that the module reads but no
    /// module publishes.
    fn load_made(&mut self, candidate: Candidate<A::Output>) -> Result<(), Refusal> {
        let name = candidate.name().to_owned();
        self.modules.load(candidate)?;
        let sentence = self.modules.unpublished().find_map(|(reader, sentence)| (reader == name).then_some(sentence));
        self.messages.extend(sentence.map(|sentence| format!("warning: {sentence}")));
        Ok(())
    }

    /// Ends the plan on trial for the reason `why`. The plan that was replaced continues at its atom in the next turn,
    /// as if no time had passed.
    ///
    /// # Errors
    /// Fails if no plan is on trial.
    pub fn rollback(&mut self, why: &str) -> Result<(), NoTrial> {
        self.go_back(why)?;
        self.plans.note(RecordedChange::RolledBack(why.to_owned()));
        Ok(())
    }

    /// Ends the plan on trial, as [`Engine::rollback`] does, but does not record the change.
    fn go_back(&mut self, why: &str) -> Result<(), NoTrial> {
        let was_late = self.plans.is_late();
        self.plans.rollback(why)?;
        if was_late {
            // The previous plan continues, with its own module.
            self.load_plan_module();
        }
        Ok(())
    }

    /// Loads a new module that makes the turns of plans, after unloading the old one, which may hang.
    fn load_plan_module(&mut self) {
        let module = self.plans.module();
        let candidate = Candidate::registered(PLAN, |declare: &mut Declare| {
            declare.doc("Makes the turns of plans.");
            declare.priority(i32::MAX);
            module
        });
        let _ = self.modules.unload(PLAN);
        if let Err(refusal) = candidate.and_then(|candidate| self.modules.load(candidate)) {
            self.messages.push(format!("error: {refusal}"));
        }
    }
}
