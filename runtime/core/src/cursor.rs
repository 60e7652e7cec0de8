//! The cursor of a plan's machine: determines which atom follows when a scope ends, and which scopes and loops then
//! restart (docs/src/reference/semantics.md, 5.3 and 6; the paper's third type of transition with its counter c(t)).

use crate::fsm::{Bracket, Kind};
use crate::{Begin, Entries, Follows, Frame, Fsm, Here, Nanometers, Nanos, Output, Slots};

/// Position in a plan: the current atom, the entry of each enclosing scope, and the number of passes that each
/// enclosing loop has left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cursor<E, P> {
    atom: u32,
    entered: E,
    left: P,
}

impl<E: Entries, P: Slots<u64>> Cursor<E, P> {
    /// Creates a cursor at the first atom of `fsm`. All scopes that enclose the atom are entered at time `t`.
    ///
    /// `entered` must have a slot for each level of scopes for which [`Cursor::since`] is called, and `left` must have
    /// a slot for each level of loops; their initial values do not matter.
    pub fn start(fsm: Fsm<'_>, entered: E, left: P, t: Nanos) -> Self {
        let mut cursor = Self { atom: 0, entered, left };
        cursor.open(fsm, 0, None, t);
        cursor
    }

    /// Returns the index of the current atom in the order of the plan's text; the number of atoms when the plan is
    /// over.
    pub fn atom(&self) -> u32 {
        self.atom
    }

    /// Returns the time since the enclosing scope of this level was entered.
    pub fn since(&self, level: u16, t: Nanos) -> Nanos {
        t.since(self.entered.time(level).unwrap_or(t))
    }

    /// Returns the length of the path driven since the enclosing scope of this level was entered.
    pub fn way(&self, level: u16) -> Nanometers {
        self.entered.way(level)
    }

    /// Returns the time for which the law of the previous turn has made no progress towards its goal; `None` if the law
    /// has no goal, or if the plan does not use this time. The value is the same throughout a turn.
    #[inline(always)]
    pub fn stalled(&self) -> Option<Nanos> {
        self.entered.stalled()
    }

    /// Records the output of a turn, and the time for which the law of the previous turn has made no progress. Called
    /// first in each turn, before a condition is read or a scope is entered.
    #[inline(always)]
    pub(crate) fn observe<Y: Output>(&mut self, y: &Y, stalled: Option<Nanos>) {
        self.entered.observe(y, stalled);
    }

    /// Records the output of the first turn after the plan was suspended.
    pub(crate) fn resume<Y: Output>(&mut self, y: &Y) {
        self.entered.resume(y);
    }

    /// Returns the frame of the current atom, if a `FRAME here` encloses it.
    #[inline(always)]
    pub(crate) fn frame(&self) -> Option<Frame> {
        let Here { level, turned } = self.entered.here(self.atom)?;
        Some(Frame(self.entered.heading(level)).turned(turned))
    }

    /// Returns `begin`; if a `FRAME here` encloses the current atom, the atom's frame replaces the plan's frame.
    #[inline(always)]
    pub(crate) fn begins(&self, begin: Begin) -> Begin {
        self.frame().map_or(begin, |frame| Begin { frame, ..begin })
    }

    /// Returns the number of the bracket of the enclosing scope at `level`: the number of the atom's own bracket if
    /// there is no such scope, and of the plan's bracket when the plan is over.
    pub fn scope(&self, fsm: Fsm<'_>, level: u16) -> u32 {
        let own = fsm.atoms.get(self.atom as usize).map_or(0, |atom| atom.scope);
        let mut outwards = fsm.outwards(own);
        let scope = outwards.find(|(_, bracket)| match bracket.kind {
            Kind::Scope { level: here } => here == level,
            Kind::Loop { .. } => false,
        });
        scope.map_or(own, |(number, _)| number)
    }

