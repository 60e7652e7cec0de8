//! The record of a run: an MCAP file that a replay re-executes to the bit (docs/src/reference/interfaces.md, 6.6).
//!
//! The thread that drives the robot only encodes a turn; the thread of an [`Outlet`] makes the messages of it and
//! writes the file.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use mdle_record::frames::{Frames, TurnMade};
use mdle_record::{Applied, Begin, Step};
use mdle_runtime::trace::{Json, Seconds};
use mdle_runtime::{Nanos, Sensed, Turn, Twist};

use crate::Intervention;
use crate::background_writer::Outlet;
use crate::cause::CauseText;
use crate::log::Entry;
use crate::transitions::Operand;

/// Time of the run after which what was recorded is handed to the system, if somebody may be watching.
const FLUSH: u64 = 1_000_000_000;

/// A record that is being written.
#[derive(Debug)]
pub(crate) struct Record {
    file: Outlet,
    frames: Frames,
    begin: Begin,
    /// The output and the input of the turn.
    exact: Option<(Sensed, Twist)>,
    has_begun: bool,
    /// `true` if each second reaches the file at once: not at the fastest pace.
    prompt: bool,
    flushed: Nanos,
    /// The frames of a turn.
    bytes: Vec<u8>,
    /// The supervisor's intervention that was recorded last.
    intervention: String,
}

impl Record {
    /// A record to `file` of a run that begins.
    pub(crate) fn new(file: Outlet, begin: Begin, prompt: bool) -> Self {
        let (frames, bytes, intervention) = (Frames::default(), Vec::new(), String::new());
        let flushed = Nanos::ZERO;
        Self { file, frames, begin, exact: None, has_begun: false, prompt, flushed, bytes, intervention }
    }

    /// Takes the output of a turn, and the input that is sent after it.
    pub(crate) fn take(&mut self, exact: Option<(&Sensed, Twist)>) {
        self.exact = exact.map(|(y, sent)| (*y, sent));
    }

    /// Writes a turn, whose output was taken.
    ///
    /// # Errors
    /// When the file cannot be written, such as when the disk is full.
    pub(crate) fn turn(&mut self, entry: &Entry<'_>) -> io::Result<()> {
        let Some((y, sent)) = self.exact.take() else {
            return Err(io::Error::other("this robot has outputs or inputs of a type of its own"));
        };
        let Entry { plan, turn: number, t, state, kind, transitions, plan_number, .. } = *entry;
        self.bytes.clear();
        if !std::mem::replace(&mut self.has_begun, true) {
            self.frames.begin(&self.begin, &y, plan.paths(), &mut self.bytes);
        }
        let applied = match kind {
            Turn::Law(()) => Applied::Law,
            Turn::Cut => Applied::Cut,
            Turn::Over => Applied::Over,
        };
        let made = TurnMade { number, t, sent, applied, plan: plan_number, state };
        let steps: Vec<_> = transitions.iter().map(|(transition, operands)| step(transition, operands)).collect();
        self.frames.turn(made, &y, steps.into_iter(), &mut self.bytes);
        self.transitions(entry);
        self.intervention(entry);
        self.file.write_all(&self.bytes)?;
        if self.prompt && t.0 >= self.flushed.0.saturating_add(FLUSH) {
            self.flushed = t;
            self.file.flush()?;
        }
        Ok(())
    }

    /// Writes the transitions of a turn for people and viewers.
    fn transitions(&mut self, entry: &Entry<'_>) {
        let Entry { plan, turn, t, transitions, .. } = *entry;
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

    /// Writes an event if the supervisor's part differs from that of the turn before.
    fn intervention(&mut self, entry: &Entry<'_>) {
        let now = entry.supervised.intervention();
        let now =
            now.map_or_else(String::new, |Intervention { verdict, rule, .. }| format!("{}: {rule}", verdict.word()));
        if now != self.intervention {
            self.event(entry.turn, entry.t, "safety", &now);
            self.intervention = now;
        }
    }

    fn event(&mut self, turn: u64, t: Nanos, kind: &str, text: &str) {
        let mut json = String::new();
        let _ =
            write!(json, "{{\"turn\":{turn},\"t\":{},\"kind\":{},\"text\":{}}}", Seconds(t), Json(kind), Json(text));
        self.frames.event(t, &json, &mut self.bytes);
    }

    /// Writes the cause of the end of the turns.
    ///
    /// # Errors
    /// When the file cannot be written.
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
    /// When the file cannot be written.
    pub(crate) fn close(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.frames.end(&mut self.bytes);
        self.file.write_all(&self.bytes)?;
        self.file.flush()
    }
}

fn step(transition: &mdle_runtime::Transition, operands: &[Operand]) -> Step {
    Step::new(transition, operands.iter().map(|(number, _)| *number))
}
