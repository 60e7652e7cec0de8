//! Static analysis: determines facts that hold in every run, without running the plan. Examples are the atoms that run,
//! the operands that can end atoms, durations, and the size of the machine.
//!
//! "Never" holds for every run; "possible" may also mean that the question was too large to decide.

mod choices;
mod constants;
mod durations;
mod ended;
mod facts;
mod judge;
mod known;
mod lints;
mod possible;
mod report;
mod sizes;
mod tables;
#[cfg(test)]
mod tests;
mod transitions;
mod variables;
mod walk;

use durations::Longest;
use mdle_runtime::TRANSITIONS_PER_TURN;
use serde::Serialize;
pub use sizes::MachineSizes;
pub use walk::Reach;
use walk::{BracketFacts, OperandOutcome};

use crate::diagnostic::Diagnostic;
use crate::fsm::{Element, ElementKind, Machine};
use crate::plan::{Condition, condition_text};

/// Facts about every run of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// Name of the plan.
    pub plan: String,
    /// Number of states of the plan's machine, including the termination state.
    pub states: u64,
    /// Number of atoms as written (before loops are expanded), including the atoms of plans that are used by name.
    pub atom_count: usize,
    /// Number of interrupts as written that can fire; `null` and removed interrupts are not counted.
    pub interrupts: usize,
    /// Maximum number of nested scopes, counting the plan and the atom's own scope.
    pub depth: usize,
    /// Maximum number of loops that enclose an atom.
    pub loop_depth: usize,
    /// Maximum number of transitions in one turn.
    pub transitions: u64,
    /// Maximum number of turns between the turn in which an interrupt fires and the turn that begins by sending the
    /// next atom's input; `None` if the search for the next atom may continue forever.
    pub reaction_turns: Option<u64>,
    /// Minimum time until the plan ends, in seconds; `None` if it never ends.
    pub shortest: Option<f64>,
    /// Maximum time until the plan ends.
    pub longest: Duration,
    /// Size of the emitted machine.
    pub bytes: MachineSizes,
    /// Facts about the plan and its behaviors, in order.
    pub scopes: Vec<ScopeAnswer>,
    /// Facts about the atoms, in order.
    pub atoms: Vec<AtomAnswer>,
}

/// Maximum duration of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Duration {
    /// Duration in seconds; `None` if there is no bound.
    pub seconds: Option<f64>,
    /// Number of turn periods to add to `seconds`. They are needed because each timer is read once per turn, and so may
    /// end up to one period late. `None` if there is no bound.
    pub turns: Option<u64>,
    /// Reason why there is no bound; `None` if there is a bound.
    pub because: Option<String>,
}

/// Facts about a scope other than an atom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScopeAnswer {
    /// Number of the scope; the plan has number 1.
    pub scope: usize,
    /// Number of the enclosing scope; `None` for the plan.
    pub within: Option<usize>,
    /// Name of the scope; empty for a scope in formal notation.
    pub name: String,
    /// Numbers of the first and the last atom of the scope.
    pub atoms: [usize; 2],
    /// Reachability of the scope's atoms.
    pub reach: Reach,
    /// Operands of the scope's interrupt by which the scope can end.
    pub ended_by: Vec<String>,
    /// Operands of the scope's interrupt by which the scope never ends.
    pub never_by: Vec<String>,
}

/// Facts about an atom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AtomAnswer {
    /// Number of the atom, counting from 1 in the order of the plan's text.
    pub atom: usize,
    /// Number of the atom's state in the first pass of all enclosing loops.
    pub state: u64,
    /// Number of the enclosing scope.
    pub within: usize,
    /// Text of the atom's law.
    pub law: String,
    /// Reachability of the atom.
    pub reach: Reach,
    /// Operands of the atom's own interrupt by which the atom can end, and `completed` if the atom's law can complete.
    pub ended_by: Vec<String>,
    /// Operands of the atom's interrupt by which the atom never ends.
    pub never_by: Vec<String>,
    /// `true` if the atom can end, either by itself or together with an enclosing scope.
    pub ends: bool,
}

/// Returns the warnings about a machine: W0202 to W0206, W0302 and W0303.
#[must_use]
pub fn lints(machine: &Machine) -> Vec<Diagnostic> {
    let most = transitions::most(machine);
    lints::lints(machine, &ended::walk_with_records(machine, !most.is_cut).found)
}

/// Returns the facts about every run of a machine.
#[must_use]
pub fn analyze(machine: &Machine) -> Analysis {
    let most = transitions::most(machine);
    let walked = ended::walk_with_records(machine, !most.is_cut);
    let longest = durations::longest(machine, &walked.found, most);
    let answers = Answers::new(machine, &walked.found);
    Analysis {
        plan: machine.root().name().to_owned(),
        states: machine.states(),
        atom_count: machine.atoms().len(),
        interrupts: machine.elements().filter(|element| *element.condition() != Condition::Null).count(),
        depth: machine.depth(),
        loop_depth: machine.sizes().slots,
        transitions: most.count,
        reaction_turns: reaction(machine, most),
        shortest: walked.shortest.map(|nanos| seconds(nanos.into())),
        longest: duration(longest, machine),
        bytes: sizes::bytes(machine),
        scopes: answers.scopes,
        atoms: answers.atoms,
    }
}

