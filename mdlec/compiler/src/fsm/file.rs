//! Writes a machine as an FSM file (docs/src/reference/interfaces.md, 5). The file contains the states, and the
//! interrupts with their transitions; finite loops are expanded.

use serde::Serialize;

use super::expand::expands;
use super::{Transition, matrices};
use crate::diagnostic::Diagnostic;
use crate::plan::{Condition, Nondegenerate};

/// Version of the format that the compiler writes.
const VERSION: u32 = 1;

/// The content of an FSM file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FsmFile {
    /// Version of the format.
    pub version: u32,
    /// Name of the plan.
    pub source: String,
    /// Names of the states; the last one is the termination state.
    pub states: Vec<String>,
    /// Name of the state in which the plan begins.
    pub start: String,
    /// Text of each state's law, such as `go 20 0`; the termination state has none.
    pub laws: Vec<String>,
    /// The interrupts in pre-order of the expanded plan, followed by the completion of laws.
    pub interrupts: Vec<InterruptEntry>,
    /// Names of the interrupts that never fire: null interrupts, and interrupts that were removed because an outer
    /// scope repeats them.
    pub never: Vec<String>,
    /// The scopes in pre-order, each with its name and its first and last state.
    pub scopes: Vec<ScopeEntry>,
}

/// An interrupt with its transition matrix in the form of a list of transitions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterruptEntry {
    /// Name of the interrupt: `x1`, `x2`, …, or `completed`.
    pub name: String,
    /// Text of the interrupt's condition.
    pub text: String,
    /// The transitions of the matrix, from state to state.
    pub moves: Moves,
}

/// Transitions, as pairs of the state that is left and the state that is entered. They are sorted by the state that is
/// left.
#[derive(Debug, Clone, PartialEq)]
pub struct Moves(pub Vec<(String, String)>);

impl Serialize for Moves {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(from, to)| (from, to)))
    }
}

/// A scope, given by its first and last states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScopeEntry {
    /// Name of the scope's interrupt.
    pub interrupt: String,
    /// Name of the scope; empty for an atom.
    pub name: String,
    /// First state of the scope.
    pub first: String,
    /// Last state of the scope.
    pub last: String,
}

/// Returns the FSM file of a plan. For each interrupt, it contains the columns of the transition matrix that the
/// interrupt lists.
///
/// # Errors
/// Fails with E0501 or E0502 as [`expand`](super::expand) does.
pub fn fsm_file(plan: &Nondegenerate) -> Result<FsmFile, Diagnostic> {
    // The file contains the text of a condition again for each state to which expansion copies the condition.
    expands(plan)?;
    let matrices = matrices(plan)?;
    let plan = plan.plan();
    let state = |number: usize| if number == matrices.laws.len() { "end".into() } else { format!("a{}", number + 1) };
    let mut file = FsmFile {
        version: VERSION,
        source: plan.root.name.clone(),
        states: (0..=matrices.laws.len()).map(state).collect(),
        start: state(0),
        laws: matrices.laws.iter().map(|law| plan.quark(*law).text.clone()).collect(),
        interrupts: Vec::new(),
        never: Vec::new(),
        scopes: Vec::new(),
    };
    for (number, Transition { interrupt, name, matrix, .. }) in (1..).zip(&matrices.transitions) {
        let x = format!("x{number}");
        let moves = matrix.columns().map(|from| (state(from), state(matrix.row()))).collect();
        if interrupt.condition == Condition::Null {
            file.never.push(x.clone());
        }
        let [first, last] = [*matrix.columns().start(), *matrix.columns().end()].map(state);
        file.scopes.push(ScopeEntry { interrupt: x.clone(), name: (*name).to_owned(), first, last });
        file.interrupts.push(InterruptEntry { name: x, text: interrupt.text.clone(), moves: Moves(moves) });
    }
    let completion = matrices.completion(plan);
    let moves: Vec<_> = completion.map(|(_, matrix)| (state(*matrix.columns().start()), state(matrix.row()))).collect();
    if !moves.is_empty() {
        let name = "completed".to_owned();
        file.interrupts.push(InterruptEntry { text: name.clone(), name, moves: Moves(moves) });
    }
    Ok(file)
}

impl FsmFile {
    /// Returns the file as JSON, on several lines.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialization fails only for maps with keys that are not strings, and there are none.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }
}
