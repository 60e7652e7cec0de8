//! Plans in the tree: `/usr/mdle`, the module that makes the turns of plans, and `/plans`, the stored plans (paper,
//! III-D and Fig. 7).

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use mdle_host::{Break, Pilot as _, PlanPosition};
use mdle_quantity::Quantity;
use mdle_runtime::Nanos;

use super::modules::COST;
use crate::Engine;
use crate::attribute::AttributeName;
use crate::module::PLAN;
use crate::plans::{EngineAlphabet, PlanEvent, PlanSource, Plans, When};
use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value, ValueKind, read};

/// Answer to a request whose plan was armed but was replaced before it took over.
const TAKEN: &str = "another plan takes its place";
const SECONDS: ValueKind = ValueKind::Quantity(Quantity::Time, "s");

/// Attributes of `/usr/mdle`, in the order of [`Served::values`].
const OWN: [(&str, Node); 14] = [
    (
        "main",
        Node::setting(
            ValueKind::Text,
            Role::Swap,
            "name of the plan that drives; a stored plan, or a text, replaces it",
        ),
    ),
    ("armed", Node::reading(ValueKind::Text, "plan that is to follow, and when")),
    ("on_trial", Node::reading(ValueKind::Flag, "`true` while `rollback` leads back to the plan before")),
    ("trial", Node::setting(SECONDS, Role::Swap, "time for which a plan that takes over is on trial")),
    COST,
    ("atom", Node::reading(ValueKind::Text, "law of the current atom")),
    ("place", Node::reading(ValueKind::Text, "place of the atom: file, line, and the scopes around it")),
    ("since", Node::reading(ValueKind::Text, "why the atom runs")),
    ("state", Node::reading(ValueKind::Integer, "number of the state in the expanded plan, from 1")),
    ("scopes", Node::reading(ValueKind::Text, "conditions of the scopes around the atom, the plan's first")),
    ("t", Node::reading(SECONDS, "time since the plan began")),
    ("load_plan", Node::method(Role::Swap, "compiles the plans of a file or of a text, and stores them")),
    ("cancel", Node::method(Role::Swap, "takes back a plan that has not taken over yet")),
    ("rollback", Node::method(Role::Swap, "ends the plan on trial, and lets the plan before it go on")),
];

/// Plans in the tree, and the requests about them that have not been answered yet.
#[derive(Debug, Default)]
pub(super) struct PlansPart {
    waiting: Vec<WaitingRequest>,
    /// Armed plans of this session, each with the number of its request and its name.
    armed: Vec<(u32, String)>,
}

/// A request that waits for the compiler.
#[derive(Debug)]
struct WaitingRequest {
    /// Number of the request.
    ticket: u32,
    /// Warnings of the text; empty if there are none.
    warnings: String,
    reply: Reply,
}

