//! The state link: robots tell each other their poses, velocities, rounds, and attributes of their modules (paper,
//! sections III and IV-D).
//!
//! A [`Link`] carries states and letters: [`Air`] between robots of one process, [`Tcp`] between processes and
//! machines. [`StateLink`] is the module of one robot: before a turn it writes the states that have arrived into
//! the output, and after the turn it sends the robot's own state. It never waits.

mod air;
mod foreign_names;
mod frame;
mod letter;
mod letter_frame;
mod orders;
mod pace;
mod rounds;
mod state;
mod state_link;
mod tcp;

use mdle_runtime::Nanos;

pub use air::{Air, Faults};
pub use letter::{Content, LONGEST_TEXT, Letter};
pub use state::{SharedValue, State};
pub use state_link::StateLink;
pub use tcp::{Tcp, TcpSettings};

use crate::attribute::{AttributeName, Reading};
use crate::module::Refusal;

/// A medium by which a robot sends its states to other robots, and receives theirs.
pub trait Link: Send {
    /// Sends the robot's state at time `now`, without waiting.
    fn send(&mut self, state: &State, now: Nanos);
    /// Calls `take` with each state that has arrived by `now`, in any order.
    fn receive(&mut self, now: Nanos, take: &mut dyn FnMut(State));
    /// Returns the session of the robot, which its states contain.
    fn session(&self) -> u64 {
        0
    }
    /// Sends a letter to the robot of this name at time `now`, without waiting.
    ///
    /// # Errors
    /// The letter cannot be sent: a sentence.
    fn post(&mut self, to: &str, letter: &Letter, now: Nanos) -> Result<(), String>;
    /// Calls `take` with each letter that has arrived by `now`.
    fn letters(&mut self, now: Nanos, take: &mut dyn FnMut(Letter));
    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}
}

/// A board that takes attributes of other robots.
pub(crate) trait Foreign {
    /// Puts a value that another robot has published on the board.
    ///
    /// # Errors
    /// A module of this robot has the name, or reads the attribute as another kind, or there are too many attributes.
    fn put_foreign(&mut self, name: &AttributeName, reading: Reading) -> Result<(), Refusal>;
}
