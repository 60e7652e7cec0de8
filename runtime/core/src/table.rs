//! Tables of a plan: its conditions and laws as values instead of code.
//!
//! `mdlec` emits tables for plans that are too long for inline code, and a plan loaded at run time owns its tables. A
//! row takes rustc almost no time, and a turn reads one row for each scope that encloses the current atom.

use crate::{Alphabet, Condition, Fact, Follows, Fsm, MarkRow, Meeting, ModuleRead, Radians, Source, TextList, Words};

/// The tables of a plan: [`Rows`] of constants, or tables that a loaded plan owns.
pub trait Table {
    /// Alphabet of the robot.
    type Alphabet: Alphabet;

    /// Returns the machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// Returns the condition that ends each bracket and the successor of the bracket, in the order of the brackets.
    fn guards(&self) -> &[Guard<<Self::Alphabet as Alphabet>::Interrupt>];
    /// Returns the operands of conditions. The operands of an operand come after it in this list, so operands cannot
    /// form a cycle.
    fn operands(&self) -> &[Condition<<Self::Alphabet as Alphabet>::Interrupt>];
    /// Returns the law of each atom, in the order of the atoms.
    fn laws(&self) -> &[LawRow<<Self::Alphabet as Alphabet>::Control>];
    /// Returns the labels of the elements that end with each bracket, in the order of the brackets.
    fn marks(&self) -> &[MarkRow];
    /// Returns the facts of all labels, which `after` reads.
    fn facts(&self) -> &[Fact];
    /// Returns the quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// Returns the condition text of a bracket.
    fn condition(&self, scope: u32) -> &str;
    /// Returns the name of a bracket.
    fn name(&self, scope: u32) -> &str;
    /// Returns the plan's source text for reports.
    fn source(&self) -> &dyn Words;
    /// Returns the names of the paths that the plan's laws replay.
    fn paths(&self) -> &[&'static str];

    /// Returns the attributes of modules that the plan reads.
    fn reads(&self) -> &'static [ModuleRead] {
        &[]
    }

    /// Returns the names of the other robots whose states the plan reads over the state link.
    fn robots(&self) -> &[&'static str] {
        &[]
    }

    /// Returns the scopes that wait for other robots with `rendezvous`, in order.
    fn meetings(&self) -> &[Meeting] {
        &[]
    }
}

/// Tables of a plan: its machine, conditions, laws, labels and texts.
pub struct Rows<'a, A: Alphabet> {
    /// The machine's tables.
    pub fsm: Fsm<'a>,
    /// Condition that ends each bracket, in the order of the brackets.
    pub guards: &'a [Guard<A::Interrupt>],
    /// The operands of conditions. The operands of an operand come after it in this list, so operands cannot form a
    /// cycle.
    pub operands: &'a [Condition<A::Interrupt>],
    /// Law of each atom, in the order of the atoms.
    pub laws: &'a [LawRow<A::Control>],
    /// The labels of the elements that end with each bracket, in the order of the brackets.
    pub marks: &'a [MarkRow],
    /// The facts of all labels, which `after` reads.
    pub facts: &'a [Fact],
    /// Texts of the plan, for traces and messages.
    pub texts: Texts<'a>,
}

impl<A: Alphabet> Table for &Rows<'_, A> {
    type Alphabet = A;

    #[inline(always)]
    fn fsm(&self) -> Fsm<'_> {
        self.fsm
    }

    #[inline(always)]
    fn guards(&self) -> &[Guard<A::Interrupt>] {
        self.guards
    }

    #[inline(always)]
    fn operands(&self) -> &[Condition<A::Interrupt>] {
        self.operands
    }

    #[inline(always)]
    fn laws(&self) -> &[LawRow<A::Control>] {
        self.laws
    }

    #[inline(always)]
    fn marks(&self) -> &[MarkRow] {
        self.marks
    }

    #[inline(always)]
    fn facts(&self) -> &[Fact] {
        self.facts
    }

    fn law(&self, atom: u32) -> &str {
        self.texts.laws.text(atom)
    }

    fn condition(&self, scope: u32) -> &str {
        self.texts.conditions.text(scope)
    }

    fn name(&self, scope: u32) -> &str {
        self.texts.names.text(scope)
    }

    fn source(&self) -> &dyn Words {
        &self.texts.source
    }

    fn paths(&self) -> &[&'static str] {
        self.texts.paths
    }
}

/// Condition that ends a scope, and the scope's successor. A loop has a row that never fires.
#[derive(Debug)]
pub struct Guard<I> {
    /// Condition of the scope's interrupt.
    pub condition: Condition<I>,
    /// Number of enclosing scopes.
    pub level: u16,
    /// Number of the nearest enclosing bracket whose condition can fire; the bracket's own number if there is
    /// none.
    pub around: u32,
    /// Successor of the scope, if it is known before the plan runs ([`Fsm::follows`]).
    pub follows: Option<Follows>,
}

/// The law of an atom, and the angle by which its frame is turned.
#[derive(Debug)]
pub struct LawRow<C> {
    /// The law with its arguments.
    pub control: C,
    /// Angle by which the atom's frame is turned, counter-clockwise.
    pub frame: Radians,
}

/// The texts of a plan; empty for a plan without texts.
#[derive(Debug)]
pub struct Texts<'a> {
    /// The quark text of each atom's law.
    pub laws: TextList<'a>,
    /// The condition text of each bracket.
    pub conditions: TextList<'a>,
    /// The name of each bracket.
    pub names: TextList<'a>,
    /// The plan's source text for reports.
    pub source: Source<'a>,
    /// The names of the paths that the plan's laws replay.
    pub paths: &'a [&'static str],
}

impl Texts<'_> {
    /// Empty texts.
    pub const NONE: Self = Self {
        laws: TextList::NONE,
        conditions: TextList::NONE,
        names: TextList::NONE,
        source: Source::NONE,
        paths: &[],
    };
}
