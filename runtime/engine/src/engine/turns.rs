//! A turn of all modules and the turn break after it, in the order of docs/src/engine.md.

use std::sync::Arc;
use std::time::{Duration, Instant};

use mdle_runtime::{ModuleRead, Nanos};

use super::event::{Arrivals, End, Event, UNENDED};
use super::loaded::{LoadedModule, ModuleCode, ModuleState};
use super::modules::{Modules, Service};
use super::relevance::relevant;
use crate::fork::{Task, TurnProgress};
use crate::module::{Fault, ThreadEnd};

/// Number of turns after which a late module is given up, if [`PATIENCE`] has passed as well.
const LATE_TURNS: u64 = 10;
/// Time after which a late module is given up. Also the maximum time that a turn break in stepped time waits for a
/// background module without a latency.
const PATIENCE: Duration = Duration::from_secs(1);
/// Maximum part of a declared latency by which [`PATIENCE`] is extended when a turn break in stepped time waits for a
/// background module. The sum has to stay below ten seconds, the maximum duration of a turn.
const LONGEST_LATENCY: Duration = Duration::from_secs(8);
/// Number of turns after which the modules are sorted by cost again.
const REORDERED: u64 = 128;

impl<Y: Send + Sync + 'static> Modules<Y> {
    /// Makes turn `number` of every relevant module, with the robot's output `y`, measured at `now`. In real time, the
    /// call returns at `deadline` even if some modules have not finished.
    pub fn turn(&mut self, y: Y, number: u64, now: Nanos, deadline: Option<Instant>) {
        let Self { loaded, order, fork, events, replayed, turn, .. } = self;
        *turn = (number, now);
        events.clear();
        let recorded = replayed.as_ref().and_then(|arrivals| arrivals.front());
        let was_skipped = |name: &Arc<str>| recorded.is_some_and(|arrivals| arrivals.skipped.contains(name));
        let modules = order.iter().filter_map(|number| loaded.get(*number));
        let seats = modules.filter(|module| !was_skipped(&module.name)).filter_map(LoadedModule::queued);
        fork.turn(y, number, now, seats, deadline);
    }

    /// Performs the first part of the turn break: finds modules that are late or have failed, and publishes the values
    /// of registered modules and then those of waiting background modules.
    pub fn settle(&mut self) {
        self.arrivals.clear();
        if let Some(replayed) = &mut self.replayed {
            self.arrivals = replayed.pop_front().unwrap_or_default();
        }
        for number in 0..self.loaded.len() {
            self.settle_registered(number);
        }
        if self.replayed.is_some() {
            self.settle_replayed();
        } else {
            for number in 0..self.loaded.len() {
                self.settle_background(number);
            }
        }
        self.events.extend(self.board.newly_refused().map(Event::NotANumber));
    }

    /// Performs the last part of the turn break: determines the relevant modules, and updates each module's copies of
    /// the attributes that it reads.
    pub fn prepare(&mut self) {
        if std::mem::take(&mut self.has_changed) {
            let relevant = self.relevant();
            for (module, is_relevant) in self.loaded.iter_mut().zip(relevant) {
                let is_wanted = is_relevant && !module.is_held;
                self.events.extend(module.becomes(is_wanted));
            }
        }
        for module in &mut self.loaded {
            let (declared, wires) = (&module.declared, &module.wires);
            match &mut module.runs {
                ModuleCode::InTurns(seat) if module.state == ModuleState::Active => {
                    if let Some(mut occupant) = seat.occupant() {
                        self.board.hand(declared, wires, &mut occupant.ports);
                    }
                }
                ModuleCode::InTurns(_) => {}
                ModuleCode::InBackground(visit) => {
                    if let Some(mut ports) = visit.ports.take() {
                        self.board.hand(declared, wires, &mut ports);
                        ports.now = self.turn.1;
                        visit.gate.give_back(ports);
                    }
                }
            }
        }
        if self.turn.0.is_multiple_of(REORDERED) {
            self.reorder();
        }
    }

    /// Returns, for each module, `true` if it always makes turns, or if something reads it.
    pub(super) fn relevant(&self) -> Vec<bool> {
        let places = self.plan_reads.iter().filter_map(|read| self.board.place_of(read));
        relevant(&self.loaded, places)
    }

    /// Sets the attributes that plans, safety rules and other robots read. A module without other readers makes turns
    /// only while this list contains one of its attributes.
    pub(crate) fn plan_reads(&mut self, reads: impl Iterator<Item = &'static ModuleRead> + Clone) {
        if !self.plan_reads.iter().eq(reads.clone()) {
            self.plan_reads.clear();
            self.plan_reads.extend(reads);
            self.has_changed = true;
        }
    }

    /// Drops values later, on another thread.
    pub(crate) fn drop_later(&self, things: impl Iterator<Item: Send + 'static>) {
        things.for_each(|thing| self.janitor.drop_later(thing));
    }

    /// Orders the modules by priority, then by cost, the most expensive first.
    pub(super) fn reorder(&mut self) {
        let Self { loaded, order, .. } = self;
        let key = |number: &usize| {
            let module = loaded.get(*number);
            let priority = module.map_or(0, |module| module.declared.priority);
            let cost = module.and_then(LoadedModule::seat).map_or(Duration::ZERO, |seat| seat.cost());
            (std::cmp::Reverse((priority, cost)), *number)
        };
        order.sort_unstable_by_key(key);
    }

    /// Publishes the values of a registered module's turn, and updates the state of the module.
    fn settle_registered(&mut self, number: usize) {
        let Self { board, loaded, events, arrivals, replayed, turn, .. } = self;
        let Some(module) = loaded.get_mut(number) else { return };
        let ModuleCode::InTurns(seat) = &module.runs else { return };
        if module.state.is_final() {
            return;
        }
        let progress = match replayed {
            Some(_) => arrivals.progress(&module.name),
            None => seat.progress(),
        };
        let LoadedModule { name, state, late_turns, fault, .. } = module;
        match progress {
            TurnProgress::Skipped if replayed.is_none() => arrivals.skipped.push(Arc::clone(name)),
            TurnProgress::Late => {
                if replayed.is_none() {
                    arrivals.late.push(Arc::clone(name));
                }
                *late_turns = late_turns.saturating_add(1);
                // A module that is late repeatedly is reported once, and its late turns are counted.
                let is_new = |event: &Event| *late_turns == 1 || !matches!(event, Event::Late(_));
                events.extend(state.is_late(name, *turn).filter(is_new));
                if *state == ModuleState::GivenUp {
                    UNENDED.clone_into(fault);
                }
            }
            TurnProgress::Done | TurnProgress::Queued | TurnProgress::Running | TurnProgress::Skipped => {}
        }
        if progress != TurnProgress::Done {
            return;
        }
        let Some(mut occupant) = seat.occupant() else { return };
        if let ModuleState::Late(..) = state {
            *state = ModuleState::Active;
            // The module may have become irrelevant in the meantime.
            self.has_changed = true;
        }
        if let Some(Fault(sentence)) = occupant.fault.take() {
            *state = ModuleState::Failed;
            fault.clone_from(&sentence);
            events.push(Event::Failed(Arc::clone(name), sentence));
            return;
        }
        occupant.task = match (occupant.task, *state) {
            (Task::Start, ModuleState::Active) | (Task::Turn, _) => Task::Turn,
            (Task::Start | Task::Stop, _) => Task::Start,
        };
        board.publish(module.first, &mut occupant.ports, turn.1, |_, _| ());
    }

    /// Publishes the values of a background module that waits for the break, or records that the module has ended.
    fn settle_background(&mut self, number: usize) {
        let Self { board, loaded, events, arrivals, service, turn, .. } = self;
        let Some(module) = loaded.get_mut(number) else { return };
        let patience = module.patience();
        let ModuleCode::InBackground(visit) = &mut module.runs else { return };
        if module.state != ModuleState::Active || *service == Service::WhenDue && turn.1 < visit.due {
            return;
        }
        let is_there = *service == Service::WhenReady || visit.gate.wait_for_offer(patience);
        if let Some(mut ports) = visit.gate.take_offer() {
            let keep = |place, value: &_| arrivals.values.push((place, Clone::clone(value)));
            board.publish(module.first, &mut ports, turn.1, keep);
            visit.ports = Some(ports);
            visit.due = Nanos(turn.1.0.saturating_add(module.declared.latency.0));
            return;
        }
        let end = match visit.gate.take_end() {
            Some(ThreadEnd::Returned) => End::Returned,
            Some(ThreadEnd::Failed(sentence)) => End::Failed(sentence),
            Some(ThreadEnd::Panicked(message)) => End::Panicked(message),
            None if is_there => return,
            None => End::GivenUp,
        };
        events.push(module.ends(end.clone()));
        arrivals.ended.push((Arc::clone(&module.name), end));
    }

    /// Publishes the values that arrived at this turn break of the recorded run, and records the modules that ended
    /// there.
    fn settle_replayed(&mut self) {
        let Self { board, loaded, events, arrivals, turn, .. } = self;
        for (place, value) in &arrivals.values {
            board.put(*place, value.clone(), turn.1);
        }
        for (name, end) in &arrivals.ended {
            let module = loaded.iter_mut().find(|module| module.name == *name);
            events.extend(module.map(|module| module.ends(end.clone())));
        }
    }
}

