//! The tables of a machine before they are validated.

use std::collections::BTreeMap;

use mdle_runtime::Here;
use mdle_runtime::fsm::{Atom, Bracket};

use crate::diagnostic::Span;
use crate::plan::{Interrupt, Mark, Quark, QuarkId, RecordId};

/// The tables of a machine, and the meaning of its brackets and atoms.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// Scopes and loops in pre-order.
    pub brackets: Vec<Bracket>,
    /// The atoms as written, from left to right.
    pub atoms: Vec<Atom>,
    /// The number of the termination state.
    pub termination: u64,
    /// The scope of each bracket; `None` for a loop.
    pub scopes: Vec<Option<ScopeMeaning>>,
    /// The place of each bracket in the plan's text.
    pub spans: Vec<Span>,
    /// The law of each atom, in its frame.
    pub laws: Vec<LawMeaning>,
    /// The frame of each atom that is inside a `FRAME here`.
    pub frames: Vec<Option<Here>>,
    /// The labels of what ends with a bracket, where there are any.
    pub marks: BTreeMap<u32, Vec<Mark>>,
    /// The place of the record of each use of a definition that `after` asks.
    pub records: BTreeMap<RecordId, RecordPlace>,
    /// Every quark with its arguments.
    pub quarks: Vec<Quark>,
    /// Sizes of the state that a machine keeps between turns.
    pub sizes: Sizes,
}

/// The meaning of a scope.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopeMeaning {
    /// The name; empty for an atom, and for a scope in formal notation.
    pub name: String,
    /// The interrupt.
    pub interrupt: Interrupt,
}

/// The meaning of an atom.
#[derive(Debug, Clone, PartialEq)]
pub struct LawMeaning {
    /// The law.
    pub quark: QuarkId,
    /// The angle by which its frame is turned, in radians; from the innermost `FRAME here` on, if there is one.
    pub frame: f64,
}

/// The place of a record among the memories of a level of scopes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordPlace {
    /// The level of the outermost scope of the definition.
    pub level: u16,
    /// The first of its memories.
    pub first: u32,
    /// The number of its memories.
    pub facts: u32,
}

/// Sizes of the state that a machine keeps between turns.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Maximum number of memories of a level of scopes: those of RISING in the scope's interrupt, and after them the
    /// facts of its record. All are empty when the scope is entered.
    pub memories: usize,
    /// The levels of scopes down to the last one that has a `wait`, a `way` or a `FRAME here`: nothing is kept of the
    /// entry of those below.
    pub levels: usize,
    /// `true` if the machine keeps odometer and heading at the entry of scopes and the progress of the law, and not the
    /// time alone: where there is a `way`, a `FRAME here`, a `stuck` or a `rendezvous`.
    pub stamps: bool,
    /// Maximum number of loops that enclose an atom.
    pub slots: usize,
}
