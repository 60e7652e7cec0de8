//! The machine `table`: the expanded FSM of Algorithm 1, with a row for each interrupt
//! (docs/src/reference/semantics.md, 8 and 9).
//!
//! The table contains the destination of each interrupt, the scopes that restart there, and the elements that end on
//! the way. All of this is computed in advance, so a turn only reads the table.

use std::collections::BTreeMap;
use std::ops::Range;

use mdle_runtime::TRANSITIONS_PER_TURN;

use super::{COMPLETED, EntryTime, Fired, Machine, Reports, ScriptedInput, TurnResult};
use crate::diagnostic::Diagnostic;
use crate::fsm::expanded_states;
use crate::plan::{Interrupt, Mark, Node, Nondegenerate, Plan, Quark, QuarkId, Record, RecordId, Scope, Situation};

/// A plan as a table, and the current state.
#[derive(Debug)]
pub struct TableMachine<'p> {
    plan: &'p Plan,
    /// All states except the termination state, in order.
    states: Vec<AtomState<'p>>,
    /// Interrupts in pre-order: the interrupt of a scope comes before those of its elements.
    rows: Vec<InterruptRow<'p>>,
    /// For each row, the memory of its scope since the scope was entered.
    memories: Vec<ScopeMemory>,
    /// For each record, a list that contains `true` for each fact that is true.
    records: BTreeMap<RecordId, Vec<bool>>,
    /// Index of the current state in `states`. When the plan has ended, this is the length of `states`.
    state: usize,
    /// `true` once the first turn has begun.
    has_begun: bool,
}

/// A state, which is an atom.
#[derive(Debug)]
struct AtomState<'p> {
    law: &'p Quark,
    /// Row of the atom's own interrupt.
    own: usize,
    /// Angle, in radians, by which the state's frame is turned.
    turned: f64,
    /// Row of the innermost scope with `FRAME here` that contains the state, which may be the row of the atom itself;
    /// `None` if there is no such scope.
    here: Option<usize>,
}

/// An interrupt with its destination and its labels.
#[derive(Debug)]
struct InterruptRow<'p> {
    interrupt: &'p Interrupt,
    level: usize,
    /// Row of the enclosing scope; `None` for the plan itself.
    around: Option<usize>,
    /// Record that is kept with the row's scope; `None` if the scope has no record.
    record: Option<Record>,
    next: RowDestination,
    /// Labels of the row's scope. `ends_with` contains the labels of the elements that end with this scope because it
    /// is their last element.
    marks: &'p [Mark],
    ends_with: Vec<&'p Mark>,
}

/// Destination of an interrupt.
#[derive(Debug, Clone)]
struct RowDestination {
    state: usize,
    /// Range of the rows whose scopes restart. Scopes that open together form a range, because rows are in pre-order.
    afresh: Range<usize>,
}

/// Memory of a scope since it was entered.
#[derive(Debug, Clone)]
struct ScopeMemory {
    entered: EntryTime,
    /// Memories of RISING in the scope's interrupt.
    rising: Vec<bool>,
}

/// A row that has fired: its text, its fired operands, and the operand that was the cause (`None` if the law
/// has completed).
struct FiredRow<'p> {
    row: usize,
    by: &'p str,
    operands: Vec<String>,
    operand: Option<u32>,
}

/// Data for evaluating a row's condition: the table, the row's memory, and the reports of the turn.
struct RowSituation<'t, 'p> {
    table: &'t TableMachine<'p>,
    memory: &'t ScopeMemory,
    reports: &'t Reports,
}

impl Situation for RowSituation<'_, '_> {
    fn quark(&self, quark: QuarkId) -> bool {
        self.reports.fired.contains(&self.table.plan.quark(quark).text)
    }

    fn waited(&self, nanos: u64) -> bool {
        self.memory.entered.waited(nanos, self.reports)
    }

    fn driven(&self, nanometers: u64) -> bool {
        self.memory.entered.driven(nanometers, self.reports)
    }

    fn remembers(&self, memory: u32) -> bool {
        self.memory.rising[memory as usize]
    }

    fn recorded(&self, record: RecordId, fact: u32) -> bool {
        self.table.records.get(&record).is_some_and(|facts| facts[fact as usize])
    }
}

