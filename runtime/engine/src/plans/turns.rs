//! The turns of plans: decides which plan makes a turn, and applies the result.

use std::sync::Arc;

use mdle_compiler::load::LoadedPlan;
use mdle_host::Transitions;
use mdle_runtime::{ModuleRead, Nanos, Published, Turn};

use super::compiler::Compiler;
use super::flight::{Flight, Landed, PlanModule};
use super::order::{Outcome, Product};
use super::peers::REPLACED;
use super::running::Running;
use super::{Driving, EngineAlphabet, NoTrial, PlanEvent, Plans, When};
use crate::board::Board;

/// Maximum number of events that are kept for a session.
const MOST_EVENTS: usize = 256;

/// Result of the plan's turn.
pub(crate) enum PlanTurn<U> {
    /// The plan has made its turn.
    Made(Turn<U>),
    /// The plan has not finished its turn yet.
    Late,
    /// The plan panicked; contains the panic message.
    Panicked(String),
}

impl<A: EngineAlphabet> Plans<A> {
    /// Hands the plan's turn at time `now` to the plan module, which makes it; `y` is the output of that turn. Returns
    /// the values that the plan reads from modules. Returns `None` if the plan cannot begin yet and therefore makes no
    /// turn.
    ///
    /// # Errors
    /// Fails with a sentence if the first plan can never begin.
    pub(crate) fn take_off(&mut self, y: &A::Output, now: Nanos, board: &Board) -> Result<Option<Published>, String> {
        let next = self.ready_to_follow(now, board);
        let Some(mut flight) = self.current.take() else { return Ok(None) };
        if let Some(suspended) = self.resumes.take() {
            flight.current.resume(suspended, now);
        }
        if let Some((next, when, published)) = next {
            flight.published = published;
            if when == When::Now {
                let mut old = std::mem::replace(&mut flight.current, next);
                old.suspend(y);
                self.begins(old, &mut flight.current, now);
            } else {
                flight.next = Some((next, when));
            }
        }
        self.aloft = flight.next.as_ref().map(|(next, _)| next.ticket);
        let published = flight.current.published(board, now);
        if let Ok(Some(_)) = published {
            flight.transitions.clear();
            (flight.turn, flight.at) = (None, now);
            self.desk.lay(flight);
        } else {
            self.current = Some(flight);
        }
        published
    }

    /// Removes and returns the armed plan if it can begin in the turn at `now`, with its moment and the values that it
    /// reads from modules.
    fn ready_to_follow(&mut self, now: Nanos, board: &Board) -> Option<(Running<A>, When, Published)> {
        let (mut next, when) = self.armed.take_if(|_| self.current.is_some())?;
        match next.published(board, now) {
            Ok(Some(published)) => return Some((next, when, published)),
            Ok(None) => self.armed = Some((next, when)),
            Err(sentence) => {
                self.tell(PlanEvent::Refused(next.ticket, sentence));
                self.discard(next);
            }
        }
        None
    }

    /// Takes the plan's turn at time `now` back from the plan module, and copies the active plan's transitions to
    /// `transitions`.
    pub(crate) fn land(&mut self, now: Nanos, transitions: &mut Transitions) -> PlanTurn<A::Input> {
        let Landed { flight, replaced, panic } = self.desk.take();
        if let Some(message) = panic {
            return PlanTurn::Panicked(message);
        }
        let Some(mut flight) = flight else { return PlanTurn::Late };
        self.aloft = None;
        // A late turn's input is out of date.
        let turn = flight.turn.take().filter(|_| flight.at == now);
        if let Some(old) = replaced {
            self.begins(old, &mut flight.current, now);
        }
        if now >= self.trial_ends
            && let Some((old, _)) = self.suspended.take()
        {
            self.discard(old);
            self.tell(PlanEvent::Accepted(flight.current.ticket));
        }
        if let Some((next, when)) = flight.next.take() {
            if self.armed.is_none() {
                self.armed = Some((next, when));
            } else {
                // Another plan was armed while the turn was late.
                self.replaced(next);
            }
        }
        std::mem::swap(transitions, &mut flight.transitions);
        self.current = Some(flight);
        turn.map_or(PlanTurn::Late, PlanTurn::Made)
    }

    /// Collects, at a turn break, the outcome of one order to the compiler.
    pub(crate) fn arm(&mut self) {
        // In a run without a session, nothing takes the events.
        let old = self.events.len().saturating_sub(MOST_EVENTS);
        self.events.drain(..old);
        let Some(Outcome { ticket, product }) = self.compiler.as_mut().and_then(Compiler::done) else { return };
        let product = match self.refuses(ticket) {
            Some(reason) => {
                self.spent.push(Box::new(product));
                Err(reason.to_owned())
            }
            None => product,
        };
        let product = product.and_then(|Product { compiled, next }| {
            if !compiled.warnings.is_empty() {
                self.tell(PlanEvent::Warned(ticket, compiled.warnings));
            }
            let names = compiled.plans.iter().map(|plan| Arc::clone(&plan.name)).collect();
            self.store_all(compiled.plans).map(|()| (names, next))
        });
        match product {
            // The request was made before the rule replaced the plan, but compiled afterwards.
            Ok((_, Some(next))) if ticket <= self.overruled => {
                self.spent.push(Box::new(next));
                self.tell(PlanEvent::Cancelled(ticket));
            }
            Ok((_, Some(next))) => self.arm_plan(ticket, next),
            Ok((names, None)) => self.tell(PlanEvent::Stored(ticket, names)),
            Err(diagnostics) => self.tell(PlanEvent::Refused(ticket, diagnostics)),
        }
    }

