//! The parts of the tree that every session has: the robot, the plan, the safety rules and the engine.

use mdle_host::Break;
use mdle_quantity::Quantity;
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Alphabet, SonarId, Twist};

use crate::safety::{Guardian, Limits, Measure};
use crate::tree::{Answer, Change, Kind, Node, Reply, Role, Served, Value, read};

/// `/usr/robot`: what the robot sensed last, and what it is sent next.
#[derive(Debug)]
pub(super) struct RobotPart;

/// `/usr/mdle`: the plan.
#[derive(Debug)]
pub(super) struct PlanPart;

/// `/engine`.
#[derive(Debug, Default)]
pub(super) struct EnginePart {
    /// `true` once the session is to end.
    pub(super) quits: bool,
}

const METRES: Kind = Kind::Quantity(Quantity::Length, "m");
const DEGREES: Kind = Kind::Quantity(Quantity::Angle, "deg");
const SPEED: Kind = Kind::Quantity(Quantity::Speed, "m/s");
const TURN_RATE: Kind = Kind::Quantity(Quantity::TurnRate, "deg/s");
const SECONDS: Kind = Kind::Quantity(Quantity::Time, "s");

impl<Y: Odometry + Bumpers + SonarRing> Served<Break<'_, Y, Twist>> for RobotPart {
    fn nodes(&self) -> Vec<(String, Node)> {
        let nodes = [
            ("x", Node::reading(METRES, "position by odometry, along the first axis")),
            ("y", Node::reading(METRES, "position by odometry, along the second axis")),
            ("theta", Node::reading(DEGREES, "heading by odometry")),
            ("v", Node::reading(SPEED, "measured forward speed")),
            ("omega", Node::reading(TURN_RATE, "measured turn rate")),
            ("bumper", Node::reading(Kind::Flag, "`true` if any bumper is in contact")),
            ("input/v", Node::reading(SPEED, "forward speed that the robot is sent next")),
            ("input/omega", Node::reading(TURN_RATE, "turn rate that the robot is sent next")),
        ];
        let own = nodes.map(|(name, node)| (format!("/usr/robot/{name}"), node));
        let range = Node::reading(METRES, "range of a sonar, counted counter-clockwise from the front");
        let ranges = (0..16).map(|number| (format!("/usr/robot/ranges/r{number}"), range));
        own.into_iter().chain(ranges).collect()
    }

    fn values(&self, moment: &Break<'_, Y, Twist>, to: &mut Vec<Option<Value>>) {
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
    }

    fn change(&mut self, path: &str, _: &Change, _: &Break<'_, Y, Twist>, reply: Reply) {
        reply.answer(Answer::Refused(format!("`{path}` is read-only")));
    }
}

impl<Y, U> Served<Break<'_, Y, U>> for PlanPart {
    fn nodes(&self) -> Vec<(String, Node)> {
        let nodes = [
            ("plan", Node::reading(Kind::Text, "name of the plan")),
            ("atom", Node::reading(Kind::Text, "law of the current atom")),
            ("place", Node::reading(Kind::Text, "place of the atom: file, line, and the scopes around it")),
            ("since", Node::reading(Kind::Text, "why the atom runs")),
            ("state", Node::reading(Kind::Integer, "number of the state in the expanded plan, from 1")),
            ("scopes", Node::reading(Kind::Text, "conditions of the scopes around the atom, the plan's first")),
            ("t", Node::reading(SECONDS, "time since the plan began")),
        ];
        nodes.map(|(name, node)| (format!("/usr/mdle/{name}"), node)).into()
    }

    fn values(&self, moment: &Break<'_, Y, U>, to: &mut Vec<Option<Value>>) {
        let Some(place) = (moment.position)() else {
            to.extend([const { None }; 7]);
            return;
        };
        let plan = place.scopes.first();
        let conditions: Vec<_> = place.scopes.iter().map(|scope| scope.condition).collect();
        to.extend(
            [
                Value::Text(plan.map_or("", |plan| plan.name).to_owned()),
                Value::Text(place.law.to_owned()),
                Value::Text(place.place),
                Value::Text(place.since.to_owned()),
                Value::Integer(place.state),
                Value::Text(conditions.join("; ")),
                Value::Quantity(plan.map_or(place.t, |plan| plan.since).seconds(), "s"),
            ]
            .map(Some),
        );
    }

    fn change(&mut self, path: &str, _: &Change, _: &Break<'_, Y, U>, reply: Reply) {
        reply.answer(Answer::Refused(format!("`{path}` is read-only")));
    }
}

impl<A> Served<Break<'_, A::Output, Twist>> for Guardian<A>
where
    A: Alphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    fn nodes(&self) -> Vec<(String, Node)> {
        let limits = Measure::ALL.map(|measure| {
            let (quantity, unit) = measure.quantity();
            let node = Node::setting(Kind::Quantity(quantity, unit), Role::Admin, "limit of inputs");
            (format!("/safety/limits/{}", measure.key()), node)
        });
        let count = Node::reading(Kind::Integer, "number of turns in which the rule has decided");
        let rules = self.envelope().counts();
        let rules =
            rules.map(|(id, _)| (format!("/safety/rules/{}/count", self.envelope().name(id).replace(' ', "_")), count));
        limits.into_iter().chain(rules).collect()
    }

    fn values(&self, _: &Break<'_, A::Output, Twist>, to: &mut Vec<Option<Value>>) {
        let mut limits: Limits = self.envelope().rules().limits;
        for measure in Measure::ALL {
            let value = *measure.of(&mut limits);
            to.push(Some(Value::Quantity(measure.in_its_unit(value), measure.quantity().1)));
        }
        to.extend(self.envelope().counts().map(|(_, count)| Some(Value::Integer(count))));
    }

    fn change(&mut self, path: &str, change: &Change, _: &Break<'_, A::Output, Twist>, reply: Reply) {
        let measure =
            Measure::ALL.into_iter().find(|measure| path.strip_prefix("/safety/limits/") == Some(measure.key()));
        let (Some(measure), Change::Set(text)) = (measure, change) else {
            return reply.answer(Answer::Refused(format!("`{path}` is read-only")));
        };
        let (quantity, unit) = measure.quantity();
        reply.answer(match read(text, Kind::Quantity(quantity, unit)) {
            Ok(Value::Quantity(value, _)) if value > 0.0 => {
                *measure.of(&mut self.envelope_mut().rules_mut().limits) = measure.in_si(value);
                Answer::Done(String::new())
            }
            Ok(_) => Answer::Refused(format!("`{path}` has to be above 0; found `{text}`")),
            Err(refusal) => Answer::Refused(format!("`{path}`: {refusal}")),
        });
    }
}

impl<Y, U> Served<Break<'_, Y, U>> for EnginePart {
    fn nodes(&self) -> Vec<(String, Node)> {
        vec![
            ("/engine/version".to_owned(), Node::reading(Kind::Text, "version of the program")),
            ("/engine/quit".to_owned(), Node::method(Role::Admin, "stops the robot and ends the session")),
        ]
    }

    fn values(&self, _: &Break<'_, Y, U>, to: &mut Vec<Option<Value>>) {
        to.extend([Some(Value::Text(env!("CARGO_PKG_VERSION").to_owned())), None]);
    }

    fn change(&mut self, path: &str, change: &Change, _: &Break<'_, Y, U>, reply: Reply) {
        match change {
            Change::Call(arguments) if arguments.is_empty() => {
                self.quits = true;
                reply.answer(Answer::Done(String::new()));
            }
            Change::Call(_) | Change::Set(_) => reply.answer(Answer::Refused(format!("`{path}` takes no arguments"))),
        }
    }
}
