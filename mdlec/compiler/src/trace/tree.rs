//! The machine `tree`: walks over the plan as written, without expanding loops or removing degeneracy
//! (docs/src/reference/semantics.md, 2 to 6). It is the reference for all other machines, and shares no stepping code
//! with them.

mod steps;

use std::sync::Arc;

use mdle_runtime::Frame;
pub use steps::{OpenPart, TreeStep};

use super::{COMPLETED, EntryTime, Fired, Machine, Reports, ScriptedInput, TurnResult};
use crate::plan::{Atom, Interrupt, Loop, Mark, Node, Plan, QuarkId, RecordId, Scope, Situation};

/// A walk over a plan.
#[derive(Debug, Clone)]
pub struct TreeWalk<'p> {
    plan: &'p Plan,
    /// Scopes, loops and atoms of the plan. The plan itself comes first, and each element comes before its nested
    /// elements. The list is flat because a plan may be nested more deeply than the stack allows for recursion.
    elements: Arc<[TreeElement<'p>]>,
    /// Open elements (elements that have been entered and have not ended); the outermost comes first, and the current
    /// atom last. Empty before the first turn and after the plan has ended.
    open: Vec<EnteredElement>,
    /// `true` once the first turn has begun.
    has_begun: bool,
}

/// A scope, a loop or an atom.
#[derive(Debug)]
struct TreeElement<'p> {
    kind: NodeKind<'p>,
    /// Nodes of the body.
    body: &'p [Node],
    /// Index of the element that is the first node of the body; the elements of the other nodes follow it.
    held: usize,
    /// Number of states in the expanded plan; for a loop, the number of states of one pass.
    states: u64,
}

