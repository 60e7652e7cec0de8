//! The newest state and the letters that the turns of a robot hand to the sending thread.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::frame::FrameDraft;
use super::letter::UNREAD;
use super::lock;

/// Maximum number of answers that are kept for one robot. Each plan has at most two answers: one when it waits to take
/// over, and one when it begins.
const ANSWERS: usize = 2 * UNREAD;
/// Interval at which the last state is sent again if there is no new state.
const HEARTBEAT: Duration = Duration::from_millis(500);

/// A letter that is to be sent.
#[derive(Clone)]
pub struct Posted {
    /// Name of the recipient.
    pub to: String,
    /// Number of the letter; this robot counts its letters from 1.
    pub number: u64,
    /// Draft of the letter, without its proof.
    pub draft: FrameDraft,
    /// `true` if the letter contains a plan; an answer is then expected.
    pub is_plan: bool,
    /// Time limit after which the letter is no longer sent.
    pub limit: Duration,
}

/// The newest state and the letters that have to be sent.
#[derive(Default)]
pub struct Outbox {
    waiting: Mutex<WaitingFrames>,
    is_new: Condvar,
}

#[derive(Default)]
struct WaitingFrames {
    /// `true` while a connection is open.
    is_open: bool,
    /// The newest state; `None` after it was taken.
    state: Option<FrameDraft>,
    letters: VecDeque<Waits>,
}

/// A letter that has not been sent, or that is kept after it was sent because the connection may break before the
/// letter arrives.
struct Waits {
    letter: Posted,
    /// Time at which the letter was posted.
    at: Instant,
    /// `true` once the letter has been sent on the current connection.
    is_sent: bool,
    /// `true` once the letter has been sent on any connection.
    was_sent: bool,
}

impl Outbox {
    /// Records that a new connection is open, on which nothing has been sent yet.
    pub fn open(&self) {
        let mut waiting = lock(&self.waiting);
        waiting.is_open = true;
        waiting.letters.iter_mut().for_each(|waits| waits.is_sent = false);
    }

    /// Records that no connection is open.
    pub fn close(&self) {
        lock(&self.waiting).is_open = false;
    }

    /// Replaces the state, without waiting.
    pub fn put(&self, state: FrameDraft) {
        lock(&self.waiting).state = Some(state);
        self.is_new.notify_one();
    }

    /// Appends a letter at time `now`, without waiting.
    ///
    /// # Errors
    /// Returns a sentence if the letter contains a plan and no connection is open, or if the queue is full.
    pub fn post(&self, letter: Posted, now: Instant) -> Result<(), String> {
        let mut waiting = lock(&self.waiting);
        if letter.is_plan && !waiting.is_open {
            return Err(format!("{} cannot be reached at the moment", letter.to));
        }
        let is_alike = |waits: &Waits| (waits.letter.is_plan, &waits.letter.to) == (letter.is_plan, &letter.to);
        let count = waiting.letters.iter().filter(|waits| is_alike(waits)).count();
        if letter.is_plan && count >= UNREAD {
            return Err(format!("{UNREAD} plans wait for {} already", letter.to));
        }
        if !letter.is_plan && count >= ANSWERS {
            // If the queue of answers is full, an answer that was sent is dropped: it has probably arrived.
            let oldest = waiting.letters.iter().position(|waits| is_alike(waits) && waits.was_sent);
            let oldest = oldest.ok_or_else(|| format!("{ANSWERS} answers wait for {} already", letter.to))?;
            waiting.letters.remove(oldest);
        }
        waiting.letters.push_back(Waits { letter, at: now, is_sent: false, was_sent: false });
        self.is_new.notify_one();
        Ok(())
    }

    /// Wakes the sender.
    pub fn wake(&self) {
        self.is_new.notify_all();
    }

