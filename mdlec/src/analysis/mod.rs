//! What is so of every run of a plan, found without running it: which atoms run, what can end them, how long it all takes,
//! how large the machine is.
//!
//! What is said never to happen never happens, in no run; what is said to be possible may be too much to look at.

mod choices;
mod constants;
mod durations;
mod judge;
mod lints;
mod report;
mod sizes;
mod tables;
#[cfg(test)]
mod tests;
mod transitions;
mod variables;
mod walk;
mod world;

use durations::Longest;
use mdle_runtime::TRANSITIONS_PER_TURN;
use serde::Serialize;
pub use sizes::Bytes;
pub use walk::Reach;
use walk::{Found, Outcome};

use crate::diagnostic::Diagnostic;
use crate::fsm::{ElementKind, Machine};
use crate::plan::{Condition, condition_text};

/// What is so of every run of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// The plan's name.
    pub plan: String,
    /// The states of its machine, the last one included.
    pub states: u64,
    /// The atoms as written, plans by name copied in.
    pub atom_count: usize,
    /// The interrupts as written that can be one that fires: null ones and removed ones are none.
    pub interrupts: usize,
    /// How many scopes are around each other at most, the plan and the atom's own included.
    pub depth: usize,
    /// How many loops are around an atom at most.
    pub loop_depth: usize,
    /// The most transitions of one turn.
    pub transitions: u64,
    /// The turns from the one in which an interrupt fires to the one that begins with what follows being sent; nothing
    /// where a search for what follows may go on without end.
    pub reaction_turns: Option<u64>,
    /// The shortest time in which it can be over, in seconds; nothing if it never is.
    pub shortest: Option<f64>,
    /// The longest time.
    pub longest: Duration,
    /// How large it is.
    pub bytes: Bytes,
    /// The plan and its behaviors, in order; atoms are below.
    pub scopes: Vec<ScopeAnswer>,
    /// The atoms, in order.
    pub atoms: Vec<AtomAnswer>,
}

/// How long a plan takes at most.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Duration {
    /// In seconds; nothing where there is no bound.
    pub seconds: Option<f64>,
    /// So many times from one turn to the next more, since a timer is read once a turn.
    pub turns: Option<u64>,
    /// What has no bound, where there is none.
    pub because: Option<String>,
}

/// What is so of a scope other than an atom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScopeAnswer {
    /// Its number, from 1: the plan.
    pub scope: usize,
    /// The number of the scope around it.
    pub within: Option<usize>,
    /// Its name; empty for a scope in formal notation.
    pub name: String,
    /// Its first and its last atom.
    pub atoms: [usize; 2],
    /// Whether its atoms come to run.
    pub reach: Reach,
    /// By which operands of its interrupt it can end.
    pub ended_by: Vec<String>,
    /// The operands by which it never ends.
    pub never_by: Vec<String>,
}

/// What is so of an atom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AtomAnswer {
    /// Its number, from 1, among the atoms as written.
    pub atom: usize,
    /// The number of its state, in the first pass of every loop around it.
    pub state: u64,
    /// The number of the scope around it.
    pub within: usize,
    /// Its law.
    pub law: String,
    /// Whether it comes to run.
    pub reach: Reach,
    /// By which operands of its own interrupt it can end, and `completed` if its law can be done.
    pub ended_by: Vec<String>,
    /// The operands by which it never ends.
    pub never_by: Vec<String>,
    /// Whether it can end at all: by itself, or with a scope around it.
    pub ends: bool,
}

/// Returns the warnings about a machine: W0202 to W0206, W0302 and W0303.
#[must_use]
pub fn lints(machine: &Machine) -> Vec<Diagnostic> {
    let most = transitions::most(machine);
    lints::lints(machine, &walk::walk(machine, !most.is_cut).found)
}

/// Analyses a machine.
#[must_use]
pub fn analyze(machine: &Machine) -> Analysis {
    let most = transitions::most(machine);
    let walked = walk::walk(machine, !most.is_cut);
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

/// The input that follows an interrupt is sent at the head of the next turn; a search that is cut goes on in that turn.
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
    fn new(machine: &Machine, found: &[Found]) -> Self {
        let mut answers = Self { scopes: Vec::new(), atoms: Vec::new() };
        // For each bracket the number of the innermost scope that it is or is in, and whether anything ends that.
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

/// The texts of the operands by which an interrupt can fire, and of those by which it cannot; `null` is none.
fn by(condition: &Condition, found: &Found, machine: &Machine) -> (Vec<String>, Vec<String>) {
    let (mut can, mut never) = (Vec::new(), Vec::new());
    for (operand, outcome) in condition.operands().iter().zip(&found.operands) {
        let text = || condition_text(operand, &|id| machine.quark(id).text.clone());
        match outcome {
            _ if *operand == Condition::Null => {}
            Outcome::Possible => can.push(text()),
            Outcome::Never | Outcome::Beaten(_) | Outcome::Late(_) | Outcome::Repeated(_) => never.push(text()),
            Outcome::Unread => {}
        }
    }
    (can, never)
}
