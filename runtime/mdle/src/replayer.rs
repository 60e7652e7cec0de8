//! Replays the turns of a record. The engine makes the turns again, with the recorded outputs, plans and safety rules.

use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm;
use mdle_compiler::load::{self, Loaded, LoadedPlan, PlanMoment};
use mdle_engine::{Engine, EngineAlphabet, Library, When};
use mdle_files::Target;
use mdle_host::{
    Helm, Intervention, Microphones, Pace, Pilot as _, Refusal, RunTerms, StopRequest, Supervised, Texts, Time,
};
use mdle_host::{PilotFault, Transitions, Verdict};
use mdle_record::{
    Applied, Begin, Message, MessageKind, ReadError, RecordedChange, RecordedTransition, RecordedTurn,
    TurnsWithMessages,
};
use mdle_runtime::{Alphabet, Nanos, Plan, Sensed, Turn, Twist};

use crate::failure::Failure;
use crate::record::{DifferingPart, OVER, Record, RecordSource};
use crate::recorded_files;
use crate::recorded_paths::RecordedPaths;
use crate::safety::{Guarded, SafetyFile};

/// A replay of a recorded run, for any robot.
pub(crate) trait RecordedRun {
    /// Replays the next turn; returns `None` at the end of the record.
    fn turn(&mut self) -> Option<Result<ReplayedTurn, ReplayStop>>;

    /// Returns the machine of the plan that was active in the last turn, and the moments of that turn; `None`
    /// if the plan has not begun, or is not observed.
    fn looked_at(&self) -> Option<(&Arc<fsm::Machine>, &[PlanMoment])>;

    /// Returns the texts of the plan that was active in the last turn; `None` if the plan has not begun, or is not
    /// observed.
    fn texts(&self) -> Option<Box<dyn Texts>>;

    /// Returns the time of the next turn; `None` at the end of the record.
    fn next_time(&self) -> Option<Nanos>;

    /// Returns `true` once the end of the record has been read. A run that was killed leaves a record without
    /// an end.
    fn is_whole(&self) -> bool;
}

/// A turn that was replayed.
#[derive(Debug)]
pub(crate) struct ReplayedTurn {
    /// The turn as recorded.
    pub(crate) recorded: RecordedTurn,
    /// The messages about this turn in the record.
    pub(crate) messages: Vec<Message>,
    /// The parts that differ from the record.
    pub(crate) parts: Vec<DifferingPart>,
    /// The laws that began in the turn, in order. The end of the plan is represented by [`OVER`].
    pub(crate) laws: Vec<String>,
    /// Law of the atom in which the turn ended; empty if there is no such atom.
    pub(crate) law: String,
    /// The transitions, with their operands.
    pub(crate) transitions: Transitions,
    /// The input that the plan's law computed, before a safety rule could replace it.
    pub(crate) asked: Twist,
    /// Reason why the plan replaced another plan; empty for the first plan.
    pub(crate) reason: String,
}

/// Reason why the replay ends before the end of the record.
#[derive(Debug)]
pub(crate) enum ReplayStop {
    /// The record cannot be read.
    Unread(ReadError),
    /// A plan that replaced another plan during the run cannot be compiled.
    Failed(Failure),
}

/// Creates the replay of a record. The machine of the record's first plan is `machine`; plans are observed if `looks`
/// is `true`.
///
/// # Errors
/// Fails if the plan or a safety rule cannot be loaded.
pub(crate) fn replay<A>(
    machine: fsm::Machine,
    sources: &Sources,
    target: &Arc<Target>,
    begin: &Begin,
    record: Record,
    looks: bool,
) -> Result<Box<dyn RecordedRun>, Failure>
where
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let plan = loaded::<A>(machine, sources, target, looks)?;
    let safety = begin.safety.as_ref().map(|texts| SafetyFile::recorded(texts)?.compile::<A>(target, looks));
    let safety = safety.transpose()?.map(Arc::new);
    let period = Duration::from_nanos(begin.period.0);
    let terms = RunTerms {
        time: Time::Stepped(Pace::Max),
        period,
        request: StopRequest::default(),
        microphones: Microphones::default(),
    };
    let engine = Engine::new(plan, &Library::new(), &terms).map_err(refused)?;
    let engine = engine.repeating(safety.as_ref().map(|safety| safety.reads()));
    let helm = Helm::new(engine, safety.map(|safety| supervised(safety, period)));
    let (target, record) = (Arc::clone(target), record.with_messages());
    Ok(Box::new(ReplayOf { helm, record, target, files: Vec::new(), paths: RecordedPaths::default(), looks }))
}

/// Loads the plan of a machine.
fn loaded<A: EngineAlphabet>(
    machine: fsm::Machine,
    sources: &Sources,
    target: &Target,
    looks: bool,
) -> Result<LoadedPlan<A>, Failure> {
    let loaded: Loaded<A> = load::load(&machine, sources, &target.alphabet)?;
    Ok(Arc::new(if looks { loaded.looked_at(Arc::new(machine)) } else { loaded }).plan())
}