impl PlansPart {
    /// Returns `true` if a request has not been answered yet.
    pub(super) fn waits(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Answers the requests that the engine has decided. Returns messages about plans whose requests were already
    /// answered.
    pub(super) fn answer<A: EngineAlphabet>(&mut self, pilot: &mut Engine<A>, now: Nanos) -> Vec<String> {
        let mut messages = Vec::new();
        let mut replaced = Vec::new();
        let events: Vec<_> = pilot.plans_mut().take_events().collect();
        let plans = pilot.plans();
        for event in events {
            match event {
                PlanEvent::Warned(ticket, warnings) => {
                    let waiting = self.waiting.iter_mut().find(|waiting| waiting.ticket == ticket);
                    waiting.into_iter().for_each(|waiting| waiting.warnings.clone_from(&warnings));
                }
                PlanEvent::Refused(ticket, sentence) => {
                    let name = self.disarmed(ticket);
                    messages.extend(name.map(|name| format!("warning: {name} does not take over: {sentence}")));
                    self.settle(ticket, Err(sentence));
                }
                PlanEvent::Stored(ticket, names) => {
                    let verb = if names.len() == 1 { "is" } else { "are" };
                    self.settle(ticket, Ok(format!("{} {verb} stored", names.join(", "))));
                }
                PlanEvent::Armed(ticket) => {
                    let is_own = self.waiting.iter().any(|waiting| waiting.ticket == ticket);
                    let armed = plans.name_of(ticket).zip(plans.armed()).filter(|_| is_own);
                    let Some((name, (_, when))) = armed else { continue };
                    let replaced = replaced.pop().map_or_else(String::new, |(_, old)| format!(", in place of {old}"));
                    let awaited = plans.awaited(pilot.modules().board(), now);
                    self.settle(ticket, Ok(format!("{name} takes over {when}{replaced}{awaited}")));
                    self.armed.push((ticket, name.to_owned()));
                }
                PlanEvent::Replaced(ticket, name) => {
                    self.settle(ticket, Err(TAKEN.to_owned()));
                    replaced.push((self.disarmed(ticket).is_some(), name));
                }
                PlanEvent::Superseded(ticket) => {
                    self.settle(ticket, Err("a later request replaces this one".to_owned()))
                }
                PlanEvent::Cancelled(ticket) => {
                    self.disarmed(ticket);
                    self.settle(ticket, Err("the request was cancelled".to_owned()));
                }
                PlanEvent::Began(ticket) => drop(self.disarmed(ticket)),
                PlanEvent::Accepted(_) | PlanEvent::RolledBack { .. } => {}
            }
        }
        // The request for the replaced plan was already answered, while the plan's turn was late.
        let own = replaced.into_iter().filter(|(is_own, _)| *is_own);
        messages.extend(own.map(|(_, name)| format!("warning: {name} does not take over: {TAKEN}")));
        messages
    }

    /// Removes the plan for this request from the armed plans, and returns its name; `None` if the plan is not among
    /// them.
    fn disarmed(&mut self, ticket: u32) -> Option<String> {
        let place = self.armed.iter().position(|(armed, _)| *armed == ticket)?;
        Some(self.armed.swap_remove(place).1)
    }

    /// Answers the request with this number, unless it was answered already.
    fn settle(&mut self, ticket: u32, result: Result<String, String>) {
        let Some(place) = self.waiting.iter().position(|waiting| waiting.ticket == ticket) else { return };
        let WaitingRequest { warnings, reply, .. } = self.waiting.remove(place);
        reply.answer(match result {
            Ok(sentence) => Answer::Done(warnings + &sentence),
            Err(sentence) => Answer::Refused(sentence),
        });
    }
}

impl<A: EngineAlphabet> Served<Break<'_, Engine<A>>> for PlansPart {
    fn nodes(&self, moment: &Break<'_, Engine<A>>) -> Vec<(String, Node)> {
        let own = OWN.map(|(name, node)| (format!("/usr/mdle/{name}"), node));
        let stored = moment.pilot.plans().stored().flat_map(|plan| {
            let nodes = [
                ("text", Node::reading(ValueKind::Text, "text of the plan's file")),
                ("diagnostics", Node::reading(ValueKind::Text, "warnings about the plan's file")),
                ("analysis", Node::reading(ValueKind::Text, "figures of the plan, as of `mdlec analyze`")),
                ("reads", Node::reading(ValueKind::Text, "attributes of modules that the plan reads")),
                (
                    "run",
                    Node::method(
                        Role::Swap,
                        "lets the plan take over: `now`, when the `atom` ends, or when the `plan` ends",
                    ),
                ),
                ("delete", Node::method(Role::Swap, "deletes the plan; if it drives, it goes on")),
            ];
            nodes.map(|(name, node)| (format!("/plans/{}/{name}", plan.name), node))
        });
        own.into_iter().chain(stored).collect()
    }

    fn values(&self, moment: &Break<'_, Engine<A>>, to: &mut Vec<Option<Value>>) {
        let plans = moment.pilot.plans();
        let armed = plans.armed().map(|(name, when)| Value::Text(format!("{name}, {when}").into()));
        to.extend([
            Some(Value::text(plans.name())),
            armed,
            Some(Value::Flag(plans.trial_ends().is_some())),
            Some(Value::Quantity(plans.trial().seconds(), "s")),
            moment.pilot.modules().cost(PLAN).map(Value::milliseconds),
        ]);
        match moment.position() {
            Some(place) => to.extend(standing(&place, moment.t.since(moment.pilot.zero())).map(Some)),
            None => to.extend([const { None }; 6]),
        }
        to.extend([const { None }; 3]);
        to.extend(plans.stored().flat_map(|plan| {
            let reads = plan.loaded.reads().iter();
            let reads: Vec<_> = reads.map(|read| AttributeName::new(read.module, read.attribute).to_string()).collect();
            let facts = [&plan.facts.diagnostics, &plan.facts.analysis];
            let [diagnostics, analysis] = facts.map(|text| (!text.is_empty()).then(|| Value::Text(Arc::clone(text))));
            let reads = Some(Value::Text(reads.join(", ").into()));
            [Some(Value::text(plan.text())), diagnostics, analysis, reads, None, None]
        }));
    }

