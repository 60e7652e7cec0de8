//! The machine `counted`: the run-time system's machine runs a lowered plan, in which loops are the paper's counters
//! (docs/src/reference/semantics.md, 9). Robots run the same machine; in a trace, a script takes the place of the
//! robot.

use mdle_runtime::{
    Begin, Cause, Cursor, Ending, Fsm, Here, Measured, Nanometers, Nanos, Pose, Stamp, Stamps, Transition, Turn, Watch,
};

use super::{Fired, Machine, Reports, ScriptedInput, TurnResult};
use crate::fsm;
use crate::plan::{Interrupt, QuarkId, RecordId, Situation};

/// A run of a lowered plan.
#[derive(Debug)]
pub struct CountedRun<'p> {
    plan_machine: &'p fsm::Machine,
    /// The machine; `None` before the first turn, because it can begin only with the output of that turn.
    machine: Option<mdle_runtime::Machine<Scripted<'p>>>,
}

impl<'p> CountedRun<'p> {
    /// Creates the machine, before its first turn.
    #[must_use]
    pub fn new(plan_machine: &'p fsm::Machine) -> Self {
        Self { plan_machine, machine: None }
    }

    /// Runs one turn, which `watch` observes. Must not be called after the plan has ended.
    pub fn watched(&mut self, reports: &Reports, watch: &mut impl Watch) -> Turn<()> {
        let begin = || mdle_runtime::Machine::begin(Scripted::new(self.plan_machine), reports, reports.t);
        self.machine.get_or_insert_with(begin).turn(reports, reports.t, watch)
    }

    /// Returns the index of the current atom in the order of the plan's text; `None` before the first turn and when the
    /// plan is over.
    #[must_use]
    pub fn atom(&self) -> Option<u32> {
        self.machine.as_ref()?.atom()
    }

    /// Calls `tell` with the number of each fired operand in the interrupt of `scope`, which encloses the
    /// current atom.
    pub fn operands(&self, scope: u32, reports: &Reports, tell: &mut dyn FnMut(u32)) {
        if let Some(machine) = &self.machine {
            let tell = &mut |number, _| tell(number);
            mdle_runtime::Plan::operands(machine.plan(), machine.cursor(), scope, reports, reports.t, tell);
        }
    }
}

impl<'p> Machine<'p> for CountedRun<'p> {
    fn turn(&mut self, reports: &Reports) -> TurnResult<'p> {
        let plan_machine = self.plan_machine;
        let begin = || mdle_runtime::Machine::begin(Scripted::new(plan_machine), reports, reports.t);
        let machine = self.machine.get_or_insert_with(begin);
        let mut transitions = TransitionRecorder { plan_machine, operands: Vec::new(), fired: Vec::new() };
        let turn = machine.turn(reports, reports.t, &mut transitions);
        let applied = match (turn, machine.atom()) {
            (Turn::Law(()), Some(atom)) => ScriptedInput::Law(&plan_machine.atom(atom).law().text),
            (Turn::Cut, _) => ScriptedInput::Cut,
            (Turn::Over, _) | (Turn::Law(()), None) => ScriptedInput::Over,
        };
        let frame = machine.frame().filter(|_| matches!(applied, ScriptedInput::Law(_)));
        TurnResult { state: machine.state(), applied, frame, fired: transitions.fired }
    }
}

/// Records the transitions of a turn.
struct TransitionRecorder<'p> {
    plan_machine: &'p fsm::Machine,
    /// Numbers of the operands that have fired for the next transition.
    operands: Vec<usize>,
    fired: Vec<Fired<'p>>,
}

impl Watch for TransitionRecorder<'_> {
    fn operand(&mut self, number: u32, _: Measured) {
        self.operands.push(number as usize);
    }

    fn transition(&mut self, Transition { from, scope, cause, .. }: Transition) {
        let by = cause.by(self.plan_machine.element(scope).condition_text());
        let operands = std::mem::take(&mut self.operands);
        let operands = self.plan_machine.element(scope).interrupt().map_or_else(Vec::new, |interrupt| {
            let parts = interrupt.condition.joined();
            let quark = |id| self.plan_machine.quark(id).text.clone();
            operands.iter().map(|number| interrupt.operand_text(*number, parts[*number], &quark)).collect()
        });
        self.fired.push(Fired { from, level: usize::from(cause.level()), by, operands });
    }
}

