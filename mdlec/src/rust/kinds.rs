//! The kinds of a plan's atoms: those of one kind mean the same but for the constants in it, and so can share code.

use std::collections::BTreeMap;

use mdle_runtime::Follows;

use super::tables::level;
use crate::fsm::Lowered;
use crate::plan::{Compared, Condition, Quark, QuarkId};

/// Atoms that mean the same but for their constants.
pub(super) struct Kind {
    /// Their numbers as written, from 0.
    pub(super) atoms: Vec<usize>,
}

/// A part of what an atom means, in the order in which an arm of code asks for it: the scopes around the atom inwards,
/// each with its condition and with what follows it, the law last. The plan's own scope is around all atoms, and no part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// A scope with an interrupt, or the atom's own.
    Scope {
        /// How many scopes are around it.
        level: u16,
    },
    /// Part of its condition.
    Null,
    /// Part of its condition.
    Quark(QuarkId),
    /// Part of its condition: the nanoseconds.
    Wait(u64),
    /// Part of its condition: an interval of time, whose ends follow.
    Elapsed,
    /// Part of its condition: an interval of the path driven, whose ends follow.
    Driven,
    /// Part of its condition: the nanometres.
    Way(u64),
    /// Part of its condition: the number of operands.
    Or(usize),
    /// Part of its condition: the number of operands.
    And(usize),
    /// Part of its condition.
    Not,
    /// What follows when the scope ends, if that is known.
    Follows(Option<Follows>),
    /// The law.
    Law(QuarkId),
    /// The angle by which the law's frame is turned.
    Frame(f64),
}

/// What atoms of one kind have in common in a part: all but its constant.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    Scope(u16),
    Null,
    Quark(u32),
    Wait,
    Elapsed,
    Driven,
    Way,
    Or(usize),
    And(usize),
    Not,
    Follows(Option<(u16, u16)>),
    Law(u32),
    Frame(bool),
}

/// What the atoms of a plan mean, part by part.
pub(super) struct Atoms<'l> {
    lowered: &'l Lowered,
    /// What follows each bracket.
    follows: Vec<Option<Follows>>,
    /// The declaration of each quark, as the number of the first quark that has it.
    declarations: Vec<u32>,
}

impl<'l> Atoms<'l> {
    pub(super) fn new(lowered: &'l Lowered) -> Self {
        let tables = lowered.tables();
        let follows = (0_u32..).zip(&lowered.brackets).map(|(number, _)| tables.follows(number)).collect();
        let mut known = BTreeMap::new();
        let declarations = (0_u32..).zip(&lowered.quarks);
        let declarations =
            declarations.map(|(id, quark)| *known.entry(declaration(quark, &lowered.quarks)).or_insert(id)).collect();
        Self { lowered, follows, declarations }
    }

    /// The atoms by kind, in order of first appearance; `None` if their arms, together, would have more than `most`
    /// parts, or an atom's row more than `widest`.
    pub(super) fn kinds(&self, most: usize, widest: usize) -> Option<Vec<Kind>> {
        let (mut kinds, mut known, mut size) = (Vec::<Kind>::new(), BTreeMap::new(), 0_usize);
        for atom in 0..self.lowered.atoms.len() {
            let parts = self.parts(atom, widest)?;
            let marks: Vec<_> = parts.iter().map(|part| self.mark(*part)).collect();
            let kind = *known.entry(marks).or_insert_with(|| {
                size = size.saturating_add(parts.len());
                kinds.push(Kind { atoms: Vec::new() });
                kinds.len() - 1
            });
            if size > most {
                return None;
            }
            kinds[kind].atoms.push(atom);
        }
        Some(kinds)
    }

    /// The parts of an atom; `None` if there are more than `most`.
    pub(super) fn parts(&self, atom: usize, most: usize) -> Option<Vec<Part>> {
        let law = &self.lowered.laws[atom];
        let mut parts = Vec::new();
        for bracket in self.scopes(atom).into_iter().rev() {
            let condition = self.condition(bracket);
            parts.push(Part::Scope { level: level(self.lowered.brackets[bracket as usize].kind) });
            conditions(condition, &mut parts);
            parts.push(Part::Follows(self.follows[bracket as usize]));
            if parts.len() > most {
                return None;
            }
        }
        parts.extend([Part::Law(law.quark), Part::Frame(self.lowered.turned(atom))]);
        Some(parts)
    }

