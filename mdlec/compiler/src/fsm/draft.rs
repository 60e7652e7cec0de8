//! The tables of a machine before they are validated.

use std::collections::BTreeMap;

use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Fsm, Here};

use crate::diagnostic::Span;
use crate::plan::{Interrupt, Mark, Quark, QuarkId, RecordId};

/// The tables of a machine, and the meaning of its brackets and atoms.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineDraft {
    /// Scopes and loops, in pre-order.
    pub brackets: Vec<Bracket>,
    /// Atoms in the order of the plan's text.
    pub atoms: Vec<Atom>,
    /// The number of the termination state.
    pub termination: u64,
    /// Meaning of each bracket that is a scope; `None` for a loop.
    pub scopes: Vec<Option<ScopeMeaning>>,
    /// Span of each bracket in the plan's text.
    pub spans: Vec<Span>,
    /// Law of each atom, and the angle of the atom's frame.
    pub laws: Vec<LawMeaning>,
    /// The frame of each atom; `None` for an atom that is not inside a `FRAME here`.
    pub frames: Vec<Option<Here>>,
    /// For each bracket, the labels of the elements that end with it; only brackets with such labels are
    /// listed.
    pub marks: BTreeMap<u32, Vec<Mark>>,
    /// Position of each record that `after` reads. A record belongs to one use of a definition.
    pub records: BTreeMap<RecordId, RecordPlace>,
    /// The quarks with their arguments; each quark is listed once.
    pub quarks: Vec<Quark>,
    /// Sizes of the state that a machine keeps between turns.
    pub sizes: Sizes,
}

impl MachineDraft {
    /// Returns the tables in the form that the run-time system uses.
    pub(super) fn tables(&self) -> Fsm<'_> {
        Fsm { brackets: &self.brackets, atoms: &self.atoms, termination: self.termination }
    }

    /// Returns the quark with this id.
    pub(super) fn quark(&self, id: QuarkId) -> &Quark {
        &self.quarks[id.0 as usize]
    }
}

/// The meaning of a scope.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopeMeaning {
    /// Name of the scope; empty for an atom, and for a scope in formal notation.
    pub name: String,
    /// Interrupt that ends the scope.
    pub interrupt: Interrupt,
}

/// Law and frame of an atom.
#[derive(Debug, Clone, PartialEq)]
pub struct LawMeaning {
    /// Law of the atom.
    pub quark: QuarkId,
    /// Angle, in radians, by which the atom's frame is turned. It is relative to the innermost enclosing `FRAME here`;
    /// without one, it is relative to the plan's frame.
    pub frame: f64,
}

/// Position of a record among the memories of a level of scopes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordPlace {
    /// Level of the outermost scope of the definition.
    pub level: u16,
    /// Number of the record's first memory at that level.
    pub first: u32,
    /// Number of the record's memories.
    pub facts: u32,
}

/// Sizes of the state that a machine keeps between turns.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Maximum number of memories at a level of scopes. These are the memories of RISING in the scope's interrupt,
    /// followed by the facts of the scope's record. All are cleared when the scope is entered.
    pub memories: usize,
    /// Number of levels of scopes, down to the deepest level with a `wait`, a `way` or a `FRAME here`. The machine does
    /// not record the entry of scopes at deeper levels.
    pub levels: usize,
    /// `true` if the machine stores more than the time at which each scope was entered: the odometer reading and the
    /// heading at that time, and the progress of the law. A plan with `way`, `FRAME here`, `stuck` or `rendezvous`
    /// needs them.
    pub stamps: bool,
    /// Maximum number of loops that enclose an atom.
    pub slots: usize,
}
