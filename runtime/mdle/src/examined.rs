//! Replays a record and examines its turns, for explanations, plots and scripts.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::Arc;

use mdle_compiler::fsm::Machine;
pub(crate) use mdle_compiler::load::{PlanMoment, ScopeMoment};
use mdle_engine::safety::{Guard, read};
use mdle_host::{Texts, Transitions};
use mdle_record::{Message, MessageKind, ReadError, RecordedTurn};
use mdle_runtime::{Nanos, Printable, Twist};

use crate::failure::{self, Failure};
use crate::record::Record;
use crate::replay::{self, WantedPlan};
use crate::replayer::{self, RecordedRun, ReplayedTurn};
use crate::targets;

/// Exit status if a record does not match its plan.
const DIFFERS: u8 = 1;

/// A recorded run, which is replayed and examined turn by turn.
pub(crate) struct ExaminedRun {
    run: Box<dyn RecordedRun>,
    /// `true` if the record does not contain the plan; the inputs and the texts of transitions are then compared with
    /// the record.
    is_compared: bool,
    /// Description of the active safety rule and of its effect; empty if no rule is active.
    safety: String,
    /// The guards in the safety rules, with their conditions.
    guards: Vec<Guard>,
    /// Name of the safety file.
    safety_file: String,
    /// The plans that have been active so far, by number.
    plans: BTreeMap<u64, Rc<ExaminedPlan>>,
    /// Number of the plan that was active in the last turn.
    number: u64,
}

/// A plan that has been active in the examined run.
pub(crate) struct ExaminedPlan {
    /// The plan as a state machine.
    pub(crate) machine: Arc<Machine>,
    /// The texts of the plan's files.
    pub(crate) texts: Box<dyn Texts>,
}

/// A turn of a record that was replayed and examined.
#[derive(Debug)]
pub(crate) struct ExaminedTurn {
    /// The turn as recorded.
    pub(crate) recorded: RecordedTurn,
    /// The transitions, with their operands.
    pub(crate) transitions: Transitions,
    /// The state of the plan before each transition and at the end of the turn.
    pub(crate) moments: Vec<PlanMoment>,
    /// The input that the plan's law computed, before a safety rule could replace it.
    pub(crate) asked: Twist,
    /// Reason why the plan replaced another plan; empty for the first plan.
    pub(crate) reason: String,
    /// Description of the safety rule that is active in the turn, and of its effect; empty if no rule is active.
    pub(crate) safety: String,
    /// Cause of the end of the record; `None` unless this is the last turn of the record.
    pub(crate) end: Option<String>,
    /// Time of the next turn; `None` at the end of the record.
    pub(crate) next: Option<Nanos>,
}

/// Reason why the replay of a record cannot continue.
#[derive(Debug)]
pub(crate) enum ExaminedStop {
    /// The record cannot be read.
    Unread(ReadError),
    /// A plan that replaced another plan during the run cannot be compiled.
    Failed(Failure),
    /// A turn does not match the record. Contains the number of the turn, and a description of the difference.
    Differs(u64, String),
}

impl ExaminedRun {
    /// Compiles the plan of a record, so that the turns of the record can be replayed.
    ///
    /// # Errors
    /// Fails if the plan cannot be read, has errors, or is not the plan of the record.
    pub(crate) fn of(wanted: &WantedPlan<'_>, record: Record) -> Result<Self, Failure> {
        let begin = wanted.begin;
        let linked = targets::of_record(begin, wanted.log)?;
        let target = Arc::new(mdle_files::target(Some(&begin.target))?);
        let (machine, sources) = replay::plan(wanted, &target)?;
        let run = (linked.replay)(machine, &sources, &target, begin, record, true)?;
        let is_compared = begin.files.is_empty();
        let rules = begin.safety.as_ref().and_then(|texts| Some((texts.name.clone(), read(&texts.text).ok()?.guards)));
        let (safety_file, guards) = rules.unwrap_or_default();
        let plans = BTreeMap::new();
        Ok(Self { run, is_compared, safety: String::new(), guards, safety_file, plans, number: 0 })
    }

    /// Replays the next turn; returns `None` at the end of the record.
    pub(crate) fn turn(&mut self) -> Option<Result<ExaminedTurn, ExaminedStop>> {
        let turn = match self.run.turn()? {
            Ok(turn) => turn,
            Err(replayer::ReplayStop::Unread(error)) => return Some(Err(ExaminedStop::Unread(error))),
            Err(replayer::ReplayStop::Failed(failure)) => return Some(Err(ExaminedStop::Failed(failure))),
        };
        if let Some(safety) = event(&turn.messages, "safety") {
            self.safety = self.with_condition(safety);
        }
        self.number = turn.recorded.plan;
        let looked_at = self.run.looked_at();
        if let Some((machine, _)) = looked_at
            && !self.plans.contains_key(&self.number)
            && let Some(texts) = self.run.texts()
        {
            let plan = ExaminedPlan { machine: Arc::clone(machine), texts };
            self.plans.insert(self.number, Rc::new(plan));
        }
        if let Some(difference) = self.difference(&turn) {
            return Some(Err(ExaminedStop::Differs(turn.recorded.number, difference)));
        }
        let moments = looked_at.map_or(&[][..], |(_, moments)| moments).to_vec();
        let (safety, next) = (self.safety.clone(), self.run.next_time());
        let ReplayedTurn { recorded, messages, transitions, asked, reason, .. } = turn;
        let reason = if reason.is_empty() { self.diversion(&messages) } else { reason };
        let end = event(&messages, "end");
        Some(Ok(ExaminedTurn { recorded, transitions, moments, asked, reason, safety, end, next }))
    }

