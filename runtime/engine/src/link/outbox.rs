//! The newest state of a robot and its letters, between the robot's turns and a thread that sends them.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

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
    /// `true` while a connection is open.
    is_open: bool,
    /// The newest state; `None` once it has been taken.
    state: Option<Draft>,
    letters: VecDeque<Waits>,
}

/// A letter that waits to be sent, or a plan that waits for its answer.
struct Waits {
    letter: Posted,
    /// Time at which the letter was posted.
    at: Instant,
    /// `true` once the letter was sent on the open connection.
    is_sent: bool,
    /// `true` once the letter was sent on any connection.
    was_sent: bool,
}

impl Outbox {
    /// Notes that a connection is open, on which nothing has been sent.
    pub fn open(&self) {
        let mut waiting = lock(&self.waiting);
        waiting.is_open = true;
        waiting.letters.iter_mut().for_each(|waits| waits.is_sent = false);
    }

    /// Notes that no connection is open.
    pub fn close(&self) {
        lock(&self.waiting).is_open = false;
    }

    /// Replaces the state, without waiting.
    pub fn put(&self, state: Draft) {
        lock(&self.waiting).state = Some(state);
        self.is_new.notify_one();
    }

    /// Appends a letter at time `now`, without waiting.
    ///
    /// # Errors
    /// The letter is a plan and no connection is open, or too many letters wait: a sentence.
    pub fn post(&self, letter: Posted, now: Instant) -> Result<(), String> {
        let mut waiting = lock(&self.waiting);
        if letter.is_plan && !waiting.is_open {
            return Err(format!("{} cannot be reached at the moment", letter.to));
        }
        if waiting.letters.len() >= UNREAD {
            return Err(format!("{UNREAD} letters wait for {} already", letter.to));
        }
        waiting.letters.push_back(Waits { letter, at: now, is_sent: false, was_sent: false });
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
        let is_idle =
            |waiting: &mut Waiting| waiting.state.is_none() && waiting.letters.iter().all(|waits| waits.is_sent);
        let waited = self.is_new.wait_timeout_while(waiting, HEARTBEAT, is_idle);
        let (mut waiting, _) = waited.unwrap_or_else(PoisonError::into_inner);
        waiting.state.take()
    }

    /// Returns the first letter that has not been sent, and has not waited too long at time `now`.
    #[must_use]
    pub fn letter(&self, now: Instant) -> Option<Posted> {
        let waiting = lock(&self.waiting);
        let letter = waiting.letters.iter().find(|waits| !waits.is_sent && !waits.is_late(now))?;
        Some(letter.letter.clone())
    }

    /// Notes that the letter of this number has been sent. A plan is sent once more if the connection is made anew
    /// before its answer has arrived.
    pub fn is_sent(&self, number: u64) {
        lock(&self.waiting).letters.retain_mut(|waits| {
            let is_it = waits.letter.number == number;
            waits.is_sent |= is_it;
            waits.was_sent |= is_it;
            !is_it || waits.letter.is_plan
        });
    }

    /// Removes the plan in the letter of this number, which has been answered.
    pub fn is_answered(&self, number: u64) {
        lock(&self.waiting).letters.retain(|waits| waits.letter.number != number);
    }

    /// Removes the letters that have waited too long at time `now`; returns those that were never sent.
    #[must_use]
    pub fn late(&self, now: Instant) -> Vec<Posted> {
        let mut late = Vec::new();
        lock(&self.waiting).letters.retain(|waits| {
            let is_late = waits.is_late(now);
            if is_late && !waits.was_sent {
                late.push(waits.letter.clone());
            }
            !is_late
        });
        late
    }
}

impl Waits {
    fn is_late(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.at) >= self.letter.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::frame::Key;

    fn letter(number: u64, is_plan: bool, limit: u64) -> Posted {
        let (draft, limit) =
            (Draft::new(*b"MDLl", None, Vec::new(), &Key::of_letters("pair")), Duration::from_secs(limit));
        Posted { to: "bob".to_owned(), number, draft, is_plan, limit }
    }

    fn numbers(letters: impl IntoIterator<Item = Posted>) -> Vec<u64> {
        letters.into_iter().map(|letter| letter.number).collect()
    }

    #[test]
    fn a_plan_needs_a_connection_and_an_answer_waits() {
        let (outbox, now) = (Outbox::default(), Instant::now());
        let refused = Err("bob cannot be reached at the moment".to_owned());
        assert_eq!(outbox.post(letter(1, true, 2), now), refused);
        assert_eq!(outbox.post(letter(2, false, 10), now), Ok(()));
        outbox.open();
        assert_eq!(outbox.post(letter(3, true, 2), now), Ok(()));
        outbox.close();
        assert_eq!(outbox.post(letter(4, true, 2), now), refused);
    }

    #[test]
    fn a_plan_that_was_not_sent_in_time_is_dropped() {
        let (outbox, begun) = (Outbox::default(), Instant::now());
        let at = |milliseconds| begun + Duration::from_millis(milliseconds);
        outbox.open();
        outbox.post(letter(1, true, 2), begun).unwrap();
        outbox.post(letter(2, true, 10), begun).unwrap();
        assert_eq!((numbers(outbox.letter(at(1999))), numbers(outbox.late(at(1999)))), (vec![1], vec![]));
        assert_eq!((numbers(outbox.letter(at(2000))), numbers(outbox.late(at(2000)))), (vec![2], vec![1]));
        assert!(outbox.late(at(9999)).is_empty());
        outbox.is_sent(2);
        assert!(outbox.late(at(10_000)).is_empty(), "it was sent, and its answer may come");
    }

    #[test]
    fn a_plan_is_sent_on_each_connection_until_it_is_answered() {
        let (outbox, now) = (Outbox::default(), Instant::now());
        outbox.open();
        outbox.post(letter(1, false, 10), now).unwrap();
        outbox.post(letter(2, true, 2), now).unwrap();
        assert_eq!(numbers(outbox.letter(now)), [1]);
        outbox.is_sent(1);
        assert_eq!(numbers(outbox.letter(now)), [2]);
        outbox.is_sent(2);
        assert!(outbox.letter(now).is_none());
        outbox.open();
        assert_eq!(numbers(outbox.letter(now)), [2]);
        outbox.is_answered(2);
        assert!(outbox.letter(now).is_none());
    }
}
