//! A run that a page advances turn by turn.

use mdle_compiler::fsm::{Element, ElementKind};
use mdle_compiler::load::{PlanMoment, ScopeMoment};
use mdle_runtime::{Nanos, Plan as _};
use serde_json::{Value, json};

use crate::causes;
use crate::course::{Course, CourseEnd};
use crate::plan::Plan;
use crate::setup::{PERIOD, PageSetup, ReadyRun};
use crate::{floor, frame, why};

/// Maximum number of moments of a turn that are shown.
const MOMENTS_MOST: usize = 40;
/// Number of transitions after which an answer contains no further turn; the limit can be exceeded by the transitions
/// of one turn, at most 4,096.
const TRANSITIONS_MOST: usize = 20_000;

/// Limits on the size of the data of a run.
#[derive(Debug, Clone, Copy)]
struct DataLimits {
    /// Maximum size of all moments, in bytes; a turn whose moments are not stored is explained by repeating the run.
    moments: usize,
    /// Maximum size, in bytes, of all turns in the form in which a page receives and stores them; the run ends when it
    /// is reached.
    turns: usize,
}

const LIMITS: DataLimits = DataLimits { moments: 128 << 20, turns: 64 << 20 };

/// A run, with the data that explain each of its turns.
pub(crate) struct Run {
    plan: Plan,
    ready: ReadyRun,
    course: Course,
    /// Moments of each turn, from the first turn to the last one before the limit was reached.
    moments: Vec<Vec<PlanMoment>>,
    /// Sizes that are still available within the limits.
    left: DataLimits,
    /// `true` if the turns have reached their limit.
    is_full: bool,
    /// Time of the last exchange.
    before: Option<Nanos>,
}

impl Run {
    /// Compiles the plan, and puts the robot at its start.
    ///
    /// # Errors
    /// Fails if the plan or the setup has errors.
    pub(crate) fn begin(setup: &PageSetup) -> Result<Self, String> {
        Self::within(LIMITS, setup)
    }

    fn within(left: DataLimits, setup: &PageSetup) -> Result<Self, String> {
        let plan = Plan::of(&setup.draft, setup.plan.as_deref())?;
        let ready = setup.ready()?;
        let course = Course::new(&plan, &ready, true)?;
        Ok(Self { plan, ready, course, moments: Vec::new(), left, is_full: false, before: None })
    }

    /// Returns the elements of the plan, and the floor with the form of the robot's body.
    ///
    /// # Errors
    /// Fails if the world is too large to be drawn.
    pub(crate) fn description(&self) -> Result<Value, String> {
        let elements: Vec<_> = self.plan.machine.elements().map(|element| self.element(element)).collect();
        let mut description = floor::ready(&self.ready)?;
        description["elements"] = elements.into();
        description["period"] = PERIOD.seconds().into();
        description["limit"] = self.ready.limit.seconds().into();
        Ok(description)
    }

    fn element(&self, element: Element<'_>) -> Value {
        let (kind, law) = match element.kind() {
            ElementKind::Atom(atom) => ("atom", Some(atom.law().text.as_str())),
            ElementKind::Loop { .. } => ("loop", None),
            ElementKind::Scope => ("scope", None),
        };
        let (_, line) = self.plan.sources.line(element.span());
        let (source, _) = self.plan.sources.range(element.span());
        json!({
            "kind": kind,
            "law": law,
            "name": element.name(),
            "condition": element.condition_text(),
            "parent": element.parent().map(Element::number),
            "atom": element.atom().map(|atom| atom.number()),
            "state": element.atom().map(|atom| atom.state()),
            "line": line,
            "file": self.plan.files.get(&source),
        })
    }

