//! The finite state machine of a plan, as a tree of brackets instead of N×N matrices (Algorithm 1; Eq. 2). See
//! docs/src/reference/generated_code.md, 1.
//!
//! A transition matrix `E_i` is determined by an interval of columns and one destination, so a scope with the atoms
//! `a..b` is stored as these two numbers. Brackets form a tree instead of a list of intervals because `((s)^2, ξ)` and
//! `(s, ξ)^2` cover the same atoms, but an interrupt ξ leaves the first plan, while it starts the second pass of the
//! second plan.

/// Tables of a plan's state machine: constants in generated code, or owned by a loaded plan.
///
/// Invariants, which `mdlec` establishes: brackets are in pre-order, bracket 0 is the plan, and each bracket's children
/// partition its atoms; atom `a` is the bracket `atoms[a].scope`, which has no children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fsm<'a> {
    /// Scopes and loops in pre-order.
    pub brackets: &'a [Bracket],
    /// Atoms in the order of the plan's text.
    pub atoms: &'a [Atom],
    /// Number of the termination state: `N`, which is one more than the number of atoms in the expanded plan.
    pub termination: u64,
}

impl<'a> Fsm<'a> {
    /// Returns an iterator over a bracket and all brackets that enclose it, with their numbers, from the innermost to
    /// the plan's own bracket. Stops at a parent whose number is not lower, so the iteration ends even if a table
    /// contains a cycle.
    pub fn outwards(self, bracket: u32) -> impl Iterator<Item = (u32, &'a Bracket)> {
        let at = move |number: u32| self.brackets.get(number as usize).map(|bracket| (number, bracket));
        core::iter::successors(
            at(bracket),
            move |(here, bracket)| {
                if bracket.parent < *here { at(bracket.parent) } else { None }
            },
        )
    }
}

/// A scope or a loop, and the atoms inside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bracket {
    /// Kind of the bracket, with the values that only this kind has.
    pub kind: Kind,
    /// Index of the first atom of the bracket, in the order of the plan's text.
    pub first: u32,
    /// Index of the last atom of the bracket, in the order of the plan's text.
    pub last: u32,
    /// Number of the enclosing bracket; the plan's own bracket is its own parent.
    pub parent: u32,
}

/// Kind of a bracket: a scope or a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A scope, which the paper calls a closed string: an atom, a behavior or a plan. Its interrupt leads from each of
    /// its atoms to the element after the string.
    Scope {
        /// Number of enclosing scopes.
        level: u16,
    },
    /// A loop, which is an open string that is run several times (the paper's counter c(t)).
    Loop {
        /// Total number of passes; 0 for a loop without end.
        times: u64,
        /// Number of enclosing loops, which is the index of the loop's counter in a cursor.
        slot: u16,
        /// Number of states of one pass in the expanded plan; 0 if all passes share their states, as in a loop without
        /// end.
        stride: u64,
    },
}

/// An atom of the plan's text, in which loops are not expanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Atom {
    /// Number of the bracket that is the atom's own scope.
    pub scope: u32,
    /// Number of the atom's state in the expanded plan, counted from 1, during the first pass of all enclosing loops.
    pub state: u64,
}

impl Bracket {
    /// Creates a scope over the atoms `first..=last`.
    #[must_use]
    pub const fn scope(level: u16, first: u32, last: u32, parent: u32) -> Self {
        Self { kind: Kind::Scope { level }, first, last, parent }
    }

    /// Creates a loop over the atoms `first..=last`; see [`Kind::Loop`] for the other parameters.
    #[must_use]
    pub const fn repeat(times: u64, slot: u16, stride: u64, first: u32, last: u32, parent: u32) -> Self {
        Self { kind: Kind::Loop { times, slot, stride }, first, last, parent }
    }
}

impl Atom {
    /// Creates an atom whose own scope is the bracket `scope`, and whose state in the first pass of all enclosing loops
    /// is `state`.
    #[must_use]
    pub const fn new(scope: u32, state: u64) -> Self {
        Self { scope, state }
    }
}
