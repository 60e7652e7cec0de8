//! A run that a page steps by turns.

use mdle_compiler::fsm::{Element, ElementKind};
use mdle_compiler::load::Moment;
use mdle_runtime::{Nanos, Plan as _};
use mdle_simulator::Form;
use serde_json::{Value, json};

use crate::causes;
use crate::course::{Course, End};
use crate::plan::Plan;
use crate::setup::{PERIOD, Ready, Setup};
use crate::{floor, frame, why};

/// Maximum number of moments of a turn that are kept.
const MOMENTS_MOST: usize = 40;
/// Maximum number of transitions in one answer: a turn can make 4,096.
const TRANSITIONS_MOST: usize = 20_000;

/// A run, with what is needed to explain each of its turns.
pub(crate) struct Run {
    plan: Plan,
    ready: Ready,
    course: Course,
    /// Moments of each turn.
    moments: Vec<Vec<Moment>>,
    /// Time of the last exchange.
    before: Option<Nanos>,
}

impl Run {
    /// Puts the robot at its start.
    ///
    /// # Errors
    /// Messages about the plan, or a sentence about the setup.
    pub(crate) fn begin(setup: Setup) -> Result<Self, String> {
        let plan = Plan::of(&setup.text, setup.plan.as_deref())?;
        let ready = setup.ready()?;
        let course = Course::new(&plan, &ready, true)?;
        Ok(Self { plan, ready, course, moments: Vec::new(), before: None })
    }

    /// Returns the plan's elements, and the floor with the robot's form.
    pub(crate) fn description(&self) -> Value {
        let form = self.ready.make.form();
        let (half_length, half_width) = form.halves();
        let pose = self.ready.begins;
        json!({
            "elements": self.plan.machine.elements().map(|element| self.element(element)).collect::<Vec<_>>(),
            "floor": floor::drawn(&self.ready.world),
            "form": { "round": matches!(form, Form::Disc { .. }), "length": half_length, "width": half_width },
            "start": [pose.x.0, pose.y.0, pose.theta.0],
            "period": PERIOD.seconds(),
            "limit": self.ready.limit.seconds(),
        })
    }

    fn element(&self, element: Element<'_>) -> Value {
        let (kind, law) = match element.kind() {
            ElementKind::Atom(atom) => ("atom", Some(atom.law().text.as_str())),
            ElementKind::Loop { .. } => ("loop", None),
            ElementKind::Scope => ("scope", None),
        };
        let (_, line) = self.plan.sources.line(element.span());
        json!({
            "kind": kind,
            "law": law,
            "name": element.name(),
            "condition": element.condition_text(),
            "parent": element.parent().map(Element::number),
            "atom": element.atom().map(|atom| atom.number()),
            "state": element.atom().map(|atom| atom.state()),
            "line": line,
        })
    }

    /// Makes at most this many turns.
    pub(crate) fn step(&mut self, turns: u64) -> Value {
        let (mut frames, mut transitions) = (Vec::new(), 0);
        for _ in 0..turns {
            if self.course.end.is_some() || transitions > TRANSITIONS_MOST {
                break;
            }
            let Some(exchange) = self.course.exchange() else { break };
            let Some(mut made) = self.course.turn(&exchange.y) else { break };
            transitions += self.course.seen.transitions.len();
            if made.moments.len() > MOMENTS_MOST {
                let last = made.moments.pop();
                made.moments.truncate(MOMENTS_MOST);
                made.moments.extend(last);
            }
            frames.push(frame::frame(&self.course, &exchange, &made, self.before));
            self.before = Some(exchange.t);
            self.moments.push(made.moments);
            if self.course.end.is_some() {
                self.course.release();
                self.course.stop();
            }
        }
        json!({ "turns": frames, "end": self.end() })
    }

    /// Returns how the run has ended; null before that.
    fn end(&self) -> Value {
        match &self.course.end {
            None => Value::Null,
            Some(End::Over) => {
                let by = self.course.machine.as_ref();
                json!({ "how": "over", "by": by.map(|machine| causes::last(machine.plan(), &self.course.seen)) })
            }
            Some(End::Limit) => json!({ "how": "limit" }),
            Some(End::Fault(sentence)) => json!({ "how": "fault", "by": sentence }),
        }
    }

    /// Explains a turn.
    ///
    /// # Errors
    /// The turn was not made.
    pub(crate) fn why(&self, turn: usize) -> Result<Value, String> {
        let moments = self.moments.get(turn).ok_or_else(|| format!("turn {turn} was not made"))?;
        let machine = self.course.machine.as_ref().ok_or("the run has not begun")?;
        Ok(json!({ "moments": why::moments(&self.plan.machine, machine.plan().source(), moments) }))
    }
}
