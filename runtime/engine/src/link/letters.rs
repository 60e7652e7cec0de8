//! The letters of a link: prepares letters to be sent, and decides which arrived letters are accepted.
//!
//! The proof of a letter covers the letter's number and the sessions of both robots; the robots' states contain the
//! sessions. Therefore, a replayed letter is not accepted a second time, on any medium.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Instant;

use mdle_runtime::Nanos;

use super::frame::{Challenge, FrameDraft, RefusedFrame, SharedKey, VERSION};
use super::letter::UNREAD;
use super::letter_frame::{self, Envelope};
use super::questions::Questions;
use super::{Content, Letter, RefusedPlan, clock, lock};

/// The letters that a robot sends and receives.
pub(super) struct Letters {
    /// Name of this robot.
    own: String,
    /// Session of this robot.
    session: u64,
    /// Name of each peer with which letters are exchanged, with the key that only these two robots share.
    keys: Vec<(String, SharedKey)>,
    unread: Mutex<ArrivedLetters>,
    questions: Mutex<Questions>,
}

/// Letters that have arrived.
#[derive(Default)]
struct ArrivedLetters {
    /// Number of the last letter from each sender in each of its sessions.
    taken: BTreeMap<(String, u64), u64>,
    /// Letters that have arrived since the last turn.
    letters: Vec<WaitingLetter>,
    /// Plans that were refused and not answered yet.
    refused: Vec<RefusedPlan>,
}

/// A letter that waits for the robot's turn.
struct WaitingLetter {
    letter: Letter,
    /// Arrival time of the letter.
    at: Nanos,
    /// Transmission delay of the letter.
    late: Nanos,
}

impl Letters {
    /// Creates the storage for letters of the robot `own` in this session. `keys` contains the name of each peer, and
    /// the key that the robot shares with this peer.
    pub(super) fn new(own: &str, session: u64, keys: &[(String, String)]) -> Self {
        let keys = keys.iter().map(|(name, key)| (name.clone(), SharedKey::of_letters(key))).collect();
        Self { own: own.to_owned(), session, keys, unread: Mutex::default(), questions: Mutex::default() }
    }

    /// Returns the draft of a letter to the peer `to`. The letter is posted at time `sent`, counted from the start of
    /// this robot's session. `session` is the peer's session; `None` if it is not known.
    ///
    /// # Errors
    /// Returns a sentence if the robot and the peer share no key for letters, or if no state of the peer has arrived.
    pub(super) fn draft(
        &self,
        to: &str,
        letter: &Letter,
        session: Option<u64>,
        sent: Nanos,
    ) -> Result<FrameDraft, String> {
        let key = self.key(to).ok_or_else(|| format!("the file of the link has no key `plans` for {to}"))?;
        let meant_for = session.ok_or_else(|| {
            format!("{to} has not been heard yet; send the plan again once it runs with a link to this robot")
        })?;
        let envelope = Envelope { from: self.own.clone(), to: to.to_owned(), sent_in: self.session, meant_for, sent };
        Ok(letter_frame::written(&envelope, letter, key))
    }

    /// Records that a letter is being sent to a robot at time `now`. If it contains a plan, an answer to it is
    /// accepted.
    pub(super) fn posts(&self, to: &str, letter: &Letter, now: Instant) {
        if letter.content.is_plan() {
            lock(&self.questions).ask(to, letter.number, now);
        }
    }

    /// Removes the record of the letter with this number, because the letter was not sent.
    pub(super) fn forget(&self, number: u64) {
        lock(&self.questions).forget(number);
    }

    /// Returns the recipient of each plan that has waited too long for an answer at time `now`; each plan is reported
    /// only once.
    pub(super) fn unanswered(&self, now: Instant) -> Vec<String> {
        lock(&self.questions).unanswered(now)
    }

