//! Lowers a plan to its finite state machine (paper, Algorithm 1; docs/src/reference/semantics.md, 8.1), loops as
//! counters.
//!
//! Afterwards: brackets are in pre-order, bracket 0 is the plan, the children of a bracket partition its atoms.

mod equation;
mod expand;
mod file;
mod matrices;
mod matrix_market;
mod observation;
mod terms;
#[cfg(test)]
mod tests;
mod validation;

pub use equation::{equation, most_states};
pub use expand::{expand, expanded_states};
pub use file::{FsmFile, InterruptEntry, Moves, ScopeEntry, fsm_file};
pub use matrices::{Matrices, Matrix, Transition, UnitVector, matrices};
pub use matrix_market::{MatrixFiles, matrix_files};
pub use observation::observation1;
pub use terms::{Extent, Term, Terms, terms};
pub use validation::validate;

use std::collections::BTreeMap;

use mdle_runtime::fsm::{Atom, Bracket, Kind};
use mdle_runtime::{Fsm, Here, Radians};

use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{self, Interrupt, Mark, Node, Nondegenerate, Quark, QuarkId, Record, RecordId, Scope};

/// The most states a plan may have: numbers up to here are exact in JSON as well.
pub const STATES: u64 = 1 << 53;

/// A plan lowered to its machine: the tables, and what its brackets and atoms mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Lowered {
    /// Scopes and loops in pre-order.
    pub brackets: Vec<Bracket>,
    /// The atoms as written, from left to right.
    pub atoms: Vec<Atom>,
    /// The termination state's number.
    pub termination: u64,
    /// What each bracket means: its scope, or `None` for a loop.
    pub scopes: Vec<Option<ScopeMeaning>>,
    /// What each atom means.
    pub laws: Vec<LawMeaning>,
    /// The frame of each atom that is inside a `FRAME here`.
    pub frames: Vec<Option<Here>>,
    /// The labels of what ends with a bracket, where there are any.
    pub marks: BTreeMap<u32, Vec<Mark>>,
    /// Where the record of each use of a definition is kept that `after` asks.
    pub records: BTreeMap<RecordId, RecordPlace>,
    /// How many memories a level of scopes has at most: those of RISING in the scope's interrupt, and behind them the
    /// facts of its record. All are empty when the scope is entered.
    pub memories: usize,
    /// Every quark with its arguments.
    pub quarks: Vec<Quark>,
    /// Levels of scopes down to the last one that has a `wait`, a `way` or a `FRAME here`: nothing is
    /// kept of the entry of those below.
    pub levels: usize,
    /// `true` if the machine keeps odometer and heading at the entry of scopes, and not the time alone: where there
    /// is a `way` or a `FRAME here`.
    pub stamps: bool,
    /// How many loops are around an atom at most.
    pub slots: usize,
}

/// What a scope means.
#[derive(Debug, Clone, PartialEq)]
pub struct ScopeMeaning {
    /// Its name; empty for an atom, and for a scope in formal notation.
    pub name: String,
    /// Its interrupt.
    pub interrupt: Interrupt,
    /// The place of the atom, or of the scope's definition.
    pub span: Span,
}

/// What an atom does.
#[derive(Debug, Clone, PartialEq)]
pub struct LawMeaning {
    /// Its law.
    pub quark: QuarkId,
    /// The angle by which its frame is turned, in radians; from the innermost `FRAME here` on, if there is one.
    pub frame: f64,
}

/// Where a record is kept: which memories of which level of scopes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordPlace {
    /// The level of the outermost scope of the definition.
    pub level: u16,
    /// The first of its memories.
    pub first: u32,
    /// How many there are.
    pub facts: u32,
}

impl Lowered {
    /// The tables, as the machine takes them.
    #[must_use]
    pub fn tables(&self) -> Fsm<'_> {
        Fsm { brackets: &self.brackets, atoms: &self.atoms, termination: self.termination }
    }

    /// The angle by which the plan's own frame is turned for an atom, in radians; 0 inside a `FRAME here`, which the
    /// machine minds.
    #[must_use]
    pub fn turned(&self, atom: usize) -> f64 {
        match (self.laws.get(atom), self.frames.get(atom)) {
            (Some(law), Some(None)) => law.frame,
            _ => 0.0,
        }
    }

    /// The quark of an id.
    #[must_use]
    pub fn quark(&self, id: QuarkId) -> &Quark {
        &self.quarks[id.0 as usize]
    }
}

/// Lowers a plan, and holds what it has made against it.
///
/// # Errors
/// E0501 when the plan, expanded, has more than [`STATES`] states; E0901 when the machine is not the plan's, which would be
/// a defect of this compiler.
pub fn algorithm1(nondegenerate: &Nondegenerate) -> Result<Lowered, Diagnostic> {
    let plan = nondegenerate.plan();
    let mut lowering = Lowering {
        lowered: Lowered {
            brackets: Vec::new(),
            atoms: Vec::new(),
            termination: 0,
            scopes: Vec::new(),
            laws: Vec::new(),
            frames: Vec::new(),
            marks: BTreeMap::new(),
            records: BTreeMap::new(),
            memories: 0,
            quarks: plan.quarks.clone(),
            levels: 0,
            stamps: false,
            slots: 0,
        },
    };
    let states = lowering.scope(&plan.root, Place { parent: 0, level: 0, slot: 0, state: 1, here: None })?;
    lowering.lowered.termination = states + 1;
    validate(nondegenerate, &lowering.lowered)?;
    observation1(&lowering.lowered)?;
    Ok(lowering.lowered)
}

