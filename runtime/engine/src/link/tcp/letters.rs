//! Letters over TCP: which are sent, and which that arrive are taken.
//!
//! The proof of a letter covers the sessions of both robots, which states tell, and its number: a letter that somebody
//! has recorded and sends once more is refused.

use std::collections::BTreeMap;
use std::sync::Mutex;

use super::lock;
use crate::link::frame::{Key, Refused};
use crate::link::letter::UNREAD;
use crate::link::letter_frame::{self, Envelope};
use crate::link::{Letter, State};

/// The letters of a robot.
pub(super) struct Letters {
    /// Name of the robot.
    own: String,
    /// Session of the robot.
    session: u64,
    /// For each peer with which letters are exchanged, its name and the key that only both have.
    keys: Vec<(String, Key)>,
    /// For each peer that has been heard, its session.
    sessions: Mutex<BTreeMap<String, u64>>,
    /// For each sender, its session and the number of the last letter.
    last: Mutex<BTreeMap<String, (u64, u64)>>,
    /// Letters that have arrived since the last turn.
    arrived: Mutex<Vec<Letter>>,
}

impl Letters {
    /// Returns the letters of the robot of this name and session, which has these keys in common with peers.
    pub(super) fn new(own: &str, session: u64, keys: &[(String, String)]) -> Self {
        let keys = keys.iter().map(|(name, key)| (name.clone(), Key::of_letters(key))).collect();
        let (sessions, last, arrived) = (Mutex::default(), Mutex::default(), Mutex::default());
        Self { own: own.to_owned(), session, keys, sessions, last, arrived }
    }

    /// Notes the session of a peer whose state has arrived.
    pub(super) fn heard(&self, state: &State) {
        let mut sessions = lock(&self.sessions);
        if sessions.get(&state.name) != Some(&state.session) {
            sessions.insert(state.name.clone(), state.session);
        }
    }

    /// Returns the frame of a letter to a peer.
    ///
    /// # Errors
    /// Robot and peer have no key for letters, or the peer has not been heard: a sentence.
    pub(super) fn frame(&self, to: &str, letter: &Letter) -> Result<Vec<u8>, String> {
        let key = self.key(to).ok_or_else(|| format!("the file of the link has no key `plans` for {to}"))?;
        let session = lock(&self.sessions).get(to).copied();
        let meant_for = session.ok_or_else(|| format!("{to} has not been heard yet"))?;
        let envelope = Envelope { from: self.own.clone(), to: to.to_owned(), sent_in: self.session, meant_for };
        Ok(letter_frame::written(&envelope, letter, key))
    }

    /// Takes a frame that has arrived.
    ///
    /// # Errors
    /// It is no letter of a peer to this robot in this run: the end of a sentence.
    pub(super) fn take(&self, frame: &[u8]) -> Result<(), String> {
        let sender = letter_frame::sender(frame).ok_or_else(|| "it sends no letters".to_owned())?;
        let key = self.key(&sender);
        let key = key.ok_or_else(|| format!("it sends a plan as `{sender}`, from which no plans are taken"))?;
        let (envelope, letter) = letter_frame::read(frame, key).map_err(|refused| match refused {
            Refused::Garbage | Refused::Version(_) => "it sends no letters".to_owned(),
            Refused::Key => format!("it sends a plan as `{sender}` with another key"),
        })?;
        let is_current = lock(&self.sessions).get(&sender) == Some(&envelope.sent_in);
        if envelope.to != self.own || envelope.meant_for != self.session || !is_current {
            return Err(format!("it sends a letter of `{sender}` that is not for this run"));
        }
        let mut last = lock(&self.last);
        let before = last.get(&sender).filter(|(session, _)| *session == envelope.sent_in);
        if before.is_some_and(|(_, number)| *number >= letter.number) {
            return Err(format!("it sends a letter of `{sender}` once more"));
        }
        let mut arrived = lock(&self.arrived);
        if arrived.len() >= UNREAD {
            return Err(format!("more than {UNREAD} letters arrive in a turn"));
        }
        last.insert(sender, (envelope.sent_in, letter.number));
        arrived.push(letter);
        Ok(())
    }

    /// Takes the letters that have arrived.
    pub(super) fn arrived(&self) -> Vec<Letter> {
        std::mem::take(&mut *lock(&self.arrived))
    }

    fn key(&self, peer: &str) -> Option<&Key> {
        self.keys.iter().find(|(name, _)| name == peer).map(|(_, key)| key)
    }
}
