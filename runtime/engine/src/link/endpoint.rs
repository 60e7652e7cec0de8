//! The endpoint of a link to other processes, for any medium that carries frames. It prepares the frames that its robot
//! sends, checks frames that arrive, and keeps the contents of these frames until the robot's turn.

#[cfg(test)]
mod tests;

use std::hash::{BuildHasher as _, RandomState};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use mdle_runtime::{Nanos, Printable};

use super::bytes::NAME;
use super::frame::{FrameDraft, RefusedFrame, SharedKey, StateTimes, VERSION};
use super::fresh_states::FreshStates;
use super::letter_frame::is_letter;
use super::letters::Letters;
use super::refusals::Refusals;
use super::source::FrameSource;
use super::state_frame::{self, LONGEST, has_fitting_name};
use super::{Letter, Posted, RefusedPlan, State, clock, lock};

/// Maximum number of messages in the queue to the operator.
const MESSAGES: usize = 32;

/// Names and keys of a link, for any medium.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkSettings {
    /// Name of the robot.
    pub name: String,
    /// Name of each other robot.
    pub peers: Vec<String>,
    /// Key that all robots of the link share.
    pub key: String,
    /// Name of each robot with which plans are exchanged, with the key that only these two robots share.
    pub plans: Vec<(String, String)>,
}

/// Endpoint of one robot's link. The robot's turns and the threads that carry frames share it.
pub struct Endpoint {
    session: u64,
    /// Start time of the session.
    begun: Nanos,
    /// Names of the robots from which states are accepted.
    peers: Vec<String>,
    key: SharedKey,
    states: Mutex<FreshStates>,
    letters: Letters,
    messages: Mutex<Vec<String>>,
    refusals: Mutex<Refusals>,
    /// `true` once the robot's run has ended.
    is_over: AtomicBool,
}

