//! Modules in the tree: `/usr/NAME` represents a loaded module, and `/lib/NAME` a module that can be loaded (paper,
//! III-H).

use std::time::Duration;

use mdle_host::Break;
use mdle_quantity::Quantity;
use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Volts};

use crate::attribute::{self, AttributeKind, AttributeName};
use crate::board::Post;
use crate::engine::{Engine, HoldEffect, ModuleState};
use crate::module::{About, PLAN, Refusal};
use crate::plans::EngineAlphabet;
use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value, ValueKind, read};

/// Node of the tree that shows how much time the turns of a module take.
pub(super) const COST: (&str, Node) = (
    ".cost",
    Node::reading(
        ValueKind::Quantity(Quantity::Time, "ms"),
        "mean time that the last turns of the module took, in real time",
    ),
);

/// Methods and readable attributes that every module has, in the order of their values.
const OWN: [(&str, Node); 9] = [
    (
        ".state",
        Node::reading(
            ValueKind::Text,
            "state of the module: `active`, `stopped`, `late`, `given up`, `failed`, `ended`",
        ),
    ),
    (".late", Node::reading(ValueKind::Integer, "number of turns that ended without the module because it was late")),
    COST,
    (".reads", Node::reading(ValueKind::Text, "attributes of other modules that the module reads")),
    (
        ".priority",
        Node::reading(ValueKind::Integer, "priority of the module: modules of higher priority begin their turns first"),
    ),
    (".fault", Node::reading(ValueKind::Text, "reason why the module failed or was given up")),
    (".start", Node::method(Role::Admin, "lets the module make turns again")),
    (".stop", Node::method(Role::Admin, "stops the module until it is started")),
    (".unload", Node::method(Role::Admin, "unloads the module; its attributes vanish")),
];

/// Name of the node in `/lib` that loads child processes. A module of the library with this name takes precedence.
const PROCESS: &str = "process";

/// Modules in the tree, and the requests to load modules that have not been answered yet.
#[derive(Debug, Default)]
pub(super) struct ModulesPart {
    waiting: Vec<(u32, Reply)>,
}

impl ModulesPart {
    /// Returns `true` if a request has not been answered yet.
    pub(super) fn waits(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Answers the request with this number to load a module.
    pub(super) fn answer(&mut self, number: u32, result: Result<(), Refusal>) {
        let Some(place) = self.waiting.iter().position(|(waiting, _)| *waiting == number) else { return };
        let (_, reply) = self.waiting.remove(place);
        reply.answer(done(result));
    }
}

impl<A: EngineAlphabet> Served<Break<'_, Engine<A>>> for ModulesPart {
    fn nodes(&self, moment: &Break<'_, Engine<A>>) -> Vec<(String, Node)> {
        let modules = moment.pilot.modules();
        let mut nodes = Vec::new();
        for (name, _) in modules.names().filter(|(name, _)| *name != PLAN) {
            let mut add = |own: &str, node| nodes.push((format!("/usr/{name}/{own}"), node));
            for about in modules.board().of(name).map(|post| &post.about) {
                add(&about.name, Node::reading(kind(about), about.doc));
            }
            for (about, _) in modules.settings(name) {
                add(&about.name, Node::setting(kind(about), Role::Tune, about.doc));
            }
            OWN.into_iter().for_each(|(own, node)| add(own, node));
        }
        for Post { name, about, .. } in modules.foreign() {
            nodes.push((name.to_string(), Node::reading(kind(about), "attribute that another robot shares")));
        }
        let load = Node::method(Role::Admin, "loads the module, which is then in /usr");
        nodes.extend(moment.pilot.library().map(|name| (format!("/lib/{name}"), load)));
        if !moment.pilot.library().any(|name| name == PROCESS) {
            let load = "loads a child process as a module: its name, and its command line";
            nodes.push((format!("/lib/{PROCESS}"), Node::method(Role::Admin, load)));
        }
        nodes
    }