    /// Returns `text`. If the text ends with the name of a guard, the guard's condition is appended.
    fn with_condition(&self, text: String) -> String {
        let rule = text.rsplit(": ").next().unwrap_or_default();
        match self.guards.iter().find(|guard| guard.name == rule) {
            Some(Guard { when, .. }) => format!("{text} ({}:{}, \"{}\")", self.safety_file, when.line, when.text),
            None => text,
        }
    }

    /// Returns the description of the safety rule that replaced the plan in the turn with these messages; empty if no
    /// rule replaced it.
    fn diversion(&self, messages: &[Message]) -> String {
        let taken = event(messages, "plan").and_then(|text| text.split_once(": ").map(|(_, why)| why.to_owned()));
        taken.map_or_else(String::new, |why| self.with_condition(why))
    }

    /// Returns the plan with this number; `None` if it has not been active.
    pub(crate) fn plan_of(&self, number: u64) -> Option<&Rc<ExaminedPlan>> {
        self.plans.get(&number)
    }

    /// Returns the plan that was active in the last turn; `None` before the first plan begins.
    pub(crate) fn plan(&self) -> Option<&Rc<ExaminedPlan>> {
        self.plans.get(&self.number)
    }

    /// Returns `true` once the end of the record has been read. A run that was killed leaves a record without
    /// an end.
    pub(crate) fn is_whole(&self) -> bool {
        self.run.is_whole()
    }

    /// Returns the difference between a turn and the record, in words; `None` if they match. If the record contains the
    /// plan, inputs may differ, because the next atom does not depend on them.
    fn difference(&self, turn: &ReplayedTurn) -> Option<String> {
        let is_input = |name: &str| matches!(name, "asked input" | "safety rule" | "input");
        if let Some(part) = turn.parts.iter().find(|part| !is_input(&part.name)) {
            let is_fault = part.name == "turn";
            return Some(if is_fault { part.replayed.clone() } else { "it makes other transitions".to_owned() });
        }
        if !self.is_compared {
            return None;
        }
        let other_text = self.plan().and_then(|plan| other_text(&*plan.texts, turn));
        other_text.or_else(|| (!turn.parts.is_empty()).then(|| "it sends another input".to_owned()))
    }
}

/// Returns the text of the last event of the kind `kind` in the messages of a turn; `None` if there is no such event.
fn event(messages: &[Message], kind: &str) -> Option<String> {
    let events = messages.iter().rev().filter(|message| message.kind == MessageKind::Event);
    let mut events = events.filter_map(|message| serde_json::from_str::<serde_json::Value>(&message.json).ok());
    let event = events.find(|event| event.get("kind").and_then(serde_json::Value::as_str) == Some(kind))?;
    event.get("text")?.as_str().map(str::to_owned)
}

/// Compares the texts of a turn's transitions with the record. Returns a description of the difference; `None` if they
/// match.
fn other_text(plan: &dyn Texts, turn: &ReplayedTurn) -> Option<String> {
    let messages = turn.messages.iter().filter(|message| message.kind == MessageKind::Transition);
    for ((transition, _), message) in turn.transitions.iter().zip(messages) {
        let Ok(known) = serde_json::from_str::<serde_json::Value>(&message.json) else { continue };
        let own = [
            ("by", transition.cause.by(plan.condition(transition.scope))),
            ("law", transition.atom.map_or("", |atom| plan.law(atom))),
        ];
        for (key, own) in own {
            let known = known.get(key).and_then(serde_json::Value::as_str).unwrap_or_default();
            if known != own {
                return Some(format!("it has `{own}` in place of `{known}`"));
            }
        }
    }
    None
}

impl ExaminedStop {
    /// Returns the reason as a sentence, for a message.
    pub(crate) fn sentence(&self) -> String {
        match self {
            Self::Unread(error) => error.to_string(),
            Self::Failed(_) => "a plan that took over cannot be compiled".to_owned(),
            Self::Differs(turn, difference) => format!("turn {turn} is not that of this plan: {difference}"),
        }
    }

    /// Prints the reason why the turns of the record `name` cannot be replayed; returns the exit status. `plan` is the
    /// file of the plan, or `None` for the plan in the record.
    ///
    /// # Errors
    /// Fails if the record cannot be read, or if one of its plans cannot be compiled.
    pub(crate) fn tell(self, name: &str, plan: Option<&Path>) -> Result<ExitCode, Failure> {
        let sentence = self.sentence();
        match self {
            Self::Failed(failure) => return Err(failure),
            Self::Unread(ReadError::System(_)) => {
                return Err(Failure::Usage(format!("the record {name} cannot be read: {sentence}")));
            }
            Self::Unread(_) => failure::error(&format!("the record {}: {sentence}", Printable(name))),
            Self::Differs(..) => {
                let help = match plan {
                    Some(_) => "`--plan` has to name the plan that ran".to_owned(),
                    None => format!("`mdle replay {name}` prints what differs"),
                };
                failure::error(&format!("the record {}: {sentence}\nhelp: {help}", Printable(name)));
            }
        }
        Ok(ExitCode::from(DIFFERS))
    }
}
