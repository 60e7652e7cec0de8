//! The machine `table`: the expanded FSM of Algorithm 1, a row for each interrupt (docs/src/reference/semantics.md, 8
//! and 9).
//!
//! Everything is computed beforehand: where an interrupt leads, which scopes start afresh there, and what ends on the way.
//! A turn only looks up.

use std::collections::BTreeMap;
use std::ops::Range;

use mdle_runtime::TRANSITIONS_PER_TURN;

use super::{Applied, COMPLETED, Fired, Machine, Moment, Outcome, Reports};
use crate::diagnostic::Diagnostic;
use crate::fsm::expanded_states;
use crate::plan::{Interrupt, Mark, Node, Nondegenerate, Plan, Quark, QuarkId, Record, RecordId, Scope, Situation};

/// A plan as a table, and where it is.
#[derive(Debug)]
pub struct Table<'p> {
    plan: &'p Plan,
    /// The states but the termination state, in order.
    states: Vec<State<'p>>,
    /// The interrupts, numbered in pre-order: a scope before what it holds.
    rows: Vec<Row<'p>>,
    /// What each row remembers since its scope was entered.
    memories: Vec<Memory>,
    /// What is so of each record of what ended last.
    records: BTreeMap<RecordId, Vec<bool>>,
    /// The place of the current state in `states`; behind them all when the plan is over.
    state: usize,
    /// `true` once there was a first turn.
    has_begun: bool,
}

/// A state: an atom.
#[derive(Debug)]
struct State<'p> {
    law: &'p Quark,
    /// The row of the atom's own interrupt.
    own: usize,
    /// The angle by which its frame is turned.
    turned: f64,
    /// The row of the innermost scope around it that is entered in a frame of its own, if there is one.
    here: Option<usize>,
}

/// What an interrupt does.
#[derive(Debug)]
struct Row<'p> {
    interrupt: &'p Interrupt,
    level: usize,
    /// The row of the scope around it; the plan's own has none.
    around: Option<usize>,
    /// The record that is kept with its scope.
    record: Option<Record>,
    next: Next,
    /// The labels of its scope, and of what ends because that was its last element.
    marks: &'p [Mark],
    ends_with: Vec<&'p Mark>,
}

/// Where an interrupt leads.
#[derive(Debug, Clone)]
struct Next {
    state: usize,
    /// The rows of the scopes that start afresh: numbers in pre-order, so that what opens together is a range.
    afresh: Range<usize>,
}

/// What a scope remembers since it was entered.
#[derive(Debug, Clone)]
struct Memory {
    entered: Moment,
    /// The memories of RISING in its interrupt.
    rising: Vec<bool>,
}

/// What has fired: a row, its text, its operands that have, and the operand that was the cause; none where the law is done.
struct Ending<'p> {
    row: usize,
    by: &'p str,
    operands: Vec<String>,
    operand: Option<u32>,
}

/// Where the condition of a row is read.
struct Reading<'t, 'p> {
    table: &'t Table<'p>,
    memory: &'t Memory,
    reports: &'t Reports,
}

impl Situation for Reading<'_, '_> {
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

impl<'p> Table<'p> {
    /// A table that is about to begin.
    ///
    /// # Errors
    /// E0501 and E0502 for a plan of too many states.
    pub fn new(plan: &'p Nondegenerate) -> Result<Self, Diagnostic> {
        expanded_states(plan)?;
        let plan = plan.plan();
        let mut filling = Filling { plan, states: Vec::new(), rows: Vec::new(), ended: Vec::new(), begun: None };
        filling.scope(&plan.root, None, None);
        // What ends the plan leads behind its last state, where nothing starts afresh.
        filling.lead_to(&Next { state: filling.states.len(), afresh: 0..0 });
        let Filling { states, rows, .. } = filling;
        let fresh = |row: &Row<'_>| {
            let rising = vec![false; row.interrupt.memories as usize];
            Memory { entered: Moment::default(), rising }
        };
        let records = rows.iter().filter_map(|row| row.record).map(|record| (record.id, empty(record))).collect();
        Ok(Self { plan, memories: rows.iter().map(fresh).collect(), records, states, rows, state: 0, has_begun: false })
    }

    /// The rows of the scopes around the current state, outwards.
    fn around(&self) -> impl Iterator<Item = usize> {
        let own = self.states.get(self.state).map(|state| state.own);
        std::iter::successors(own, |row| self.rows[*row].around)
    }

