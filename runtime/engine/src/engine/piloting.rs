//! The engine as the pilot of a run: in each turn the plan and the modules, then the turn break.

use std::time::{Duration, Instant};

use mdle_compiler::load::LoadedPlan;
use mdle_host::{Moment, Pilot, PilotFault, RunTerms, Time, Transitions, claim_for_worker};
use mdle_record::Change;
use mdle_runtime::{Machine, ModuleRead, Nanos, Output as _, Plan as _, Turn};

use super::event::Event;
use super::loading::{Loading, NewModule};
use super::modules::{Modules, Service};
use crate::fork::Threads;
use crate::library::Library;
use crate::link::StateLink;
use crate::module::{Candidate, Declare, PLAN, Refusal};
use crate::plans::{EngineAlphabet, NoTrial, PlanTurn, Plans, reads};
use crate::recorder::Recorder;
use crate::replay::{History, Repeats};

/// Number of workers in real time.
const WORKERS: usize = 2;

/// An engine: the plans and the modules of one robot.
pub struct Engine<A: EngineAlphabet> {
    plans: Plans<A>,
    modules: Modules<A::Output>,
    loading: Loading<A::Output>,
    /// Time from the output of a turn to the deadline of its modules; `None` in stepped time.
    patience: Option<Duration>,
    /// Attributes of modules that safety rules read; `None` without rules.
    rules_read: Option<&'static [ModuleRead]>,
    messages: Vec<String>,
    /// History of this run, for a record; `None` if it is not recorded.
    history: Option<History>,
    /// The recorded run that is made again.
    repeats: Option<Repeats>,
    link: Option<StateLink>,
    recorder: Option<Box<dyn Recorder<A::Output>>>,
}

