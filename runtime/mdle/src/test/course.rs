//! The course of a run: the atoms that began, the transitions, and the end.

use mdle_compiler::fsm::Machine;
use mdle_host::{Operand, Transitions};
use mdle_runtime::{Cause, Nanos, Pose, Transition, Words};

/// The course of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TestCourse {
    /// The atoms that began, each recorded when its law was first applied.
    pub(super) began: Vec<Began>,
    /// All transitions.
    pub(super) steps: Vec<CourseTransition>,
    /// Number of turns.
    pub(super) turns: u64,
    /// Time of the last turn.
    pub(super) t: Nanos,
    pub(super) ending: TestEnd,
    /// The true pose of a simulated robot at the end of the run; `None` for a script.
    pub(super) pose: Option<Pose>,
    /// The violations of `expect.never`.
    pub(super) breaches: Vec<Breach>,
}

/// The beginning of an atom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Began {
    /// Number of the atom, counted from 0 in the order of the plan's text.
    pub(super) atom: u32,
    pub(super) turn: u64,
    pub(super) t: Nanos,
}

/// A transition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CourseTransition {
    pub(super) turn: u64,
    pub(super) t: Nanos,
    /// Number of the atom that was left.
    pub(super) from: Option<u32>,
    /// Number of the atom that was entered; `None` if the plan has ended.
    pub(super) to: Option<u32>,
    /// Number of the element that ended.
    pub(super) scope: u32,
    pub(super) has_completed: bool,
    /// Numbers of the operands that had fired.
    pub(super) operands: Vec<u32>,
    /// The cause with its values, as a report shows it.
    pub(super) words: String,
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum TestEnd {
    /// The plan is over; the last transition ended it.
    Over,
    /// The plan was not over at the end of the script, or at the limit of the run.
    Running,
    /// A fault ended the run; contains the message about the fault.
    Failed(String),
}

/// The first turn in which a forbidden state occurred.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Breach {
    /// Number of the expectation.
    pub(super) number: usize,
    pub(super) turn: u64,
    pub(super) t: Nanos,
    /// Number of the atom that ran in that turn; `None` if no atom ran.
    pub(super) atom: Option<u32>,
    /// The distance that was too short, in metres; `None` for any other state.
    pub(super) gap: Option<f64>,
}

/// Recorder of the course of a run.
#[derive(Debug)]
pub(super) struct CourseRecorder<'m> {
    machine: &'m Machine,
    pub(super) course: TestCourse,
    /// Number of the current atom; `None` before the plan begins, and once it is over.
    atom: Option<u32>,
}

impl<'m> CourseRecorder<'m> {
    /// Returns the recorder of a run of this machine, before its first turn.
    pub(super) fn new(machine: &'m Machine) -> Self {
        let course = TestCourse {
            began: Vec::new(),
            steps: Vec::new(),
            turns: 0,
            t: Nanos::ZERO,
            ending: TestEnd::Running,
            pose: None,
            breaches: Vec::new(),
        };
        Self { machine, course, atom: None }
    }

    /// Records the turn at time `t`, after which `atom` is current; `words` returns the cause of a transition.
    pub(super) fn turn(
        &mut self,
        t: Nanos,
        atom: Option<u32>,
        transitions: &Transitions,
        words: impl Fn(&Transition, &[Operand]) -> String,
    ) {
        let turn = self.course.turns;
        self.course.turns += 1;
        self.course.t = t;
        let first = self.machine.root().first().number();
        let mut from = self.atom.or(Some(first));
        for (transition, operands) in transitions.iter() {
            self.course.steps.push(CourseTransition {
                turn,
                t,
                from,
                to: transition.atom,
                scope: transition.scope,
                has_completed: matches!(transition.cause, Cause::Completed(_)),
                operands: operands.iter().map(|(number, _)| *number).collect(),
                words: words(transition, operands),
            });
            from = transition.atom;
        }
        let begins = self.atom.is_none() || !transitions.is_empty();
        if let Some(atom) = atom.filter(|_| begins) {
            self.course.began.push(Began { atom, turn, t });
        }
        self.atom = atom;
    }

    /// Records a turn at time `t` in which the plan has not begun.
    pub(super) fn waits(&mut self, t: Nanos) {
        self.course.turns += 1;
        self.course.t = t;
    }

    /// Records that a forbidden state has occurred in this turn.
    pub(super) fn breach(&mut self, number: usize, gap: Option<f64>) {
        let turn = self.course.turns.saturating_sub(1);
        let (t, atom) = (self.course.t, self.atom);
        self.course.breaches.push(Breach { number, turn, t, atom, gap });
    }
}

impl TestCourse {
    /// Returns the transition that ended the plan; `None` if the plan was not over.
    pub(super) fn last(&self) -> Option<&CourseTransition> {
        self.steps.last().filter(|step| step.to.is_none())
    }
}

/// Returns the law of an atom with its line, as in `go 20 0 (line 6)`; if `atom` is `None`, returns "the end of the
/// plan".
pub(super) fn atom_words(machine: &Machine, words: &dyn Words, atom: Option<u32>) -> String {
    let Some(atom) = atom else { return "the end of the plan".to_owned() };
    let atom = machine.atom(atom);
    let line = words.bracket(atom.element().number()).map_or(0, |bracket| bracket.at.line);
    format!("{} (line {line})", atom.law().text)
}
