//! Lowers a plan to its state machine (paper, Algorithm 1; docs/src/reference/semantics.md, 8.1). Loops become
//! counters.

use std::collections::BTreeMap;

use mdle_runtime::fsm::{Atom, Bracket, Kind};
use mdle_runtime::{Here, Radians};

use super::draft::{LawMeaning, MachineDraft, RecordPlace, ScopeMeaning, Sizes};
use super::{Machine, observation1, validate};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{self, Mark, Node, Nondegenerate, Record, Scope};

/// Maximum number of states of a plan. Numbers up to this limit are exact in JSON.
pub const STATES: u64 = 1 << 53;

/// Lowers a plan, and validates the resulting machine against the plan.
///
/// # Errors
/// Fails with E0501 if the expanded plan has more than [`STATES`] states; E0901 if the machine does not agree with the
/// plan, which indicates a bug in this compiler.
pub fn lower(nondegenerate: &Nondegenerate) -> Result<Machine, Diagnostic> {
    let plan = nondegenerate.plan();
    let mut lowering = Lowering {
        draft: MachineDraft {
            brackets: Vec::new(),
            atoms: Vec::new(),
            termination: 0,
            scopes: Vec::new(),
            spans: Vec::new(),
            laws: Vec::new(),
            frames: Vec::new(),
            marks: BTreeMap::new(),
            records: BTreeMap::new(),
            quarks: plan.quarks.clone(),
            sizes: Sizes::default(),
        },
    };
    let states = lowering.scope(&plan.root, NodePlace { parent: 0, level: 0, slot: 0, state: 1, here: None })?;
    lowering.draft.termination = states + 1;
    validate(nondegenerate, &lowering.draft)?;
    let machine = Machine::new(lowering.draft);
    observation1(&machine)?;
    Ok(machine)
}

struct Lowering {
    draft: MachineDraft,
}

/// Position of a node in the plan: the enclosing bracket, the numbers of enclosing scopes and loops, and the node's
/// first state.
#[derive(Clone, Copy)]
struct NodePlace {
    parent: u32,
    level: u16,
    slot: u16,
    state: u64,
    /// Level of the innermost enclosing scope with `FRAME here`; `None` if there is no such scope.
    here: Option<u16>,
}

impl Lowering {
    /// Lowers a scope, and returns the number of its states.
    fn scope(&mut self, scope: &Scope, place: NodePlace) -> Result<u64, Diagnostic> {
        let meaning = ScopeMeaning { name: scope.name.clone(), interrupt: scope.interrupt.clone() };
        let bracket =
            self.bracket(Kind::Scope { level: place.level }, place.parent, Some(meaning), &scope.marks, scope.span);
        if let Some(Record { id, facts }) = scope.record {
            let first = scope.interrupt.memories;
            self.draft.records.insert(id, RecordPlace { level: place.level, first, facts });
            self.memories(first.saturating_add(facts));
        }
        let here = self.here(scope.here, place);
        let inside = NodePlace { parent: bracket, level: place.level.saturating_add(1), here, ..place };
        let states = self.sequence(&scope.body, inside, scope.span)?;
        self.close(bracket);
        Ok(states)
    }

    fn sequence(&mut self, body: &[Node], place: NodePlace, span: Span) -> Result<u64, Diagnostic> {
        let mut states = 0;
        for node in body {
            let here = NodePlace { state: place.state.saturating_add(states), ..place };
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

    fn atom(&mut self, atom: &plan::Atom, place: NodePlace) -> u64 {
        let meaning = ScopeMeaning { name: String::new(), interrupt: atom.interrupt.clone() };
        let scope =
            self.bracket(Kind::Scope { level: place.level }, place.parent, Some(meaning), &atom.marks, atom.span);
        self.draft.atoms.push(Atom { scope, state: place.state });
        let here = self.here(atom.here, place);
        self.draft.laws.push(LawMeaning { quark: atom.law, frame: atom.frame });
        self.draft.frames.push(here.map(|level| Here { level, turned: Radians(atom.frame) }));
        1
    }

    /// Returns the level of the innermost scope with `FRAME here` that contains the elements of the scope at `place`,
    /// which may be this scope itself; `None` if there is no such scope. `is_here` is `true` if the scope at `place`
    /// has `FRAME here`.
    fn here(&mut self, is_here: bool, place: NodePlace) -> Option<u16> {
        if !is_here {
            return place.here;
        }
        self.draft.sizes.levels = self.draft.sizes.levels.max(usize::from(place.level) + 1);
        self.draft.sizes.stamps = true;
        Some(place.level)
    }

    fn repeated(&mut self, repeated: &plan::Loop, place: NodePlace) -> Result<u64, Diagnostic> {
        let times = repeated.times.unwrap_or(0);
        let bracket = self.bracket(
            Kind::Loop { times, slot: place.slot, stride: 0 },
            place.parent,
            None,
            &repeated.marks,
            repeated.span,
        );
        self.draft.sizes.slots = self.draft.sizes.slots.max(usize::from(place.slot) + 1);
        let inside = NodePlace { parent: bracket, slot: place.slot.saturating_add(1), ..place };
        let pass = self.sequence(&repeated.body, inside, repeated.span)?;
        self.close(bracket);
        if repeated.times.is_none() {
            return Ok(pass);
        }
        if let Kind::Loop { stride, .. } = &mut self.draft.brackets[bracket as usize].kind {
            *stride = pass;
        }
        pass.checked_mul(times).filter(|states| *states < STATES).ok_or_else(|| too_many(repeated.span))
    }

    /// Opens a bracket that begins with the next atom; returns the number of the bracket. [`Lowering::close`] sets the
    /// last atom.
    fn bracket(&mut self, kind: Kind, parent: u32, meaning: Option<ScopeMeaning>, marks: &[Mark], span: Span) -> u32 {
        self.memories(meaning.as_ref().map_or(0, |meaning| meaning.interrupt.memories));
        if let (Kind::Scope { level }, Some(meaning)) = (kind, &meaning)
            && (meaning.interrupt.condition.waits() || meaning.interrupt.condition.drives())
        {
            self.draft.sizes.levels = self.draft.sizes.levels.max(usize::from(level) + 1);
            self.draft.sizes.stamps |= meaning.interrupt.condition.drives() || meaning.interrupt.condition.lasts();
        }
        let number = u32::try_from(self.draft.brackets.len()).unwrap_or(u32::MAX);
        let first = u32::try_from(self.draft.atoms.len()).unwrap_or(u32::MAX);
        self.draft.brackets.push(Bracket { kind, first, last: first, parent });
        self.draft.scopes.push(meaning);
        self.draft.spans.push(span);
        if !marks.is_empty() {
            self.draft.marks.insert(number, marks.to_vec());
        }
        number
    }

    /// Ensures that each level has at least this number of memories.
    fn memories(&mut self, memories: u32) {
        self.draft.sizes.memories = self.draft.sizes.memories.max(memories as usize);
    }

    fn close(&mut self, bracket: u32) {
        let last = u32::try_from(self.draft.atoms.len().saturating_sub(1)).unwrap_or(u32::MAX);
        self.draft.brackets[bracket as usize].last = last;
    }
}

fn too_many(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0501, format!("this plan has more than {STATES} states"), span, "these make too many")
        .help("every pass of a loop counts, and loops inside loops multiply: lower a count, or write `inf`")
}