struct Lowering {
    lowered: Lowered,
}

/// Where a node stands: the bracket around it, the scopes and loops around it, the number of its first state.
#[derive(Clone, Copy)]
struct Place {
    parent: u32,
    level: u16,
    slot: u16,
    state: u64,
    /// The level of the innermost scope around it with `FRAME here`.
    here: Option<u16>,
}

impl Lowering {
    /// Lowers a scope and returns the number of its states.
    fn scope(&mut self, scope: &Scope, place: Place) -> Result<u64, Diagnostic> {
        let meaning = ScopeMeaning { name: scope.name.clone(), interrupt: scope.interrupt.clone(), span: scope.span };
        let bracket = self.bracket(Kind::Scope { level: place.level }, place.parent, Some(meaning), &scope.marks);
        if let Some(Record { id, facts }) = scope.record {
            let first = scope.interrupt.memories;
            self.lowered.records.insert(id, RecordPlace { level: place.level, first, facts });
            self.memories(first.saturating_add(facts));
        }
        let here = self.here(scope.here, place);
        let inside = Place { parent: bracket, level: place.level.saturating_add(1), here, ..place };
        let states = self.sequence(&scope.body, inside, scope.span)?;
        self.close(bracket);
        Ok(states)
    }

    fn sequence(&mut self, body: &[Node], place: Place, span: Span) -> Result<u64, Diagnostic> {
        let mut states = 0;
        for node in body {
            let here = Place { state: place.state.saturating_add(states), ..place };
            states += match node {
                Node::Atom(atom) => self.atom(atom, here),
                Node::Scope(scope) => self.scope(scope, here)?,
                Node::Loop(repeated) => self.repeated(repeated, here)?,
            };
            if states >= STATES {
                return Err(too_many(span));
            }
        }
        Ok(states)
    }

    fn atom(&mut self, atom: &plan::Atom, place: Place) -> u64 {
        let meaning = ScopeMeaning { name: String::new(), interrupt: atom.interrupt.clone(), span: atom.span };
        let scope = self.bracket(Kind::Scope { level: place.level }, place.parent, Some(meaning), &atom.marks);
        self.lowered.atoms.push(Atom { scope, state: place.state });
        let here = self.here(atom.here, place);
        self.lowered.laws.push(LawMeaning { quark: atom.law, frame: atom.frame });
        self.lowered.frames.push(here.map(|level| Here { level, turned: Radians(atom.frame) }));
        1
    }

    /// The innermost scope with `FRAME here` for what is inside a scope at `place`, which may have one itself.
    fn here(&mut self, is_here: bool, place: Place) -> Option<u16> {
        if !is_here {
            return place.here;
        }
        self.lowered.levels = self.lowered.levels.max(usize::from(place.level) + 1);
        self.lowered.stamps = true;
        Some(place.level)
    }

    fn repeated(&mut self, repeated: &plan::Loop, place: Place) -> Result<u64, Diagnostic> {
        let times = repeated.times.unwrap_or(0);
        let bracket =
            self.bracket(Kind::Loop { times, slot: place.slot, stride: 0 }, place.parent, None, &repeated.marks);
        self.lowered.slots = self.lowered.slots.max(usize::from(place.slot) + 1);
        let inside = Place { parent: bracket, slot: place.slot.saturating_add(1), ..place };
        let pass = self.sequence(&repeated.body, inside, repeated.span)?;
        self.close(bracket);
        if repeated.times.is_none() {
            return Ok(pass);
        }
        if let Kind::Loop { stride, .. } = &mut self.lowered.brackets[bracket as usize].kind {
            *stride = pass;
        }
        pass.checked_mul(times).filter(|states| *states < STATES).ok_or_else(|| too_many(repeated.span))
    }

    /// Opens a bracket at the next atom; [`Lowering::close`] tells its last one.
    fn bracket(&mut self, kind: Kind, parent: u32, meaning: Option<ScopeMeaning>, marks: &[Mark]) -> u32 {
        self.memories(meaning.as_ref().map_or(0, |meaning| meaning.interrupt.memories));
        if let (Kind::Scope { level }, Some(meaning)) = (kind, &meaning)
            && (meaning.interrupt.condition.waits() || meaning.interrupt.condition.drives())
        {
            self.lowered.levels = self.lowered.levels.max(usize::from(level) + 1);
            self.lowered.stamps |= meaning.interrupt.condition.drives();
        }
        let number = u32::try_from(self.lowered.brackets.len()).unwrap_or(u32::MAX);
        let first = u32::try_from(self.lowered.atoms.len()).unwrap_or(u32::MAX);
        self.lowered.brackets.push(Bracket { kind, first, last: first, parent });
        self.lowered.scopes.push(meaning);
        if !marks.is_empty() {
            self.lowered.marks.insert(number, marks.to_vec());
        }
        number
    }

    /// Makes room for so many memories a level.
    fn memories(&mut self, memories: u32) {
        self.lowered.memories = self.lowered.memories.max(memories as usize);
    }

    fn close(&mut self, bracket: u32) {
        let last = u32::try_from(self.lowered.atoms.len().saturating_sub(1)).unwrap_or(u32::MAX);
        self.lowered.brackets[bracket as usize].last = last;
    }
}

fn too_many(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0501, format!("this plan has more than {STATES} states"), span, "these make too many")
        .help("every pass of a loop counts, and loops inside loops multiply: lower a count, or write `inf`")
}
