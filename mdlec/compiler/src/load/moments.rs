//! Records the moments of a turn. A moment contains the states of the scopes that enclose the current atom, either
//! before a transition or at the end of the turn.

use mdle_runtime::fsm::Kind;
use mdle_runtime::{Alphabet, Cause, Cursor, Examined, Nanometers, Nanos, Plan as _};

use super::Entered;
use super::table::LoadedRows;

/// Position in a loaded plan.
pub(super) type Position = Cursor<Entered, Box<[u64]>>;

/// State of a plan before a transition, or at the end of a turn.
#[derive(Debug, Clone)]
pub struct PlanMoment {
    /// Index of the current atom in the order of the plan's text.
    pub atom: u32,
    /// Cause of the transition; `None` at the end of a turn.
    pub cause: Option<Cause>,
    /// `true` if the law of the atom is done.
    pub is_completed: bool,
    /// Time for which the law of the previous turn has made no progress; `None` if that law has no goal.
    pub stalled: Option<Nanos>,
    /// Scopes that enclose the atom, from the plan to the atom's own scope.
    pub scopes: Vec<ScopeMoment>,
}

impl PlanMoment {
    /// Returns `true` if the atom was entered in this turn.
    #[must_use]
    pub fn is_new(&self) -> bool {
        self.scopes.last().is_some_and(|own| own.since == Nanos::ZERO)
    }
}

/// State of a scope at a moment of a turn.
#[derive(Debug, Clone)]
pub struct ScopeMoment {
    /// Number of the scope's bracket.
    pub bracket: u32,
    /// Number of scopes that enclose this scope.
    pub level: u16,
    /// Time since the scope was entered.
    pub since: Nanos,
    /// Length of the path driven since the scope was entered.
    pub way: Nanometers,
    /// Values of the scope's condition and of all its parts; each part comes before its operands.
    pub parts: Vec<Examined>,
    /// Index of the atom that would follow if the scope ended now; `None` if the plan would then be over.
    pub leads_to: Option<u32>,
}

/// Returns the moment of the current atom, either before a transition with this cause or at the end of a turn.
pub(super) fn moment<A: Alphabet>(
    rows: &LoadedRows<A>,
    cursor: &Position,
    cause: Option<Cause>,
    y: &A::Output,
    t: Nanos,
) -> PlanMoment {
    let (fsm, atom) = (rows.fsm(), cursor.atom());
    let own = fsm.atoms.get(atom as usize).map_or(0, |atom| atom.scope);
    let mut scopes: Vec<_> = fsm
        .outwards(own)
        .filter_map(|(bracket, found)| match found.kind {
            Kind::Scope { level } => Some(scope(rows, cursor, (bracket, level), y, t)),
            Kind::Loop { .. } => None,
        })
        .collect();
    scopes.reverse();
    PlanMoment { atom, cause, is_completed: rows.is_completed(y, t), stalled: cursor.stalled(), scopes }
}

/// Returns the state of a scope at a moment.
fn scope<A: Alphabet>(
    rows: &LoadedRows<A>,
    cursor: &Position,
    (bracket, level): (u32, u16),
    y: &A::Output,
    t: Nanos,
) -> ScopeMoment {
    let mut parts = Vec::new();
    rows.examine(cursor, bracket, y, t, &mut |part| parts.push(part));
    let mut after = cursor.clone();
    let leads_to = after.end(rows.fsm(), level, t).then(|| after.atom());
    ScopeMoment { bracket, level, since: cursor.since(level, t), way: cursor.way(level), parts, leads_to }
}