    /// Runs at most `turns` turns, and returns the data from which a page draws them. The result contains the end of
    /// the run if the run has ended.
    pub(crate) fn step(&mut self, turns: u64) -> Value {
        let (mut frames, mut transitions) = (Vec::new(), 0);
        for _ in 0..turns {
            if self.is_full || self.course.end.is_some() || transitions > TRANSITIONS_MOST {
                break;
            }
            let Some(exchange) = self.course.exchange() else { break };
            let Some(made) = self.course.turn(&exchange.y) else { break };
            transitions += self.course.seen.transitions.len();
            let frame = frame::frame(&self.course, &exchange, &made, self.before);
            self.before = Some(exchange.t);
            self.count(&frame);
            frames.push(frame);
            self.keep(made.number, shown(made.moments));
            if self.course.end.is_some() {
                self.course.release();
                self.course.stop();
            }
        }
        json!({ "turns": frames, "end": self.end() })
    }

    fn count(&mut self, frame: &Value) {
        let size = frame.to_string().len();
        self.is_full = size > self.left.turns;
        self.left.turns = self.left.turns.saturating_sub(size);
    }

    /// Stores the moments of a turn, if the moments of all earlier turns are stored and the limit allows it.
    fn keep(&mut self, turn: u64, moments: Vec<PlanMoment>) {
        let size: usize = moments.iter().map(size).sum();
        if self.moments.len() as u64 == turn && size <= self.left.moments {
            self.left.moments -= size;
            self.moments.push(moments);
        }
    }

    /// Returns the reason why the run has ended, and its result with respect to the goal; null if the run has not
    /// ended.
    fn end(&self) -> Value {
        let judged = self.course.judged(self.ready.goal.as_ref());
        match &self.course.end {
            None if self.is_full => json!({ "how": "full" }),
            None => Value::Null,
            Some(CourseEnd::Over) => {
                let by = self.course.machine.as_ref().map(|machine| causes::last(machine.plan(), &self.course.seen));
                json!({ "how": "over", "by": by, "judged": judged })
            }
            Some(CourseEnd::Limit) => json!({ "how": "limit", "judged": judged }),
            Some(CourseEnd::Fault(sentence)) => json!({ "how": "fault", "by": sentence }),
        }
    }

    /// Explains a turn.
    ///
    /// # Errors
    /// Fails if the turn was not made.
    pub(crate) fn why(&self, turn: usize) -> Result<Value, String> {
        if turn as u64 >= self.course.turns {
            return Err(format!("turn {turn} was not made"));
        }
        let machine = self.course.machine.as_ref().ok_or("the run has not begun")?;
        let again;
        let moments = match self.moments.get(turn) {
            Some(moments) => moments,
            None => {
                again = self.made_again(turn as u64)?;
                &again
            }
        };
        Ok(json!({ "moments": why::moments(&self.plan.machine, machine.plan().source(), moments) }))
    }

    /// Repeats the run up to a turn, and returns the moments of that turn.
    fn made_again(&self, turn: u64) -> Result<Vec<PlanMoment>, String> {
        let mut course = Course::new(&self.plan, &self.ready, true)?;
        loop {
            let made = course.exchange().and_then(|exchange| course.turn(&exchange.y));
            let made = made.ok_or_else(|| format!("turn {turn} was not made"))?;
            if made.number == turn {
                return Ok(shown(made.moments));
            }
        }
    }
}

/// Returns the moments or, if there are too many to show, only the first ones and the last one.
fn shown(mut moments: Vec<PlanMoment>) -> Vec<PlanMoment> {
    if moments.len() > MOMENTS_MOST {
        let last = moments.pop();
        moments.truncate(MOMENTS_MOST);
        moments.extend(last);
        // A turn can have 4,096 moments, so the excess capacity is freed.
        moments.shrink_to_fit();
    }
    moments
}

/// Returns the size of a moment, in bytes.
fn size(moment: &PlanMoment) -> usize {
    let scope = |scope: &ScopeMoment| size_of::<ScopeMoment>() + size_of_val(scope.parts.as_slice());
    size_of::<PlanMoment>() + moment.scopes.iter().map(scope).sum::<usize>()
}

#[cfg(test)]
mod tests;
