//! The modules of an engine. The modules make turns; between two turns there is a turn break, which serves the modules
//! in a fixed order.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use mdle_runtime::{ModuleRead, Nanos};

use super::event::{Arrivals, Event};
use super::janitor::Janitor;
use super::loaded::{LoadedModule, ModuleCode, ModuleState};
use super::unpublished::unpublished;
use crate::attribute::{AttributeName, Reading, Value};
use crate::board::Board;
use crate::fork::{Fork, Threads};
use crate::module::{About, Candidate, PLAN, ROBOT, Refusal, ValueSource};

/// Rule that decides when a background module exchanges values with a turn break.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Service {
    /// In real time, the module exchanges values at the first turn break at which it is waiting.
    WhenReady,
    /// In stepped time, the module exchanges values at the first turn break after its latency has passed. The turn
    /// break waits for the module, so runs with the same inputs are equal.
    WhenDue,
}

/// Modules, with the board on which they publish.
///
/// A turn consists of [`Modules::turn`], [`Modules::settle`], changes by requests, and [`Modules::prepare`]; the last
/// three steps are the turn break.
pub struct Modules<Y> {
    pub(super) board: Board,
    /// Loaded modules in the order in which they were loaded. Every turn break uses this order.
    pub(super) loaded: Vec<LoadedModule<Y>>,
    /// Order in which worker threads start the modules in a turn.
    pub(super) order: Vec<usize>,
    pub(super) fork: Fork<Y>,
    pub(super) service: Service,
    pub(super) janitor: Janitor,
    /// Attributes that are read by other robots, by safety rules, and by plans, including plans that may become active.
    pub(super) plan_reads: Vec<ModuleRead>,
    /// `true` if the relevant modules have to be determined again.
    pub(super) has_changed: bool,
    pub(super) events: Vec<Event>,
    pub(super) arrivals: Arrivals,
    /// Recorded arrivals for the remaining turn breaks of the replayed run; `None` if no run is replayed. In a replay,
    /// no background module runs.
    pub(super) replayed: Option<VecDeque<Arrivals>>,
    /// Number and start time of the current turn.
    pub(super) turn: (u64, Nanos),
}

