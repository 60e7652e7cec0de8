//! The end of a link that leaves the process, whatever carries the frames: it drafts the frames of its robot, checks
//! those that arrive, and keeps what they contain until the robot's turn.

use std::collections::BTreeMap;
use std::hash::{BuildHasher as _, RandomState};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use mdle_runtime::Nanos;

use super::frame::{Draft, Key, Refused, VERSION};
use super::letter_frame::is_letter;
use super::letters::Letters;
use super::sessions::Sessions;
use super::source::Source;
use super::state_frame::{self, LONGEST};
use super::{Letter, State, lock};

/// Maximum number of messages that wait to be shown to the operator.
const MESSAGES: usize = 32;

/// Names and keys of a link, whatever carries it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkSettings {
    /// Name of the robot.
    pub name: String,
    /// Name of each other robot.
    pub peers: Vec<String>,
    /// Key that all robots of the link have.
    pub key: String,
    /// Name of each robot with which plans are exchanged, and the key that only both have.
    pub plans: Vec<(String, String)>,
}

/// A letter that is to be sent.
#[derive(Clone)]
pub struct Posted {
    /// Name of the robot to which the letter is sent.
    pub to: String,
    /// The letter, without its proof.
    pub draft: Draft,
}

/// The end of one robot's link. Threads that carry frames share it with the robot's turns.
pub struct Endpoint {
    session: u64,
    /// Time at which the session began.
    begun: Instant,
    /// Names of the robots from which states are accepted.
    peers: Vec<String>,
    key: Key,
    sessions: Mutex<Sessions>,
    /// For each robot, the newest state that has arrived since the last turn.
    arrived: Mutex<BTreeMap<String, State>>,
    letters: Letters,
    messages: Mutex<Vec<String>>,
    /// `true` once the robot's run has ended.
    is_over: AtomicBool,
}

impl Endpoint {
    /// Returns the endpoint of a robot in a new session.
    #[must_use]
    pub fn new(settings: &LinkSettings) -> Self {
        let LinkSettings { name, peers, key, plans } = settings;
        // Keyed by random numbers of the system.
        let session = RandomState::new().hash_one(name);
        Self {
            session,
            begun: Instant::now(),
            peers: peers.clone(),
            key: Key::of(key),
            sessions: Mutex::default(),
            arrived: Mutex::default(),
            letters: Letters::new(name, session, plans),
            messages: Mutex::default(),
            is_over: AtomicBool::new(false),
        }
    }

    /// Returns the session of the robot.
    #[must_use]
    pub fn session(&self) -> u64 {
        self.session
    }

    /// Returns the names of the other robots.
    #[must_use]
    pub fn peers(&self) -> &[String] {
        &self.peers
    }

    /// Returns the draft of a state of this robot.
    #[must_use]
    pub fn state(&self, state: &State) -> Draft {
        state_frame::written(state, self.time(Instant::now()), &self.key)
    }

    /// Returns a letter to a peer.
    ///
    /// # Errors
    /// Robot and peer have no key for letters, or the peer has not been heard: a sentence.
    pub fn letter(&self, to: &str, letter: &Letter) -> Result<Posted, String> {
        let session = lock(&self.sessions).of(to);
        let draft = self.letters.draft(to, letter, session, self.time(Instant::now()))?;
        Ok(Posted { to: to.to_owned(), draft })
    }

    /// Returns a time as time of the robot's session.
    fn time(&self, now: Instant) -> Nanos {
        Nanos(u64::try_from(now.saturating_duration_since(self.begun).as_nanos()).unwrap_or(u64::MAX))
    }

