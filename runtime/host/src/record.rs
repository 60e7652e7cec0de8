//! The record of a run: an MCAP file from which the run can be replayed bit for bit (docs/src/reference/interfaces.md,
//! 6.6).
//!
//! The thread that drives the robot only encodes each turn. The thread of an [`Outlet`] converts the turns to messages,
//! and writes the file.

use std::io::{self, Write};

use mdle_record::frames::Frames;
use mdle_record::{Applied, Begin, Overruled, RecordedChange, RecordedTransition, TurnMade};
use mdle_runtime::trace::{Json, Seconds};
use mdle_runtime::{Nanos, Sensed, Turn, Twist};

use crate::Intervention;
use crate::background_writer::Outlet;
use crate::cause::CauseText;
use crate::drive::Exact;
use crate::log::LogEntry;
use crate::supervised::Supervised;
use crate::transitions::Operand;

/// Interval of the run's time, in nanoseconds, at which recorded data are passed to the system in a run that a person
/// may be watching.
const FLUSH: u64 = 1_000_000_000;

/// A record that is being written.
#[derive(Debug)]
pub(crate) struct RecordWriter<W = Outlet> {
    file: W,
    frames: Frames,
    begin: Begin,
    /// Output of the turn, the input that the plan requested, and the input that is sent.
    exact: Option<(Sensed, Twist, Twist)>,
    /// Changes, other than the robot's output, that influenced the turn.
    changes: Vec<RecordedChange>,
    has_begun: bool,
    /// `true` if each second of the run is written to the file immediately; `false` at the fastest pace.
    prompt: bool,
    flushed: Nanos,
    /// Encoded frames of a turn.
    bytes: Vec<u8>,
    /// Last recorded intervention of the supervisor.
    intervention: String,
}

/// The number, time and plan of a turn, without results of the plan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnmadeTurn<'a> {
    /// Number of the turn, counted from 0.
    pub(crate) number: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// Number of the plan, counted from 1.
    pub(crate) plan: u64,
    /// The supervisor's intervention in the turn.
    pub(crate) supervised: &'a Supervised,
}

impl<W: Write> RecordWriter<W> {
    /// Creates the record of a run that begins, which is written to `file`.
    pub(crate) fn new(file: W, begin: Begin, prompt: bool) -> Self {
        let (frames, bytes, intervention) = (Frames::default(), Vec::new(), String::new());
        let flushed = Nanos::ZERO;
        let changes = Vec::new();
        Self { file, frames, begin, exact: None, changes, has_begun: false, prompt, flushed, bytes, intervention }
    }

    /// Stores the output and the input of a turn, and the other changes that influenced the turn.
    pub(crate) fn take(&mut self, exact: Option<Exact<'_>>, changes: Vec<RecordedChange>) {
        self.exact = exact.map(|Exact { y, asked, sent }| (*y, asked, sent));
        self.changes = changes;
    }

    /// Writes a turn whose output has been stored.
    ///
    /// # Errors
    /// Fails if the file cannot be written, for example because the disk is full.
    pub(crate) fn turn(&mut self, entry: &LogEntry<'_>) -> io::Result<()> {
        let LogEntry { turn, t, state, kind, transitions, plan_number, supervised, .. } = *entry;
        let applied = match kind {
            Turn::Law(()) => Applied::Law,
            Turn::Cut => Applied::Cut,
            Turn::Over => Applied::Over,
        };
        let steps = transitions.iter().map(|(transition, operands)| step(transition, operands)).collect();
        let unmade = UnmadeTurn { number: turn, t, plan: plan_number, supervised };
        self.exact(&unmade, (applied, state), steps)?;
        self.transitions(entry);
        self.written(&unmade)
    }

