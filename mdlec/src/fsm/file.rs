//! The machine as an FSM file (docs/src/reference/interfaces.md, 5): states, interrupts with their moves, finite loops
//! expanded.

use mdle_runtime::fsm::{Bracket, Kind};
use serde::Serialize;

use super::{Machine, expand, lower};
use crate::diagnostic::Diagnostic;
use crate::plan::{Condition, Nondegenerate};

/// The version of the format.
const VERSION: u32 = 1;

/// An FSM file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FsmFile {
    /// The version of the format.
    pub version: u32,
    /// The plan's name.
    pub source: String,
    /// The states; the last is the termination state.
    pub states: Vec<String>,
    /// The state in which the plan begins.
    pub start: String,
    /// The quark text of each state's law, without the termination state.
    pub laws: Vec<String>,
    /// The interrupts in pre-order of the expanded plan, then completion.
    pub interrupts: Vec<InterruptEntry>,
    /// The interrupts that never fire: null, or removed because an outer one repeats them.
    pub never: Vec<String>,
    /// The scopes in pre-order: name, first and last state.
    pub scopes: Vec<ScopeEntry>,
}

/// An interrupt with its transition matrix, as the columns that it moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterruptEntry {
    /// `x1`, `x2`, …, or `completed`.
    pub name: String,
    /// Its condition text.
    pub text: String,
    /// From state to state.
    pub moves: Moves,
}

/// Moves in the order of the states they leave.
#[derive(Debug, Clone, PartialEq)]
pub struct Moves(pub Vec<(String, String)>);

impl Serialize for Moves {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(from, to)| (from, to)))
    }
}

/// A scope, as the states it holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScopeEntry {
    /// Its interrupt.
    pub interrupt: String,
    /// Its name; empty for an atom.
    pub name: String,
    /// Its first state.
    pub first: String,
    /// Its last state.
    pub last: String,
}

/// The file of a plan.
///
/// # Errors
/// E0501 and E0502, as [`expand`] has them.
pub fn fsm_file(plan: &Nondegenerate) -> Result<FsmFile, Diagnostic> {
    let lowered = lower(&expand(plan)?)?;
    let columns = Columns(&lowered);
    let mut file = FsmFile {
        version: VERSION,
        source: lowered.scopes.iter().flatten().next().map(|plan| plan.name.clone()).unwrap_or_default(),
        states: (0..=columns.atoms()).map(|atom| columns.state(atom)).collect(),
        start: columns.state(0),
        laws: lowered.laws.iter().map(|law| lowered.quark(law.quark).text.clone()).collect(),
        interrupts: Vec::new(),
        never: Vec::new(),
        scopes: Vec::new(),
    };
    for (scope, bracket) in lowered.scopes.iter().zip(&lowered.brackets) {
        let Some(scope) = scope else { continue };
        let name = format!("x{}", file.interrupts.len() + 1);
        let to = columns.state(columns.destination(bracket));
        let moves = (bracket.first..=bracket.last).map(|atom| (columns.state(atom), to.clone())).collect();
        if scope.interrupt.condition == Condition::Null {
            file.never.push(name.clone());
        }
        file.scopes.push(ScopeEntry {
            interrupt: name.clone(),
            name: scope.name.clone(),
            first: columns.state(bracket.first),
            last: columns.state(bracket.last),
        });
        file.interrupts.push(InterruptEntry { name, text: scope.interrupt.text.clone(), moves: Moves(moves) });
    }
    file.interrupts.extend(columns.completion());
    Ok(file)
}

impl FsmFile {
    /// The file as JSON, on several lines.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Only maps with keys that are no strings cannot be written, and there are none.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }
}

/// The columns of the transition matrices of a machine whose finite loops are expanded.
struct Columns<'a>(&'a Machine);

impl Columns<'_> {
    fn atoms(&self) -> u32 {
        u32::try_from(self.0.atoms.len()).unwrap_or(u32::MAX)
    }

    /// Where the interrupt of a scope sends its columns: to the start of the innermost loop outside it that ends where
    /// it ends, else behind its last atom.
    fn destination(&self, scope: &Bracket) -> u32 {
        let mut inside = scope;
        loop {
            let around = &self.0.brackets[inside.parent as usize];
            if around.last != scope.last || std::ptr::eq(around, inside) {
                return scope.last + 1;
            }
            if matches!(around.kind, Kind::Loop { .. }) {
                return around.first;
            }
            inside = around;
        }
    }

    fn state(&self, atom: u32) -> String {
        if atom == self.atoms() { "end".into() } else { format!("a{}", atom + 1) }
    }

    /// The interrupt that laws raise when they are done.
    fn completion(&self) -> Option<InterruptEntry> {
        let atoms = self.0.laws.iter().zip(&self.0.atoms).zip(0..);
        let moves: Vec<_> = atoms
            .filter(|((law, _), _)| self.0.quark(law.quark).completes)
            .map(|((_, atom), number)| {
                let own = &self.0.brackets[atom.scope as usize];
                (self.state(number), self.state(self.destination(own)))
            })
            .collect();
        let name = "completed".to_owned();
        (!moves.is_empty()).then(|| InterruptEntry { text: name.clone(), name, moves: Moves(moves) })
    }
}