#[derive(Debug, Clone, Copy)]
enum NodeKind<'p> {
    Scope(&'p Scope),
    Loop(&'p Loop),
    Atom(&'p Atom),
}

/// An element that has been entered and has not ended.
#[derive(Debug, Clone)]
struct EnteredElement {
    element: usize,
    entered: EntryTime,
    /// Index of the open nested element within the body.
    index: usize,
    /// For a loop, the number of the current pass, counted from 1.
    pass: u64,
    /// Number of the first state in the current pass.
    first: u64,
    /// Number of the first state in the open nested element.
    here: u64,
    /// Memories of RISING in the element's interrupt.
    memories: Vec<bool>,
    /// For the outermost scope of a definition, a list that contains `true` for each fact in its record that is true.
    facts: Vec<bool>,
}

/// A scope that ends.
struct EndedScope<'p> {
    /// Index of the scope in the list of open elements.
    place: usize,
    level: usize,
    /// Text of the interrupt, as the trace shows it.
    by: &'p str,
    /// Operands of the scope's interrupt that have fired.
    operands: Vec<String>,
    /// Number of the operand of the scope's interrupt that was the cause; `None` if the law has completed.
    operand: Option<u32>,
}

/// Data for evaluating a condition: an open element, and the reports of the turn.
struct ElementSituation<'t, 'p> {
    tree: &'t TreeWalk<'p>,
    open: &'t EnteredElement,
    reports: &'t Reports,
}

impl Situation for ElementSituation<'_, '_> {
    fn quark(&self, quark: QuarkId) -> bool {
        self.reports.fired.contains(&self.tree.plan.quark(quark).text)
    }

    fn waited(&self, nanos: u64) -> bool {
        self.open.entered.waited(nanos, self.reports)
    }

    fn driven(&self, nanometers: u64) -> bool {
        self.open.entered.driven(nanometers, self.reports)
    }

    fn remembers(&self, memory: u32) -> bool {
        self.open.memories[memory as usize]
    }

    fn recorded(&self, record: RecordId, fact: u32) -> bool {
        let kept = self.tree.open.iter().find(|open| self.tree.elements[open.element].record() == Some(record));
        kept.is_some_and(|open| open.facts[fact as usize])
    }
}

impl<'p> TreeWalk<'p> {
    /// Creates the walk before its first turn.
    #[must_use]
    pub fn new(plan: &'p Plan) -> Self {
        Self { plan, elements: flat(&plan.root).into(), open: Vec::new(), has_begun: false }
    }

    /// Enters an element, and all nested elements down to an atom.
    fn enter(&mut self, element: usize, first: u64, entered: EntryTime) {
        let mut next = Some(element);
        while let Some(element) = next {
            let TreeElement { kind, body, held, .. } = self.elements[element];
            let memories = kind.interrupt().map_or(0, |interrupt| interrupt.memories as usize);
            let facts = match kind {
                NodeKind::Scope(Scope { record: Some(record), .. }) => record.facts as usize,
                NodeKind::Scope(_) | NodeKind::Loop(_) | NodeKind::Atom(_) => 0,
            };
            let (memories, facts) = (vec![false; memories], vec![false; facts]);
            self.open.push(EnteredElement { element, entered, index: 0, pass: 1, first, here: first, memories, facts });
            next = (!body.is_empty()).then_some(held);
        }
    }

    /// Returns the outermost scope whose interrupt has fired, or else the completion of the atom's law; `None`
    /// if neither has happened.
    fn fired(&self, reports: &Reports) -> Option<EndedScope<'p>> {
        let mut level = 0;
        for (place, open) in self.open.iter().enumerate() {
            let Some(interrupt) = self.elements[open.element].kind.interrupt() else { continue };
            let read = ElementSituation { tree: self, open, reports };
            if interrupt.condition.fired(&read) {
                let operand = Some(interrupt.condition.cause(&read));
                let operands = self.plan.operands_fired(interrupt, &read);
                return Some(EndedScope { place, level, by: &interrupt.text, operands, operand });
            }
            level += 1;
        }
        let done = self.law().is_some_and(|law| law.completes && reports.completed.contains(&law.text));
        let (place, level) = (self.open.len().checked_sub(1)?, level.checked_sub(1)?);
        done.then(|| EndedScope { place, level, by: COMPLETED, operands: Vec::new(), operand: None })
    }

    /// Sets the memory of each RISING whose operand is false, in the scopes that enclose the current atom.
    fn settle(&mut self, reports: &Reports) {
        for place in 0..self.open.len() {
            let open = &self.open[place];
            let mut low = Vec::new();
            if let Some(interrupt) = self.elements[open.element].kind.interrupt() {
                let read = ElementSituation { tree: self, open, reports };
                interrupt.condition.each_rising(&mut |memory, operand| {
                    if !operand.fired(&read) {
                        low.push(memory as usize);
                    }
                });
            }
            low.into_iter().for_each(|memory| self.open[place].memories[memory] = true);
        }
    }

    fn law(&self) -> Option<&'p crate::plan::Quark> {
        match self.elements[self.open.last()?.element].kind {
            NodeKind::Atom(atom) => Some(self.plan.quark(atom.law)),
            NodeKind::Scope(_) | NodeKind::Loop(_) => None,
        }
    }

    /// Returns the frame of the current atom if the atom or an enclosing scope has `FRAME here`.
    fn frame(&self) -> Option<Frame> {
        let NodeKind::Atom(atom) = self.elements[self.open.last()?.element].kind else { return None };
        let anew = self.open.iter().rev().find(|open| self.elements[open.element].kind.is_here())?;
        Some(anew.entered.frame(atom.frame))
    }

    /// Returns the number of the current atom's state in the expanded plan, or of the termination state.
    fn state(&self) -> u64 {
        match self.open.last() {
            Some(atom) => atom.first,
            None => self.elements.first().map_or(1, |plan| plan.states.saturating_add(1)),
        }
    }

    /// Ends a scope, continues outwards to the first element that has a successor, and enters the successor. Returns
    /// the number of elements that have stayed open.
    fn leave(&mut self, ending: &EndedScope<'p>, now: EntryTime) -> usize {
        let mut ended = Vec::new();
        let first = self.elements[self.open[ending.place].element].kind;
        ended.push((first.marks(), ending.operand));
        self.open.truncate(ending.place);
        while let Some(open) = self.open.last_mut() {
            let TreeElement { kind, body, held, states } = self.elements[open.element];
            if open.index + 1 < body.len() {
                open.here = open.here.saturating_add(self.elements[held + open.index].all_states());
                open.index += 1;
            } else if let NodeKind::Loop(repeated) = kind
                && repeated.times.is_none_or(|times| open.pass < times)
            {
                open.pass = open.pass.saturating_add(1);
                open.index = 0;
                // All passes of an endless loop use the same states.
                open.first = open.first.saturating_add(if repeated.times.is_some() { states } else { 0 });
                open.here = open.first;
            } else {
                // The element has ended with its last element.
                ended.push((kind.marks(), None));
                self.open.pop();
                continue;
            }
            let (next, first) = (held + open.index, open.here);
            self.record(&ended);
            let kept = self.open.len();
            self.enter(next, first, now);
            return kept;
        }
        0
    }

    /// Replaces the record of each definition in which labelled elements have ended. `ended` contains the labels of
    /// each ended element, and the operand that ended it.
    fn record(&mut self, ended: &[(&[Mark], Option<u32>)]) {
        let marks = || ended.iter().flat_map(|(marks, operand)| marks.iter().map(move |mark| (mark, *operand)));
        for open in &mut self.open {
            let Some(record) = self.elements[open.element].record() else { continue };
            let of_this = || marks().filter(|(mark, _)| mark.record == record);
            if of_this().next().is_none() {
                continue;
            }
            open.facts.fill(false);
            for (mark, operand) in of_this() {
                mark.facts
                    .iter()
                    .filter(|fact| fact.holds(operand))
                    .for_each(|fact| open.facts[fact.number as usize] = true);
            }
        }
    }
}

