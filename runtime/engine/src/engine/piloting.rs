//! The engine as the pilot of a run: in each turn the plan and the modules, then the turn break.

use std::time::{Duration, Instant};

use mdle_compiler::load::LoadedPlan;
use mdle_host::{Moment, Pilot, PilotFault, RunTerms, Time, Transitions, claim_for_worker};
use mdle_runtime::{Machine, Nanos, Output as _, Turn};

use super::event::Event;
use super::modules::{Modules, Service};
use crate::fork::Threads;
use crate::library::Library;
use crate::module::{Candidate, Declare};
use crate::plans::{EngineAlphabet, PlanTurn, Plans};

/// Name of the module that makes the turns of plans; no other module can have it.
pub const PLAN: &str = "mdle";
/// Number of workers in real time.
const WORKERS: usize = 2;

/// An engine: the plans and the modules of one robot.
pub struct Engine<A: EngineAlphabet> {
    plans: Plans<A>,
    modules: Modules<A::Output>,
    /// Time from the output of a turn to the deadline of its modules; `None` in stepped time.
    patience: Option<Duration>,
    messages: Vec<String>,
}

impl<A: EngineAlphabet> Engine<A> {
    /// Returns an engine for a run with this plan and these modules. In real time modules make their turns on workers,
    /// in stepped time on the thread of the caller.
    ///
    /// # Errors
    /// A module is refused (exit status 2), or the system gives no threads.
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
        let mut engine = Self { plans, modules, patience, messages: Vec::new() };
        engine.load_plan_module();
        for candidate in library.candidates() {
            let loaded = candidate.and_then(|candidate| engine.modules.load(candidate));
            loaded.map_err(|refusal| mdle_host::Refusal::Usage(refusal.to_string()))?;
        }
        engine.modules.plan_reads(engine.plans.reads());
        engine.modules.prepare();
        Ok(engine)
    }

    /// Returns the plans, for requests at a turn break.
    pub fn plans(&mut self) -> &mut Plans<A> {
        &mut self.plans
    }

    /// Returns the modules, for requests at a turn break.
    pub fn modules(&mut self) -> &mut Modules<A::Output> {
        &mut self.modules
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
    fn land(&mut self, t: Nanos, transitions: &mut Transitions) -> Result<Turn<A::Input>, PilotFault> {
        match self.plans.land(t, transitions) {
            PlanTurn::Made(turn) => Ok(turn),
            PlanTurn::Late => Ok(Turn::Cut),
            PlanTurn::Panicked(message) => match self.plans.rollback(&format!("its code panicked: {message}")) {
                Ok(()) => {
                    self.load_plan_module();
                    Ok(Turn::Cut)
                }
                Err(_) => Err(PilotFault::Panicked(message)),
            },
        }
    }

    /// Makes the turn break, as far as it follows from the turn.
    fn turn_break(&mut self) -> Result<(), PilotFault> {
        let (mut result, mut is_given_up) = (Ok(()), false);
        for event in self.modules.events() {
            match event {
                Event::GivenUp(name) if &**name == PLAN => {
                    let sentence = "the plan has not ended its turn";
                    result = self.plans.rollback(sentence).map_err(|_| PilotFault::Stopped(sentence.to_owned()));
                    is_given_up = true;
                }
                Event::Loaded(_) | Event::Unloaded(_) | Event::Started(_) | Event::Stopped(_) => {}
                Event::Failed(..) | Event::Late(_) | Event::GivenUp(_) | Event::Ended(_) | Event::NotANumber(_) => {
                    self.messages.push(format!("warning: {event}"));
                }
            }
        }
        if is_given_up && result.is_ok() {
            // The plan before goes on, with a module of its own.
            self.load_plan_module();
        }
        result
    }
}

impl<A: EngineAlphabet> Pilot for Engine<A> {
    type Plan = LoadedPlan<A>;

    fn turn(
        &mut self,
        Moment { y, t, number }: Moment<'_, A::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<A::Input>, PilotFault> {
        let published = self.plans.take_off(t, self.modules.board()).map_err(PilotFault::Stopped)?;
        let mut y = y.clone();
        if let Some(published) = published {
            y.take_published(published);
        }
        let deadline = self.patience.map(|patience| Instant::now() + patience);
        self.modules.turn(y, number, t, deadline);
        let turn = self.land(t, transitions)?;
        self.modules.settle();
        self.turn_break()?;
        self.plans.arm();
        self.modules.drop_later(self.plans.take_spent());
        self.modules.plan_reads(self.plans.reads());
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

    fn machine(&self) -> Option<&Machine<LoadedPlan<A>>> {
        self.plans.machine()
    }

    fn zero(&self) -> Nanos {
        self.plans.zero()
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.messages.drain(..).for_each(|message| say(&message));
    }
}