impl<'p> TableMachine<'p> {
    /// Creates the table, before the first turn.
    ///
    /// # Errors
    /// Fails with E0501 or E0502 for a plan with too many states.
    pub fn new(plan: &'p Nondegenerate) -> Result<Self, Diagnostic> {
        expanded_states(plan)?;
        let plan = plan.plan();
        let mut filling = Filling { plan, states: Vec::new(), rows: Vec::new(), ended: Vec::new(), begun: None };
        filling.scope(&plan.root, None, None);
        // The interrupts that end the plan lead to the state after its last state, where no scope restarts.
        filling.lead_to(&RowDestination { state: filling.states.len(), afresh: 0..0 });
        let Filling { states, rows, .. } = filling;
        let fresh = |row: &InterruptRow<'_>| {
            let rising = vec![false; row.interrupt.memories as usize];
            ScopeMemory { entered: EntryTime::default(), rising }
        };
        let records = rows.iter().filter_map(|row| row.record).map(|record| (record.id, empty(record))).collect();
        Ok(Self { plan, memories: rows.iter().map(fresh).collect(), records, states, rows, state: 0, has_begun: false })
    }

    /// Returns the rows of the scopes that enclose the current state; the innermost comes first.
    fn around(&self) -> impl Iterator<Item = usize> {
        let own = self.states.get(self.state).map(|state| state.own);
        std::iter::successors(own, |row| self.rows[*row].around)
    }

    fn reading<'t>(&'t self, row: usize, reports: &'t Reports) -> RowSituation<'t, 'p> {
        RowSituation { table: self, memory: &self.memories[row], reports }
    }

    /// Returns the outermost interrupt that has fired, or else the completion of the law; `None` if neither has
    /// happened.
    fn fired(&self, reports: &Reports) -> Option<FiredRow<'p>> {
        let has_fired = |row: &usize| self.rows[*row].interrupt.condition.fired(&self.reading(*row, reports));
        if let Some(row) = self.around().filter(has_fired).last() {
            let interrupt = self.rows[row].interrupt;
            let (condition, reading) = (&interrupt.condition, self.reading(row, reports));
            let operands = self.plan.operands_fired(interrupt, &reading);
            return Some(FiredRow { row, by: &interrupt.text, operands, operand: Some(condition.cause(&reading)) });
        }
        let state = self.states.get(self.state)?;
        let done = state.law.completes && reports.completed.contains(&state.law.text);
        done.then_some(FiredRow { row: state.own, by: COMPLETED, operands: Vec::new(), operand: None })
    }

    fn follow(&mut self, ending: &FiredRow<'p>, now: EntryTime) {
        self.record(ending);
        let RowDestination { state, afresh } = self.rows[ending.row].next.clone();
        for row in afresh {
            let memory = &mut self.memories[row];
            memory.entered = now;
            memory.rising.fill(false);
            if let Some(record) = self.rows[row].record {
                self.records.insert(record.id, empty(record));
            }
        }
        self.state = state;
    }

    /// Replaces the record of each definition in which a labelled element ends with this row.
    fn record(&mut self, ending: &FiredRow<'p>) {
        let InterruptRow { marks, ends_with, .. } = &self.rows[ending.row];
        let own = marks.iter().map(|mark| (mark, ending.operand));
        let ended = || own.clone().chain(ends_with.iter().map(|mark| (*mark, None)));
        for (mark, _) in ended() {
            self.records.entry(mark.record).and_modify(|facts| facts.fill(false));
        }
        for (mark, operand) in ended() {
            let Some(facts) = self.records.get_mut(&mark.record) else { continue };
            for fact in mark.facts.iter().filter(|fact| fact.holds(operand)) {
                facts[fact.number as usize] = true;
            }
        }
    }

    /// Sets the memory of each RISING whose operand is false, in the scopes that enclose the current state.
    fn settle(&mut self, reports: &Reports) {
        let mut set = Vec::new();
        for row in self.around() {
            let reading = self.reading(row, reports);
            self.rows[row].interrupt.condition.each_rising(&mut |memory, operand| {
                if !operand.fired(&reading) {
                    set.push((row, memory as usize));
                }
            });
        }
        set.into_iter().for_each(|(row, memory)| self.memories[row].rising[memory] = true);
    }

    /// Returns the number of the current state, counted from 1.
    fn number(&self) -> u64 {
        self.state as u64 + 1
    }
}

