//! Requests of a front end to compile, store, load, delete and start plans, and to cancel a plan that is about to take
//! over.

use std::io;
use std::sync::Arc;

use mdle_compiler::load::LoadedPlan;
use mdle_record::RecordedChange;
use mdle_runtime::Plan as _;

use super::compiler::{Compiler, CompilerThread};
use super::event::{PlanEvent, When};
use super::order::{Compile, NextPlan, Order, PlanSource, SlowTask};
use super::running::{EngineAlphabet, Running};
use super::stored::{MOST_STORED, StoredPlan};
use super::{Plans, Spent};

impl<A: EngineAlphabet> Plans<A> {
    /// Permits requests that contain plans as text. `compile` compiles the text on a separate thread.
    ///
    /// # Errors
    /// Fails if the system cannot create the thread.
    pub fn compile_with(&mut self, compile: Box<Compile<A>>) -> io::Result<()> {
        self.compiler = Some(Compiler::Thread(CompilerThread::new(compile)?));
        Ok(())
    }

    /// Permits requests that contain plans as text, in simulated time. Turns wait while `compile` compiles the text.
    pub fn compile_at_once_with(&mut self, compile: Box<Compile<A>>) {
        self.compiler = Some(Compiler::AtOnce(compile, std::collections::VecDeque::new()));
    }

    /// Takes the events of plans that other robots have sent.
    pub(crate) fn take_peer_events(&mut self) -> Vec<PlanEvent> {
        self.peers.take_events()
    }

    /// Stores a plan under its name, in place of an earlier plan with this name. If the earlier plan is active, it
    /// continues to run. At most [`MOST_STORED`] plans are stored.
    ///
    /// # Errors
    /// Fails with a sentence if too many plans are stored.
    pub fn store(&mut self, plan: StoredPlan<A>) -> Result<(), String> {
        self.store_all(vec![plan])
    }

    /// Returns the stored plans, sorted by name.
    pub fn stored(&self) -> impl Iterator<Item = &StoredPlan<A>> {
        self.stored.iter()
    }

    /// Returns the stored plan with this name.
    ///
    /// # Errors
    /// Fails with a sentence if no plan with this name is stored.
    pub fn stored_plan(&self, name: &str) -> Result<StoredPlan<A>, String> {
        self.stored.get(name).cloned().ok_or_else(|| self.no_plan(name))
    }

    /// Deletes a stored plan. If the plan is active, it continues.
    ///
    /// # Errors
    /// Fails with a sentence if no plan with this name is stored.
    pub fn delete(&mut self, name: &str) -> Result<(), String> {
        let plan = self.stored.remove(name).ok_or_else(|| self.no_plan(name))?;
        self.spent.push(Box::new(plan));
        Ok(())
    }

    /// Requests that the plans in a source text be stored; returns the number of the request. The answer at a later
    /// turn break is [`PlanEvent::Stored`] or [`PlanEvent::Refused`].
    pub fn load(&mut self, source: PlanSource) -> u32 {
        self.order(SlowTask::Compile(source, None))
    }

    /// Requests that the plan in a source text take over; returns the number of the request. The plan is also stored,
    /// unless another robot has sent it. The answer at a later turn break is [`PlanEvent::Refused`], or
    /// [`PlanEvent::Armed`] and then [`PlanEvent::Began`]. A later request supersedes this request before it is
    /// compiled, and replaces its plan if the plan is armed but has not begun. However, a request of another robot
    /// never supersedes or replaces a request of the operator: it is refused while a plan of the operator is armed.
    pub fn swap(&mut self, source: PlanSource, when: When) -> u32 {
        self.order(SlowTask::Compile(source, Some(when)))
    }

    /// Requests that a stored plan take over, as [`Plans::swap`] does; returns the number of the request.
    ///
    /// # Errors
    /// Fails with a sentence if no plan with this name is stored.
    pub fn run(&mut self, name: &str, when: When) -> Result<u32, String> {
        let plan = self.stored_plan(name)?;
        Ok(self.order(SlowTask::Begin(plan, when)))
    }

    /// Requests that `plan`, which is already loaded, take over; returns the number of the request. The plan is armed
    /// at once.
    pub fn replace(&mut self, plan: LoadedPlan<A>, when: When) -> u32 {
        self.last = self.last.saturating_add(1);
        let number = self.last;
        self.arm_plan(number, NextPlan { plan, files: Arc::default(), when });
        number
    }