    /// Takes a frame that has arrived from a source, without its length. The first frame of a source has to be a state,
    /// which proves the name of its robot.
    ///
    /// # Errors
    /// It is neither a state of a peer nor a letter of a peer to this robot in this run, or the source sends too many
    /// frames: the end of a sentence.
    pub fn take(&self, source: &mut Source, frame: &[u8]) -> Result<(), String> {
        let now = Instant::now();
        if is_letter(frame) {
            source.count_letter(now)?;
            let robot = source.robot.as_deref().ok_or_else(|| "it sends a letter before its state".to_owned())?;
            let session = lock(&self.sessions).of(robot);
            return self.letters.take(frame, &source.challenge, (robot, session));
        }
        if frame.len() > LONGEST {
            return Err("it sends no states".to_owned());
        }
        let read = state_frame::read(frame, &self.key, &source.challenge).map_err(|refused| match refused {
            Refused::Garbage => "it sends no states".to_owned(),
            Refused::Version(other) => format!("its version of the link is {other}, and this one has {VERSION}"),
            Refused::Key => "it has another key, or repeats what was recorded".to_owned(),
            Refused::Impossible => "its pose or velocity is one that no robot has".to_owned(),
        })?;
        let (state, _) = read;
        if !self.peers.contains(&state.name) {
            let name = state.name.escape_debug();
            return Err(format!("its robot `{name}` is none of {}", self.peers.join(", ")));
        }
        let robot = source.robot.get_or_insert_with(|| state.name.clone());
        if *robot != state.name {
            return Err(format!("it sends a state of `{}`, and is `{robot}`", state.name));
        }
        source.count_state(now)?;
        if lock(&self.sessions).take(&state.name, (state.session, state.number), now)? {
            lock(&self.arrived).insert(state.name.clone(), state);
        }
        Ok(())
    }

    /// Takes the newest state of each robot that has arrived since the last call.
    pub fn states(&self) -> impl Iterator<Item = State> + use<> {
        std::mem::take(&mut *lock(&self.arrived)).into_values()
    }

    /// Takes the letters that have arrived since the last call.
    #[must_use]
    pub fn letters(&self) -> Vec<Letter> {
        self.letters.arrived()
    }

    /// Reports a message to the operator, unless too many messages wait.
    pub fn say(&self, message: String) {
        let mut messages = lock(&self.messages);
        if messages.len() < MESSAGES {
            messages.push(message);
        }
    }

    /// Takes the messages for the operator since the last call.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        std::mem::take(&mut *lock(&self.messages))
    }

    /// Notes that the robot's run has ended.
    pub fn end(&self) {
        self.is_over.store(true, Ordering::Relaxed);
    }

    /// Returns `true` once the robot's run has ended.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::Content;
    use crate::link::frame::Challenge;
    use crate::plans::When;

    fn endpoint(name: &str, peer: &str) -> Endpoint {
        let plans = vec![(peer.to_owned(), "pair".to_owned())];
        let (name, peers, key) = (name.to_owned(), vec![peer.to_owned()], "key".to_owned());
        Endpoint::new(&LinkSettings { name, peers, key, plans })
    }

    /// Returns the frame of a state with this number on a medium without connections.
    fn state(from: &Endpoint, name: &str, number: u64) -> Vec<u8> {
        let state = State { session: from.session, ..State::of(name, number) };
        from.state(&state).frame(&Challenge::NONE)[4..].to_vec()
    }

    #[test]
    fn a_letter_is_taken_once_on_any_medium() {
        let (ada, bob) = (endpoint("ada", "bob"), endpoint("bob", "ada"));
        let from_ada = || Source::without_connection("ada");
        bob.take(&mut from_ada(), &state(&ada, "ada", 1)).unwrap();
        ada.take(&mut Source::without_connection("bob"), &state(&bob, "bob", 1)).unwrap();
        let content = Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
        let plan = Letter { from: "ada".to_owned(), number: 1, content };
        let letter = ada.letter("bob", &plan).unwrap().draft.frame(&Challenge::NONE)[4..].to_vec();
        assert_eq!(bob.take(&mut from_ada(), &letter), Ok(()));
        for _ in 0..2 {
            let refused = bob.take(&mut from_ada(), &letter).unwrap_err();
            assert_eq!(refused, "it sends a letter of `ada` once more");
        }
        assert_eq!(bob.letters(), [plan]);
    }
}