impl mdle_runtime::Output for Reports {
    fn here(&self) -> Pose {
        Pose { theta: self.heading, ..Pose::ORIGIN }
    }

    fn way(&self) -> Option<Nanometers> {
        Some(self.way)
    }
}

/// A lowered plan whose robot is a script.
#[derive(Debug)]
struct Scripted<'p> {
    plan_machine: &'p fsm::Machine,
    /// Memories of all levels of scopes, one level after the other.
    memories: Vec<bool>,
}

/// The entries of a plan's scopes.
type Entered<'p> = Stamps<Box<[Stamp]>, &'p [Option<Here>]>;

type CountedCursor<'p> = Cursor<Entered<'p>, Box<[u64]>>;

/// Data for evaluating a condition: the level of its scope in the current state, and the reports of the turn.
struct LevelSituation<'r, 'p> {
    scripted: &'r Scripted<'p>,
    cursor: &'r CountedCursor<'r>,
    level: u16,
    y: &'r Reports,
}

impl Situation for LevelSituation<'_, '_> {
    fn quark(&self, quark: QuarkId) -> bool {
        self.y.fired.contains(&self.scripted.plan_machine.quark(quark).text)
    }

    fn waited(&self, nanos: u64) -> bool {
        self.cursor.since(self.level, self.y.t) >= Nanos(nanos)
    }

    fn driven(&self, nanometers: u64) -> bool {
        self.cursor.way(self.level) >= Nanometers(nanometers)
    }

    fn remembers(&self, memory: u32) -> bool {
        self.scripted.memories[self.scripted.place(self.level, memory)]
    }

    fn recorded(&self, record: RecordId, fact: u32) -> bool {
        let Some(record) = self.scripted.plan_machine.record(record) else { return false };
        self.scripted.memories[self.scripted.place(record.level, record.first + fact)]
    }
}

impl<'p> Scripted<'p> {
    fn new(plan_machine: &'p fsm::Machine) -> Self {
        let memories = plan_machine.sizes().memories;
        let levels = if memories == 0 { 0 } else { plan_machine.depth() };
        Self { plan_machine, memories: vec![false; levels * memories] }
    }

    fn place(&self, level: u16, memory: u32) -> usize {
        usize::from(level) * self.plan_machine.sizes().memories + memory as usize
    }

