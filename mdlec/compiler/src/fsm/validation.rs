//! Test oracle of the lowering: compares the tables of a machine with its plan, and shares no code with the lowering.
//!
//! All transitions must agree with the plan (paper, Eq. 2; docs/src/reference/semantics.md, 5.3 and 8). The oracle
//! walks over the plan. For each scope, loop and atom, it determines from the plan's nesting what follows when it ends;
//! in the machine, intervals of atoms contain this information. If every single step outwards agrees, so does every
//! chain of steps: the state to which a transition leads, the scopes and counters that it restarts, and the loop that
//! it repeats. The cost does not depend on loop counts, so every lowering can be validated.

use std::fmt;

use mdle_runtime::fsm::{Bracket, Kind};
use mdle_runtime::{Here, Radians};

use super::{MachineDraft, RecordPlace, Sizes};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Interrupt, Mark, Node, Nondegenerate, Record, Scope};

/// Checks that `draft` is the machine of `plan`.
///
/// # Errors
/// Fails with E0901 for the first difference between plan and machine. A difference indicates a bug in the compiler.
pub fn validate(plan: &Nondegenerate, draft: &MachineDraft) -> Result<(), Diagnostic> {
    let root = &plan.plan().root;
    let mut walk = NodeWalk { draft, brackets: 0, atoms: 0 };
    let states =
        walk.scope(root, NodePosition { holder: 0, behind: None, scopes: 0, loops: 0, states: 0, here: None })?;
    same(root.span, "its brackets", walk.brackets, draft.brackets.len() as u32)?;
    same(root.span, "its atoms", walk.atoms, draft.atoms.len() as u32)?;
    same(root.span, "its meanings", (walk.brackets, walk.atoms), (draft.scopes.len() as u32, draft.laws.len() as u32))?;
    same(root.span, "its termination state", states + 1, u128::from(draft.termination))
}

/// Position of a node in the plan.
#[derive(Clone, Copy)]
struct NodePosition {
    /// Bracket of the enclosing node. For the plan, this is the plan's own bracket.
    holder: u32,
    /// `true` if another node follows the node in its string; `None` for the plan.
    behind: Option<bool>,
    /// Number of scopes that enclose the node.
    scopes: u16,
    /// Number of loops that enclose the node.
    loops: u16,
    /// Number of states of the expanded plan that come before the node, in the first pass of all loops.
    states: u128,
    /// Level of the innermost enclosing scope with `FRAME here`; `None` if there is no such scope.
    here: Option<u16>,
}

/// Consequence of the end of a node, without further steps.
#[derive(Debug, PartialEq)]
enum Consequence {
    /// The plan is over.
    Over,
    /// The atom `atom` becomes current, and everything inside the bracket `inside` restarts.
    Enters { atom: u32, inside: u32 },
    /// The string of this enclosing bracket has ended. If the bracket is a loop, it may begin its next pass.
    Ends { bracket: u32 },
}

struct NodeWalk<'l> {
    draft: &'l MachineDraft,
    /// Number of brackets that the walk has visited.
    brackets: u32,
    /// Number of atoms that the walk has visited.
    atoms: u32,
}