    /// Ends the plan on trial for this reason. The plan that it replaced continues at its atom in the next turn, as if
    /// no time had passed.
    ///
    /// # Errors
    /// Fails if no plan is on trial.
    pub(crate) fn rollback(&mut self, why: &str) -> Result<(), NoTrial> {
        let (old, suspended) = self.suspended.take().ok_or(NoTrial)?;
        self.resumes = Some(suspended);
        let from = self.drives(&old, "rolled back".to_owned());
        let to = old.ticket;
        self.take_over(old);
        self.tell(PlanEvent::RolledBack { from, to, why: why.to_owned() });
        Ok(())
    }

    /// Replaces the active plan at once and without a trial, on behalf of a supervisor. Cancels all plans that were
    /// about to take over, including plans that are being compiled, and bans plans of other robots.
    pub(crate) fn divert(&mut self, plan: LoadedPlan<A>) {
        self.peers.bar(self.last, REPLACED);
        self.take_back();
        self.overruled = self.last;
        self.last = self.last.saturating_add(1);
        let mut plan = Running::new(self.last, plan);
        plan.number = self.next_number();
        self.drives(&plan, String::new());
        self.take_over(plan);
        if let Some((old, _)) = self.suspended.take() {
            self.discard(old);
        }
        self.resumes = None;
        self.tell(PlanEvent::Began(self.last));
    }

    /// Refuses plans of other robots for this reason until a plan has begun that the operator requested after this
    /// call. Returns `true` if a plan of another robot was armed.
    pub(crate) fn bar_peers(&mut self, reason: &'static str) -> bool {
        self.peers.bar(self.last, reason);
        if let Some(order) = self.compiler.as_ref().and_then(Compiler::take_back_sent) {
            self.tell(PlanEvent::Refused(order.ticket, reason.to_owned()));
            self.spent.push(Box::new(order));
        }
        let Some((plan, _)) = self.armed.take_if(|(plan, _)| self.peers.has(plan.ticket)) else { return false };
        self.tell(PlanEvent::Refused(plan.ticket, reason.to_owned()));
        self.discard(plan);
        true
    }

    /// Returns `true` while the active plan's turn is late, and after the plan has panicked.
    pub(crate) fn is_late(&self) -> bool {
        self.current.is_none()
    }

    /// Returns the module attributes that the active, the next and the suspended plan read.
    pub(crate) fn reads(&self) -> impl Iterator<Item = &'static ModuleRead> + Clone {
        let next = |flight: &Flight<A>| flight.next.as_ref().map(|(next, _)| next.reads);
        let current = self.current.iter().flat_map(move |flight| [Some(flight.current.reads), next(flight)]).flatten();
        let armed = self.armed.iter().map(|(armed, _)| armed.reads);
        let suspended = self.suspended.iter().map(|(suspended, _)| suspended.reads);
        current.chain(armed).chain(suspended).flatten()
    }

    /// Returns the names of the other robots that the active and the armed plan refer to.
    pub(crate) fn robots(&self) -> impl Iterator<Item = &'static str> {
        let current = self.current.iter().map(|flight| &flight.current);
        let plans = current.chain(self.armed.iter().map(|(armed, _)| armed));
        plans.flat_map(|plan| plan.robots.iter().copied())
    }

    /// Returns the module that makes the turns of these plans.
    pub(crate) fn module(&self) -> PlanModule<A> {
        PlanModule(Arc::clone(&self.desk))
    }

    /// Suspends `old`, and records that the plan `new` has replaced it in the turn at `now`.
    fn begins(&mut self, old: Running<A>, new: &mut Running<A>, now: Nanos) {
        new.number = self.next_number();
        if let Some((older, _)) = self.suspended.replace((old, now)) {
            self.discard(older);
        }
        self.trial_ends = Nanos(now.0.saturating_add(self.trial.0));
        self.drives(new, format!("main set to {}", new.name));
        if !self.peers.has(new.ticket) {
            self.peers.lift(new.ticket);
        }
        self.tell(PlanEvent::Began(new.ticket));
    }

    fn next_number(&mut self) -> u32 {
        self.begun = self.begun.saturating_add(1);
        self.begun
    }

    /// Records that a plan is active from now on, for this reason; returns the request number of the previously active
    /// plan.
    fn drives(&mut self, plan: &Running<A>, reason: String) -> u32 {
        let driving = Driving { number: plan.number, ticket: plan.ticket, name: Arc::clone(&plan.name) };
        self.reason = reason;
        std::mem::replace(&mut self.driving, driving).ticket
    }

    /// Replaces the active plan. If the active plan has panicked or hangs, it remains with its thread.
    fn take_over(&mut self, plan: Running<A>) {
        match &mut self.current {
            Some(flight) => {
                let old = std::mem::replace(&mut flight.current, plan);
                self.discard(old);
            }
            None => {
                if let Some(ticket) = self.aloft.take() {
                    self.tell(PlanEvent::Cancelled(ticket));
                }
                self.current = Some(Flight::new(plan));
                self.desk = Arc::default();
            }
        }
    }
}
