//! The machine `tree`: a direct walk over the plan as written, neither expanded nor without degeneracy
//! (semantics, sections 2 to 6). The reference for all others, so it shares no stepping code with any of them.

use mdle_runtime::{Nanos, TRANSITIONS_PER_TURN};

use super::{Applied, Fired, Machine, Outcome, Reports};
use crate::plan::{Atom, Interrupt, Loop, Node, Plan, Scope};

/// A plan that is walked.
#[derive(Debug)]
pub struct Tree<'p> {
    plan: &'p Plan,
    /// The plan's scopes, loops and atoms. Each stands before what it holds, the plan itself first: a flat list, because
    /// a plan may be nested deeper than the stack allows for recursion.
    elements: Vec<Element<'p>>,
    /// What is open, outermost first; the last is the current atom. Empty when the plan is over.
    open: Vec<Open>,
}

/// A scope, a loop or an atom.
#[derive(Debug)]
struct Element<'p> {
    kind: Kind<'p>,
    /// What it holds: `body.len()` elements, the first of them this one.
    body: &'p [Node],
    held: usize,
    /// Its states in the expanded plan; for a loop those of one pass.
    states: u64,
}

#[derive(Debug, Clone, Copy)]
enum Kind<'p> {
    Scope(&'p Scope),
    Loop(&'p Loop),
    Atom(&'p Atom),
}

/// An element that has been entered.
#[derive(Debug)]
struct Open {
    element: usize,
    entered: Nanos,
    /// The place in its body where the walk is.
    index: usize,
    /// For a loop: the number of the pass, from 1.
    pass: u64,
    /// The number of the first state of this pass, and of what stands at `index`.
    first: u64,
    here: u64,
}

impl<'p> Tree<'p> {
    /// A walk that is about to begin, at time 0.
    #[must_use]
    pub fn new(plan: &'p Plan) -> Self {
        let mut tree = Self { plan, elements: flat(&plan.root), open: Vec::new() };
        tree.enter(0, 1, Nanos::ZERO);
        tree
    }

    /// Enters an element and everything that opens with it, down to an atom.
    fn enter(&mut self, element: usize, first: u64, t: Nanos) {
        let mut next = Some(element);
        while let Some(element) = next {
            self.open.push(Open { element, entered: t, index: 0, pass: 1, first, here: first });
            let Element { body, held, .. } = self.elements[element];
            next = (!body.is_empty()).then_some(held);
        }
    }

    /// The outermost scope whose interrupt has fired, the completion of the atom's law last: its place among those
    /// that are open, its level and the cause.
    fn fired(&self, reports: &Reports) -> Option<(usize, usize, &'p str)> {
        let mut level = 0;
        for (place, open) in self.open.iter().enumerate() {
            let interrupt = match self.elements[open.element].kind {
                Kind::Scope(scope) => &scope.interrupt,
                Kind::Atom(atom) => &atom.interrupt,
                Kind::Loop(_) => continue,
            };
            if self.has_fired(interrupt, open.entered, reports) {
                return Some((place, level, &interrupt.text));
            }
            level += 1;
        }
        let done = self.law().is_some_and(|law| law.completes && reports.completed.contains(&law.text));
        done.then(|| (self.open.len() - 1, level - 1, Fired::COMPLETED))
    }

    fn has_fired(&self, interrupt: &Interrupt, entered: Nanos, reports: &Reports) -> bool {
        let quark = |id| reports.fired.contains(&self.plan.quark(id).text);
        let wait = |nanos| reports.t.since(entered) >= Nanos(nanos);
        interrupt.condition.fired(&quark, &wait)
    }

    fn law(&self) -> Option<&'p crate::plan::Quark> {
        match self.elements[self.open.last()?.element].kind {
            Kind::Atom(atom) => Some(self.plan.quark(atom.law)),
            Kind::Scope(_) | Kind::Loop(_) => None,
        }
    }

    /// The number of the current atom in the expanded plan, or of the termination state.
    fn state(&self) -> u64 {
        match self.open.last() {
            Some(atom) => atom.first,
            None => self.elements.first().map_or(1, |plan| plan.states.saturating_add(1)),
        }
    }

    /// Ends the scope at this place and goes outward to the first element that has a successor.
    fn leave(&mut self, place: usize, t: Nanos) {
        self.open.truncate(place);
        while let Some(open) = self.open.last_mut() {
            let Element { kind, body, held, states } = self.elements[open.element];
            if open.index + 1 < body.len() {
                open.here = open.here.saturating_add(self.elements[held + open.index].all_states());
                open.index += 1;
            } else if let Kind::Loop(repeated) = kind
                && repeated.times.is_none_or(|times| open.pass < times)
            {
                open.pass = open.pass.saturating_add(1);
                open.index = 0;
                // The passes of a loop without end share their states.
                open.first = open.first.saturating_add(if repeated.times.is_some() { states } else { 0 });
                open.here = open.first;
            } else {
                self.open.pop();
                continue;
            }
            let (next, first) = (held + open.index, open.here);
            return self.enter(next, first, t);
        }
    }
}

impl<'p> Machine<'p> for Tree<'p> {
    fn turn(&mut self, reports: &Reports) -> Outcome<'p> {
        let mut fired = Vec::new();
        while let Some((place, level, by)) = self.fired(reports) {
            if fired.len() == TRANSITIONS_PER_TURN as usize {
                return Outcome { state: self.state(), applied: Applied::Cut, fired };
            }
            fired.push(Fired { from: self.state(), level, by });
            self.leave(place, reports.t);
        }
        let applied = self.law().map_or(Applied::Over, |law| Applied::Law(&law.text));
        Outcome { state: self.state(), applied, fired }
    }
}

impl Element<'_> {
    /// Its states in the expanded plan, all passes of a finite loop together.
    fn all_states(&self) -> u64 {
        match self.kind {
            Kind::Loop(repeated) => self.states.saturating_mul(repeated.times.unwrap_or(1)),
            Kind::Scope(_) | Kind::Atom(_) => self.states,
        }
    }
}

/// The elements of a plan, each before what it holds, the elements of a body side by side.
fn flat(root: &Scope) -> Vec<Element<'_>> {
    let mut elements = vec![Element { kind: Kind::Scope(root), body: &root.body, held: 0, states: 0 }];
    let mut next = 0;
    while next < elements.len() {
        elements[next].held = elements.len();
        let body = elements[next].body;
        elements.extend(body.iter().map(|node| {
            let (kind, body, states): (_, &[Node], _) = match node {
                Node::Atom(atom) => (Kind::Atom(atom), &[], 1),
                Node::Scope(scope) => (Kind::Scope(scope), &scope.body, 0),
                Node::Loop(repeated) => (Kind::Loop(repeated), &repeated.body, 0),
            };
            Element { kind, body, held: 0, states }
        }));
        next += 1;
    }
    for place in (0..elements.len()).rev() {
        let Element { body, held, states, .. } = elements[place];
        let inside = elements[held..held + body.len()].iter();
        elements[place].states = inside.fold(states, |sum, element| sum.saturating_add(element.all_states()));
    }
    elements
}
