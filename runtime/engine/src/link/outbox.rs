//! The newest state of a robot and its letters, between the robot's turns and a thread that sends them.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::endpoint::Posted;
use super::frame::Draft;
use super::letter::UNREAD;
use super::lock;

/// Time without a new state after which the last one is to be sent again.
const HEARTBEAT: Duration = Duration::from_millis(500);

/// The newest state and the letters that wait for a sender.
#[derive(Default)]
pub struct Outbox {
    waiting: Mutex<Waiting>,
    is_new: Condvar,
}

#[derive(Default)]
struct Waiting {
    /// The newest state; `None` once it has been taken.
    state: Option<Draft>,
    letters: VecDeque<Posted>,
}

impl Outbox {
    /// Replaces the state, without waiting.
    pub fn put(&self, state: Draft) {
        lock(&self.waiting).state = Some(state);
        self.is_new.notify_one();
    }

    /// Appends a letter, without waiting.
    ///
    /// # Errors
    /// Too many letters wait: a sentence.
    pub fn post(&self, letter: Posted) -> Result<(), String> {
        let mut waiting = lock(&self.waiting);
        if waiting.letters.len() >= UNREAD {
            return Err(format!("{UNREAD} letters wait for {} already", letter.to));
        }
        waiting.letters.push_back(letter);
        self.is_new.notify_one();
        Ok(())
    }

    /// Wakes the sender.
    pub fn wake(&self) {
        self.is_new.notify_all();
    }

    /// Waits half a second for a state or a letter that has not been sent; returns the state, or `None` if there is
    /// none.
    #[must_use]
    pub fn next(&self) -> Option<Draft> {
        let waiting = lock(&self.waiting);
        let is_idle = |waiting: &mut Waiting| waiting.state.is_none() && waiting.letters.is_empty();
        let waited = self.is_new.wait_timeout_while(waiting, HEARTBEAT, is_idle);
        let (mut waiting, _) = waited.unwrap_or_else(PoisonError::into_inner);
        waiting.state.take()
    }

    /// Returns the first letter that has not been sent.
    #[must_use]
    pub fn letter(&self) -> Option<Posted> {
        lock(&self.waiting).letters.front().cloned()
    }

    /// Removes the first letter, which has been sent.
    pub fn letter_is_sent(&self) {
        lock(&self.waiting).letters.pop_front();
    }
}
