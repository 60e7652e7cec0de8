//! Parts of the tree that belong to no plan or module: the robot, the safety rules and the engine.

use mdle_host::{Break, Pilot};
use mdle_quantity::Quantity;
use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_runtime::{Alphabet, Plan, SonarId, Twist};

use crate::safety::{Guardian, Limits, Measure};
use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value, ValueKind, read};

/// `/usr/robot`: the robot's latest output and next input.
#[derive(Debug)]
pub(super) struct RobotPart;

/// `/safety`: the safety rules. In a run without rules, the limits have no values.
#[derive(Debug)]
pub(super) struct SafetyPart<A: Alphabet>(pub(super) Option<Guardian<A>>);

/// `/engine`: the engine itself.
#[derive(Debug, Default)]
pub(super) struct EnginePart {
    /// `true` once the session has to end.
    pub(super) quits: bool,
}

const METRES: ValueKind = ValueKind::Quantity(Quantity::Length, "m");
const DEGREES: ValueKind = ValueKind::Quantity(Quantity::Angle, "deg");
const SPEED: ValueKind = ValueKind::Quantity(Quantity::Speed, "m/s");
const TURN_RATE: ValueKind = ValueKind::Quantity(Quantity::TurnRate, "deg/s");

impl<B> Served<Break<'_, B>> for RobotPart
where
    B: Pilot<Plan: Plan<Output: Odometry + Bumpers + SonarRing, Input = Twist>>,
{
    fn nodes(&self, moment: &Break<'_, B>) -> Vec<(String, Node)> {
        let nodes = [
            ("x", Node::reading(METRES, "position by odometry, along the first axis")),
            ("y", Node::reading(METRES, "position by odometry, along the second axis")),
            ("theta", Node::reading(DEGREES, "heading by odometry")),
            ("v", Node::reading(SPEED, "measured forward speed")),
            ("omega", Node::reading(TURN_RATE, "measured turn rate")),
            ("bumper", Node::reading(ValueKind::Flag, "`true` if any bumper is in contact")),
            ("input/v", Node::reading(SPEED, "forward speed that the robot is sent next")),
            ("input/omega", Node::reading(TURN_RATE, "turn rate that the robot is sent next")),
        ];
        let own = nodes.map(|(name, node)| (format!("/usr/robot/{name}"), node));
        let range = Node::reading(METRES, "range of a sonar, counted counter-clockwise from the front");
        let ranges = (0..16).map(|number| (format!("/usr/robot/ranges/r{number}"), range));
        let settings = moment.settings.as_ref().map_or(&[][..], |settings| settings.settings());
        let settings = settings
            .iter()
            .map(|(name, doc)| (format!("/usr/robot/{name}"), Node::setting(ValueKind::Text, Role::Tune, doc)));
        own.into_iter().chain(ranges).chain(settings).collect()
    }

    fn values(&self, moment: &Break<'_, B>, to: &mut Vec<Option<Value>>) {
        let (pose, velocity) = (moment.y.pose(), moment.y.velocity());
        let twist = |Twist { v, omega }: Twist| {
            [Value::Quantity(v.0, "m/s"), Value::Quantity(omega.0.to_degrees(), "deg/s")].map(Some)
        };
        to.extend([Some(Value::Quantity(pose.x.0, "m")), Some(Value::Quantity(pose.y.0, "m"))]);
        to.push(Some(Value::Quantity(pose.theta.degrees(), "deg")));
        to.extend(twist(velocity));
        to.push(Some(Value::Flag(moment.y.pressed())));
        to.extend(twist(*moment.input));
        to.extend((0..16).map(|number| {
            let ping = moment.y.pings(SonarId::new(number)).newest_first().next()?;
            Some(Value::Quantity(ping.range.map_or(f64::INFINITY, |range| range.0), "m"))
        }));
        if let Some(robot) = &moment.settings {
            to.extend(robot.settings().iter().map(|(name, _)| Some(Value::Text(robot.setting(name)?.into()))));
        }
    }

    fn change(&mut self, path: &str, change: &Change, moment: &mut Break<'_, B>, reply: Reply) {
        let name = path.strip_prefix("/usr/robot/").unwrap_or(path);
        let result = match (change, &mut moment.settings) {
            (Change::Set(text), Some(robot)) => robot.set(name, text),
            (Change::Set(_) | Change::Call(_), _) => Err("it is read-only".to_owned()),
        };
        reply.answer(match result {
            Ok(()) => Answer::Done(String::new()),
            Err(sentence) => Answer::Refused(format!("`{path}`: {sentence}")),
        });
    }
}

/// Method that resets the safety rules.
const RESET: &str = "/safety/reset";

/// Returns the answer to a reset of the safety rules; `again` names the rules that were off because they had replaced a
/// plan.
fn after_reset(again: &[String]) -> String {
    let limits = "the limits are those of the safety file";
    match again {
        [] => limits.to_owned(),
        [rule] => format!("{limits}, and {rule} applies again"),
        rules => format!("{limits}, and {} apply again", rules.join(", ")),
    }
}