/// Returns the supervisor for a run with these safety rules.
fn supervised<A>(safety: Arc<Guarded<A>>, period: Duration) -> Supervised<'static, Engine<A>>
where
    A: EngineAlphabet<Output = Sensed, Input = Twist>,
{
    let supervisor = Box::new(safety.guardian(period));
    Supervised { supervisor, diversions: Box::new(move |number| safety.diversion(number)) }
}

fn refused(refusal: Refusal) -> Failure {
    Failure::Usage(refusal.to_string())
}

struct ReplayOf<A: EngineAlphabet<Output = Sensed, Input = Twist>> {
    helm: Helm<'static, Engine<A>>,
    record: TurnsWithMessages<RecordSource>,
    target: Arc<Target>,
    /// Files of the plans that replaced other plans, by their numbers in the record.
    files: Vec<Vec<(String, String)>>,
    /// Paths that have been recorded so far.
    paths: RecordedPaths,
    /// `true` if plans are observed.
    looks: bool,
}

impl<A: EngineAlphabet<Output = Sensed, Input = Twist>> RecordedRun for ReplayOf<A> {
    fn turn(&mut self) -> Option<Result<ReplayedTurn, ReplayStop>> {
        let (mut recorded, messages) = match self.record.next()? {
            Ok(turn) => turn,
            Err(error) => return Some(Err(ReplayStop::Unread(error))),
        };
        for change in std::mem::take(&mut recorded.changes) {
            if let Err(failure) = self.repeat(change) {
                return Some(Err(ReplayStop::Failed(failure)));
            }
        }
        Some(Ok(self.made(recorded, messages)))
    }

    fn looked_at(&self) -> Option<(&Arc<fsm::Machine>, &[PlanMoment])> {
        self.helm.pilot().machine()?.plan().looked_at()
    }

    fn texts(&self) -> Option<Box<dyn Texts>> {
        Some(Box::new(self.helm.pilot().machine()?.plan().again()?))
    }

    fn next_time(&self) -> Option<Nanos> {
        self.record.next_time()
    }

    fn is_whole(&self) -> bool {
        self.record.is_whole()
    }
}

impl<A: EngineAlphabet<Output = Sensed, Input = Twist>> ReplayOf<A> {
    /// Applies a recorded change before a turn.
    fn repeat(&mut self, change: RecordedChange) -> Result<(), Failure> {
        match change {
            RecordedChange::Files(files) => self.files.push(files),
            RecordedChange::Armed { files, plan, when } => {
                let plan = self.plan(files, &plan)?;
                let when = When::of_number(when).unwrap_or(When::Now);
                self.helm.pilot_mut().plans_mut().replace(plan, when);
            }
            RecordedChange::Limit { .. } | RecordedChange::SafetyReset => {
                if let Some(supervisor) = self.helm.supervisor_mut() {
                    supervisor.repeat(&change);
                }
            }
            RecordedChange::Path { name, setpoints } => self.paths.replace(name, setpoints),
            RecordedChange::Attribute { .. }
            | RecordedChange::Vanished(_)
            | RecordedChange::Published { .. }
            | RecordedChange::Cancelled
            | RecordedChange::RolledBack(_)
            | RecordedChange::Trial(_)
            | RecordedChange::Skipped
            | RecordedChange::Late
            | RecordedChange::Back
            | RecordedChange::Peer { .. } => self.helm.pilot_mut().repeat(&change),
        }
        Ok(())
    }

    /// Compiles a plan that replaced another plan.
    fn plan(&self, files: u32, name: &str) -> Result<LoadedPlan<A>, Failure> {
        let files = self.files.get(files as usize).map_or(&[][..], Vec::as_slice);
        let (machine, sources) = recorded_files::compiled(files, Some(name), &self.target)?;
        loaded(machine, &sources, &self.target, self.looks)
    }

    /// Replays a turn, and compares it with the record.
    fn made(&mut self, recorded: RecordedTurn, messages: Vec<Message>) -> ReplayedTurn {
        let (mut y, mut transitions) = (recorded.y, Transitions::default());
        self.paths.complete(&mut y);
        let made = self.helm.turn(&mut y, recorded.t, recorded.number, &mut transitions);
        let plan = self.helm.pilot().machine().map(|machine| machine.plan());
        let laws = transitions.iter().map(|(transition, _)| match (transition.atom, plan) {
            (Some(atom), Some(plan)) => Plan::law(plan, atom).to_owned(),
            (Some(_) | None, _) => OVER.to_owned(),
        });
        let laws = laws.collect();
        let parts = self.differing((&recorded, &messages), &made, &transitions);
        let machine = self.helm.pilot().machine();
        let law = machine.and_then(|machine| Some(Plan::law(machine.plan(), machine.atom()?).to_owned()));
        if let Some(Intervention { verdict: Verdict::Ended, rule, .. }) = self.helm.intervention() {
            let rule = rule.to_owned();
            self.helm.pilot_mut().ended_by(&rule);
        }
        let (asked, reason) = (self.helm.asked().unwrap_or_default(), self.helm.pilot().reason().to_owned());
        ReplayedTurn { recorded, messages, parts, laws, law: law.unwrap_or_default(), transitions, asked, reason }
    }