impl<'p> Machine<'p> for TableMachine<'p> {
    fn turn(&mut self, reports: &Reports) -> TurnResult<'p> {
        if !std::mem::replace(&mut self.has_begun, true) {
            // The scopes that are entered later get a new moment at their entry.
            self.memories.iter_mut().for_each(|memory| memory.entered = reports.moment());
        }
        let mut fired = Vec::new();
        while let Some(mut ending) = self.fired(reports) {
            if fired.len() == TRANSITIONS_PER_TURN as usize {
                self.settle(reports);
                return TurnResult { state: self.number(), applied: ScriptedInput::Cut, frame: None, fired };
            }
            let operands = std::mem::take(&mut ending.operands);
            fired.push(Fired { from: self.number(), level: self.rows[ending.row].level, by: ending.by, operands });
            self.follow(&ending, reports.moment());
        }
        self.settle(reports);
        let state = self.states.get(self.state);
        let applied = state.map_or(ScriptedInput::Over, |state| ScriptedInput::Law(&state.law.text));
        let frame = state.and_then(|state| Some(self.memories[state.here?].entered.frame(state.turned)));
        TurnResult { state: self.number(), applied, frame, fired }
    }
}

/// Returns a record for the case that no element has ended.
fn empty(record: Record) -> Vec<bool> {
    vec![false; record.facts as usize]
}

/// A table that is being filled in the order of the plan's text.
struct Filling<'p> {
    plan: &'p Plan,
    states: Vec<AtomState<'p>>,
    rows: Vec<InterruptRow<'p>>,
    /// Rows of the scopes that have just ended; these rows lead to the next state.
    ended: Vec<usize>,
    /// First row of the scopes that have begun since the last atom; `None` directly after an atom.
    begun: Option<usize>,
}

impl<'p> Filling<'p> {
    fn scope(&mut self, scope: &'p Scope, around: Option<usize>, here: Option<usize>) {
        let row = self.row(&scope.interrupt, around, &scope.marks);
        self.rows[row].record = scope.record;
        self.sequence(&scope.body, row, if scope.here { Some(row) } else { here });
        self.ends_too(&scope.marks);
        self.ended.push(row);
    }

    /// Adds the elements of a scope, with finite loops written out.
    fn sequence(&mut self, body: &'p [Node], around: usize, here: Option<usize>) {
        for node in body {
            match node {
                Node::Atom(atom) => {
                    let own = self.row(&atom.interrupt, Some(around), &atom.marks);
                    let from = self.begun.take().unwrap_or(own);
                    self.lead_to(&RowDestination { state: self.states.len(), afresh: from..own + 1 });
                    let here = if atom.here { Some(own) } else { here };
                    self.states.push(AtomState { law: self.plan.quark(atom.law), own, turned: atom.frame, here });
                    self.ended.push(own);
                }
                Node::Scope(scope) => self.scope(scope, Some(around), here),
                Node::Loop(repeated) => match repeated.times {
                    Some(times) => {
                        (0..times).for_each(|_| self.sequence(&repeated.body, around, here));
                        self.ends_too(&repeated.marks);
                    }
                    None => self.without_end(&repeated.body, around, here),
                },
            }
        }
    }

    /// Appends the elements of an endless loop once. The rows that end a pass lead back to the loop's first state.
    fn without_end(&mut self, body: &'p [Node], around: usize, here: Option<usize>) {
        let (state, from) = (self.states.len(), self.rows.len());
        self.sequence(body, around, here);
        let own = self.states[state].own;
        self.lead_to(&RowDestination { state, afresh: from..own + 1 });
    }

    /// Appends the row of a scope or an atom, and returns the number of the row.
    fn row(&mut self, interrupt: &'p Interrupt, around: Option<usize>, marks: &'p [Mark]) -> usize {
        let row = self.rows.len();
        let level = around.map_or(0, |around| self.rows[around].level + 1);
        self.begun.get_or_insert(row);
        let (next, ends_with) = (RowDestination { state: 0, afresh: 0..0 }, Vec::new());
        self.rows.push(InterruptRow { interrupt, level, around, record: None, next, marks, ends_with });
        row
    }

    /// Adds `marks` to the rows that have just ended, because the element with these labels ends together with its last
    /// element.
    fn ends_too(&mut self, marks: &'p [Mark]) {
        for row in self.ended.iter().filter(|_| !marks.is_empty()) {
            self.rows[*row].ends_with.extend(marks);
        }
    }

    fn lead_to(&mut self, next: &RowDestination) {
        for row in self.ended.drain(..) {
            self.rows[row].next = next.clone();
        }
    }
}
