//! A walk over the scopes, loops and atoms of a plan, in the order of its text.

use std::{iter, slice};

use super::{Atom, Interrupt, Loop, Node, Plan, Scope};
use crate::diagnostic::Span;

/// A scope, a loop or an atom of a plan.
#[derive(Debug, Clone, Copy)]
pub enum PlanPart<'p> {
    /// A behavior, or the plan.
    Scope(&'p Scope),
    /// A string that is run several times.
    Loop(&'p Loop),
    /// An atom.
    Atom(&'p Atom),
}

/// One step of a walk through a plan.
#[derive(Debug, Clone, Copy)]
pub enum Visit<'p> {
    /// The part is entered.
    Enter(PlanPart<'p>),
    /// The walk leaves the part, after all parts inside it.
    Leave(PlanPart<'p>),
}

/// A walk over a plan, which visits each part twice: at its entry and at its end.
#[derive(Debug)]
pub struct Walk<'p> {
    root: Option<&'p Scope>,
    /// Parts that have been entered and not left yet, each with those of its nodes that have not been visited.
    open: Vec<(PlanPart<'p>, slice::Iter<'p, Node>)>,
}

impl Plan {
    /// Returns a walk over all parts. It enters each part, visits the parts inside it, and leaves it.
    #[must_use]
    pub fn walk(&self) -> Walk<'_> {
        Walk { root: Some(&self.root), open: Vec::new() }
    }

    /// Returns all parts in pre-order: each part comes before its nested parts.
    pub fn parts(&self) -> impl Iterator<Item = PlanPart<'_>> {
        let mut walk = self.walk();
        iter::from_fn(move || walk.by_ref().find_map(Visit::entered))
    }
}

impl<'p> Walk<'p> {
    /// Returns the number of parts that enclose the part that is visited next.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// Returns the scopes that enclose the part that is visited next; the innermost comes first.
    pub fn scopes(&self) -> impl Iterator<Item = &'p Scope> {
        self.open.iter().rev().filter_map(|(part, _)| part.scope())
    }

    fn enter(&mut self, part: PlanPart<'p>) -> Visit<'p> {
        self.open.push((part, part.body().iter()));
        Visit::Enter(part)
    }
}

impl<'p> Iterator for Walk<'p> {
    type Item = Visit<'p>;

    fn next(&mut self) -> Option<Visit<'p>> {
        if let Some(root) = self.root.take() {
            return Some(self.enter(PlanPart::Scope(root)));
        }
        match self.open.last_mut()?.1.next() {
            Some(node) => Some(self.enter(node.part())),
            None => self.open.pop().map(|(part, _)| Visit::Leave(part)),
        }
    }
}

impl<'p> Visit<'p> {
    /// Returns the part if this step enters it; `None` otherwise.
    #[must_use]
    pub fn entered(self) -> Option<PlanPart<'p>> {
        match self {
            Self::Enter(part) => Some(part),
            Self::Leave(_) => None,
        }
    }
}

impl<'p> PlanPart<'p> {
    /// Returns the interrupt of a scope or an atom; `None` for a loop.
    #[must_use]
    pub fn interrupt(self) -> Option<&'p Interrupt> {
        match self {
            Self::Scope(scope) => Some(&scope.interrupt),
            Self::Atom(atom) => Some(&atom.interrupt),
            Self::Loop(_) => None,
        }
    }

    /// Returns the nodes of the string that a scope or a loop runs; empty for an atom.
    #[must_use]
    pub fn body(self) -> &'p [Node] {
        match self {
            Self::Scope(scope) => &scope.body,
            Self::Loop(repeated) => &repeated.body,
            Self::Atom(_) => &[],
        }
    }

    /// Returns the scope if the part is a scope; `None` otherwise.
    #[must_use]
    pub fn scope(self) -> Option<&'p Scope> {
        match self {
            Self::Scope(scope) => Some(scope),
            Self::Loop(_) | Self::Atom(_) => None,
        }
    }

    /// Returns the atom if the part is an atom; `None` otherwise.
    #[must_use]
    pub fn atom(self) -> Option<&'p Atom> {
        match self {
            Self::Atom(atom) => Some(atom),
            Self::Scope(_) | Self::Loop(_) => None,
        }
    }

    /// Returns the span of an atom, of a loop, or of a scope's definition.
    #[must_use]
    pub fn span(self) -> Span {
        match self {
            Self::Scope(scope) => scope.span,
            Self::Loop(repeated) => repeated.span,
            Self::Atom(atom) => atom.span,
        }
    }
}

impl Node {
    /// Returns the node as a part of the plan.
    #[must_use]
    pub fn part(&self) -> PlanPart<'_> {
        match self {
            Self::Atom(atom) => PlanPart::Atom(atom),
            Self::Scope(scope) => PlanPart::Scope(scope),
            Self::Loop(repeated) => PlanPart::Loop(repeated),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::compiled;

    #[test]
    fn a_walk_knows_its_depth_and_the_enclosing_scopes() {
        let text = "{ P (bumper) { Q (Atom (wait 1) stop)^2 } { R (Atom (null) stop) } }";
        let plan = &compiled(text)[0].plan;
        let mut walk = plan.walk();
        let mut seen = Vec::new();
        loop {
            let around: Vec<_> = walk.scopes().map(|scope| scope.name.as_str()).collect();
            let (depth, around) = (walk.depth(), around.join(" in "));
            let word = match walk.next() {
                Some(Visit::Enter(part)) => match part {
                    PlanPart::Scope(scope) => scope.name.clone(),
                    PlanPart::Loop(_) => "loop".to_owned(),
                    PlanPart::Atom(_) => "atom".to_owned(),
                },
                Some(Visit::Leave(_)) => continue,
                None => break,
            };
            seen.push(format!("{depth} {word} in {around}"));
        }
        let expected = ["0 P in ", "1 Q in P", "2 loop in Q in P", "3 atom in Q in P", "1 R in P", "2 atom in R in P"];
        assert_eq!(seen, expected);
        assert_eq!(plan.parts().filter_map(PlanPart::atom).count(), 2);
        assert_eq!(plan.walk().count(), 2 * plan.parts().count());
    }
}
