//! Computes the successor of a scope before the plan runs, if the successor depends on no loop
//! (docs/src/reference/semantics.md, 5.3; Eq. 2: the single destination of a transition matrix).

use crate::Fsm;
use crate::fsm::Kind;

/// A successor of a scope that is known before the plan runs, because it depends on no loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Follows {
    /// Index of the atom that becomes current; the number of atoms if the plan is then over.
    pub atom: u32,
    /// Level of the outermost scope that is entered with the atom.
    pub from: u16,
    /// One more than the level of the innermost scope that is entered with the atom; at most `from` when the plan is
    /// over.
    pub to: u16,
}

impl Follows {
    /// Creates the successor that makes `atom` current and enters the scopes of levels `from..to`.
    #[must_use]
    pub const fn new(atom: u32, from: u16, to: u16) -> Self {
        Self { atom, from, to }
    }
}

impl Fsm<'_> {
    /// Returns the successor of this scope; `None` if a loop ends with the scope or begins after it, because the
    /// successor then depends on the number of passes left.
    #[must_use]
    pub fn follows(self, scope: u32) -> Option<Follows> {
        let mut outwards = self.outwards(scope);
        let (_, inner) = outwards.next()?;
        let (mut holder, mut is_over) = (scope, true);
        for (number, around) in outwards {
            holder = number;
            is_over = around.last == inner.last;
            if !is_over {
                break;
            }
            if matches!(around.kind, Kind::Loop { .. }) {
                return None;
            }
        }
        if is_over {
            return Some(Follows::new(u32::try_from(self.atoms.len()).ok()?, 0, 0));
        }
        let atom = inner.last.checked_add(1)?;
        let own = self.atoms.get(atom as usize)?.scope;
        let (mut from, mut to) = (u16::MAX, 0);
        for (_, bracket) in self.outwards(own).take_while(|(here, _)| *here != holder) {
            let Kind::Scope { level } = bracket.kind else { return None };
            from = from.min(level);
            to = to.max(level.checked_add(1)?);
        }
        Some(Follows::new(atom, from, to))
    }
}
