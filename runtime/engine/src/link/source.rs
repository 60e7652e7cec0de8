//! A source of frames, such as a connection, and the limits on its frames.

use std::time::{Duration, Instant};

use super::frame::Challenge;
use super::lag::Lag;

/// Maximum number of states per second from a source. A sender sends half as many at most.
const STATES: u32 = 2000;
/// Maximum number of letters per second from a source. A sender keeps fewer letters than this, and may send all of them
/// at once on a new connection.
const LETTERS: u32 = 40;

/// A source of frames, with the name of its robot, and the numbers of states and letters that it has sent in the
/// current second.
#[derive(Debug)]
pub struct FrameSource {
    pub(super) challenge: Challenge,
    /// Name of the robot; `None` before a frame has proved the name.
    pub(super) robot: Option<String>,
    pub(super) lag: Lag,
    second: Instant,
    states: u32,
    letters: u32,
}

impl FrameSource {
    /// Creates the source for a new connection, on which each frame needs a proof for this challenge.
    pub(super) fn of_connection(challenge: Challenge) -> Self {
        Self { challenge, robot: None, lag: Lag::default(), second: Instant::now(), states: 0, letters: 0 }
    }

    /// Creates the source for the frames of a robot on a medium without connections. Such a source cannot detect
    /// replayed frames of a session from before this run, unless a newer session of the robot is known; replayed frames
    /// then keep that old session alive.
    #[must_use]
    pub fn without_connection(robot: &str) -> Self {
        Self { robot: Some(robot.to_owned()), ..Self::of_connection(Challenge::NONE) }
    }

    /// Returns the name of the robot; `None` before a frame has proved the name.
    #[must_use]
    pub fn robot(&self) -> Option<&str> {
        self.robot.as_deref()
    }

    /// Counts a state that has arrived at time `now`.
    ///
    /// # Errors
    /// Returns the end of a sentence if the source sends too many states.
    pub(super) fn count_state(&mut self, now: Instant) -> Result<(), String> {
        self.tick(now);
        self.states = self.states.saturating_add(1);
        if self.states > STATES { Err(format!("it sends more than {STATES} states a second")) } else { Ok(()) }
    }

    /// Counts a letter that has arrived at time `now`.
    ///
    /// # Errors
    /// Returns the end of a sentence if the source sends too many letters.
    pub(super) fn count_letter(&mut self, now: Instant) -> Result<(), String> {
        self.tick(now);
        self.letters = self.letters.saturating_add(1);
        if self.letters > LETTERS { Err(format!("it sends more than {LETTERS} letters a second")) } else { Ok(()) }
    }

    /// Resets the counts at the end of each second.
    fn tick(&mut self, now: Instant) {
        if now.saturating_duration_since(self.second) >= Duration::from_secs(1) {
            (self.second, self.states, self.letters) = (now, 0, 0);
        }
    }
}