impl NodeWalk<'_> {
    /// Compares a scope with the machine, and returns the number of its states.
    fn scope(&mut self, scope: &Scope, around: NodePosition) -> Result<u128, Diagnostic> {
        let (number, first) = self.met();
        let inside = NodePosition {
            holder: number,
            scopes: around.scopes.saturating_add(1),
            here: self.here(scope.here, around, scope.span)?,
            ..around
        };
        let states = self.sequence(&scope.body, inside)?;
        let kind = Kind::Scope { level: around.scopes };
        self.bracket(number, first, kind, around, scope.span)?;
        self.meaning(number, Some((&scope.name, &scope.interrupt)), &scope.marks, around, scope.span)?;
        if let Some(record) = scope.record {
            self.record(record, scope, around)?;
        }
        Ok(states)
    }

    fn sequence(&mut self, body: &[Node], inside: NodePosition) -> Result<u128, Diagnostic> {
        let mut states = 0;
        for (place, node) in body.iter().enumerate() {
            let behind = Some(place + 1 < body.len());
            let here = NodePosition { behind, states: inside.states + states, ..inside };
            states += match node {
                Node::Atom(_) => self.atom(node, here)?,
                Node::Scope(scope) => self.scope(scope, here)?,
                Node::Loop(_) => self.repeated(node, here)?,
            };
        }
        Ok(states)
    }

    fn repeated(&mut self, node: &Node, around: NodePosition) -> Result<u128, Diagnostic> {
        let Node::Loop(repeated) = node else { return Ok(0) };
        let (number, first) = self.met();
        let inside = NodePosition { holder: number, loops: around.loops.saturating_add(1), ..around };
        let pass = self.sequence(&repeated.body, inside)?;
        // All passes of an endless loop use the same states.
        let (times, stride) = repeated.times.map_or((0, 0), |times| (times, pass));
        same(repeated.span, "the states of a pass", Some(stride), self.stride(number))?;
        let kind = Kind::Loop { times, slot: around.loops, stride: stride as u64 };
        self.bracket(number, first, kind, around, repeated.span)?;
        self.meaning(number, None, &repeated.marks, around, repeated.span)?;
        if usize::from(around.loops) >= self.draft.sizes.slots {
            return Err(mismatch(
                repeated.span,
                "its counter",
                "a place for it",
                &format!("{} places", self.draft.sizes.slots),
            ));
        }
        Ok(pass * u128::from(times.max(1)))
    }

    fn atom(&mut self, node: &Node, around: NodePosition) -> Result<u128, Diagnostic> {
        let Node::Atom(atom) = node else { return Ok(0) };
        let (number, first) = self.met();
        self.atoms += 1;
        self.bracket(number, first, Kind::Scope { level: around.scopes }, around, atom.span)?;
        self.meaning(number, Some(("", &atom.interrupt)), &atom.marks, around, atom.span)?;
        let in_machine = self.draft.atoms.get(first as usize);
        let in_machine = in_machine.map(|in_machine| (in_machine.scope, u128::from(in_machine.state)));
        same(atom.span, "its bracket and state", Some((number, around.states + 1)), in_machine)?;
        let here = self.here(atom.here, around, atom.span)?;
        let law = self.draft.laws.get(first as usize).map(|law| (law.quark, law.frame.to_bits()));
        same(atom.span, "its law and frame", Some((atom.law, atom.frame.to_bits())), law)?;
        let in_plan = here.map(|level| Here { level, turned: Radians(atom.frame) });
        same(atom.span, "its frame", Some(&in_plan), self.draft.frames.get(first as usize))?;
        Ok(1)
    }

    /// Returns the level of the innermost scope with `FRAME here` that contains the nodes of a scope; `None` if there
    /// is no such scope. If the scope itself has `FRAME here`, also checks that the machine can store the heading of
    /// this scope.
    fn here(&self, is_here: bool, around: NodePosition, span: Span) -> Result<Option<u16>, Diagnostic> {
        let Sizes { stamps, levels, .. } = self.draft.sizes;
        match is_here {
            true if stamps && usize::from(around.scopes) < levels => Ok(Some(around.scopes)),
            true => Err(mismatch(
                span,
                "its heading",
                &format!("one of level {}", around.scopes),
                &format!("headings of {levels} levels"),
            )),
            false => Ok(around.here),
        }
    }

    /// Counts the next bracket. Returns the bracket's number, and the number of its first atom.
    fn met(&mut self) -> (u32, u32) {
        self.brackets += 1;
        (self.brackets - 1, self.atoms)
    }

    /// Checks that a bracket has the given kind and first atom, and the successor that the plan requires.
    fn bracket(&self, number: u32, first: u32, kind: Kind, around: NodePosition, span: Span) -> Result<(), Diagnostic> {
        let in_machine = self.draft.brackets.get(number as usize);
        same(
            span,
            "what it is",
            Some((kind, first)),
            in_machine.map(|in_machine| (in_machine.kind, in_machine.first)),
        )?;
        let in_plan = match around.behind {
            None => Consequence::Over,
            // The walk has visited all atoms inside the bracket, so the next atom is the first after the bracket.
            Some(true) => Consequence::Enters { atom: self.atoms, inside: around.holder },
            Some(false) => Consequence::Ends { bracket: around.holder },
        };
        same(span, "what follows it", Some(in_plan), in_machine.and_then(|in_machine| self.step(number, in_machine)))
    }

    /// Returns the step that the machine takes when this bracket ends; `None` if the machine's tables are inconsistent.
    fn step(&self, number: u32, bracket: &Bracket) -> Option<Consequence> {
        if number == 0 {
            return (bracket.parent == 0 && bracket.last as usize + 1 == self.draft.atoms.len())
                .then_some(Consequence::Over);
        }
        // Because each parent has a smaller number, the steps outwards end at the plan.
        let holder = self.draft.brackets.get(bracket.parent as usize).filter(|_| bracket.parent < number)?;
        Some(if bracket.last == holder.last {
            Consequence::Ends { bracket: bracket.parent }
        } else {
            Consequence::Enters { atom: bracket.last.saturating_add(1), inside: bracket.parent }
        })
    }

    fn stride(&self, number: u32) -> Option<u128> {
        match self.draft.brackets.get(number as usize)?.kind {
            Kind::Loop { stride, .. } => Some(u128::from(stride)),
            Kind::Scope { .. } => None,
        }
    }

    /// Checks that a bracket has the given name, interrupt and labels, and that the machine has enough memories.
    fn meaning(
        &self,
        number: u32,
        in_plan: Option<(&str, &Interrupt)>,
        marks: &[Mark],
        around: NodePosition,
        span: Span,
    ) -> Result<(), Diagnostic> {
        let in_machine = self.draft.scopes.get(number as usize);
        let in_machine = in_machine
            .map(|in_machine| in_machine.as_ref().map(|in_machine| (in_machine.name.as_str(), &in_machine.interrupt)));
        same(span, "its name and interrupt", Some(in_plan), in_machine)?;
        same(span, "its labels", marks, self.draft.marks.get(&number).map_or(&[], Vec::as_slice))?;
        let Some((_, interrupt)) = in_plan else { return Ok(()) };
        let (memories, levels) = (self.draft.sizes.memories, self.draft.sizes.levels);
        if interrupt.memories as usize > memories {
            return Err(mismatch(span, "its memories", &interrupt.memories.to_string(), &memories.to_string()));
        }
        if interrupt.condition.waits() && usize::from(around.scopes) >= levels {
            let in_plan = format!("one of level {}", around.scopes);
            return Err(mismatch(span, "its timer", &in_plan, &format!("timers of {levels} levels")));
        }
        if interrupt.condition.drives() && (usize::from(around.scopes) >= levels || !self.draft.sizes.stamps) {
            let in_plan = format!("one of level {}", around.scopes);
            return Err(mismatch(span, "its way", &in_plan, &format!("ways of {levels} levels")));
        }
        if interrupt.condition.lasts() && !self.draft.sizes.stamps {
            return Err(mismatch(span, "its progress", "that of a law", "no progress"));
        }
        Ok(())
    }

    /// Checks that a record is stored after the memories of its scope's interrupt, and that the machine has enough
    /// memories for the record.
    fn record(&self, record: Record, scope: &Scope, around: NodePosition) -> Result<(), Diagnostic> {
        let (first, facts) = (scope.interrupt.memories, record.facts);
        let in_plan = RecordPlace { level: around.scopes, first, facts };
        same(scope.span, "its record", Some(in_plan), self.draft.records.get(&record.id).copied())?;
        let (end, memories) = (first as usize + facts as usize, self.draft.sizes.memories);
        if end > memories {
            Err(mismatch(scope.span, "its record", &end.to_string(), &memories.to_string()))
        } else {
            Ok(())
        }
    }
}

/// Checks that a value is the same in the plan and in the machine; error messages call the value `what`.
fn same<T: PartialEq + fmt::Debug>(span: Span, what: &str, in_plan: T, in_machine: T) -> Result<(), Diagnostic> {
    if in_plan == in_machine {
        Ok(())
    } else {
        Err(mismatch(span, what, &format!("{in_plan:?}"), &format!("{in_machine:?}")))
    }
}

fn mismatch(span: Span, what: &str, in_plan: &str, in_machine: &str) -> Diagnostic {
    let message =
        format!("the machine differs from the plan: {what} is {in_plan} in the plan and {in_machine} in the machine");
    Diagnostic::new(Code::E0901, message, span, "this is not what was made of it")
        .help("this is a defect of mdlec, not of the plan: please report it with the plan")
}
