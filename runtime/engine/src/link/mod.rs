//! The state link: robots send each other their poses, velocities, rounds, and module attributes (paper, sections III
//! and IV-D).
//!
//! A [`Link`] carries states and letters: [`Air`] between robots in one process, [`Tcp`] between processes and
//! machines. An [`Endpoint`] prepares and checks the frames of a link to other processes, for any medium. [`StateLink`]
//! belongs to one robot. Before a turn, it writes the states that have arrived to the robot's output; after the turn,
//! it sends the robot's own state. It never waits.

mod air;
mod bytes;
mod clock;
mod endpoint;
mod foreign_names;
mod frame;
mod fresh_states;
mod lag;
mod letter;
mod letter_frame;
mod letters;
mod orders;
mod outbox;
mod pace;
mod questions;
mod refusals;
mod rounds;
mod sessions;
mod source;
mod state;
mod state_frame;
mod state_link;
mod tcp;

use std::sync::{Mutex, MutexGuard, PoisonError};

use mdle_runtime::Nanos;

pub use air::{Air, Faults};
pub use endpoint::{Endpoint, LinkSettings};
pub use frame::{Challenge, FrameDraft};
pub use letter::{Content, LONGEST_TEXT, Letter, RefusedPlan};
pub use letter_frame::LONGEST_LETTER;
pub use outbox::{Outbox, Posted};
pub use source::FrameSource;
pub use state::{SharedValue, State};
pub use state_link::StateLink;
pub use tcp::{Tcp, TcpSettings};

use crate::attribute::{AttributeName, Reading};
use crate::module::Refusal;

/// A medium through which a robot exchanges states and letters with other robots.
pub trait Link: Send {
    /// Sends the robot's state at time `now`, without waiting.
    fn send(&mut self, state: &State, now: Nanos);
    /// Calls `take` with each state that has arrived by `now`, in any order.
    fn receive(&mut self, now: Nanos, take: &mut dyn FnMut(State));
    /// Returns the session of the robot, which all its states contain.
    fn session(&self) -> u64 {
        0
    }
    /// Sends a letter to the robot `to` at time `now`, without waiting.
    ///
    /// # Errors
    /// Returns a sentence with the reason if the letter cannot be sent.
    fn post(&mut self, to: &str, letter: &Letter, now: Nanos) -> Result<(), String>;
    /// Calls `take` with each letter that has arrived by `now`.
    fn letters(&mut self, now: Nanos, take: &mut dyn FnMut(Letter));
    /// Calls `take` with each plan that was refused on arrival and has to be answered.
    fn refused_plans(&mut self, _take: &mut dyn FnMut(RefusedPlan)) {}
    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}
}

/// A board for attributes of other robots.
pub(crate) trait Foreign {
    /// Puts a value on the board that another robot has published.
    ///
    /// # Errors
    /// Fails if a module of this robot has the same name, if a module reads the attribute with another kind, if the
    /// attribute's kind has changed, or if there are too many attributes.
    fn put_foreign(&mut self, name: &AttributeName, reading: Reading) -> Result<(), Refusal>;
}

/// Locks a mutex, even if it is poisoned because a thread panicked while it held the lock.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
