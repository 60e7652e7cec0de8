//! Letters of a link: which are sent, and which that arrive are taken.
//!
//! The proof of a letter covers the sessions of both robots, which states tell, and its number: a letter that somebody
//! has recorded and sends once more is not taken again, whatever carries it.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Instant;

use mdle_runtime::Nanos;

use super::frame::{Challenge, Draft, Key, Refused, VERSION};
use super::letter::{NOW, UNREAD};
use super::letter_frame::{self, Envelope};
use super::questions::Questions;
use super::{Content, Letter, lock};
use crate::plans::When;

/// The letters of a robot.
pub(super) struct Letters {
    /// Name of the robot.
    own: String,
    /// Session of the robot.
    session: u64,
    /// For each peer with which letters are exchanged, its name and the key that only both have.
    keys: Vec<(String, Key)>,
    /// For each sender and each of its sessions, the number of the last letter.
    taken: Mutex<BTreeMap<(String, u64), u64>>,
    /// Letters that have arrived since the last turn.
    arrived: Mutex<Vec<Letter>>,
    questions: Mutex<Questions>,
}

impl Letters {
    /// Returns the letters of the robot of this name and session, which has these keys in common with peers.
    pub(super) fn new(own: &str, session: u64, keys: &[(String, String)]) -> Self {
        let keys = keys.iter().map(|(name, key)| (name.clone(), Key::of_letters(key))).collect();
        let (taken, arrived, questions) = (Mutex::default(), Mutex::default(), Mutex::default());
        Self { own: own.to_owned(), session, keys, taken, arrived, questions }
    }

    /// Returns the draft of a letter to a peer, which is in this session, at time `sent` of this robot's session.
    ///
    /// # Errors
    /// Robot and peer have no key for letters, or the peer has not been heard: a sentence.
    pub(super) fn draft(&self, to: &str, letter: &Letter, session: Option<u64>, sent: Nanos) -> Result<Draft, String> {
        let key = self.key(to).ok_or_else(|| format!("the file of the link has no key `plans` for {to}"))?;
        let meant_for = session.ok_or_else(|| format!("{to} has not been heard yet"))?;
        let envelope = Envelope { from: self.own.clone(), to: to.to_owned(), sent_in: self.session, meant_for, sent };
        Ok(letter_frame::written(&envelope, letter, key))
    }

    /// Notes that a letter is being sent to a robot at time `now`, so that an answer to it is taken.
    pub(super) fn posts(&self, to: &str, letter: &Letter, now: Instant) {
        if matches!(letter.content, Content::Plan { .. }) {
            lock(&self.questions).ask(to, letter.number, now);
        }
    }

    /// Forgets the letter of this number, which was not sent.
    pub(super) fn forget(&self, number: u64) {
        lock(&self.questions).forget(number);
    }

    /// Returns the recipients of plans that have had no answer for too long at time `now`, each plan once.
    pub(super) fn unanswered(&self, now: Instant) -> Vec<String> {
        lock(&self.questions).unanswered(now)
    }

    /// Takes a frame that has arrived from a robot, which is in this session; returns `true` if its plan replaces one
    /// that waits for the robot's turn. `late` returns how late a letter is that was sent at a time of the robot's
    /// session.
    ///
    /// # Errors
    /// It is no letter of the robot to this robot in this run: the end of a sentence.
    pub(super) fn take(
        &self,
        frame: &[u8],
        challenge: &Challenge,
        (robot, session): (&str, Option<u64>),
        late: impl FnOnce(Nanos) -> Nanos,
    ) -> Result<bool, String> {
        let key = self.key(robot);
        let key = key.ok_or_else(|| format!("no plans are exchanged with {robot}"))?;
        let (envelope, letter) = letter_frame::read(frame, key, challenge).map_err(|refused| match refused {
            Refused::Garbage | Refused::Impossible => "it is damaged".to_owned(),
            Refused::Version(other) => format!("its version of the link is {other}, and this one has {VERSION}"),
            Refused::Key => "it has another key `plans`, or was recorded".to_owned(),
        })?;
        let Envelope { from, to, sent_in, meant_for, sent } = envelope;
        if from != robot || to != self.own || meant_for != self.session || session != Some(sent_in) {
            return Err("it is not for this run".to_owned());
        }
        // Somebody on the line may hold it back.
        if matches!(letter.content, Content::Plan { when: When::Now, .. }) && late(sent).0 > NOW.as_nanos() as u64 {
            return Err(format!("it is a plan for `now`, and is more than {} s late", NOW.as_secs()));
        }
        let mut arrived = lock(&self.arrived);
        let mut taken = lock(&self.taken);
        let last = taken.entry((from, sent_in)).or_default();
        // A sender does not know if a plan has arrived when its connection breaks, and sends it once more.
        if letter.number <= *last {
            return Ok(false);
        }
        *last = letter.number;
        match letter.content {
            Content::Answer { of, .. } if !lock(&self.questions).answer(robot, of) => {
                return Err("it answers a plan that was not sent".to_owned());
            }
            Content::Answer { .. } => {
                let answers = arrived.iter().filter(|letter| letter.from == robot).count();
                if answers >= UNREAD {
                    return Err(format!("more than {UNREAD} letters arrive in a turn"));
                }
            }
            Content::Plan { .. } => {}
        }
        let is_plan = |letter: &Letter| matches!(letter.content, Content::Plan { .. });
        let before = arrived.len();
        // The newest plan counts, as it does once both have been read.
        arrived.retain(|waiting| !(is_plan(&letter) && is_plan(waiting) && waiting.from == letter.from));
        let replaces = arrived.len() < before;
        arrived.push(letter);
        Ok(replaces)
    }

    /// Takes the letters that have arrived.
    pub(super) fn arrived(&self) -> Vec<Letter> {
        std::mem::take(&mut *lock(&self.arrived))
    }

    fn key(&self, peer: &str) -> Option<&Key> {
        self.keys.iter().find(|(name, _)| name == peer).map(|(_, key)| key)
    }
}
