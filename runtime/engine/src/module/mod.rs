//! Modules: code that makes a turn in every turn of the engine, or runs in the background (paper, sections III-B to
//! III-E).

mod background;
mod candidate;
mod declare;

use background::Gate;
pub(crate) use background::ThreadEnd;
pub use background::{Background, Exchange, Offer, Stopped};
pub use candidate::{Candidate, PLAN, Refusal};
pub(crate) use candidate::{Form, ROBOT, ThreadGate, panicked};
pub use declare::{About, Declare, Relevance};
pub(crate) use declare::{Declared, Ports, ValueSource};
use mdle_runtime::Nanos;

use crate::attribute::{Attribute, In, Out, Reading};

/// A registered module of an engine whose robot has the output `Y`. The function that creates the module declares its
/// attributes; unloading the module drops it.
///
/// Any thread may call a module, but only one thread at a time.
pub trait Module<Y>: Send {
    /// Makes a turn of the module. It can read the robot's output of this turn, and the values that modules had
    /// published by the end of the previous turn.
    ///
    /// # Errors
    /// Returns the reason why the module cannot continue, for the operator. The module then makes no further turn.
    fn turn(&mut self, turn: &mut Turn<'_, Y>) -> Result<(), Fault>;

    /// Called before the module's first turn, and before the first turn after [`Module::stop`].
    fn start(&mut self) {}

    /// Called after the module's last turn when the module is stopped, because a user has stopped it or because nothing
    /// reads it at present.
    fn stop(&mut self) {}
}

impl<Y> Module<Y> for Box<dyn Module<Y>> {
    fn turn(&mut self, turn: &mut Turn<'_, Y>) -> Result<(), Fault> {
        (**self).turn(turn)
    }

    fn start(&mut self) {
        (**self).start();
    }

    fn stop(&mut self) {
        (**self).stop();
    }
}

/// Reason why a module cannot continue, as a sentence for the operator.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault(pub String);

/// Data of one turn of the engine, passed to a module.
#[derive(Debug)]
pub struct Turn<'t, Y> {
    /// Number of the turn, counted from 0.
    pub number: u64,
    /// Time of the turn on the engine's clock; zero in the first turn.
    pub now: Nanos,
    /// The robot's output of this turn.
    pub y: &'t Y,
    pub(crate) ports: &'t mut Ports,
}

impl<Y> Turn<'_, Y> {
    /// Returns the value of an attribute as of the last turn break, or the value of a setting. Returns `None` before a
    /// module has published the attribute, and after its module was unloaded.
    #[must_use]
    pub fn get<T: Attribute>(&self, attribute: In<T>) -> Option<T> {
        self.ports.get(attribute)
    }

    /// Returns the value that [`Turn::get`] returns, with the time at which it was published; for a setting, with the
    /// time at which it was changed.
    #[must_use]
    pub fn reading<T>(&self, attribute: In<T>) -> Option<&Reading> {
        self.ports.reading(attribute)
    }

    /// Publishes a value at the turn break that ends this turn. If a turn publishes several values of an attribute,
    /// only the last one is used; a value that contains NaN is not published.
    pub fn publish<T: Attribute>(&mut self, attribute: Out<T>, value: T) {
        self.ports.publish(attribute, value);
    }
}