    /// The scopes around an atom that can end, from its own outwards, without the plan's.
    pub(super) fn scopes(&self, atom: usize) -> Vec<u32> {
        let own = self.lowered.atoms[atom].scope;
        let completes = self.lowered.quark(self.lowered.laws[atom].quark).completes;
        let (mut scopes, mut here) = (Vec::new(), own);
        while here != 0 {
            if *self.condition(here) != Condition::Null || (here == own && completes) {
                scopes.push(here);
            }
            here = self.lowered.brackets[here as usize].parent;
        }
        scopes
    }

    /// The condition of a bracket.
    pub(super) fn condition(&self, bracket: u32) -> &'l Condition {
        let scope = self.lowered.scopes[bracket as usize].as_ref();
        scope.map_or(&Condition::Null, |scope| &scope.interrupt.condition)
    }

    /// What follows a bracket, if that is known.
    pub(super) fn follows(&self, bracket: u32) -> Option<Follows> {
        self.follows[bracket as usize]
    }

    fn mark(&self, part: Part) -> Mark {
        match part {
            Part::Scope { level } => Mark::Scope(level),
            Part::Null => Mark::Null,
            Part::Quark(QuarkId(id)) => Mark::Quark(self.declarations[id as usize]),
            Part::Wait(_) => Mark::Wait,
            Part::Elapsed => Mark::Elapsed,
            Part::Driven => Mark::Driven,
            Part::Way(_) => Mark::Way,
            Part::Or(count) => Mark::Or(count),
            Part::And(count) => Mark::And(count),
            Part::Not => Mark::Not,
            Part::Follows(follows) => Mark::Follows(follows.map(|follows| (follows.from, follows.to))),
            Part::Law(QuarkId(id)) => Mark::Law(self.declarations[id as usize]),
            Part::Frame(angle) => Mark::Frame(angle != 0.0),
        }
    }
}

/// The declarations that a quark is made of: one, or for a comparison those of its signals, of which a number has none.
fn declaration<'l>(quark: &'l Quark, quarks: &'l [Quark]) -> Vec<Option<(&'l str, usize)>> {
    let of = |quark: &'l Quark| Some((quark.name.as_str(), quark.overload));
    let Some(comparison) = &quark.comparison else { return vec![of(quark)] };
    let with = match comparison.with {
        Compared::Signal(other) => of(&quarks[other.0 as usize]),
        Compared::Value(_) => None,
    };
    vec![of(&quarks[comparison.signal.0 as usize]), with]
}

