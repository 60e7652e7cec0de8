//! A run of a plan on a script, with steps forward and back. Runs are deterministic: a step back restarts from a copy
//! of an earlier state and runs forward again.

use mdle_compiler::diagnostic::Span;
use mdle_compiler::plan::Plan;
use mdle_compiler::trace::{OpenPart, Reports, ScriptedInput, TreeStep, TreeWalk};

/// Maximum number of copies of the state. When it is reached, every second copy is deleted.
const MOST_COPIES: usize = 64;

/// A position in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RunPosition {
    /// Number of steps from the start of the run.
    pub(crate) steps: u64,
    /// Number of the turn, counted from 0.
    pub(crate) turn: usize,
    /// Number of transitions that the turn has made so far.
    made: usize,
    /// Input of the turn; `None` until the turn has ended.
    pub(crate) input: Option<TurnInput>,
}

/// Input of a turn that has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnInput {
    /// The input that the current atom's law returns.
    Law,
    /// The null input, because the turn reached the maximum number of transitions.
    Cut,
    /// The null input, because the plan has ended.
    Over,
}

/// Kind of a step forward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepKind {
    /// The next turn has begun, at a later time.
    Turn,
    /// A scope has ended. `ended` is the number of open elements that enclosed this scope. `kept` is the number of
    /// elements that were open before the step and remain open.
    Transition { ended: usize, kept: usize },
    /// The turn has ended.
    End,
}

/// A run of a plan on a script.
#[derive(Debug)]
pub(crate) struct DebugRun<'p> {
    turns: &'p [Reports],
    tree: TreeWalk<'p>,
    at: RunPosition,
    /// Copies of the state in the order of the run; the first one is the start of the run.
    copies: Vec<(RunPosition, TreeWalk<'p>)>,
    /// Number of turns between two copies of the state.
    apart: usize,
}

impl<'p> DebugRun<'p> {
    /// Enters the plan at the first of `turns`; returns `None` if there is no turn.
    pub(crate) fn new(plan: &'p Plan, turns: &'p [Reports]) -> Option<Self> {
        let mut tree = TreeWalk::new(plan);
        tree.begin(turns.first()?);
        let at = RunPosition { steps: 0, turn: 0, made: 0, input: None };
        Some(Self { turns, at, copies: vec![(at, tree.clone())], tree, apart: 32 })
    }

    /// Returns the current position.
    pub(crate) fn at(&self) -> RunPosition {
        self.at
    }