impl Arrivals {
    /// Returns the progress of a module at this turn break of the recorded run.
    fn progress(&self, name: &Arc<str>) -> TurnProgress {
        match (self.late.contains(name), self.skipped.contains(name)) {
            (true, _) => TurnProgress::Late,
            (false, true) => TurnProgress::Skipped,
            (false, false) => TurnProgress::Done,
        }
    }
}

impl ModuleState {
    /// Records that a module is late at this turn break. Returns an event if the module was not late before, or if it
    /// is given up now.
    fn is_late(&mut self, name: &Arc<str>, (number, now): (u64, Nanos)) -> Option<Event> {
        let Self::Late(since, at) = *self else {
            *self = Self::Late(number, now);
            return Some(Event::Late(Arc::clone(name)));
        };
        let is_over = number.saturating_sub(since) >= LATE_TURNS && now.since(at).0 >= nanos(PATIENCE);
        is_over.then(|| {
            *self = Self::GivenUp;
            Event::GivenUp(Arc::clone(name))
        })
    }
}

impl<Y> LoadedModule<Y> {
    /// Starts or stops a module. Returns the event; `None` if nothing has changed.
    fn becomes(&mut self, is_wanted: bool) -> Option<Event> {
        let mut occupant = self.seat().and_then(|seat| seat.occupant());
        let task = occupant.as_mut().map(|occupant| &mut occupant.task);
        let (state, event) = match (self.state, is_wanted) {
            (ModuleState::Stopped, true) => {
                if let Some(task) = task {
                    // A module with a pending stop continues.
                    *task = if *task == Task::Stop { Task::Turn } else { Task::Start };
                }
                (ModuleState::Active, Event::Started(Arc::clone(&self.name)))
            }
            (ModuleState::Active, false) => {
                if let Some(task) = task.filter(|task| **task == Task::Turn) {
                    *task = Task::Stop;
                }
                (ModuleState::Stopped, Event::Stopped(Arc::clone(&self.name)))
            }
            (_, true | false) => return None,
        };
        drop(occupant);
        self.state = state;
        Some(event)
    }

    /// Returns the real time for which a turn break in stepped time waits for a background module.
    fn patience(&self) -> Duration {
        PATIENCE.saturating_add(Duration::from_nanos(self.declared.latency.0).min(LONGEST_LATENCY))
    }

    /// Records the end of a background module.
    fn ends(&mut self, end: End) -> Event {
        let name = Arc::clone(&self.name);
        let (state, event) = match end {
            End::Returned => (ModuleState::Ended, Event::Ended(name)),
            End::Failed(sentence) => (ModuleState::Failed, Event::Failed(name, sentence)),
            End::Panicked(message) => {
                (ModuleState::Failed, Event::Failed(name, format!("its code panicked, which is a bug: {message}")))
            }
            End::GivenUp => {
                let sentence = format!("it has exchanged no values within {} s", self.patience().as_secs_f64());
                (ModuleState::GivenUp, Event::Failed(name, sentence))
            }
        };
        if let Event::Failed(_, sentence) = &event {
            self.fault.clone_from(sentence);
        }
        self.state = state;
        event
    }
}

fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
