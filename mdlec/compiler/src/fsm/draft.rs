//! The tables of a machine before they are validated.

use std::collections::BTreeMap;

use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Fsm, Here};

use crate::diagnostic::Span;
use crate::plan::{Interrupt, Mark, Quark, QuarkId, RecordId};

/// The tables of a machine, and the meaning of its brackets and atoms.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineDraft {
    /// The scopes and loops, in pre-order.
    pub brackets: Vec<Bracket>,
    /// The atoms as written, from left to right.
    pub atoms: Vec<Atom>,
    /// The number of the termination state.
    pub termination: u64,
    /// The scope of each bracket; `None` for a loop.
    pub scopes: Vec<Option<ScopeMeaning>>,
    /// The place of each bracket in the plan's text.
    pub spans: Vec<Span>,
    /// The law of each atom, with the angle of the atom's frame.
    pub laws: Vec<LawMeaning>,
    /// The frame of each atom; `None` for an atom that is not inside a `FRAME here`.
    pub frames: Vec<Option<Here>>,
    /// For each bracket, the labels of the elements that end with it; only brackets with such labels are
    /// listed.
    pub marks: BTreeMap<u32, Vec<Mark>>,
    /// The place of each record that `after` reads; a record belongs to one use of a definition.
    pub records: BTreeMap<RecordId, RecordPlace>,
    /// The quarks with their arguments, each once.
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
    /// Interrupt of the scope.
    pub interrupt: Interrupt,
}

/// The meaning of an atom.
#[derive(Debug, Clone, PartialEq)]
pub struct LawMeaning {
    /// Law of the atom.
    pub quark: QuarkId,
    /// Angle by which the atom's frame is turned, in radians; relative to the innermost enclosing `FRAME here`,
    /// if there is one.
    pub frame: f64,
}

/// The place of a record among the memories of a level of scopes.
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
    /// Maximum number of memories at a level of scopes: the memories of RISING in the scope's interrupt, and
    /// after them the facts of the scope's record. All are empty when the scope is entered.
    pub memories: usize,
    /// Number of levels of scopes, down to the deepest level with a `wait`, a `way` or a `FRAME here`. The machine does
    /// not record the entry of scopes at deeper levels.
    pub levels: usize,
    /// `true` if the machine stores not only the time at which each scope was entered, but also the odometer and the
    /// heading at that moment, and the progress of the law. A plan with `way`, `FRAME here`, `stuck` or `rendezvous`
    /// needs them.
    pub stamps: bool,
    /// Maximum number of loops that enclose an atom.
    pub slots: usize,
}
