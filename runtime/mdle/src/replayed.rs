//! Turns of a plan with the outputs of a record, and the first that differs from the record.

use std::io::{BufReader, Read};
use std::sync::Arc;

use mdle_compiler::load::Loaded;
use mdle_record::{Applied, Message, MessageKind, ReadError, RecordedTurn, Records, Step};
use mdle_runtime::{Alphabet, Cause, Machine, Measured, Nanos, Plan, Sensed, Transition, Turn, Twist, Watch};

/// The end of a plan, in place of a law.
const OVER: &str = "plan over";

/// A record that is being read.
pub(crate) type Record = Records<BufReader<Box<dyn Read>>>;

/// Outcome of a replay.
#[derive(Debug)]
pub(crate) enum Outcome {
    /// All turns are those of the record.
    Same {
        /// Number of turns.
        turns: u64,
        /// `true` if the record has an end, or the replay ended before it as asked.
        is_whole: bool,
    },
    /// A turn differs from the record.
    Differs(Difference),
    /// The turns up to this number are those of the record, and the next cannot be read.
    Unread(u64, ReadError),
}

/// The first turn that differs.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// Number of the turn, from 0.
    pub(crate) turn: u64,
    /// Time of the run.
    pub(crate) t: Nanos,
    /// The parts that differ.
    pub(crate) parts: Vec<Part>,
    /// The turns with transitions from this one on; empty unless they were asked for.
    pub(crate) after: Vec<Parting>,
}

/// The transitions of a turn in the record and in the replay, each by the law that began.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Parting {
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// Laws that began in the record; `plan over` at its end.
    pub(crate) recorded: Vec<String>,
    /// Laws that began in the replay.
    pub(crate) replayed: Vec<String>,
}

/// The part of a record that is replayed, and what is wanted of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReplayTerms {
    /// Time of the last turn; `None` for all.
    pub(crate) until: Option<Nanos>,
    /// `true` if the plan goes on after the first turn that differs.
    pub(crate) goes_on: bool,
}

/// A part of a turn that differs.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Name of the part.
    pub(crate) name: String,
    /// The part in the record.
    pub(crate) recorded: String,
    /// The part in the replay.
    pub(crate) replayed: String,
}

/// The transitions of a turn.
#[derive(Debug, Default)]
struct Steps {
    steps: Vec<Step>,
    /// Operands of the next transition.
    operands: Vec<u32>,
    /// The atoms that were entered; `None` for the end of the plan.
    laws: Vec<Option<u32>>,
}

impl Watch for Steps {
    fn operand(&mut self, number: u32, _: Measured) {
        self.operands.push(number);
    }

    fn transition(&mut self, transition: Transition) {
        self.steps.push(Step::new(&transition, std::mem::take(&mut self.operands)));
        self.laws.push(transition.atom);
    }
}

/// Runs a plan on the outputs of a record.
pub(crate) fn replayed<A: Alphabet<Output = Sensed, Input = Twist>>(
    loaded: &Arc<Loaded<A>>,
    record: Record,
    terms: ReplayTerms,
) -> Outcome {
    let (mut machine, mut turns, mut difference) = (None, 0, None::<Difference>);
    let mut record = record.with_messages();
    for recorded in &mut record {
        let (recorded, messages) = match recorded {
            Ok(recorded) => recorded,
            Err(error) if difference.is_none() => return Outcome::Unread(turns, error),
            Err(_) => break,
        };
        let RecordedTurn { t, y, .. } = &recorded;
        if terms.until.is_some_and(|until| *t > until) {
            return difference.map_or(Outcome::Same { turns, is_whole: true }, Outcome::Differs);
        }
        let machine = machine.get_or_insert_with(|| Machine::begin(loaded.plan(), y, *t));
        let mut watch = Steps::default();
        let made = machine.turn(y, *t, &mut watch);
        if difference.is_none() {
            let parts = differing(machine.plan(), &recorded, made, &watch.steps, machine.state());
            if parts.is_empty() {
                turns += 1;
                continue;
            }
            let (turn, t) = (recorded.number, *t);
            difference = Some(Difference { turn, t, parts, after: Vec::new() });
        }
        if !terms.goes_on {
            break;
        }
        let replayed: Vec<_> = watch.laws.iter().map(|atom| law(machine.plan(), *atom)).collect();
        let recorded: Vec<_> = messages.iter().filter_map(law_of).collect();
        if let Some(Difference { after, .. }) = &mut difference
            && !(recorded.is_empty() && replayed.is_empty())
        {
            after.push(Parting { t: *t, recorded, replayed });
        }
    }
    difference.map_or(Outcome::Same { turns, is_whole: record.is_whole() }, Outcome::Differs)
}

/// The law of an atom that began.
fn law(plan: &impl Plan, atom: Option<u32>) -> String {
    atom.map_or_else(|| OVER.to_owned(), |atom| plan.law(atom).to_owned())
}

/// The law that began with a transition of the record.
fn law_of(message: &Message) -> Option<String> {
    let transition: serde_json::Value = serde_json::from_str(&message.json).ok()?;
    (message.kind == MessageKind::Transition)
        .then(|| transition.get("law").and_then(serde_json::Value::as_str).unwrap_or(OVER).to_owned())
}

/// The parts of a turn that differ from the record.
fn differing(plan: &impl Plan, recorded: &RecordedTurn, made: Turn<Twist>, steps: &[Step], state: u64) -> Vec<Part> {
    let words = |applied: Applied| match applied {
        Applied::Law => "the law of the atom",
        Applied::Cut => "the null input, after too many transitions",
        Applied::Over => "the end of the plan",
    };
    let applied = match made {
        Turn::Law(_) => Applied::Law,
        Turn::Cut => Applied::Cut,
        Turn::Over => Applied::Over,
    };
    let sent = made.input();
    let bits = |input: &Twist| [input.v.0, input.omega.0].map(f64::to_bits);
    let input = |input: &Twist| format!("{} m/s, {} rad/s", input.v.0, input.omega.0);
    let listed = |steps: &[Step]| steps.iter().map(|step| text(plan, step)).collect::<Vec<_>>().join("; ");
    let candidates = [
        (recorded.steps == steps, "transitions", listed(&recorded.steps), listed(steps)),
        (recorded.state == state, "state", recorded.state.to_string(), state.to_string()),
        (recorded.applied == applied, "input by", words(recorded.applied).to_owned(), words(applied).to_owned()),
        (bits(&recorded.sent) == bits(&sent), "input", input(&recorded.sent), input(&sent)),
    ];
    let differing = candidates.into_iter().filter(|(is_same, ..)| !is_same);
    let part = |(_, name, recorded, replayed): (bool, &str, String, String)| {
        let none = |text: String| if text.is_empty() { "none".to_owned() } else { text };
        Part { name: name.to_owned(), recorded: none(recorded), replayed: none(replayed) }
    };
    differing.map(part).collect()
}

/// The words of a transition, as a trace has them.
fn text(plan: &impl Plan, step: &Step) -> String {
    let Step { from, scope, cause, to, operands } = step;
    let source = plan.source();
    let fired = operands.iter().filter_map(|number| source.operand(*scope, *number)).map(|words| words.text);
    let by = match cause {
        Cause::Completed(_) => "completed".to_owned(),
        Cause::Fired(_) if operands.is_empty() => plan.condition(*scope).to_owned(),
        Cause::Fired(_) => fired.collect::<Vec<_>>().join(" and "),
    };
    format!("{from} to {to} by {by}")
}