impl<'p> Machine<'p> for TreeWalk<'p> {
    fn turn(&mut self, reports: &Reports) -> TurnResult<'p> {
        self.begin(reports);
        let mut transitions = Vec::new();
        loop {
            match self.step(reports, transitions.len()) {
                TreeStep::Transition { fired, .. } => transitions.push(fired),
                TreeStep::End(applied) => {
                    let frame = self.frame().filter(|_| matches!(applied, ScriptedInput::Law(_)));
                    return TurnResult { state: self.state(), applied, frame, fired: transitions };
                }
            }
        }
    }
}

impl<'p> NodeKind<'p> {
    /// Returns the interrupt of a scope or an atom; `None` for a loop.
    fn interrupt(self) -> Option<&'p Interrupt> {
        match self {
            Self::Scope(scope) => Some(&scope.interrupt),
            Self::Atom(atom) => Some(&atom.interrupt),
            Self::Loop(_) => None,
        }
    }

    /// Returns `true` if the element has `FRAME here`.
    fn is_here(self) -> bool {
        match self {
            Self::Scope(scope) => scope.here,
            Self::Atom(atom) => atom.here,
            Self::Loop(_) => false,
        }
    }

    /// Returns the labels of the elements that end together with this element.
    fn marks(self) -> &'p [Mark] {
        match self {
            Self::Scope(scope) => &scope.marks,
            Self::Atom(atom) => &atom.marks,
            Self::Loop(repeated) => &repeated.marks,
        }
    }
}

impl TreeElement<'_> {
    /// Returns the record that is kept with the element; `None` if the element has no record.
    fn record(&self) -> Option<RecordId> {
        match self.kind {
            NodeKind::Scope(scope) => scope.record.map(|record| record.id),
            NodeKind::Loop(_) | NodeKind::Atom(_) => None,
        }
    }

    /// Returns the number of states in the expanded plan, including all passes of a finite loop.
    fn all_states(&self) -> u64 {
        match self.kind {
            NodeKind::Loop(repeated) => self.states.saturating_mul(repeated.times.unwrap_or(1)),
            NodeKind::Scope(_) | NodeKind::Atom(_) => self.states,
        }
    }
}

/// Returns the elements of a plan. Each element comes before its nested elements; the elements of a body are
/// consecutive.
fn flat(root: &Scope) -> Vec<TreeElement<'_>> {
    let mut elements = vec![TreeElement { kind: NodeKind::Scope(root), body: &root.body, held: 0, states: 0 }];
    let mut next = 0;
    while next < elements.len() {
        elements[next].held = elements.len();
        let body = elements[next].body;
        elements.extend(body.iter().map(|node| {
            let (kind, body, states): (_, &[Node], _) = match node {
                Node::Atom(atom) => (NodeKind::Atom(atom), &[], 1),
                Node::Scope(scope) => (NodeKind::Scope(scope), &scope.body, 0),
                Node::Loop(repeated) => (NodeKind::Loop(repeated), &repeated.body, 0),
            };
            TreeElement { kind, body, held: 0, states }
        }));
        next += 1;
    }
    for place in (0..elements.len()).rev() {
        let TreeElement { body, held, states, .. } = elements[place];
        let inside = elements[held..held + body.len()].iter();
        elements[place].states = inside.fold(states, |sum, element| sum.saturating_add(element.all_states()));
    }
    elements
}
