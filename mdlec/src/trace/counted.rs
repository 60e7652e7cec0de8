//! The machine `counted`: the run-time system's own machine on a lowered plan, loops as the paper's counters
//! (semantics, section 9). It is what robots run, with a script in place of the robot.

use mdle_runtime::{Begin, Cause, Cursor, Ending, Fsm, Nanos, Next, Transition, Turn, Watch};

use super::{Applied, Fired, Machine, Outcome, Reports};
use crate::fsm::Lowered;
use crate::plan::Quark;

/// A lowered plan that is run.
#[derive(Debug)]
pub struct Counted<'p> {
    lowered: &'p Lowered,
    /// None before the first turn, whose output the machine begins with.
    machine: Option<mdle_runtime::Machine<Scripted<'p>>>,
}

impl<'p> Counted<'p> {
    /// A machine that is about to begin.
    #[must_use]
    pub fn new(lowered: &'p Lowered) -> Self {
        Self { lowered, machine: None }
    }
}

impl<'p> Machine<'p> for Counted<'p> {
    fn turn(&mut self, reports: &Reports) -> Outcome<'p> {
        let lowered = self.lowered;
        let begin = || mdle_runtime::Machine::begin(Scripted(lowered), reports, reports.t);
        let machine = self.machine.get_or_insert_with(begin);
        let mut transitions = Transitions { lowered, fired: Vec::new() };
        let turn = machine.turn(reports, reports.t, &mut transitions);
        let applied = match (turn, machine.atom()) {
            (Turn::Law(()), Some(atom)) => Applied::Law(&lowered.law(atom).text),
            (Turn::Cut, _) => Applied::Cut,
            (Turn::Over, _) | (Turn::Law(()), None) => Applied::Over,
        };
        Outcome { state: machine.state(), applied, fired: transitions.fired }
    }
}

/// Takes down the transitions of a turn.
struct Transitions<'p> {
    lowered: &'p Lowered,
    fired: Vec<Fired<'p>>,
}

impl Watch for Transitions<'_> {
    fn transition(&mut self, Transition { from, scope, cause, .. }: Transition) {
        let by = cause.by(self.lowered.condition(scope));
        self.fired.push(Fired { from, level: usize::from(cause.level()), by });
    }
}

impl mdle_runtime::Output for Reports {}

/// What a lowered plan means where a script is the robot.
#[derive(Debug)]
struct Scripted<'p>(&'p Lowered);

impl Scripted<'_> {
    /// Which scope around the current atom ends, and why.
    fn ending(&self, cursor: &Cursor<Box<[Nanos]>, Box<[u64]>>, y: &Reports, t: Nanos) -> Option<Cause> {
        let own = self.0.atoms.get(cursor.atom() as usize)?.scope;
        let quark = |id| y.fired.contains(&self.0.quark(id).text);
        let mut outermost = None;
        let mut here = own;
        // Outwards, so that the last one found is the outermost.
        while let (Some(bracket), Some(meaning)) =
            (self.0.brackets.get(here as usize), self.0.scopes.get(here as usize))
        {
            if let (mdle_runtime::fsm::Kind::Scope { level }, Some(scope)) = (bracket.kind, meaning)
                && scope.interrupt.condition.fired(&quark, &|nanos| cursor.since(level, t) >= Nanos(nanos))
            {
                outermost = Some(Cause::Fired(level));
            }
            if bracket.parent == here {
                break;
            }
            here = bracket.parent;
        }
        outermost.or_else(|| self.0.completed(cursor.atom(), y))
    }
}

impl mdle_runtime::Plan for Scripted<'_> {
    type Output = Reports;
    type Input = ();
    type Entered = Box<[Nanos]>;
    type Left = Box<[u64]>;

    fn fsm(&self) -> Fsm<'_> {
        self.0.tables()
    }

    fn slots(&self) -> (Self::Entered, Self::Left) {
        (vec![Nanos::ZERO; self.0.levels].into(), vec![0; self.0.slots].into())
    }

    fn enter(&mut self, _: u32, _: &Reports, _: Begin) {}

    fn next(&mut self, cursor: &mut Cursor<Self::Entered, Self::Left>, y: &Reports, begin: Begin, _: bool) -> Next {
        self.ending(cursor, y, begin.now).map(Ending::from).into()
    }

    fn input(&mut self, _: &Reports, _: Nanos) {}

    fn law(&self, atom: u32) -> &str {
        &self.0.law(atom).text
    }

    fn condition(&self, scope: u32) -> &str {
        self.0.condition(scope)
    }

    fn name(&self, scope: u32) -> &str {
        self.0.scopes.get(scope as usize).and_then(Option::as_ref).map_or("", |scope| &scope.name)
    }
}

impl Lowered {
    fn law(&self, atom: u32) -> &Quark {
        self.quark(self.laws[atom as usize].quark)
    }

    fn condition(&self, scope: u32) -> &str {
        self.scopes.get(scope as usize).and_then(Option::as_ref).map_or("", |scope| &scope.interrupt.text)
    }

    fn completed(&self, atom: u32, y: &Reports) -> Option<Cause> {
        let law = self.law(atom);
        let bracket = self.brackets.get(self.atoms.get(atom as usize)?.scope as usize)?;
        let mdle_runtime::fsm::Kind::Scope { level } = bracket.kind else { return None };
        (law.completes && y.completed.contains(&law.text)).then_some(Cause::Completed(level))
    }
}