/// The parts of a condition, each operator before its operands.
fn conditions(condition: &Condition, parts: &mut Vec<Part>) {
    match condition {
        // A plan with these is rows.
        Condition::Null | Condition::Rising { .. } | Condition::After(_) => parts.push(Part::Null),
        Condition::Quark(id) => parts.push(Part::Quark(*id)),
        Condition::Wait { nanos, .. } => parts.push(Part::Wait(*nanos)),
        Condition::Elapsed { from, until, .. } => {
            parts.extend([Part::Elapsed, Part::Wait(*from), Part::Wait(until.unwrap_or(u64::MAX))]);
        }
        Condition::Driven { from, until, .. } => {
            parts.extend([Part::Driven, Part::Way(*from), Part::Way(until.unwrap_or(u64::MAX))]);
        }
        Condition::Or(operands) | Condition::And(operands) => {
            let count = operands.len();
            parts.push(if matches!(condition, Condition::Or(_)) { Part::Or(count) } else { Part::And(count) });
            operands.iter().for_each(|operand| conditions(operand, parts));
        }
        Condition::Not(operand) => {
            parts.push(Part::Not);
            conditions(operand, parts);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Atoms;
    use crate::samples::compiled;

    fn kinds(body: &str) -> Vec<Vec<usize>> {
        let compiled = compiled(&format!("{{ P {body} (Atom (wait 1) stop) }}"));
        let kinds = Atoms::new(&compiled[0].lowered).kinds(usize::MAX, usize::MAX).unwrap_or_default();
        kinds.into_iter().map(|kind| kind.atoms).collect()
    }

    #[test]
    fn operands_tell_kinds_apart() {
        let one = |condition: &str| format!("(Atom ({condition}) turn 10)");
        let apart = |conditions: [&str; 2]| kinds(&conditions.map(one).concat()).len() == 3;
        assert!(apart(["wait 1 OR bumper", "wait 1 OR wait 2"]));
        assert!(apart(["wait 1 OR bumper", "wait 1 AND bumper"]));
        assert!(apart(["NOT bumper", "NOT wait 1"]));
        assert!(apart(["t < 2", "bumper"]));
        assert!(!apart(["wait 1 OR bumper", "wait 2 OR bumper"]));
    }

    #[test]
    fn levels_tell_kinds_apart_where_what_follows_is_not_known() {
        let one = "(Atom (bumper) turn 10)";
        assert_eq!(kinds(&format!("ExecPlan 2 {{ {one} }} ExecPlan 2 {{ {{ Q {one} }} }}")), [[0], [1], [2]]);
    }

    #[test]
    fn scopes_that_cannot_end_are_no_parts() {
        let compiled = compiled(
            "{ P { Q (Atom (null) rotate 90) } { R (bumper) { S (Atom (wait 1) stop) } } { T (Atom (null) stop) } }",
        );
        let atoms = Atoms::new(&compiled[0].lowered);
        let own = |atom: usize| compiled[0].lowered.atoms[atom].scope;
        let around = |bracket: u32| compiled[0].lowered.brackets[bracket as usize].parent;
        // A law that completes ends its own scope, and none around it.
        assert_eq!(atoms.scopes(0), [own(0)]);
        assert_eq!(atoms.scopes(1), [own(1), around(around(own(1)))]);
        assert!(atoms.scopes(2).is_empty());
    }

    #[test]
    fn too_many_parts_are_refused() {
        let compiled = compiled("{ P (Atom (wait 1) turn 10) (Atom (wait 1 OR bumper) turn 10) }");
        let atoms = Atoms::new(&compiled[0].lowered);
        // Scope, condition and what follows; then the law and its frame.
        let (narrow, wide) = (3, 5);
        assert!(atoms.parts(0, narrow).is_some() && atoms.parts(0, narrow - 1).is_none());
        assert!(atoms.kinds(usize::MAX, wide).is_some() && atoms.kinds(usize::MAX, wide - 1).is_none());
        let all = narrow + wide + 2 * 2;
        assert!(atoms.kinds(all, usize::MAX).is_some() && atoms.kinds(all - 1, usize::MAX).is_none());
    }

    #[test]
    fn atoms_that_differ_in_more_than_constants_are_of_different_kinds() {
        let alike = "(Atom (wait 1) turn 10) (Atom (wait 2) turn 20)";
        assert_eq!(kinds(alike), [vec![0, 1], vec![2]]);
        let one = "(Atom (wait 1) turn 10)";
        for other in [
            "FRAME 90deg (Atom (wait 1) turn 10)",
            "(Atom (wait 1) rotate 10)",
            "(Atom (bumper) turn 10)",
            "(Atom (NOT wait 1) turn 10)",
            "(Atom (wait 1 OR bumper) turn 10)",
            "{ Q (bumper) (Atom (wait 1) turn 10) (Atom (wait 1) turn 10) }",
        ] {
            assert!(
                !kinds(&format!("{one} {other}")).iter().any(|kind| kind.contains(&0) && kind.len() > 1),
                "{other}"
            );
        }
        // What follows is a constant, but whether it is known beforehand is not.
        assert_eq!(kinds(&format!("{one} {one} ExecPlan 2 {{ {one} }}")), [vec![0], vec![1, 2], vec![3]]);
    }
}