impl<Y: Send + Sync + 'static> Modules<Y> {
    /// Creates the modules of an engine; no module is loaded yet.
    ///
    /// # Errors
    /// Fails if the system cannot create the threads.
    pub fn new(threads: Threads, service: Service) -> io::Result<Self> {
        Ok(Self {
            board: Board::default(),
            loaded: Vec::new(),
            order: Vec::new(),
            fork: Fork::new(threads)?,
            service,
            janitor: Janitor::get()?,
            plan_reads: Vec::new(),
            has_changed: true,
            events: Vec::new(),
            arrivals: Arrivals::default(),
            replayed: None,
            turn: (0, Nanos::ZERO),
        })
    }

    /// Creates the modules of a replay. `arrivals` contains the arrivals at each turn break of the recorded run, in
    /// order.
    ///
    /// # Errors
    /// Fails if the system cannot create the threads.
    pub fn replaying(threads: Threads, arrivals: impl IntoIterator<Item = Arrivals>) -> io::Result<Self> {
        let mut modules = Self::new(threads, Service::WhenReady)?;
        modules.replayed = Some(arrivals.into_iter().collect());
        Ok(modules)
    }

    /// Returns the board as of the last turn break.
    #[must_use]
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// Returns the board, so that a replay can set the values of the recorded run.
    pub(super) fn board_mut(&mut self) -> &mut Board {
        &mut self.board
    }

    /// Returns the events since the last call of [`Modules::turn`].
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Returns the arrivals at the last turn break: values from background modules, background modules that have ended,
    /// and registered modules that were late or skipped.
    #[must_use]
    pub fn arrivals(&self) -> &Arrivals {
        &self.arrivals
    }

    /// Returns the name and the state of each loaded module.
    pub fn names(&self) -> impl Iterator<Item = (&str, ModuleState)> {
        self.loaded.iter().map(|module| (&*module.name, module.state))
    }

    /// Returns the number of turns that ended without a module because it was late; 0 if no module has this name.
    #[must_use]
    pub fn late_turns(&self, name: &str) -> u64 {
        self.module(name).map_or(0, |module| module.late_turns)
    }

    /// Returns the mean real time of the last turns of a registered module, in which newer turns weigh more. Returns
    /// `None` before the first turn, and if no registered module has this name.
    #[must_use]
    pub fn cost(&self, name: &str) -> Option<Duration> {
        let cost = self.module(name)?.seat()?.cost();
        (!cost.is_zero()).then_some(cost)
    }

    /// Returns the priority of a module; 0 if no module has this name.
    #[must_use]
    pub fn priority(&self, name: &str) -> i32 {
        self.module(name).map_or(0, |module| module.declared.priority)
    }

    /// Returns the reason why a module failed or was given up; empty for any other module, and if no module has this
    /// name.
    #[must_use]
    pub fn fault(&self, name: &str) -> &str {
        self.module(name).map_or("", |module| &module.fault)
    }

    /// Returns the attributes of other modules that a module reads.
    pub fn reads(&self, name: &str) -> impl Iterator<Item = &AttributeName> {
        let sources = self.module(name).into_iter().flat_map(|module| &module.declared.reads);
        sources.filter_map(|source| match source {
            ValueSource::Attribute(attribute, _) => Some(attribute),
            ValueSource::Setting(..) => None,
        })
    }

    fn module(&self, name: &str) -> Option<&LoadedModule<Y>> {
        self.loaded.iter().find(|module| &*module.name == name)
    }

    /// Loads a module at the end of the list of modules. A registered module makes its first turn after the next
    /// [`Modules::prepare`].
    ///
    /// # Errors
    /// Fails without any change if the name is taken, or if another module expects a different kind for one of the
    /// module's attributes.
    pub fn load(&mut self, candidate: Candidate<Y>) -> Result<(), Refusal> {
        let name = Arc::clone(&candidate.name);
        let is_loaded = self.names().any(|(known, _)| known == &*name);
        if &*name == ROBOT || &*name == PLAN && is_loaded {
            return Err(Refusal::Reserved(name.to_string()));
        }
        if is_loaded || self.board.of(&name).next().is_some() {
            return Err(Refusal::NameTaken(name.to_string()));
        }
        self.board.add(&name, &candidate.declared);
        let refused = self.board.wires(&name, &candidate.declared).err();
        let refused = refused.or_else(|| self.loaded.iter().find_map(|module| self.rewired(module).err()));
        if let Some(refusal) = refused {
            self.board.remove(&name);
            return Err(refusal);
        }
        self.loaded.push(LoadedModule::new(candidate, self.turn.1, self.replayed.is_none()));
        self.rewire();
        self.events.push(Event::Loaded(name));
        Ok(())
    }

    /// Returns each loaded module that reads unpublished attributes: its name, and a sentence about these attributes.
    pub(super) fn unpublished(&self) -> impl Iterator<Item = (&str, String)> {
        let sentence = |module: &LoadedModule<Y>| unpublished(&module.name, &module.declared, &self.board);
        self.loaded.iter().filter_map(move |module| Some((&*module.name, sentence(module)?)))
    }

    /// Unloads a module, and removes its attributes from the board. A thread that is still running a turn of the module
    /// keeps the module until the turn ends.
    ///
    /// # Errors
    /// Fails if no module has this name.
    pub fn unload(&mut self, name: &str) -> Result<(), Refusal> {
        let number = self.number(name)?;
        let module = self.loaded.remove(number);
        self.board.remove(name);
        self.rewire();
        self.events.push(Event::Unloaded(Arc::clone(&module.name)));
        // Dropping the module runs its code, which may take long.
        self.janitor.drop_later(module.runs);
        Ok(())
    }

    /// Changes a setting of a module; the new value applies from the module's next turn or exchange on.
    ///
    /// # Errors
    /// Fails if there is no such module or setting, or if the value has another kind or is NaN.
    pub fn set(&mut self, name: &str, setting: &str, value: Value) -> Result<(), Refusal> {
        let number = self.number(name)?;
        let path = AttributeName::new(name, setting);
        let about = self.settings(name).find(|(about, _)| &*about.name == setting).map(|(about, _)| about.kind);
        let kind = about.ok_or_else(|| Refusal::NoSetting(name.to_owned(), setting.to_owned()))?;
        if kind != value.kind() {
            return Err(Refusal::OtherSetting(path, kind, value.kind()));
        }
        if value.has_nan() {
            return Err(Refusal::NotANumber(path));
        }
        let reading = Reading { value, at: self.turn.1 };
        self.loaded.get_mut(number).map(|module| module.declared.set(setting, reading));
        Ok(())
    }

    /// Returns the settings of a module with their values.
    pub fn settings(&self, name: &str) -> impl Iterator<Item = (&About, &Reading)> {
        let module = self.loaded.iter().filter(move |module| &*module.name == name);
        module.flat_map(|module| module.declared.settings())
    }

    pub(super) fn number(&self, name: &str) -> Result<usize, Refusal> {
        let number = self.loaded.iter().position(|module| &*module.name == name);
        number.ok_or_else(|| Refusal::Unknown(name.to_owned()))
    }

    pub(super) fn rewired(&self, module: &LoadedModule<Y>) -> Result<crate::board::Wires, Refusal> {
        self.board.wires(&module.name, &module.declared)
    }

    pub(super) fn rewire(&mut self) {
        let Self { board, loaded, .. } = self;
        for module in loaded.iter_mut() {
            module.first = board.first(&module.name);
            // Kinds were compared before.
            module.wires = board.wires(&module.name, &module.declared).unwrap_or_default();
        }
        self.order = (0..self.loaded.len()).collect();
        self.has_changed = true;
        self.reorder();
    }
}

impl<Y> Drop for Modules<Y> {
    /// Asks the threads of all background modules to end. The modules are dropped afterwards, which waits for the
    /// threads.
    fn drop(&mut self) {
        for module in &self.loaded {
            if let ModuleCode::InBackground(visit) = &module.runs {
                visit.gate.stop();
            }
        }
    }
}