impl<A: Alphabet, B: Pilot> Served<Break<'_, B>> for SafetyPart<A> {
    fn nodes(&self, _: &Break<'_, B>) -> Vec<(String, Node)> {
        let limits = Measure::ALL.map(|measure| {
            let (quantity, unit) = measure.quantity();
            let node = Node::setting(ValueKind::Quantity(quantity, unit), Role::Admin, "limit of inputs");
            (format!("/safety/limits/{}", measure.key()), node)
        });
        let reset = Node::method(Role::Admin, "takes the limits of the safety file, and lets all rules apply again");
        let own = limits.into_iter().chain([(RESET.to_owned(), reset)]);
        let Some(envelope) = self.0.as_ref().map(Guardian::envelope) else { return own.collect() };
        let count = Node::reading(ValueKind::Integer, "number of turns in which the rule has decided");
        let when = Node::reading(ValueKind::Text, "condition of the guard");
        let then = Node::reading(ValueKind::Text, "consequence of the rule, in the words of a safety file");
        let rules = envelope.counts().flat_map(|(id, _)| {
            let own = [
                Some(("count", count)),
                envelope.rules().when(id).map(|_| ("when", when)),
                envelope.rules().then(id).map(|_| ("then", then)),
            ];
            let folder = format!("/safety/rules/{}", envelope.rules().name(id).replace(' ', "_"));
            own.into_iter().flatten().map(move |(name, node)| (format!("{folder}/{name}"), node))
        });
        own.chain(rules).collect()
    }

    fn values(&self, _: &Break<'_, B>, to: &mut Vec<Option<Value>>) {
        let Some(envelope) = self.0.as_ref().map(Guardian::envelope) else {
            return to.extend([const { None }; Measure::ALL.len() + 1]);
        };
        let mut limits: Limits = envelope.rules().limits;
        for measure in Measure::ALL {
            let value = *measure.of(&mut limits);
            to.push(Some(Value::Quantity(measure.in_its_unit(value), measure.quantity().1)));
        }
        to.push(None);
        to.extend(envelope.counts().flat_map(|(id, count)| {
            let words = [envelope.rules().when(id), envelope.rules().then(id)].into_iter().flatten();
            [Value::count(count)].into_iter().chain(words.map(Value::text)).map(Some)
        }));
    }

    fn change(&mut self, path: &str, change: &Change, _: &mut Break<'_, B>, reply: Reply) {
        let measure =
            Measure::ALL.into_iter().find(|measure| path.strip_prefix("/safety/limits/") == Some(measure.key()));
        if self.0.is_none() {
            let sentence = format!("`{path}`: this session has no safety rules: begin it with `--safety FILE`");
            return reply.answer(Answer::Refused(sentence));
        }
        if let (RESET, Some(guardian), Change::Call(arguments)) = (path, &mut self.0, change) {
            return reply.answer(if arguments.is_empty() {
                Answer::Done(after_reset(&guardian.reset()))
            } else {
                Answer::Refused(format!("`{path}` takes no arguments"))
            });
        }
        let (Some(measure), Some(guardian), Change::Set(text)) = (measure, &mut self.0, change) else {
            return reply.answer(Answer::Refused(format!("`{path}` is read-only")));
        };
        let (quantity, unit) = measure.quantity();
        reply.answer(match read(text, ValueKind::Quantity(quantity, unit)) {
            Ok(Value::Quantity(value, _)) if value > 0.0 => {
                *measure.of(&mut guardian.envelope_mut().rules_mut().limits) = measure.in_si(value);
                Answer::Done(String::new())
            }
            Ok(_) => Answer::Refused(format!("`{path}` has to be above 0; found `{text}`")),
            Err(refusal) => Answer::Refused(format!("`{path}`: {refusal}")),
        });
    }
}

impl<B: Pilot> Served<Break<'_, B>> for EnginePart {
    fn nodes(&self, _: &Break<'_, B>) -> Vec<(String, Node)> {
        vec![
            ("/engine/version".to_owned(), Node::reading(ValueKind::Text, "version of the program")),
            ("/engine/quit".to_owned(), Node::method(Role::Admin, "stops the robot and ends the session")),
        ]
    }

    fn values(&self, _: &Break<'_, B>, to: &mut Vec<Option<Value>>) {
        to.extend([Some(Value::text(env!("CARGO_PKG_VERSION"))), None]);
    }

    fn change(&mut self, path: &str, change: &Change, _: &mut Break<'_, B>, reply: Reply) {
        match change {
            Change::Call(arguments) if arguments.is_empty() => {
                self.quits = true;
                reply.answer(Answer::Done(String::new()));
            }
            Change::Call(_) | Change::Set(_) => reply.answer(Answer::Refused(format!("`{path}` takes no arguments"))),
        }
    }
}