/// Returns `true` if a scope can end because its last element ends, and not only because of its own condition.
#[must_use]
pub fn body_ends(machine: &Machine, scope: Element<'_>) -> bool {
    let most = transitions::most(machine);
    let walked = ended::walk_with_records(machine, !most.is_cut);
    walked.found.get(scope.index()).is_some_and(|found| found.body_ends)
}

/// Returns the maximum number of turns between the firing of an interrupt and the input of the next atom; `None` if the
/// search for the next atom may continue forever. The input is sent at the beginning of the next turn. A search that
/// reaches the limit of a turn continues in the next turn.
fn reaction(machine: &Machine, most: transitions::Most) -> Option<u64> {
    let endless = || machine.elements().any(|element| matches!(element.kind(), ElementKind::Loop { times: None }));
    match most.is_cut {
        false => Some(1),
        true if endless() => None,
        true => Some(1 + machine.states() / u64::from(TRANSITIONS_PER_TURN)),
    }
}

fn duration(longest: Longest, machine: &Machine) -> Duration {
    match longest {
        Longest::Bounded { nanos, turns } => {
            Duration { seconds: Some(seconds(nanos)), turns: Some(turns), because: None }
        }
        Longest::Unbounded(bracket) => {
            let element = machine.element(bracket);
            let (atom, law) = (element.first().number() + 1, &element.first().law().text);
            let because = match element.kind() {
                ElementKind::Loop { .. } => format!("no timer ends the loop without end at atom {atom}, `{law}`"),
                ElementKind::Scope | ElementKind::Atom(_) => format!("no timer ends atom {atom}, `{law}`"),
            };
            Duration { seconds: None, turns: None, because: Some(because) }
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "a time is told in seconds")]
fn seconds(nanos: u128) -> f64 {
    nanos as f64 / 1e9
}

struct Answers {
    scopes: Vec<ScopeAnswer>,
    atoms: Vec<AtomAnswer>,
}

impl Answers {
    fn new(machine: &Machine, found: &[BracketFacts]) -> Self {
        let mut answers = Self { scopes: Vec::new(), atoms: Vec::new() };
        // For each bracket: the number of the innermost scope that it is or that encloses it, and `true` if the
        // condition of that scope or of a scope around it can fire.
        let mut scope_of: Vec<(usize, bool)> = Vec::with_capacity(found.len());
        for (element, found) in machine.elements().zip(found) {
            let around = element.parent().map_or((0, false), |parent| scope_of[parent.index()]);
            let (ended_by, never_by) = by(element.condition(), found, machine);
            let inside = match element.kind() {
                ElementKind::Loop { .. } => around,
                ElementKind::Atom(atom) => {
                    let own = ended_by.into_iter().chain(found.completes.then(|| "completed".to_owned()));
                    let ended_by: Vec<String> = own.collect();
                    answers.atoms.push(AtomAnswer {
                        atom: atom.index() + 1,
                        state: atom.state(),
                        within: around.0,
                        law: atom.law().text.clone(),
                        reach: found.reach,
                        ends: found.reach != Reach::Never && (around.1 || !ended_by.is_empty()),
                        ended_by,
                        never_by,
                    });
                    around
                }
                ElementKind::Scope => {
                    let number = answers.scopes.len() + 1;
                    let ends = around.1 || !ended_by.is_empty();
                    answers.scopes.push(ScopeAnswer {
                        scope: number,
                        within: (number > 1).then_some(around.0),
                        name: element.name().to_owned(),
                        atoms: [element.first().index() + 1, element.last().index() + 1],
                        reach: found.reach,
                        ended_by,
                        never_by,
                    });
                    (number, ends)
                }
            };
            scope_of.push(inside);
        }
        answers
    }
}

/// Returns the texts of the operands by which an interrupt can fire, and the texts of the operands by which it cannot
/// fire. Omits `null`.
fn by(condition: &Condition, found: &BracketFacts, machine: &Machine) -> (Vec<String>, Vec<String>) {
    let (mut can, mut never) = (Vec::new(), Vec::new());
    for (operand, outcome) in condition.operands().iter().zip(&found.operands) {
        let text = || condition_text(operand, &|id| machine.quark(id).text.clone());
        match outcome {
            _ if *operand == Condition::Null => {}
            OperandOutcome::Possible => can.push(text()),
            OperandOutcome::Never
            | OperandOutcome::Beaten(_)
            | OperandOutcome::Late(_)
            | OperandOutcome::Repeated(_) => never.push(text()),
            OperandOutcome::Unread => {}
        }
    }
    (can, never)
}
