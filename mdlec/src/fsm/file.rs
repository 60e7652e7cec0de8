//! The machine as an FSM file (interfaces, "FSM files"): states, interrupts with their moves, finite loops expanded.

use std::collections::BTreeMap;

use mdle_runtime::fsm::Kind;
use serde::Serialize;

use super::{Lowered, algorithm1, expand};
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
    let lowered = algorithm1(&expand(plan)?)?;
    let machine = Columns::of(&lowered);
    let scopes: Vec<_> = lowered
        .scopes
        .iter()
        .zip(&lowered.brackets)
        .enumerate()
        .filter_map(|(bracket, (scope, extent))| Some((bracket, scope.as_ref()?, extent)))
        .collect();
    let name = |index: usize| format!("x{}", index + 1);
    let mut interrupts: Vec<_> = scopes
        .iter()
        .enumerate()
        .map(|(index, (bracket, scope, extent))| {
            let to = machine.state(machine.destination(*bracket));
            let moves = (extent.first..=extent.last).map(|atom| (machine.state(atom), to.clone())).collect();
            InterruptEntry { name: name(index), text: scope.interrupt.text.clone(), moves: Moves(moves) }
        })
        .collect();
    interrupts.extend(machine.completion());
    let never = |(index, (_, scope, _)): (usize, &(usize, &super::ScopeMeaning, _))| {
        (scope.interrupt.condition == Condition::Null).then(|| name(index))
    };
    Ok(FsmFile {
        version: VERSION,
        source: plan.plan().root.name.clone(),
        states: (0..=machine.atoms()).map(|atom| machine.state(atom)).collect(),
        laws: lowered.laws.iter().map(|law| lowered.quark(law.quark).text.clone()).collect(),
        never: scopes.iter().enumerate().filter_map(never).collect(),
        scopes: scopes
            .iter()
            .enumerate()
            .map(|(index, (_, scope, extent))| ScopeEntry {
                interrupt: name(index),
                name: scope.name.clone(),
                first: machine.state(extent.first),
                last: machine.state(extent.last),
            })
            .collect(),
        interrupts,
    })
}

/// The columns of the transition matrices of a machine whose finite loops are expanded.
struct Columns<'a> {
    lowered: &'a Lowered,
    /// For each atom, the loops without end that end there, by their brackets, outermost first.
    loops: BTreeMap<u32, Vec<u32>>,
}

impl<'a> Columns<'a> {
    fn of(lowered: &'a Lowered) -> Self {
        let mut loops: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (bracket, number) in lowered.brackets.iter().zip(0..) {
            if matches!(bracket.kind, Kind::Loop { .. }) {
                loops.entry(bracket.last).or_default().push(number);
            }
        }
        Self { lowered, loops }
    }

    fn atoms(&self) -> u32 {
        u32::try_from(self.lowered.atoms.len()).unwrap_or(u32::MAX)
    }

    /// Where the interrupt of a scope sends its columns: to the start of the innermost loop outside it that ends where
    /// it ends, else behind its last atom.
    fn destination(&self, scope: usize) -> u32 {
        let last = self.lowered.brackets[scope].last;
        // Pre-order: a loop around the scope has a smaller number, and the innermost of them the largest.
        let around = self.loops.get(&last).into_iter().flatten().filter(|number| (**number as usize) < scope);
        around.max().map_or(last + 1, |number| self.lowered.brackets[*number as usize].first)
    }

    fn state(&self, atom: u32) -> String {
        if atom == self.atoms() { "end".into() } else { format!("a{}", atom + 1) }
    }

    /// The interrupt that laws raise when they are done.
    fn completion(&self) -> Option<InterruptEntry> {
        let atoms = self.lowered.laws.iter().zip(&self.lowered.atoms).zip(0..);
        let moves: Vec<_> = atoms
            .filter(|((law, _), _)| self.lowered.quark(law.quark).completes)
            .map(|((_, atom), number)| (self.state(number), self.state(self.destination(atom.scope as usize))))
            .collect();
        let name = "completed".to_owned();
        (!moves.is_empty()).then(|| InterruptEntry { text: name.clone(), name, moves: Moves(moves) })
    }
}