    fn values(&self, moment: &Break<'_, Engine<A>>, to: &mut Vec<Option<Value>>) {
        let modules = moment.pilot.modules();
        for (name, state) in modules.names().filter(|(name, _)| *name != PLAN) {
            let posts = modules.board().of(name);
            to.extend(posts.map(|post| post.reading.as_ref().map(|reading| shown(&post.about, &reading.value))));
            to.extend(modules.settings(name).map(|(about, reading)| Some(shown(about, &reading.value))));
            let reads: Vec<_> = modules.reads(name).map(AttributeName::to_string).collect();
            let fault = Some(modules.fault(name)).filter(|fault| !fault.is_empty());
            to.extend([Some(Value::text(state_text(state))), Some(Value::count(modules.late_turns(name)))]);
            to.push(modules.cost(name).map(Value::milliseconds));
            to.push(Some(Value::Text(reads.join(", ").into())));
            to.extend([Some(Value::Integer(modules.priority(name).into())), fault.map(Value::text)]);
            to.extend([None, None, None]);
        }
        to.extend(modules.foreign().map(|post| Some(shown(&post.about, &post.reading.as_ref()?.value))));
        to.extend(moment.pilot.library().map(|_| None));
        to.extend((!moment.pilot.library().any(|name| name == PROCESS)).then_some(None));
    }

    fn change(&mut self, path: &str, change: &Change, moment: &mut Break<'_, Engine<A>>, reply: Reply) {
        if let Some(name) = path.strip_prefix("/lib/") {
            let is_process = name == PROCESS && !moment.pilot.library().any(|name| name == PROCESS);
            let begun = match (is_process, change) {
                (false, Change::Call(arguments)) if !arguments.is_empty() => {
                    Err(format!("`{path}` takes no arguments"))
                }
                (false, _) => moment.pilot.load(name),
                (true, Change::Call(arguments)) => load_process(moment.pilot, arguments),
                (true, Change::Set(_)) => Err(format!("`{path}` is a method: call it")),
            };
            return match begun {
                Ok(number) => self.waiting.push((number, reply)),
                Err(sentence) => reply.answer(Answer::Refused(sentence)),
            };
        }
        let (name, own) = path.strip_prefix("/usr/").and_then(|rest| rest.split_once('/')).unwrap_or_default();
        let modules = moment.pilot.modules_mut();
        let result = match change {
            Change::Call(arguments) if !arguments.is_empty() => {
                return reply.answer(Answer::Refused(format!("`{path}` takes no arguments")));
            }
            Change::Call(_) if own == ".unload" => modules.unload(name),
            Change::Call(_) => {
                let effect = modules.hold(name, own == ".stop");
                return reply.answer(match effect {
                    Ok(effect) => Answer::Done(held(name, own == ".stop", effect)),
                    Err(refusal) => Answer::Refused(refusal.to_string()),
                });
            }
            Change::Set(text) => {
                let about = modules.settings(name).map(|(about, _)| about).find(|about| &*about.name == own).cloned();
                let Some(about) = about else {
                    return reply.answer(Answer::Refused(format!("`{path}` is read-only")));
                };
                match read(text, kind(&about)).and_then(|value| taken(&about, value)) {
                    Ok(value) => modules.set(name, own, value),
                    Err(refusal) => return reply.answer(Answer::Refused(format!("`{path}`: {refusal}"))),
                }
            }
        };
        reply.answer(done(result));
    }
}

/// Starts to load the child process that the arguments describe; returns the number of the request.
fn load_process<A: EngineAlphabet>(engine: &mut Engine<A>, arguments: &[String]) -> Result<u32, String> {
    match arguments {
        [name, command @ ..] if !command.is_empty() => engine.load_process(name, &command.join(" ")),
        _ => Err(format!(
            "`/lib/{PROCESS}` takes the name of a module and a command line, as in `call /lib/{PROCESS} ears python3 ears.py`"
        )),
    }
}

/// Returns the answer to a request to stop or start the module `name`.
fn held(name: &str, is_stop: bool, effect: HoldEffect) -> String {
    match effect {
        HoldEffect::None if is_stop => format!("{name} is stopped already"),
        HoldEffect::None => format!("{name} makes turns already"),
        HoldEffect::Stops => format!("{name} makes no turns from now on"),
        HoldEffect::StaysStopped => {
            format!("nothing reads {name}, so it makes no turns; from now on none even if something does")
        }
        HoldEffect::Starts => format!("{name} makes turns from now on"),
        HoldEffect::WaitsForReaders => format!("{name} makes no turns before a plan, a rule or a module reads it"),
        HoldEffect::StopsWhenDone => format!("{name} is late, and makes no turns once its turn is done"),
        HoldEffect::StartsWhenDone => format!("{name} is late, and makes turns once its turn is done"),
    }
}