impl<A: EngineAlphabet> Engine<A> {
    /// Returns an engine for a run with this plan and these modules. In real time modules make their turns on workers,
    /// in stepped time on the thread of the caller.
    ///
    /// # Errors
    /// A module is refused (exit status 2), the system gives no threads, or the run is asked to end before.
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
        engine.modules.plan_reads(engine.plans.reads());
        engine.modules.prepare();
        Ok(engine)
    }

    /// Puts the engine under safety rules that read these attributes of modules: outputs have them from now on.
    ///
    /// # Errors
    /// A module publishes one with another kind (exit status 2).
    pub fn under_rules(self, reads: &'static [ModuleRead]) -> Result<Self, mdle_host::Refusal> {
        reads::check(reads, self.modules.board()).map_err(mdle_host::Refusal::Usage)?;
        let mut engine = Self { rules_read: Some(reads), ..self };
        engine.modules.plan_reads(engine.plans.reads().chain(reads));
        engine.modules.prepare();
        Ok(engine)
    }

    /// Makes a recorded run again under safety rules that read these attributes of modules, if it had rules:
    /// [`Engine::repeat`] gives it the values of modules. The engine has no modules but that of the plans.
    #[must_use]
    pub fn repeating(self, rules_read: Option<&'static [ModuleRead]>) -> Self {
        Self { rules_read, repeats: Some(Repeats::default()), ..self }
    }

    /// Repeats a change before the next turn. The caller repeats a plan that was armed, by [`Plans::replace`], and the
    /// limits of safety rules.
    pub fn repeat(&mut self, change: &Change) {
        match change {
            Change::Cancelled => self.plans.cancel(),
            // A record notes only what was carried out.
            Change::RolledBack(why) => drop(self.rollback(why)),
            Change::Trial(time) => self.plans.set_trial(*time),
            Change::Attribute { .. }
            | Change::Vanished(_)
            | Change::Published { .. }
            | Change::Files(_)
            | Change::Armed { .. }
            | Change::Limit { .. }
            | Change::Skipped
            | Change::Late
            | Change::Back => {
                if let Some(repeats) = &mut self.repeats {
                    repeats.repeat(change, self.modules.board_mut());
                }
            }
        }
    }

    /// Lets the robot tell others its state, and plans read theirs.
    #[must_use]
    pub fn linked(self, link: StateLink) -> Self {
        Self { link: Some(link), ..self }
    }

    /// Lets the ways of some laws become a path that plans replay.
    #[must_use]
    pub fn recording(self, recorder: Box<dyn Recorder<A::Output>>) -> Self {
        Self { recorder: Some(recorder), ..self }
    }

    /// Returns the plans.
    pub fn plans(&self) -> &Plans<A> {
        &self.plans
    }

    /// Returns the plans, for requests at a turn break.
    pub fn plans_mut(&mut self) -> &mut Plans<A> {
        &mut self.plans
    }

    /// Returns the modules.
    pub fn modules(&self) -> &Modules<A::Output> {
        &self.modules
    }

    /// Returns the modules, for requests at a turn break.
    pub fn modules_mut(&mut self) -> &mut Modules<A::Output> {
        &mut self.modules
    }

    /// Returns the names of the modules that can be loaded.
    pub fn library(&self) -> impl Iterator<Item = &str> {
        self.loading.library().names()
    }

    /// Begins to load a module of the library, which is made on a thread of its own; returns the number of the request,
    /// which [`Engine::progress`] answers.
    ///
    /// # Errors
    /// It cannot be loaded at present: a sentence.
    pub fn load(&mut self, name: &str) -> Result<u32, String> {
        self.begin_loading(NewModule::OfLibrary(name.to_owned()))
    }

    /// Begins to load a child process as a module of this name, as [`Engine::load`] does; `/bin/sh` reads the command
    /// line.
    ///
    /// # Errors
    /// It cannot be loaded at present: a sentence.
    pub fn load_process(&mut self, name: &str, command: &str) -> Result<u32, String> {
        self.begin_loading(NewModule::Process(name.to_owned(), command.to_owned()))
    }

    fn begin_loading(&mut self, module: NewModule) -> Result<u32, String> {
        if self.modules.names().any(|(loaded, _)| loaded == module.name()) {
            return Err(Refusal::NameTaken(module.name().to_owned()).to_string());
        }
        self.loading.begin(module)
    }

    /// Reports a message to the operator with the next turn.
    pub fn tell(&mut self, message: String) {
        self.messages.push(message);
    }

    /// Carries on with requests at a break: a plan that is compiled is armed, a module that is made is loaded, and
    /// modules get what has changed. Returns the number of a request to load a module with its result.
    pub fn progress(&mut self) -> Option<(u32, Result<(), Refusal>)> {
        self.plans.arm();
        let made = self.loading.next();
        let loaded =
            made.map(|(number, candidate)| (number, candidate.and_then(|candidate| self.modules.load(candidate))));
        self.modules.drop_later(self.plans.take_spent());
        self.modules.plan_reads(self.plans.reads().chain(self.rules_read.unwrap_or_default()));
        self.modules.prepare();
        loaded
    }

    /// Ends the plan on trial for this reason; the plan before it goes on in the next turn at its atom, as if no time
    /// had passed for it.
    ///
    /// # Errors
    /// No plan is on trial.
    pub fn rollback(&mut self, why: &str) -> Result<(), NoTrial> {
        self.go_back(why)?;
        self.plans.note(Change::RolledBack(why.to_owned()));
        Ok(())
    }

    /// Ends the plan on trial, as [`Engine::rollback`] does, for a reason that follows from the turns.
    fn go_back(&mut self, why: &str) -> Result<(), NoTrial> {
        let was_late = self.plans.is_late();
        self.plans.rollback(why)?;
        if was_late {
            // The plan before goes on, with a module of its own.
            self.load_plan_module();
        }
        Ok(())
    }

    /// Loads the module that makes the turns of plans, in place of one that hangs.
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

    /// Takes the plan's turn; a plan on trial that panicked or hangs is rolled back.
    fn land(&mut self, t: Nanos, is_new: bool, transitions: &mut Transitions) -> Result<Turn<A::Input>, PilotFault> {
        if self.repeats.as_ref().is_some_and(|repeats| !repeats.lands()) {
            return Ok(Turn::Cut);
        }
        let was_away = !is_new && self.plans.is_late();
        match self.plans.land(t, transitions) {
            PlanTurn::Made(turn) => Ok(turn),
            PlanTurn::Late => {
                let progress = match (is_new, self.plans.is_late()) {
                    (true, true) => Some(Change::Late),
                    (true, false) => Some(Change::Skipped),
                    (false, false) if was_away => Some(Change::Back),
                    // It is not back yet, or waits for what it reads.
                    (false, _) => None,
                };
                if let Some(history) = &mut self.history {
                    progress.into_iter().for_each(|progress| history.note(progress));
                }
                Ok(Turn::Cut)
            }
            PlanTurn::Panicked(message) => {
                let sentence = format!("its code panicked, which is a bug: {message}");
                self.ends_trial(&sentence).map(|()| Turn::Cut).map_err(|_| PilotFault::Panicked(message))
            }
        }
    }

    /// Rolls back for a reason that the operator has to be told.
    fn ends_trial(&mut self, why: &str) -> Result<(), NoTrial> {
        let name = self.plans.name().to_owned();
        self.go_back(why)?;
        self.messages.push(format!("warning: the plan {name} on trial is ended: {why}"));
        Ok(())
    }

    /// Makes the turn break, as far as it follows from the turn.
    fn turn_break(&mut self) -> Result<(), PilotFault> {
        let mut is_given_up = false;
        for event in self.modules.events() {
            match event {
                Event::GivenUp(name) if &**name == PLAN => is_given_up = true,
                Event::Loaded(_) | Event::Unloaded(_) | Event::Started(_) | Event::Stopped(_) => {}
                Event::Failed(..) | Event::Late(_) | Event::GivenUp(_) | Event::Ended(_) | Event::NotANumber(_) => {
                    self.messages.push(format!("warning: {event}"));
                }
            }
        }
        if is_given_up {
            let why = "it has not ended its turn";
            if self.ends_trial(why).is_err() {
                return Err(PilotFault::Stopped("the plan has not ended its turn".to_owned()));
            }
            self.plans.note(Change::RolledBack(why.to_owned()));
        }
        Ok(())
    }
}

