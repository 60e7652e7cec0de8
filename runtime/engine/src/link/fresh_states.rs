//! Sessions of the other robots, and the newest state of each robot that has arrived since this robot's last turn.

use std::collections::BTreeMap;
use std::time::Instant;

use mdle_runtime::Nanos;

use super::sessions::Sessions;
use super::{State, clock};

/// States of other robots. One lock protects both the sessions and the states, so that an older state never replaces a
/// newer one.
#[derive(Debug, Default)]
pub(super) struct FreshStates {
    sessions: Sessions,
    /// Newest state of each robot, with its arrival time.
    states: BTreeMap<String, (State, Nanos)>,
}

impl FreshStates {
    /// Returns the current session of a robot; `None` before its first state has arrived.
    pub(super) fn session(&self, robot: &str) -> Option<u64> {
        self.sessions.of(robot)
    }

    /// Stores a state that has arrived at time `at`, unless a newer state of the same robot has already arrived.
    ///
    /// # Errors
    /// Returns the end of a sentence if the state belongs to an ended session, or to another robot with the same name.
    pub(super) fn take(&mut self, state: State, at: Nanos) -> Result<(), String> {
        if self.sessions.take(&state.name, (state.session, state.number), Instant::now())? {
            self.states.insert(state.name.clone(), (state, at));
        }
        Ok(())
    }

    /// Removes and returns the newest state of each robot from which a state has arrived since the last call. The time
    /// since its arrival is added to the age of each state.
    pub(super) fn take_all(&mut self) -> impl Iterator<Item = State> + use<> {
        let now = clock::now();
        std::mem::take(&mut self.states).into_values().map(move |(mut state, at)| {
            state.age = Nanos(state.age.0.saturating_add(now.since(at).0));
            state
        })
    }
}