fn done(result: Result<(), Refusal>) -> Answer {
    match result {
        Ok(()) => Answer::Done(String::new()),
        Err(refusal) => Answer::Refused(refusal.to_string()),
    }
}

fn state_text(state: ModuleState) -> &'static str {
    match state {
        ModuleState::Active => "active",
        ModuleState::Stopped => "stopped",
        ModuleState::Late(..) => "late",
        ModuleState::GivenUp => "given up",
        ModuleState::Failed => "failed",
        ModuleState::Ended => "ended",
    }
}

/// Returns the kind that an attribute has in the tree; a quantity has the unit that the attribute's description names.
fn kind(about: &About) -> ValueKind {
    let quantity = about.unit.and_then(|unit| Some((Quantity::of_unit(unit.name)?.0, unit.name)));
    match (about.kind, quantity) {
        (_, Some((quantity, unit))) => ValueKind::Quantity(quantity, unit),
        (AttributeKind::Flag, None) => ValueKind::Flag,
        (AttributeKind::Integer, None) => ValueKind::Integer,
        (AttributeKind::Text, None) => ValueKind::Text,
        (AttributeKind::Pose, None) => ValueKind::Pose,
        (AttributeKind::Numbers, None) => ValueKind::Numbers,
        (AttributeKind::Bytes, None) => ValueKind::Bytes,
        (
            AttributeKind::Number
            | AttributeKind::Length
            | AttributeKind::Speed
            | AttributeKind::Angle
            | AttributeKind::AngularRate
            | AttributeKind::Voltage
            | AttributeKind::Time,
            None,
        ) => ValueKind::Number,
    }
}

/// Converts the value of an attribute to a value of the tree.
fn shown(about: &About, value: &attribute::Value) -> Value {
    use attribute::Value as Of;
    let number = |number: f64| match about.unit {
        Some(unit) => Value::Quantity(number / unit.to_si(1.0), unit.name),
        None => Value::Number(number),
    };
    match value {
        Of::Flag(flag) => Value::Flag(*flag),
        Of::Integer(number) => Value::Integer(*number),
        Of::Text(text) => Value::Text(text.clone()),
        Of::Pose(pose) => Value::Pose([pose.x.0, pose.y.0, pose.theta.degrees()]),
        Of::Numbers(numbers) => Value::Numbers(numbers.clone()),
        Of::Bytes(bytes) => Value::Bytes(bytes.clone()),
        Of::Time(time) => number(time.seconds()),
        Of::Number(of)
        | Of::Length(Meters(of))
        | Of::Speed(MetersPerSecond(of))
        | Of::Angle(Radians(of))
        | Of::AngularRate(RadiansPerSecond(of))
        | Of::Voltage(Volts(of)) => number(*of),
    }
}

/// Converts a value that a user has typed to an attribute's value.
fn taken(about: &About, value: Value) -> Result<attribute::Value, String> {
    use attribute::Value as Of;
    let si = match value {
        Value::Flag(flag) => return Ok(Of::Flag(flag)),
        Value::Integer(number) => return Ok(Of::Integer(number)),
        Value::Text(text) => return Ok(Of::Text(text)),
        Value::Pose([x, y, theta]) => {
            return Ok(Of::Pose(Pose { x: Meters(x), y: Meters(y), theta: Radians(theta.to_radians()) }));
        }
        Value::Numbers(numbers) => return Ok(Of::Numbers(numbers)),
        Value::Bytes(bytes) => return Ok(Of::Bytes(bytes)),
        Value::Number(number) => number,
        Value::Quantity(number, _) => about.unit.map_or(number, |unit| unit.to_si(number)),
    };
    Ok(match about.kind {
        AttributeKind::Length => Of::Length(Meters(si)),
        AttributeKind::Speed => Of::Speed(MetersPerSecond(si)),
        AttributeKind::Angle => Of::Angle(Radians(si)),
        AttributeKind::AngularRate => Of::AngularRate(RadiansPerSecond(si)),
        AttributeKind::Voltage => Of::Voltage(Volts(si)),
        AttributeKind::Time => {
            let time = Duration::try_from_secs_f64(si).map_err(|_| "expected a time of at least 0s".to_owned())?;
            Of::Time(Nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)))
        }
        AttributeKind::Number
        | AttributeKind::Flag
        | AttributeKind::Integer
        | AttributeKind::Pose
        | AttributeKind::Text
        | AttributeKind::Numbers
        | AttributeKind::Bytes => Of::Number(si),
    })
}
