//! The turns of an engine that drives a robot: the turn of the plan, the turns of modules, the turn break, and the
//! effects of safety rules.

use std::time::Instant;

use mdle_compiler::load::LoadedPlan;
use mdle_host::{Pilot, PilotFault, PilotTurn, Transitions};
use mdle_record::RecordedChange;
use mdle_runtime::{Machine, Nanos, Output as _, Plan as _, Turn};

use super::Engine;
use crate::engine::event::Event;
use crate::module::PLAN;
use crate::plans::{ENDED, EngineAlphabet, NoTrial, PlanTurn, reads};
use crate::replay::{History, Repeats};

impl<A: EngineAlphabet> Pilot for Engine<A> {
    type Plan = LoadedPlan<A>;

    fn complete(&mut self, y: &mut A::Output, now: Nanos) {
        if let Some(link) = &mut self.link {
            self.messages.extend(link.receive(now, &mut self.modules));
        }
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
        PilotTurn { y, t, number }: PilotTurn<'_, A::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<A::Input>, PilotFault> {
        let mut complete = y.clone();
        if let Some(link) = &self.link {
            let links = link.sense(self.plans.robots(), t);
            self.history.iter_mut().for_each(|history| history.heard(&links));
            complete.take_links(links);
        }
        if let Some(repeats) = &self.repeats {
            complete.take_links(repeats.links(self.plans.robots()));
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.complete(&mut complete);
            let replaced = recorder.take_replaced();
            self.history.iter_mut().zip(replaced).for_each(|(history, path)| history.replaced(&path));
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
        if let Some(recorder) = &mut self.recorder {
            let machine = self.plans.machine();
            let law = machine.and_then(|machine| machine.atom().map(|atom| machine.plan().law(atom)));
            self.messages.extend(recorder.turn(y, law, !transitions.is_empty()));
        }
        self.modules.settle();
        if let Some(link) = &mut self.link {
            let plan = self.plans.machine().map(|machine| (self.plans.number().into(), machine));
            link.tell(y, plan, transitions, self.modules.board(), t);
        }
        self.turn_break()?;
        if let Some(link) = &mut self.link {
            self.messages.extend(link.take_plans(&mut self.plans, t));
        }
        self.plans.arm();
        if let Some(link) = &mut self.link {
            self.messages.extend(link.answer_plans(&mut self.plans, t));
        }
        self.modules.drop_later(self.plans.take_spent());
        self.read_modules();
        self.modules.prepare();
        Ok(turn)
    }

    fn divert(&mut self, plan: LoadedPlan<A>, _: PilotTurn<'_, A::Output>) {
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
        let goes_on = self.ends_trial(&format!("the safety rule {rule} ends it")).is_ok();
        // A replay detects the end of the trial by itself, and has no requests of other robots.
        if self.plans.bar_peers(ENDED) {
            self.plans.note(RecordedChange::Cancelled);
        }
        goes_on
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

    fn take_changes(&mut self) -> Vec<RecordedChange> {
        self.history.as_mut().map(History::take).unwrap_or_default()
    }
}

impl<A: EngineAlphabet> Engine<A> {
    /// Collects the result of the plan's turn. If a plan on trial panicked, rolls the plan back.
    fn land(&mut self, t: Nanos, is_new: bool, transitions: &mut Transitions) -> Result<Turn<A::Input>, PilotFault> {
        if self.repeats.as_ref().is_some_and(|repeats| !repeats.lands()) {
            return Ok(Turn::Cut);
        }
        let was_away = !is_new && self.plans.is_late();
        match self.plans.land(t, transitions) {
            PlanTurn::Made(turn) => Ok(turn),
            PlanTurn::Late => {
                let progress = match (is_new, self.plans.is_late()) {
                    (true, true) => Some(RecordedChange::Late),
                    (true, false) => Some(RecordedChange::Skipped),
                    (false, false) if was_away => Some(RecordedChange::Back),
                    // The plan is not back yet, or waits for attributes that it reads.
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

    /// Ends the plan on trial, and reports the reason to the operator.
    fn ends_trial(&mut self, why: &str) -> Result<(), NoTrial> {
        let name = self.plans.name().to_owned();
        self.go_back(why)?;
        self.messages.push(format!("warning: the plan {name} on trial is ended: {why}"));
        Ok(())
    }

    /// Reports faults of modules to the operator. Rolls back a plan on trial that was given up because it hangs.
    ///
    /// # Errors
    /// Fails if the plan was given up and is not on trial.
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
            self.plans.note(RecordedChange::RolledBack(why.to_owned()));
        }
        Ok(())
    }
}
