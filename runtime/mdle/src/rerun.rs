//! The turns of a record, made again by its plan and looked at.

use std::io::{BufReader, Read};
use std::sync::Arc;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm;
use mdle_compiler::load::{self, Entered, Examining, Loaded, LoadedPlan};
pub(crate) use mdle_compiler::load::{Moment, ScopeMoment};
use mdle_compiler::plan::Condition;
use mdle_files::Target;
use mdle_host::{Texts, Transitions};
use mdle_record::{Message, MessageKind, ReadError, RecordedTurn, Step, TurnsWithMessages};
use mdle_runtime::{Alphabet, Machine, Nanos, Plan, Sensed, Stamp, Stamps, Turn, Twist};

use crate::failure::Failure;
use crate::record::Record;

/// A turn of a record that was made again.
#[derive(Debug)]
pub(crate) struct RerunTurn {
    /// The turn in the record.
    pub(crate) recorded: RecordedTurn,
    /// The transitions, with their operands.
    pub(crate) transitions: Transitions,
    /// The plan before each transition and at the end of the turn; empty unless the turn was looked at.
    pub(crate) moments: Vec<Moment>,
    /// The plan's input; not that of the law if laws are not run.
    pub(crate) computed: Turn<Twist>,
    /// The event that the record has last up to this turn, as JSON; empty before the first.
    pub(crate) event: String,
    /// Time of the next turn; `None` at the end of the record.
    pub(crate) next: Option<Nanos>,
}

/// Reason why the turns of a record are not made again.
#[derive(Debug)]
pub(crate) enum Stop {
    /// The record cannot be read.
    Unread(ReadError),
    /// This turn is not that of the record, by a difference in words.
    Differs(u64, String),
    /// From this time on another plan ran.
    OtherPlan(Nanos),
}

/// The laws that run when the turns of a record are made again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RerunLaws {
    /// The laws on which transitions depend.
    Needed,
    /// All laws, for the inputs of the plan; those that were sent may be others.
    All,
    /// All laws, whose inputs have to be those that were sent.
    Compared,
}

/// The record of a run whose turns are made again, on any robot.
pub(crate) trait Rerun {
    /// Makes the next turn; `looks` decides whether it is looked at. Returns `None` at the end of the record.
    fn turn(&mut self, looks: &mut dyn FnMut(&RecordedTurn, Option<Nanos>) -> bool) -> Option<Result<RerunTurn, Stop>>;

    /// Returns the texts of the plan.
    fn texts(&self) -> &dyn Texts;

    /// Returns `true` once the end of the record was read; a run that was killed leaves a record without an end.
    fn is_whole(&self) -> bool;
}

/// Loads the plan of a machine, to make the turns of a record again with these laws.
///
/// # Errors
/// The robot of the bound alphabet has other quarks.
pub(crate) fn rerun<A>(
    machine: &fsm::Machine,
    sources: &Sources,
    target: &Target,
    record: Record,
    laws: RerunLaws,
) -> Result<Box<dyn Rerun>, Failure>
where
    A: Alphabet<Output = Sensed, Input = Twist> + 'static,
{
    let loaded = Arc::new(load::load::<A>(machine, sources, &target.alphabet)?);
    // `stuck` reads the progress of laws.
    let lasts = machine.elements().any(|element| element.condition().any(&|part: &Condition| part.lasting().is_some()));
    let runs = machine.atoms().map(|atom| laws != RerunLaws::Needed || lasts || atom.law().completes).collect();
    let texts = loaded.plan();
    let entered = Entered::Stamps(Stamps::new(vec![Stamp::START; machine.depth()].into(), machine.frames().into()));
    Ok(Box::new(RerunOf {
        loaded,
        texts,
        entered,
        runs,
        is_compared: laws == RerunLaws::Compared,
        record: record.with_messages(),
        machine: None,
        event: String::new(),
    }))
}

/// Returns `true` for an event that holds until the next: not for a request, or for a plan that took over.
fn is_standing(message: &Message) -> bool {
    let is_moment = || ["request", "plan"].iter().any(|kind| message.json.contains(&format!("\"kind\":\"{kind}\"")));
    message.kind == MessageKind::Event && !is_moment()
}

struct RerunOf<A: Alphabet> {
    loaded: Arc<Loaded<A>>,
    texts: LoadedPlan<A>,
    entered: Entered,
    runs: Vec<bool>,
    /// `true` if inputs and the texts of transitions have to be those of the record.
    is_compared: bool,
    record: TurnsWithMessages<BufReader<Box<dyn Read>>>,
    machine: Option<Machine<Examining<A>>>,
    /// The last event of the turns that were made.
    event: String,
}

impl<A: Alphabet<Output = Sensed, Input = Twist>> Rerun for RerunOf<A> {
    fn turn(&mut self, looks: &mut dyn FnMut(&RecordedTurn, Option<Nanos>) -> bool) -> Option<Result<RerunTurn, Stop>> {
        let (recorded, messages) = match self.record.next()? {
            Ok(turn) => turn,
            Err(error) => return Some(Err(Stop::Unread(error))),
        };
        let next = self.record.next_time();
        if let Some(event) = messages.iter().rfind(|message| is_standing(message)) {
            self.event.clone_from(&event.json);
        }
        if recorded.plan != 1 {
            return Some(Err(Stop::OtherPlan(recorded.t)));
        }
        let RecordedTurn { t, y, .. } = &recorded;
        let begin =
            || Machine::begin(Examining::new(self.loaded.plan(), self.entered.clone(), self.runs.clone()), y, *t);
        let machine = self.machine.get_or_insert_with(begin);
        machine.plan().look(looks(&recorded, next));
        let mut transitions = Transitions::default();
        let computed = machine.turn(y, *t, &mut transitions);
        let steps = transitions.iter().map(|(made, fired)| Step::new(made, fired.iter().map(|(number, _)| *number)));
        if recorded.state != machine.state() || !steps.eq(recorded.steps.iter().cloned()) {
            return Some(Err(Stop::Differs(recorded.number, "it makes other transitions".to_owned())));
        }
        if self.is_compared
            && let Some(difference) = difference(machine.plan(), (&recorded, &messages), &transitions, computed)
        {
            return Some(Err(Stop::Differs(recorded.number, difference)));
        }
        let moments = machine.plan().moments();
        let event = self.event.clone();
        Some(Ok(RerunTurn { recorded, transitions, moments, computed, event, next }))
    }

    fn texts(&self) -> &dyn Texts {
        &self.texts
    }

    fn is_whole(&self) -> bool {
        self.record.is_whole()
    }
}

/// Returns how the texts of transitions, or the input, differ from those of the record.
fn difference(
    plan: &impl Plan<Input = Twist>,
    (recorded, messages): (&RecordedTurn, &[Message]),
    transitions: &Transitions,
    computed: Turn<Twist>,
) -> Option<String> {
    let texts = messages.iter().filter(|message| message.kind == MessageKind::Transition);
    for ((transition, _), message) in transitions.iter().zip(texts) {
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
    let bits = |input: Twist| [input.v.0, input.omega.0].map(f64::to_bits);
    (bits(computed.input()) != bits(recorded.sent)).then(|| "it sends another input".to_owned())
}