    fn change(&mut self, path: &str, change: &Change, moment: &mut Break<'_, Engine<A>>, reply: Reply) {
        let armed = moment.pilot.plans().armed().map(|(name, _)| name.to_owned());
        let result = match change {
            Change::Set(text) => set(path, text, moment.pilot.plans_mut()),
            Change::Call(arguments) => call(path, arguments, moment.pilot),
        };
        match result {
            Ok(Some(ticket)) => self.waiting.push(WaitingRequest { ticket, warnings: String::new(), reply }),
            // The name of the plan that continues is known only after the rollback.
            Ok(None) if path == "/usr/mdle/rollback" => {
                reply.answer(Answer::Done(format!("{} goes on", moment.pilot.plans().name())));
            }
            Ok(None) if path == "/usr/mdle/cancel" => reply.answer(Answer::Done(match armed {
                Some(name) => format!("{name} does not take over"),
                None => "no plan was to take over".to_owned(),
            })),
            Ok(None) => reply.answer(Answer::Done(String::new())),
            Err(sentence) => reply.answer(Answer::Refused(sentence)),
        }
    }
}

/// Sets an attribute. Returns the number of the request if the answer has to wait for the compiler.
fn set<A: EngineAlphabet>(path: &str, text: &str, plans: &mut Plans<A>) -> Result<Option<u32>, String> {
    match path {
        "/usr/mdle/main" if text.starts_with('{') => Ok(Some(plans.swap(PlanSource::Text(text.to_owned()), When::Now))),
        "/usr/mdle/main" => plans.run(text, When::Now).map(Some),
        _ => set_trial(plans, text).map(|()| None),
    }
}

/// Calls a method. Returns the number of the request if the answer has to wait for the compiler.
fn call<A: EngineAlphabet>(path: &str, arguments: &[String], engine: &mut Engine<A>) -> Result<Option<u32>, String> {
    if path == "/usr/mdle/load_plan" {
        let source = match arguments {
            [first, ..] if first.starts_with('{') => PlanSource::Text(arguments.join(" ")),
            [file] => PlanSource::File(PathBuf::from(file)),
            [] | [_, _, ..] => {
                return Err("`load_plan` takes the name of a file, or the text of a plan in braces".to_owned());
            }
        };
        return Ok(Some(engine.plans_mut().load(source)));
    }
    let stored = path.strip_prefix("/plans/");
    if let Some(name) = stored.and_then(|stored| stored.strip_suffix("/run")) {
        return engine.plans_mut().run(name, when(arguments)?).map(Some);
    }
    if !arguments.is_empty() {
        return Err(format!("`{path}` takes no arguments"));
    }
    match (path, stored.and_then(|stored| stored.strip_suffix("/delete"))) {
        (_, Some(name)) => engine.plans_mut().delete(name)?,
        ("/usr/mdle/cancel", None) => engine.plans_mut().cancel(),
        (_, None) => engine.rollback("asked for").map_err(|none| none.to_string())?,
    }
    Ok(None)
}

/// Returns the moment that the arguments name; the next turn if there are no arguments.
pub(super) fn when(arguments: &[String]) -> Result<When, String> {
    let words = || When::ALL.map(|(word, _)| word).join(", ");
    match arguments {
        [] => Ok(When::Now),
        [word] => {
            let found = When::ALL.iter().find(|(known, _)| known == word);
            found.map(|(_, when)| *when).ok_or_else(|| format!("expected one of {}, found `{word}`", words()))
        }
        [_, _, ..] => Err(format!("a plan takes over at one moment: {}", words())),
    }
}

fn set_trial<A: EngineAlphabet>(plans: &mut Plans<A>, text: &str) -> Result<(), String> {
    let Value::Quantity(seconds, _) = read(text, SECONDS)? else {
        return Err("`/usr/mdle/trial` is a time".to_owned());
    };
    let time = Duration::try_from_secs_f64(seconds);
    let time = time.map_err(|_| format!("`/usr/mdle/trial` has to be at least 0s; found `{text}`"))?;
    plans.set_trial(Nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)));
    Ok(())
}

/// Returns the values that describe the current position in a plan; `t` is the time since the plan began.
fn standing(place: &PlanPosition<'_>, t: Nanos) -> [Value; 6] {
    let conditions: Vec<_> = place.scopes.iter().map(|scope| scope.condition).collect();
    [
        Value::text(place.law),
        Value::text(&place.place),
        Value::text(place.since),
        Value::count(place.state),
        Value::Text(conditions.join("; ").into()),
        Value::Quantity(t.seconds(), "s"),
    ]
}