    /// Waits at most half a second for a new state or an unsent letter. Returns the state, or `None` if there is no new
    /// state.
    #[must_use]
    pub fn next(&self) -> Option<FrameDraft> {
        let waiting = lock(&self.waiting);
        let is_idle =
            |waiting: &mut WaitingFrames| waiting.state.is_none() && waiting.letters.iter().all(|waits| waits.is_sent);
        let waited = self.is_new.wait_timeout_while(waiting, HEARTBEAT, is_idle);
        let (mut waiting, _) = waited.unwrap_or_else(PoisonError::into_inner);
        waiting.state.take()
    }

    /// Returns the first letter that has not been sent on the current connection and whose time limit has not passed at
    /// `now`.
    #[must_use]
    pub fn letter(&self, now: Instant) -> Option<Posted> {
        let waiting = lock(&self.waiting);
        let letter = waiting.letters.iter().find(|waits| !waits.is_sent && !waits.is_late(now))?;
        Some(letter.letter.clone())
    }

    /// Records that the letter with this number was sent. On a new connection, the letter is sent again, unless its
    /// time limit has passed or, for a plan, the answer has arrived.
    pub fn is_sent(&self, number: u64) {
        for waits in lock(&self.waiting).letters.iter_mut().filter(|waits| waits.letter.number == number) {
            (waits.is_sent, waits.was_sent) = (true, true);
        }
    }

    /// Removes the letter with this number, because its plan was answered.
    pub fn is_answered(&self, number: u64) {
        lock(&self.waiting).letters.retain(|waits| waits.letter.number != number);
    }

    /// Removes letters whose time limit has passed at `now`. Returns the removed letters that were never sent.
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
    use crate::link::frame::SharedKey;

    fn letter(number: u64, is_plan: bool, limit: u64) -> Posted {
        let (draft, limit) =
            (FrameDraft::new(*b"MDLl", None, Vec::new(), &SharedKey::of_letters("pair")), Duration::from_secs(limit));
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
    fn a_letter_is_sent_on_each_connection_until_its_limit() {
        let (outbox, begun) = (Outbox::default(), Instant::now());
        let at = |seconds| begun + Duration::from_secs(seconds);
        let sent = |now| {
            outbox.open();
            let letters = std::iter::from_fn(|| outbox.letter(now).inspect(|letter| outbox.is_sent(letter.number)));
            numbers(letters)
        };
        outbox.open();
        outbox.post(letter(1, false, 10), begun).unwrap();
        outbox.post(letter(2, true, 2), begun).unwrap();
        assert_eq!([sent(begun), sent(at(1)), sent(at(3))], [vec![1, 2], vec![1, 2], vec![1]]);
        outbox.post(letter(3, true, 2), at(3)).unwrap();
        outbox.is_answered(3);
        assert_eq!([sent(at(9)), sent(at(10))], [vec![1], vec![]]);
        assert!(outbox.late(at(10)).is_empty(), "they were sent");
    }

    #[test]
    fn the_letters_that_are_kept_are_bounded() {
        let (outbox, now) = (Outbox::default(), Instant::now());
        outbox.open();
        let plans = (0..=UNREAD as u64).map(|number| outbox.post(letter(number, true, 10), now));
        assert_eq!(plans.last().unwrap(), Err("8 plans wait for bob already".to_owned()));
        let to_eve = Posted { to: "eve".to_owned(), ..letter(50, true, 10) };
        assert_eq!(outbox.post(to_eve, now), Ok(()), "each robot has a number of its own");
        outbox.is_answered(50);
        let answers = (100..=100 + ANSWERS as u64).map(|number| outbox.post(letter(number, false, 10), now));
        assert_eq!(answers.last().unwrap(), Err("16 answers wait for bob already".to_owned()));
        outbox.is_sent(103);
        assert_eq!(outbox.post(letter(200, false, 10), now), Ok(()));
        assert!(outbox.post(letter(201, false, 10), now).is_err());
        outbox.open();
        let letters = std::iter::from_fn(|| outbox.letter(now).inspect(|letter| outbox.is_sent(letter.number)));
        let numbers = numbers(letters);
        assert!(numbers.len() == UNREAD + ANSWERS && !numbers.contains(&103), "{numbers:?}");
    }
}