    /// Returns the levels and interrupts of the scopes that enclose the current atom; the atom's own scope comes first.
    fn scopes(&self, cursor: &CountedCursor) -> impl Iterator<Item = (u16, &'p Interrupt)> + use<'p> {
        let own = self.plan_machine.atom(cursor.atom()).element();
        own.outwards().filter_map(|element| Some((element.level()?, element.interrupt()?)))
    }

    /// Returns the cause of the next transition: the outermost interrupt that has fired, or else the completion of the
    /// law; `None` if neither has happened.
    fn ending(&self, cursor: &CountedCursor<'_>, y: &Reports) -> Option<Cause> {
        let fired = |(level, interrupt): &(u16, &Interrupt)| {
            interrupt.condition.fired(&LevelSituation { scripted: self, cursor, level: *level, y })
        };
        // The scopes are in order from the inside outwards, so the last match is the outermost.
        let outermost = self.scopes(cursor).filter(fired).last().map(|(level, _)| Cause::Fired(level));
        outermost.or_else(|| self.completed(cursor, y))
    }

    /// Returns the completion of the current atom's law as a cause; `None` if the law has not completed.
    fn completed(&self, cursor: &CountedCursor<'_>, y: &Reports) -> Option<Cause> {
        let atom = self.plan_machine.atom(cursor.atom());
        let level = atom.element().level()?;
        (atom.law().completes && y.completed.contains(&atom.law().text)).then_some(Cause::Completed(level))
    }

    /// Records the labelled elements that end together with the scope of this cause, and clears the records of nested
    /// scopes.
    fn record(&mut self, cursor: &CountedCursor<'_>, cause: Cause, y: &Reports) {
        let level = cause.level();
        let operand = match cause {
            Cause::Completed(_) => None,
            Cause::Fired(_) => self
                .scopes(cursor)
                .find(|(here, _)| *here == level)
                .map(|(_, interrupt)| interrupt.condition.cause(&LevelSituation { scripted: self, cursor, level, y })),
        };
        let mut outermost = level;
        let (mut records, mut facts) = (Vec::new(), Vec::new());
        for (place, (number, _)) in cursor.ending(self.plan_machine.tables(), level).enumerate() {
            let element = self.plan_machine.element(number);
            outermost = element.level().unwrap_or(outermost);
            for mark in element.marks() {
                let Some(record) = self.plan_machine.record(mark.record) else { continue };
                records.push(record);
                let operand = operand.filter(|_| place == 0);
                let hold = mark.facts.iter().filter(|fact| fact.holds(operand));
                facts.extend(hold.map(|fact| self.place(record.level, record.first + fact.number)));
            }
        }
        for record in records {
            let first = self.place(record.level, record.first);
            self.memories[first..first + record.facts as usize].fill(false);
        }
        facts.into_iter().for_each(|fact| self.memories[fact] = true);
        let inside = self.place(outermost, 0);
        self.memories[inside..].fill(false);
    }
}

impl<'p> mdle_runtime::Plan for Scripted<'p> {
    type Output = Reports;
    type Input = ();
    type Entered = Entered<'p>;
    type Left = Box<[u64]>;

    fn fsm(&self) -> Fsm<'_> {
        self.plan_machine.tables()
    }

    fn slots(&self) -> (Self::Entered, Self::Left) {
        (
            Stamps::new(vec![Stamp::START; self.plan_machine.sizes().levels].into(), self.plan_machine.frames()),
            vec![0; self.plan_machine.sizes().slots].into(),
        )
    }

    fn enter(&mut self, _: u32, _: &Reports, _: Begin) {}

    fn next(&self, cursor: &CountedCursor<'p>, y: &Reports, _: Nanos) -> Option<Ending> {
        self.ending(cursor, y).map(Ending::from)
    }

    fn leave(&mut self, cursor: &CountedCursor<'p>, cause: Cause, y: &Reports, _: Nanos) {
        if self.plan_machine.sizes().memories > 0 {
            self.record(cursor, cause, y);
        }
    }

    fn settle(&mut self, cursor: &CountedCursor<'p>, y: &Reports, _: Nanos) {
        if self.plan_machine.sizes().memories == 0 {
            return;
        }
        let mut set = Vec::new();
        for (level, interrupt) in self.scopes(cursor) {
            let read = LevelSituation { scripted: self, cursor, level, y };
            interrupt.condition.each_rising(&mut |memory, operand| {
                if !operand.fired(&read) {
                    set.push(self.place(level, memory));
                }
            });
        }
        set.into_iter().for_each(|memory| self.memories[memory] = true);
    }

    fn operands(
        &self,
        cursor: &CountedCursor<'p>,
        scope: u32,
        y: &Reports,
        _: Nanos,
        tell: &mut dyn FnMut(u32, Measured),
    ) {
        let element = self.plan_machine.element(scope);
        let (Some(level), Some(interrupt)) = (element.level(), element.interrupt()) else { return };
        let read = LevelSituation { scripted: self, cursor, level, y };
        let operands = (0..).zip(interrupt.condition.joined());
        operands.filter(|(_, part)| part.fired(&read)).for_each(|(number, _)| tell(number, Measured::Nothing));
    }

    fn input(&mut self, _: &Reports, _: Nanos) {}

    fn law(&self, atom: u32) -> &str {
        &self.plan_machine.atom(atom).law().text
    }

    fn condition(&self, scope: u32) -> &str {
        self.plan_machine.element(scope).condition_text()
    }

    fn name(&self, scope: u32) -> &str {
        self.plan_machine.element(scope).name()
    }
}