    fn reading<'t>(&'t self, row: usize, reports: &'t Reports) -> Reading<'t, 'p> {
        Reading { table: self, memory: &self.memories[row], reports }
    }

    /// The outermost interrupt that has fired, the completion of the law last.
    fn fired(&self, reports: &Reports) -> Option<Ending<'p>> {
        let has_fired = |row: &usize| self.rows[*row].interrupt.condition.fired(&self.reading(*row, reports));
        if let Some(row) = self.around().filter(has_fired).last() {
            let interrupt = self.rows[row].interrupt;
            let (condition, reading) = (&interrupt.condition, self.reading(row, reports));
            let operands = self.plan.operands_fired(interrupt, &reading);
            return Some(Ending { row, by: &interrupt.text, operands, operand: Some(condition.cause(&reading)) });
        }
        let state = self.states.get(self.state)?;
        let done = state.law.completes && reports.completed.contains(&state.law.text);
        done.then_some(Ending { row: state.own, by: COMPLETED, operands: Vec::new(), operand: None })
    }

    fn follow(&mut self, ending: &Ending<'p>, now: Moment) {
        self.record(ending);
        let Next { state, afresh } = self.rows[ending.row].next.clone();
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

    /// Replaces each record of which labelled elements end now by these.
    fn record(&mut self, ending: &Ending<'p>) {
        let Row { marks, ends_with, .. } = &self.rows[ending.row];
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

    /// Sets each memory of RISING around the current state whose operand has not fired.
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

    /// The number of the current state, from 1.
    fn number(&self) -> u64 {
        self.state as u64 + 1
    }
}

impl<'p> Machine<'p> for Table<'p> {
    fn turn(&mut self, reports: &Reports) -> Outcome<'p> {
        if !std::mem::replace(&mut self.has_begun, true) {
            // Whatever is entered later is entered anew.
            self.memories.iter_mut().for_each(|memory| memory.entered = reports.moment());
        }
        let mut fired = Vec::new();
        while let Some(mut ending) = self.fired(reports) {
            if fired.len() == TRANSITIONS_PER_TURN as usize {
                self.settle(reports);
                return Outcome { state: self.number(), applied: Applied::Cut, frame: None, fired };
            }
            let operands = std::mem::take(&mut ending.operands);
            fired.push(Fired { from: self.number(), level: self.rows[ending.row].level, by: ending.by, operands });
            self.follow(&ending, reports.moment());
        }
        self.settle(reports);
        let state = self.states.get(self.state);
        let applied = state.map_or(Applied::Over, |state| Applied::Law(&state.law.text));
        let frame = state.and_then(|state| Some(self.memories[state.here?].entered.frame(state.turned)));
        Outcome { state: self.number(), applied, frame, fired }
    }
}

/// A record in which nothing has ended.
fn empty(record: Record) -> Vec<bool> {
    vec![false; record.facts as usize]
}

/// A table that is filled from left to right.
struct Filling<'p> {
    plan: &'p Plan,
    states: Vec<State<'p>>,
    rows: Vec<Row<'p>>,
    /// The rows of the scopes that have just ended: they lead to what comes now.
    ended: Vec<usize>,
    /// The first row of what has begun, up to its first atom.
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

    /// The elements of a scope, the finite loops among them written out.
    fn sequence(&mut self, body: &'p [Node], around: usize, here: Option<usize>) {
        for node in body {
            match node {
                Node::Atom(atom) => {
                    let own = self.row(&atom.interrupt, Some(around), &atom.marks);
                    let from = self.begun.take().unwrap_or(own);
                    self.lead_to(&Next { state: self.states.len(), afresh: from..own + 1 });
                    let here = if atom.here { Some(own) } else { here };
                    self.states.push(State { law: self.plan.quark(atom.law), own, turned: atom.frame, here });
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

    /// A loop without end is written once: what ends its pass leads back to its first state.
    fn without_end(&mut self, body: &'p [Node], around: usize, here: Option<usize>) {
        let (state, from) = (self.states.len(), self.rows.len());
        self.sequence(body, around, here);
        let own = self.states[state].own;
        self.lead_to(&Next { state, afresh: from..own + 1 });
    }

    /// Begins a scope or an atom.
    fn row(&mut self, interrupt: &'p Interrupt, around: Option<usize>, marks: &'p [Mark]) -> usize {
        let row = self.rows.len();
        let level = around.map_or(0, |around| self.rows[around].level + 1);
        self.begun.get_or_insert(row);
        let (next, ends_with) = (Next { state: 0, afresh: 0..0 }, Vec::new());
        self.rows.push(Row { interrupt, level, around, record: None, next, marks, ends_with });
        row
    }

    /// What has these labels ends with its last element, which has just ended.
    fn ends_too(&mut self, marks: &'p [Mark]) {
        for row in self.ended.iter().filter(|_| !marks.is_empty()) {
            self.rows[*row].ends_with.extend(marks);
        }
    }

    fn lead_to(&mut self, next: &Next) {
        for row in self.ended.drain(..) {
            self.rows[row].next = next.clone();
        }
    }
}
