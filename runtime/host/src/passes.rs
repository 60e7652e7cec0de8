//! Counts the passes of the loops that enclose the current atom, for reports. A machine itself counts only the passes
//! of finite loops.

use mdle_runtime::fsm::{Bracket, Kind};
use mdle_runtime::{Fsm, Transition};

/// Number of the current pass of each loop, counted from 1, indexed by the loop's bracket.
#[derive(Debug, Default)]
pub struct Passes(Vec<u64>);

impl Passes {
    /// Returns the number of the current pass of a loop.
    #[must_use]
    pub fn of(&self, bracket: u32) -> u64 {
        self.0.get(bracket as usize).copied().unwrap_or(1)
    }

    /// Updates the passes of the loops that a transition begins or repeats.
    pub fn step(&mut self, fsm: Fsm<'_>, transition: &Transition) {
        self.step_into(fsm, transition, |_| ());
    }

    /// Updates the passes as [`Passes::step`] does, and calls `begins` with each bracket that begins in the transition.
    pub fn step_into(&mut self, fsm: Fsm<'_>, transition: &Transition, mut begins: impl FnMut(u32)) {
        self.0.resize(fsm.brackets.len(), 1);
        let own = transition.atom.and_then(|atom| fsm.atoms.get(atom as usize));
        let (Some(own), Some(ended)) = (own, fsm.brackets.get(transition.scope as usize)) else { return };
        // The innermost bracket around the scope that has something left to run: another element, or another pass.
        let mut goes_on = 0;
        for (number, around) in outwards(fsm, ended.parent).filter(|(number, _)| *number != transition.scope) {
            goes_on = number;
            if around.last != ended.last || self.spend(number, around) {
                break;
            }
        }
        for (number, begun) in outwards(fsm, own.scope).take_while(|(number, _)| *number != goes_on) {
            begins(number);
            match (begun.kind, self.0.get_mut(number as usize)) {
                (Kind::Loop { .. }, Some(pass)) => *pass = 1,
                (Kind::Loop { .. } | Kind::Scope { .. }, _) => {}
            }
        }
    }

    /// Begins the next pass of `bracket`; returns `false` if it is not a loop or has no pass left.
    fn spend(&mut self, number: u32, bracket: &Bracket) -> bool {
        let (Kind::Loop { times, .. }, Some(pass)) = (bracket.kind, self.0.get_mut(number as usize)) else {
            return false;
        };
        if times != 0 && *pass >= times {
            return false;
        }
        *pass = pass.saturating_add(1);
        true
    }
}

/// Returns an iterator over a bracket and all brackets that enclose it, with their numbers, from the innermost to the
/// outermost.
pub fn outwards(fsm: Fsm<'_>, bracket: u32) -> impl Iterator<Item = (u32, &Bracket)> {
    let at = move |number: u32| fsm.brackets.get(number as usize).map(|bracket| (number, bracket));
    std::iter::successors(at(bracket), move |(number, bracket)| {
        at(bracket.parent).filter(|(around, _)| around < number)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::Cause;
    use mdle_runtime::fsm::Atom;

    #[test]
    fn each_loop_around_an_atom_counts_its_passes() {
        // { P ((a (b)^2)^inf c) }
        let brackets = [
            Bracket::scope(0, 0, 2, 0),
            Bracket::repeat(0, 0, 0, 0, 1, 0),
            Bracket::scope(1, 0, 0, 1),
            Bracket::repeat(2, 1, 1, 1, 1, 1),
            Bracket::scope(1, 1, 1, 3),
            Bracket::scope(1, 2, 2, 0),
        ];
        let atoms = [Atom::new(2, 1), Atom::new(4, 2), Atom::new(5, 4)];
        let fsm = Fsm { brackets: &brackets, atoms: &atoms, termination: 5 };
        let mut passes = Passes::default();
        let mut counts = Vec::new();
        for (scope, atom) in [(2, 1), (4, 1), (4, 0), (2, 1), (4, 1), (4, 0)] {
            let transition = Transition { from: 1, scope, cause: Cause::Fired(1), atom: Some(atom), to: 1 };
            passes.step(fsm, &transition);
            counts.push((passes.of(1), passes.of(3)));
        }
        assert_eq!(counts, [(1, 1), (1, 2), (2, 2), (2, 1), (2, 2), (3, 2)]);
    }
}