    /// Writes a turn that was made without a plan and whose output has been stored.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn turn_without_plan(&mut self, unmade: &UnmadeTurn<'_>) -> io::Result<()> {
        self.exact(unmade, (Applied::Cut, 0), Vec::new())?;
        self.written(unmade)
    }

    /// Writes the beginning of the record, unless it has already been written with a turn.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn begins(&mut self, y: &Sensed) -> io::Result<()> {
        self.bytes.clear();
        self.begin(y);
        self.file.write_all(&self.bytes)
    }

    /// Appends the beginning of the record to the encoded bytes, before the first turn.
    fn begin(&mut self, y: &Sensed) {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.frames.begin(&self.begin, y, &mut self.bytes);
        }
    }

    /// Writes the data of a turn that a replay needs.
    fn exact(
        &mut self,
        turn: &UnmadeTurn<'_>,
        (applied, state): (Applied, u64),
        steps: Vec<RecordedTransition>,
    ) -> io::Result<()> {
        let Some((y, asked, sent)) = self.exact.take() else {
            return Err(io::Error::other("this robot has outputs or inputs of a type of its own"));
        };
        let UnmadeTurn { number, t, plan, supervised } = *turn;
        self.bytes.clear();
        self.begin(&y);
        let overruled = supervised.intervention();
        let overruled = overruled.map(|Intervention { rule, .. }| Overruled { asked, rule: rule.to_owned() });
        let (changes, overruled) = (self.changes.as_slice(), overruled.as_ref());
        let turn = TurnMade { number, t, sent, applied, plan, state, changes, overruled };
        self.frames.turn(turn, &y, steps.into_iter(), &mut self.bytes);
        Ok(())
    }

    /// Writes the events of a turn, and passes the whole turn to the writing thread.
    fn written(&mut self, turn: &UnmadeTurn<'_>) -> io::Result<()> {
        let UnmadeTurn { number, t, plan, supervised } = *turn;
        for request in &supervised.requests {
            self.event(number, t, "request", request);
        }
        if let Some(reason) = &supervised.begins {
            self.event(number, t, "plan", &format!("plan {plan}: {reason}"));
        }
        self.intervention(turn);
        self.file.write_all(&self.bytes)?;
        if self.prompt && t.0 >= self.flushed.0.saturating_add(FLUSH) {
            self.flushed = t;
            self.file.flush()?;
        }
        Ok(())
    }

    /// Writes the transitions of a turn for users and viewers.
    fn transitions(&mut self, entry: &LogEntry<'_>) {
        let LogEntry { plan, turn, t, transitions, .. } = *entry;
        for (transition, operands) in transitions.iter() {
            let source = plan.source();
            let texts = operands.iter().filter_map(|(number, _)| source.operand(transition.scope, *number));
            let texts: Vec<_> = texts.map(|words| Json(words.text).to_string()).collect();
            let by = transition.cause.by(plan.condition(transition.scope));
            let cause = CauseText { plan, transition, operands }.to_string();
            let law = transition.atom.map_or("null".to_owned(), |atom| Json(plan.law(atom)).to_string());
            let json = format!(
                "{{\"turn\":{turn},\"t\":{},\"from\":{},\"to\":{},\"level\":{},\"by\":{},\"operands\":[{}],\
                 \"cause\":{},\"law\":{law}}}",
                Seconds(t),
                transition.from,
                transition.to,
                transition.cause.level(),
                Json(by),
                texts.join(","),
                Json(&cause),
            );
            self.frames.transition(t, &json, &mut self.bytes);
        }
    }

    /// Writes an event if the supervisor's intervention differs from the one in the previous turn.
    fn intervention(&mut self, turn: &UnmadeTurn<'_>) {
        let now = turn.supervised.intervention();
        let now =
            now.map_or_else(String::new, |Intervention { verdict, rule, .. }| format!("{}: {rule}", verdict.word()));
        if now != self.intervention {
            self.event(turn.number, turn.t, "safety", &now);
            self.intervention = now;
        }
    }

    fn event(&mut self, turn: u64, t: Nanos, kind: &str, text: &str) {
        let json = format!("{{\"turn\":{turn},\"t\":{},\"kind\":{},\"text\":{}}}", Seconds(t), Json(kind), Json(text));
        self.frames.event(t, &json, &mut self.bytes);
    }

    /// Writes the reason why the turns have ended.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn ended(&mut self, turn: u64, t: Nanos, cause: &str) -> io::Result<()> {
        if !self.has_begun {
            return Ok(());
        }
        self.bytes.clear();
        self.event(turn, t, "end", cause);
        self.file.write_all(&self.bytes)
    }

    /// Completes the record.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn close(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.frames.end(&mut self.bytes);
        self.file.write_all(&self.bytes)?;
        self.file.flush()
    }
}

fn step(transition: &mdle_runtime::Transition, operands: &[Operand]) -> RecordedTransition {
    RecordedTransition::new(transition, operands.iter().map(|(number, _)| *number))
}