    /// Requests that a compiled plan take over in the next turn; returns the number of the request. The plan is armed
    /// at once, and its files become part of the record of the run.
    ///
    /// # Errors
    /// Fails with a sentence if the plan replays a path that the first plan does not.
    pub fn follow(&mut self, plan: &StoredPlan<A>) -> Result<u32, String> {
        self.last = self.last.saturating_add(1);
        let number = self.last;
        let next = NextPlan { plan: plan.loaded.plan(), files: Arc::clone(&plan.files), when: When::Now };
        self.arm_plan(number, next);
        match self.events.pop_if(|event| matches!(event, PlanEvent::Refused(ticket, _) if *ticket == number)) {
            Some(PlanEvent::Refused(_, sentence)) => Err(sentence),
            _ => Ok(number),
        }
    }

    /// Cancels the armed plan, and the requests for plans to take over that wait for the compiler. Does not cancel a
    /// text that is being compiled.
    pub fn cancel(&mut self) {
        if self.armed.is_some() {
            self.note(RecordedChange::Cancelled);
        }
        self.take_back();
    }

    /// Cancels plans that are about to take over, as [`Plans::cancel`] does, but does not record the change.
    pub(super) fn take_back(&mut self) {
        let waiting = self.compiler.as_ref().map_or([None, None], Compiler::take_back);
        for order in waiting.into_iter().flatten() {
            self.tell(self.peers.cancelled(order.ticket));
            self.spent.push(Box::new(order));
        }
        if let Some((plan, _)) = self.armed.take() {
            self.tell(self.peers.cancelled(plan.ticket));
            self.discard(plan);
        }
    }

    fn no_plan(&self, name: &str) -> String {
        let names = self.stored().map(|plan| &*plan.name);
        let near = mdle_compiler::alphabet::nearest(name, names);
        let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        format!("no plan `{name}` is stored{near}")
    }

    /// Passes an order to the compiler; returns the number of the request. A plan of another robot that must not take
    /// over is refused instead.
    fn order(&mut self, task: SlowTask<A>) -> u32 {
        self.last = self.last.saturating_add(1);
        let ticket = self.last;
        if task.is_sent() {
            self.peers.add(ticket);
        }
        if let Some(reason) = self.refuses(ticket) {
            self.tell(PlanEvent::Refused(ticket, reason.to_owned()));
            return ticket;
        }
        let given = match &mut self.compiler {
            Some(compiler) => compiler.order(Order { ticket, task }),
            None => Err("this engine has no compiler".to_owned()),
        };
        match given {
            Ok(superseded) => superseded.into_iter().flatten().for_each(|order| {
                self.tell(PlanEvent::Superseded(order.ticket));
                self.spent.push(Box::new(order));
            }),
            Err(sentence) => self.tell(PlanEvent::Refused(ticket, sentence)),
        }
        ticket
    }

    pub(super) fn store_all(&mut self, plans: Vec<StoredPlan<A>>) -> Result<(), String> {
        let (plans, result) = match self.stored.put(plans) {
            Ok(replaced) => (replaced, Ok(())),
            Err(refused) => (refused, Err(format!("{MOST_STORED} plans are stored, which is the most: delete one"))),
        };
        self.spent.extend(plans.into_iter().map(|plan| Box::new(plan) as Spent));
        result
    }

    pub(super) fn arm_plan(&mut self, ticket: u32, next: NextPlan<A>) {
        let NextPlan { plan, files, when } = next;
        let missing = plan.paths().iter().find(|path| !self.paths.contains(path));
        if let Some(path) = missing {
            let sentence = format!("the plan replays the path `{path}`, which the first plan of the run does not");
            self.tell(PlanEvent::Refused(ticket, sentence));
            return self.discard(Running::new(ticket, plan));
        }
        if let Some(changes) = &mut self.changes {
            changes.armed(&files, plan.name(0), when);
        }
        if let Some((old, _)) = self.armed.replace((Running::new(ticket, plan), when)) {
            self.replaced(old);
        }
        self.tell(PlanEvent::Armed(ticket));
    }

    /// Reports that another plan was armed instead of `plan`, and drops `plan`.
    pub(super) fn replaced(&mut self, plan: Running<A>) {
        self.tell(PlanEvent::Replaced(plan.ticket, Arc::clone(&plan.name)));
        self.discard(plan);
    }
}