impl<A: EngineAlphabet> Pilot for Engine<A> {
    type Plan = LoadedPlan<A>;

    fn complete(&mut self, y: &mut A::Output, now: Nanos) {
        if let Some(history) = &mut self.history {
            let reads = self.plans.reads().chain(self.rules_read.unwrap_or_default());
            let reads: Vec<_> = reads.collect();
            history.begin(self.plans.take_changes(), reads.into_iter(), self.modules.board());
        }
        let Some(rules_read) = self.rules_read else { return };
        let board = self.modules.board();
        let oldest = reads::oldest(rules_read.iter().chain(self.plans.driving_reads()), board, now);
        y.take_published(reads::current(rules_read, board, now).as_old_as(oldest));
    }

    fn turn(
        &mut self,
        Moment { y, t, number }: Moment<'_, A::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<A::Input>, PilotFault> {
        let mut complete = y.clone();
        if let Some(link) = &mut self.link {
            link.sense(&mut complete, self.plans.robots(), t);
        }
        if let Some(recorder) = &self.recorder {
            recorder.complete(&mut complete);
        }
        let published = self.plans.take_off(y, t, self.modules.board()).map_err(PilotFault::Stopped)?;
        if let Some(published) = published {
            complete.take_published(published);
        }
        let deadline = self.patience.map(|patience| Instant::now() + patience);
        if self.repeats.as_ref().is_none_or(Repeats::makes_turn) {
            self.modules.turn(complete, number, t, deadline);
        }
        let turn = self.land(t, published.is_some(), transitions)?;
        if let Some(repeats) = &mut self.repeats {
            repeats.end_turn();
        }
        if let Some(link) = &mut self.link {
            let plan = self.plans.machine().map(|machine| (self.plans.number().into(), machine));
            link.tell(y, plan, transitions, t);
        }
        if let Some(recorder) = &mut self.recorder {
            let machine = self.plans.machine();
            let law = machine.and_then(|machine| machine.atom().map(|atom| machine.plan().law(atom)));
            self.messages.extend(recorder.turn(y, law, !transitions.is_empty()));
        }
        self.modules.settle();
        self.turn_break()?;
        self.plans.arm();
        self.modules.drop_later(self.plans.take_spent());
        self.modules.plan_reads(self.plans.reads().chain(self.rules_read.unwrap_or_default()));
        self.modules.prepare();
        Ok(turn)
    }

    fn divert(&mut self, plan: LoadedPlan<A>, _: Moment<'_, A::Output>) {
        let was_late = self.plans.is_late();
        self.plans.divert(plan);
        if was_late {
            self.load_plan_module();
            self.modules.prepare();
        }
    }

    fn plan_number(&self) -> u64 {
        self.plans.number().into()
    }

    fn reason(&self) -> &str {
        self.plans.reason()
    }

    fn ended_by(&mut self, rule: &str) -> bool {
        self.ends_trial(&format!("the safety rule {rule} ends it")).is_ok()
    }

    fn machine(&self) -> Option<&Machine<LoadedPlan<A>>> {
        self.plans.machine()
    }

    fn zero(&self) -> Nanos {
        self.plans.zero()
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.messages.drain(..).for_each(|message| say(&message));
        if let Some(link) = &mut self.link {
            link.messages(say);
        }
    }

    fn record(&mut self) {
        self.history = Some(History::default());
        self.plans.record();
    }

    fn take_changes(&mut self) -> Vec<Change> {
        self.history.as_mut().map(History::take).unwrap_or_default()
    }
}