    /// Returns the number of the current state in the expanded plan, counted from 1; the termination state when the
    /// plan is over.
    pub fn state(&self, fsm: Fsm<'_>) -> u64 {
        let Some(atom) = fsm.atoms.get(self.atom as usize) else { return fsm.termination };
        fsm.outwards(atom.scope).fold(atom.state, |state, (_, bracket)| match bracket.kind {
            Kind::Scope { .. } => state,
            Kind::Loop { times, slot, stride } => {
                let left = self.left.as_ref().get(usize::from(slot)).copied().unwrap_or(0);
                let passes = times.saturating_sub(left).saturating_sub(1);
                state.saturating_add(passes.saturating_mul(stride))
            }
        })
    }

    /// Returns the brackets that end when the enclosing scope at `level` ends: first that scope's bracket, then each
    /// bracket whose last element ends with it. A loop ends only with its last pass.
    pub fn ending<'f>(&self, fsm: Fsm<'f>, level: u16) -> impl Iterator<Item = (u32, &'f Bracket)> {
        let mut outwards = fsm.outwards(self.scope(fsm, level));
        let scope = outwards.next();
        let last = scope.map_or(0, |(_, bracket)| bracket.last);
        let around = outwards.take_while(move |(_, around)| around.last == last && !self.has_pass(around));
        scope.into_iter().chain(around)
    }

    /// Returns `true` if `bracket` is a loop that has a pass left.
    fn has_pass(&self, bracket: &Bracket) -> bool {
        let Kind::Loop { times, slot, .. } = bracket.kind else { return false };
        times == 0 || self.left.as_ref().get(usize::from(slot)).is_some_and(|left| *left > 0)
    }

    /// Ends the enclosing scope of this level at time `t`, and moves to the atom that follows. Returns `false`
    /// if the plan is then over.
    pub fn end(&mut self, fsm: Fsm<'_>, level: u16, t: Nanos) -> bool {
        let mut outwards = fsm.outwards(self.scope(fsm, level));
        // Brackets that end together with the scope have the same last atom.
        let last = outwards.next().map_or(0, |(_, scope)| scope.last);
        for (holder, around) in outwards {
            if last != around.last {
                self.open(fsm, last.saturating_add(1), Some(holder), t);
                return true;
            }
            if self.spend(around) {
                self.open(fsm, around.first, Some(holder), t);
                return true;
            }
        }
        self.atom = u32::try_from(fsm.atoms.len()).unwrap_or(u32::MAX);
        false
    }

    /// Moves to the successor of a scope that has ended at time `t`, as [`Fsm::follows`] computed it beforehand.
    pub fn follow(&mut self, follows: Follows, t: Nanos) {
        self.atom = follows.atom;
        // Most plans without timers store no levels.
        if self.entered.is_empty() {
            return;
        }
        for level in follows.from..follows.to {
            self.entered.note(level, t);
        }
    }

    /// Uses up a pass of `bracket`; returns `true` if `bracket` is a loop that had a pass left.
    fn spend(&mut self, bracket: &Bracket) -> bool {
        let Kind::Loop { times, slot, .. } = bracket.kind else { return false };
        if times == 0 {
            return true;
        }
        match self.left.as_mut().get_mut(usize::from(slot)) {
            Some(left) if *left > 0 => {
                *left = left.saturating_sub(1);
                true
            }
            Some(_) | None => false,
        }
    }

    /// Makes `atom` current, and restarts every bracket that encloses the atom and is inside `holder`. If `holder` is
    /// `None`, restarts all brackets that enclose the atom.
    fn open(&mut self, fsm: Fsm<'_>, atom: u32, holder: Option<u32>, t: Nanos) {
        self.atom = atom;
        // If both are empty in generated code, the compiler knows this and removes the table lookup below.
        if self.entered.is_empty() && self.left.as_ref().is_empty() {
            return;
        }
        let Some(own) = fsm.atoms.get(atom as usize) else { return };
        for (_, bracket) in fsm.outwards(own.scope).take_while(|(here, _)| holder != Some(*here)) {
            match bracket.kind {
                Kind::Scope { level } => self.entered.note(level, t),
                Kind::Loop { times, slot, .. } => {
                    if let Some(left) = self.left.as_mut().get_mut(usize::from(slot)) {
                        *left = times.saturating_sub(1);
                    }
                }
            }
        }
    }
}