    /// Returns the parts of a turn that differ from the record.
    fn differing(
        &self,
        (recorded, messages): (&RecordedTurn, &[Message]),
        made: &Result<Turn<()>, PilotFault>,
        transitions: &Transitions,
    ) -> Vec<DifferingPart> {
        let made = match made {
            Ok(made) => *made,
            Err(PilotFault::Stopped(sentence) | PilotFault::Panicked(sentence)) => {
                return vec![DifferingPart::new("turn", "made", sentence)];
            }
        };
        let applied = match made {
            Turn::Law(()) => Applied::Law,
            Turn::Cut => Applied::Cut,
            Turn::Over => Applied::Over,
        };
        let pilot = self.helm.pilot();
        let (state, number) = (pilot.machine().map_or(0, |machine| machine.state()), pilot.plan_number());
        let steps = transitions
            .iter()
            .map(|(made, fired)| RecordedTransition::new(made, fired.iter().map(|(number, _)| *number)));
        let steps: Vec<_> = steps.collect();
        let (asked, sent) = (self.helm.asked().unwrap_or_default(), *self.helm.input());
        let rule = self.helm.intervention().map_or("", |intervention| intervention.rule);
        let overruled = recorded.overruled.as_ref();
        let recorded_rule = overruled.map_or("", |overruled| &overruled.rule);
        let recorded_asked = overruled.map_or(recorded.sent, |overruled| overruled.asked);
        let mut parts = Vec::new();
        let mut part = |name: &str, is_same: bool, texts: &dyn Fn() -> [String; 2]| {
            if !is_same {
                let [recorded, replayed] = texts();
                parts.push(DifferingPart::new(name, &recorded, &replayed));
            }
        };
        let texts = pilot.machine().map(|machine| machine.plan());
        part("plan", recorded.plan == number, &|| [recorded.plan, number].map(|number| number.to_string()));
        part("transitions", recorded.steps == steps, &|| [recorded_transitions(messages), listed(texts, &steps)]);
        part("state", recorded.state == state, &|| [recorded.state, state].map(|state| state.to_string()));
        part("input by", recorded.applied == applied, &|| [recorded.applied, applied].map(words));
        part("asked input", bits(recorded_asked) == bits(asked) || overruled.is_none() && rule.is_empty(), &|| {
            [recorded_asked, asked].map(input)
        });
        part("safety rule", recorded_rule == rule, &|| [recorded_rule, rule].map(str::to_owned));
        part("input", bits(recorded.sent) == bits(sent), &|| [recorded.sent, sent].map(input));
        parts
    }
}

fn bits(input: Twist) -> [u64; 2] {
    [input.v.0, input.omega.0].map(f64::to_bits)
}

fn input(input: Twist) -> String {
    format!("{} m/s, {} rad/s", input.v.0, input.omega.0)
}

fn words(applied: Applied) -> String {
    match applied {
        Applied::Law => "the law of the atom",
        Applied::Cut => "the null input",
        Applied::Over => "the end of the plan",
    }
    .to_owned()
}

/// Returns the recorded transitions of a turn as text, with the conditions of the plan that ran.
fn recorded_transitions(messages: &[Message]) -> String {
    let transitions = messages.iter().filter(|message| message.kind == MessageKind::Transition).filter_map(|message| {
        let json: serde_json::Value = serde_json::from_str(&message.json).ok()?;
        let operands = json.get("operands")?.as_array()?.iter().filter_map(serde_json::Value::as_str);
        let operands = operands.collect::<Vec<_>>().join(" and ");
        let by = if operands.is_empty() { json.get("by")?.as_str()? } else { &operands };
        Some(format!("{} to {} by {by}", json.get("from")?, json.get("to")?))
    });
    transitions.collect::<Vec<_>>().join("; ")
}

/// Returns the replayed transitions of a turn as text, as a trace shows them.
fn listed<A: Alphabet>(plan: Option<&LoadedPlan<A>>, steps: &[RecordedTransition]) -> String {
    steps.iter().map(|step| text(plan, step)).collect::<Vec<_>>().join("; ")
}

fn text<A: Alphabet>(plan: Option<&LoadedPlan<A>>, step: &RecordedTransition) -> String {
    let RecordedTransition { from, scope, cause, to, operands } = step;
    let Some(plan) = plan else { return format!("{from} to {to}") };
    let source = Plan::source(plan);
    let fired = operands.iter().filter_map(|number| source.operand(*scope, *number)).map(|words| words.text);
    let by = match cause {
        mdle_runtime::Cause::Completed(_) => "completed".to_owned(),
        mdle_runtime::Cause::Fired(_) if operands.is_empty() => Texts::condition(plan, *scope).to_owned(),
        mdle_runtime::Cause::Fired(_) => fired.collect::<Vec<_>>().join(" and "),
    };
    format!("{from} to {to} by {by}")
}