    /// Processes a frame that has arrived from a robot with the current session `session`. A plan is refused if it is
    /// too late, if it was sent to an earlier run of this robot, or if a newer plan from its sender arrives before the
    /// next turn. `late` returns the delay of a letter, given the time at which it was posted, counted from the start
    /// of the sender's session.
    ///
    /// # Errors
    /// Returns the end of a sentence if the frame is not a letter to this robot from the current session of the sender,
    /// or if it answers a plan that was not sent in this run.
    pub(super) fn take(
        &self,
        frame: &[u8],
        challenge: &Challenge,
        (robot, session): (&str, Option<u64>),
        late: impl FnOnce(Nanos) -> Nanos,
    ) -> Result<(), String> {
        let key = self.key(robot);
        let key = key.ok_or_else(|| format!("no plans are exchanged with {robot}"))?;
        let (envelope, letter) = letter_frame::read(frame, key, challenge).map_err(|refused| match refused {
            RefusedFrame::Garbage | RefusedFrame::Impossible => "it is damaged".to_owned(),
            RefusedFrame::Version(other) => format!("its version of the link is {other}, and this one has {VERSION}"),
            RefusedFrame::Key => "it has another key `plans`, or was recorded".to_owned(),
        })?;
        let Envelope { from, to, sent_in, meant_for, sent } = envelope;
        if from != robot || to != self.own || session != Some(sent_in) {
            return Err("it is not for this run".to_owned());
        }
        let mut unread = lock(&self.unread);
        let last = unread.taken.entry((from, sent_in)).or_default();
        // If its connection breaks, a sender does not know whether a letter has arrived, and sends it again.
        if letter.number <= *last {
            return Ok(());
        }
        *last = letter.number;
        let is_for_this_run = meant_for == self.session;
        match &letter.content {
            Content::Plan { .. } if is_for_this_run => {
                unread.put(WaitingLetter { letter, at: clock::now(), late: late(sent) });
            }
            Content::Plan { .. } => unread.refuse(&letter, format!("it was sent to an earlier run of {}", self.own)),
            Content::Answer { of, .. } if is_for_this_run => {
                lock(&self.questions).answer(robot, *of)?;
                unread.letters.push(WaitingLetter { letter, at: clock::now(), late: Nanos::ZERO });
            }
            Content::Answer { .. } => return Err("it is not for this run".to_owned()),
        }
        Ok(())
    }

    /// Removes and returns the letters that have arrived. Refuses plans that are too late at time `now`.
    pub(super) fn arrived(&self, now: Nanos) -> Vec<Letter> {
        let mut unread = lock(&self.unread);
        let waiting = std::mem::take(&mut unread.letters).into_iter();
        let in_time = waiting.filter_map(|waiting| match waiting.lateness(now) {
            None => Some(waiting.letter),
            Some(reason) => {
                unread.refuse(&waiting.letter, reason);
                None
            }
        });
        in_time.collect()
    }

    /// Removes and returns the plans that were refused since the last call.
    pub(super) fn refused(&self) -> Vec<RefusedPlan> {
        std::mem::take(&mut lock(&self.unread).refused)
    }

    fn key(&self, peer: &str) -> Option<&SharedKey> {
        self.keys.iter().find(|(name, _)| name == peer).map(|(_, key)| key)
    }
}

impl ArrivedLetters {
    /// Adds a plan; it replaces an older plan from the same sender. Refuses the plan if it is too late.
    fn put(&mut self, plan: WaitingLetter) {
        if let Some(reason) = plan.lateness(plan.at) {
            return self.refuse(&plan.letter, reason);
        }
        let from = &plan.letter.from;
        let older = self.letters.iter().position(|old| old.letter.content.is_plan() && old.letter.from == *from);
        if let Some(older) = older.map(|place| self.letters.remove(place)) {
            self.refuse(&older.letter, "a newer one has arrived".to_owned());
        }
        self.letters.push(plan);
    }

    /// Records that a plan was refused and has to be answered. If too many refused plans of a sender wait for an
    /// answer, further plans of this sender are not answered.
    fn refuse(&mut self, letter: &Letter, reason: String) {
        let Letter { from, number, .. } = letter;
        if self.refused.iter().filter(|plan| plan.from == *from).count() < UNREAD {
            self.refused.push(RefusedPlan { from: from.clone(), number: *number, reason });
        }
    }
}

impl WaitingLetter {
    /// Returns the reason to refuse a plan that is too late at time `now`, because an attacker on the line may have
    /// delayed it. Returns `None` for an answer, and for a plan that is in time.
    fn lateness(&self, now: Nanos) -> Option<String> {
        let limit = self.letter.content.limit();
        let late = self.late.0.saturating_add(now.since(self.at).0);
        let is_late = self.letter.content.is_plan() && u128::from(late) > limit.as_nanos();
        is_late.then(|| format!("it is more than {} s late", limit.as_secs()))
    }
}