impl Endpoint {
    /// Creates the endpoint of a robot, with a new session.
    #[must_use]
    pub fn new(settings: &LinkSettings) -> Self {
        let LinkSettings { name, peers, key, plans } = settings;
        // The hasher is seeded with random numbers of the system.
        let session = RandomState::new().hash_one(name);
        Self {
            session,
            begun: clock::now(),
            peers: peers.clone(),
            key: SharedKey::of(key),
            states: Mutex::default(),
            letters: Letters::new(name, session, plans),
            messages: Mutex::default(),
            refusals: Mutex::default(),
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

    /// Returns the draft of this robot's state. Attributes whose names are too long are omitted.
    #[must_use]
    pub fn state(&self, state: &State) -> FrameDraft {
        for shared in state.attributes.iter().filter(|shared| !has_fitting_name(shared)) {
            self.refuse(&shared.name.to_string(), &format!("a name that is shared has at most {NAME} bytes"));
        }
        let times = StateTimes { begun: self.begun, measured: clock::now() };
        state_frame::written(state, times, &self.key)
    }

    /// Prepares a letter to a peer for sending. If the letter contains a plan, an answer is expected from now on, until
    /// [`Endpoint::is_unsent`] is called.
    ///
    /// # Errors
    /// Returns a sentence if the robot and the peer share no key for letters, or if no state of the peer has arrived.
    pub fn letter(&self, to: &str, letter: &Letter) -> Result<Posted, String> {
        let session = lock(&self.states).session(to);
        let draft = self.letters.draft(to, letter, session, self.time(clock::now()))?;
        self.letters.posts(to, letter, Instant::now());
        let (is_plan, limit) = (letter.content.is_plan(), letter.content.limit());
        Ok(Posted { to: to.to_owned(), number: letter.number, draft, is_plan, limit })
    }

    /// Records that a letter was refused before it was sent, so that no answer to it is expected.
    pub fn is_unsent(&self, number: u64) {
        self.letters.forget(number);
    }

    /// Reports that a letter was dropped because it could not be sent in time.
    pub fn is_late(&self, letter: &Posted) {
        self.letters.forget(letter.number);
        let Posted { to, is_plan, limit, .. } = letter;
        let (what, seconds) = (if *is_plan { "plan for" } else { "answer to" }, limit.as_secs());
        self.say(format!("warning: state link: the {what} {to} is dropped: it could not be sent for {seconds} s"));
    }

    /// Converts a time on the link's clock to the time since the start of the robot's session.
    fn time(&self, now: Nanos) -> Nanos {
        now.since(self.begun)
    }

    /// Processes a frame, without its length field, from `source`. The first frame of a connection must be a state: it
    /// proves the name of the robot. A letter that is refused is reported, and is not an error.
    ///
    /// # Errors
    /// Returns the reason, as a clause such as `it sends a letter before its state`, if the caller has to close the
    /// source. For example, the frame may have another key or version, come from another robot than before, or be one
    /// of too many in a second.
    pub fn take(&self, source: &mut FrameSource, frame: &[u8]) -> Result<(), String> {
        let now = clock::now();
        if is_letter(frame) {
            source.count_letter(Instant::now())?;
            let FrameSource { challenge, robot, lag, .. } = source;
            let robot = robot.as_deref().ok_or_else(|| "it sends a letter before its state".to_owned())?;
            let session = lock(&self.states).session(robot);
            let late = |sent| lag.of(sent, self.time(now));
            // The robot has proved its name: even if this letter is refused, its states are accepted.
            if let Err(reason) = self.letters.take(frame, challenge, (robot, session), late) {
                self.refuse(&format!("a letter of {robot}"), &reason);
            }
            return Ok(());
        }
        if frame.len() > LONGEST {
            return Err("it sends no states".to_owned());
        }
        let read = state_frame::read(frame, &self.key, &source.challenge).map_err(|refused| match refused {
            RefusedFrame::Garbage => "it sends no states".to_owned(),
            RefusedFrame::Version(other) => format!("its version of the link is {other}, and this one has {VERSION}"),
            RefusedFrame::Key => "it has another key, or repeats what was recorded".to_owned(),
            RefusedFrame::Impossible => "its pose or velocity is one that no robot has".to_owned(),
        })?;
        let (state, written) = read;
        if !self.peers.contains(&state.name) {
            let name = Printable(&state.name);
            return Err(format!("its robot `{name}` is none of {}", self.peers.join(", ")));
        }
        let robot = source.robot.get_or_insert_with(|| state.name.clone());
        if *robot != state.name {
            return Err(format!("it sends a state of `{}`, and is `{robot}`", state.name));
        }
        source.count_state(Instant::now())?;
        let lag = source.lag.of(written, self.time(now));
        let age = Nanos(state.age.0.saturating_add(lag.0));
        lock(&self.states).take(State { age, ..state }, now)
    }

    /// Removes and returns the newest state of each robot from which a state has arrived since the last call.
    pub fn states(&self) -> impl Iterator<Item = State> + use<> {
        lock(&self.states).take_all()
    }

    /// Removes and returns the letters that have arrived since the last call. Refuses plans that are too late by now.
    #[must_use]
    pub fn letters(&self) -> Vec<Letter> {
        self.letters.arrived(clock::now())
    }

    /// Removes and returns the plans that were refused since the last call, and reports them. The caller has to answer
    /// each plan.
    #[must_use]
    pub fn refused_plans(&self) -> Vec<RefusedPlan> {
        let plans = self.letters.refused();
        plans.iter().for_each(|plan| self.refuse(&format!("a plan of {}", plan.from), &plan.reason));
        plans
    }

    /// Reports that `what` was refused for a reason, unless the same report was made a short time ago.
    pub fn refuse(&self, what: &str, reason: &str) {
        let warning = lock(&self.refusals).warning(what, reason, Instant::now());
        warning.into_iter().for_each(|warning| self.say(warning));
    }

    /// Reports a message to the operator, unless the queue is full.
    pub fn say(&self, message: String) {
        let mut messages = lock(&self.messages);
        if messages.len() < MESSAGES {
            messages.push(message);
        }
    }

    /// Removes and returns the messages for the operator since the last call.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        let mut messages = std::mem::take(&mut *lock(&self.messages));
        let unanswered = self.letters.unanswered(Instant::now()).into_iter();
        messages.extend(
            unanswered.map(|to| format!("warning: state link: {to} has not answered the plan that was sent 10 s ago")),
        );
        messages
    }

    /// Records that the robot's run has ended.
    pub fn end(&self) {
        self.is_over.store(true, Ordering::Relaxed);
    }

    /// Returns `true` once the robot's run has ended.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}