    /// Returns the reports of the current turn.
    pub(crate) fn reports(&self) -> &'p Reports {
        &self.turns[self.at.turn]
    }

    /// Returns the reports of the previous turn; `None` in the first turn.
    pub(crate) fn reports_before(&self) -> Option<&'p Reports> {
        self.turns.get(self.at.turn.checked_sub(1)?)
    }

    /// Returns the open elements, from the plan to the current atom; the list is empty if the plan has ended.
    pub(crate) fn open(&self) -> impl DoubleEndedIterator<Item = OpenPart<'_, 'p>> + ExactSizeIterator {
        self.tree.open()
    }

    /// Returns the places of the operands that fire and thereby end a scope in the next step.
    pub(crate) fn firing(&self) -> Vec<Span> {
        if self.at.input.is_some() { Vec::new() } else { self.tree.firing(self.reports()) }
    }

    /// Returns `true` if the plan has ended.
    pub(crate) fn is_over(&self) -> bool {
        self.open().len() == 0
    }

    /// Makes a step; returns `None` at the end of the plan or of the script.
    pub(crate) fn step(&mut self) -> Option<StepKind> {
        let step = if self.at.input.is_some() { self.next_turn()? } else { self.go_on() };
        self.at.steps += 1;
        Some(step)
    }

    fn next_turn(&mut self) -> Option<StepKind> {
        if self.is_over() || self.at.turn + 1 >= self.turns.len() {
            return None;
        }
        if self.copies.last().is_none_or(|(at, _)| at.turn + self.apart <= self.at.turn) {
            self.copy();
        }
        self.at = RunPosition { turn: self.at.turn + 1, made: 0, input: None, ..self.at };
        Some(StepKind::Turn)
    }

    fn go_on(&mut self) -> StepKind {
        match self.tree.step(&self.turns[self.at.turn], self.at.made) {
            TreeStep::Transition { ended, kept, .. } => {
                self.at.made += 1;
                StepKind::Transition { ended, kept }
            }
            TreeStep::End(applied) => {
                self.at.input = Some(match applied {
                    ScriptedInput::Law(_) => TurnInput::Law,
                    ScriptedInput::Cut => TurnInput::Cut,
                    ScriptedInput::Over => TurnInput::Over,
                });
                StepKind::End
            }
        }
    }

    fn copy(&mut self) {
        if self.copies.len() >= MOST_COPIES {
            let mut number = 0_usize;
            self.copies.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.apart *= 2;
        }
        self.copies.push((self.at, self.tree.clone()));
    }

    /// Moves back to the last earlier position that `is_there` accepts, or to the start of the run if there is none.
    /// The second argument of `is_there` is the step that leads to the position; `None` at the start. Returns `false`
    /// if the run is already at its start.
    pub(crate) fn back(&mut self, mut is_there: impl FnMut(&Self, Option<StepKind>) -> bool) -> bool {
        let here = self.at.steps;
        if here == 0 {
            return false;
        }
        let mut end = here;
        while let Some((copied, tree)) = self.copies.iter().rev().find(|(at, _)| at.steps < end).cloned() {
            (self.at, self.tree) = (copied, tree);
            let mut last = (copied.steps == 0 && is_there(self, None)).then_some(0);
            while self.at.steps < end {
                let Some(step) = self.step() else { break };
                if self.at.steps < here && is_there(self, Some(step)) {
                    last = Some(self.at.steps);
                }
            }
            if let Some(steps) = last.or((copied.steps == 0).then_some(0)) {
                self.go_to(steps);
                return true;
            }
            // The search up to this copy has already made the step that leads to it.
            end = copied.steps;
        }
        false
    }

    /// Moves to the position after `steps` steps from the start of the run.
    fn go_to(&mut self, steps: u64) {
        if let Some((at, tree)) = self.copies.iter().rev().find(|(at, _)| at.steps <= steps).cloned() {
            (self.at, self.tree) = (at, tree);
        }
        while self.at.steps < steps && self.step().is_some() {}
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use mdle_compiler::compile;
    use mdle_compiler::diagnostic::SourceId;
    use mdle_compiler::trace::Script;

    use super::*;

    const PLAN: &str = "{ P (wait 9000)
      ExecPlan inf { (Atom (RISING bumper OR wait 3) (go 20 0)) (Atom (bumper AND wait 1) (go 10 0))^3 }
    }";

    /// Calls `test` with a run of a plan on a script of `turns` turns. In the script, the interrupt `bumper` fires in
    /// every third and in every seventh turn.
    fn with_run(turns: usize, test: impl FnOnce(DebugRun<'_>)) {
        let target = mdle_files::target(Some("sim")).unwrap();
        let (compiled, _) = compile(SourceId(0), PLAN, &target.alphabet, None);
        let line = |turn: usize| {
            let fired = if turn.is_multiple_of(3) || turn.is_multiple_of(7) { "\"bumper\"" } else { "" };
            format!("{{\"t\": {}.5, \"fired\": [{fired}]}}\n", turn)
        };
        let script = Script::read(&(0..turns).map(line).collect::<String>()).unwrap();
        test(DebugRun::new(&compiled[0].plan, script.turns()).unwrap());
    }

    /// Returns the complete state of a run as text.
    fn state(run: &DebugRun<'_>) -> String {
        format!("{:?} {:?}", run.at, run.tree)
    }

    #[test]
    fn going_back_and_forth_ends_in_the_same_state() {
        with_run(1_200, |mut run| {
            let mut states = vec![state(&run)];
            while run.step().is_some() {
                states.push(state(&run));
            }
            assert!(states.len() > 2_500 && run.copies.len() > 4, "{} {}", states.len(), run.copies.len());
            for expected in states.iter().rev().skip(1) {
                assert!(run.back(|_, _| true));
                assert_eq!(state(&run), *expected);
            }
            assert!(!run.back(|_, _| true));
            for expected in &states[1..] {
                run.step().unwrap();
                assert_eq!(state(&run), *expected);
            }
        });
    }

    #[test]
    fn back_finds_the_last_place_and_else_the_start() {
        with_run(1_200, |mut run| {
            while run.at.turn < 1_100 {
                run.step();
            }
            assert!(run.back(|run, step| step == Some(StepKind::Turn) && run.at.turn == 3));
            assert_eq!(run.at.turn, 3);
            assert!(run.back(|_, _| false));
            assert_eq!(run.at.steps, 0);
        });
    }

    #[test]
    fn copies_of_a_long_run_are_few() {
        with_run(20_000, |mut run| {
            while run.step().is_some() {}
            assert!(run.copies.len() <= MOST_COPIES);
            assert_eq!(run.copies[0].0.steps, 0);
        });
    }
}
