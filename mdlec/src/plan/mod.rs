//! A plan with everything resolved: names, arguments, units, plans by name (paper, Definition 2).
//!
//! After this stage no string is looked up again: a quark is an id, an argument its exact decimal, its unit and its SI value.

mod angle;
mod arguments;
mod comparisons;
mod condition;
mod conditions;
mod definitions;
pub(crate) mod families;
mod formal;
mod functions;
mod labels;
pub mod lints;
mod nondegenerate;
mod parameters;
mod print;
mod quarks;
mod resolve;
mod size;
#[cfg(test)]
mod tests;
pub(crate) mod untyped;
mod words;

pub use crate::syntax::tree::Comparison as Operator;
pub use angle::{HERE, frame_text, in_degrees};
pub use arguments::signature;
pub use comparisons::{is_time, is_way};
pub use condition::{After, Condition, Situation};
pub use conditions::condition_text;
pub use functions::{Function, Functions};
pub use nondegenerate::{Nondegenerate, remove_degeneracy};
pub use resolve::resolve;
pub(crate) use words::Words;

use std::num::NonZeroU32;

use crate::alphabet::{Decimal, Kind};
use crate::diagnostic::Span;

/// A plan: the outermost scope and the quarks that it and everything in it use.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The outermost scope, with the plan's name.
    pub root: Scope,
    /// Every quark with its arguments, once each, in order of first appearance.
    pub quarks: Vec<Quark>,
}

impl Plan {
    /// The quark of an id.
    #[must_use]
    pub fn quark(&self, id: QuarkId) -> &Quark {
        &self.quarks[id.0 as usize]
    }

    /// Returns the texts of the operands of `interrupt` that have fired.
    pub(crate) fn operands_fired(&self, interrupt: &Interrupt, at: &impl Situation) -> Vec<String> {
        let parts = interrupt.condition.joined().into_iter().enumerate().filter(|(_, part)| part.fired(at));
        parts.map(|(number, part)| interrupt.operand_text(number, part, &|id| self.quark(id).text.clone())).collect()
    }
}

/// A quark with its arguments, among [`Plan::quarks`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct QuarkId(pub u32);

/// A quark with its arguments.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quark {
    /// Its name in the alphabet.
    pub name: String,
    /// Which of the declarations of this name it is, from 0, in the alphabet's order.
    pub overload: usize,
    /// Its arguments, defaults filled in.
    pub args: Vec<Value>,
    /// For a law: whether it can be done by itself.
    pub completes: bool,
    /// Whether it has a memory of its own, so that it is never the same function in two scopes.
    pub remembers: bool,
    /// For a comparison of signals: what it compares. Its name is then the operator.
    pub comparison: Option<Comparison>,
    /// Quark text of the quark (docs/src/reference/language.md, 7).
    pub text: String,
}

/// A comparison of a signal: an interrupt quark that has fired while it holds.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Comparison {
    /// The signal.
    pub signal: QuarkId,
    /// How it is compared.
    pub operator: Operator,
    /// With what.
    pub with: Compared,
    /// How far apart equal values may be.
    pub tolerance: Value,
}

/// What a signal is compared with.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compared {
    /// Another signal, of the same kind.
    Signal(QuarkId),
    /// A value of its kind.
    Value(Value),
}

/// An argument; equal arguments are the same to the last digit.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Value {
    /// A number of some kind.
    Quantity {
        /// What it measures.
        kind: Kind,
        /// Its exact value in the unit of its family.
        exact: Decimal,
        /// That unit: degrees and radians are two families. Empty for a number without a unit.
        family: &'static str,
    },
    /// For ever: a time or a count.
    Infinity(Kind),
    /// Bits, the one written first first.
    Bits(Vec<bool>),
    /// A whole number.
    Integer(i64),
    /// A sonar, 0 to 15.
    Sonar(u8),
    /// A robot, a module or a file.
    Name(Kind, String),
}

/// A closed string: a sequence with an interrupt of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    /// Its name; empty for a scope in formal notation.
    pub name: String,
    /// Its interrupt.
    pub interrupt: Interrupt,
    /// What it runs, in order; never empty.
    pub body: Vec<Node>,
    /// `true` if the frame is the robot's heading at the moment of the entry: `FRAME here`.
    pub here: bool,
    /// For the outermost scope of a plan in which `after` stands: the record of this use of it.
    pub record: Option<Record>,
    /// The labels of what ends with it.
    pub marks: Vec<Mark>,
    /// Where its definition is.
    pub span: Span,
}

/// What stands in a sequence.
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// An atom.
    Atom(Atom),
    /// A behavior.
    Scope(Scope),
    /// A string that is run several times.
    Loop(Loop),
}

/// An atom: a law that runs until its interrupt fires or it is done.
#[derive(Debug, Clone, PartialEq)]
pub struct Atom {
    /// Its law.
    pub law: QuarkId,
    /// Its interrupt.
    pub interrupt: Interrupt,
    /// The angle by which its frame is turned, in radians, counter-clockwise; from the innermost `FRAME here` on, if there
    /// is one.
    pub frame: f64,
    /// `true` if the frame is the robot's heading at the moment of the entry: `FRAME here`.
    pub here: bool,
    /// The labels of what ends with it.
    pub marks: Vec<Mark>,
    /// Where it is.
    pub span: Span,
}

/// A loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// The number of passes, at least 1; `None` is for ever.
    pub times: Option<u64>,
    /// What it runs, in order; never empty.
    pub body: Vec<Node>,
    /// The labels of what ends with its last pass.
    pub marks: Vec<Mark>,
    /// Where it is.
    pub span: Span,
}

impl Node {
    /// The labels of what ends with it.
    pub(crate) fn marks_mut(&mut self) -> &mut Vec<Mark> {
        match self {
            Self::Atom(atom) => &mut atom.marks,
            Self::Scope(scope) => &mut scope.marks,
            Self::Loop(repeated) => &mut repeated.marks,
        }
    }
}

/// One use of the definition of a plan, whose record `after` asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RecordId(pub u32);

/// The record of labelled elements that ended last, in one use of a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Record {
    /// Which use.
    pub id: RecordId,
    /// How many different things `after` asks of it.
    pub facts: u32,
}

/// A label of what ends with a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// The use of the definition that the label stands in.
    pub record: RecordId,
    /// The label.
    pub label: String,
    /// What `after` asks about it.
    pub facts: Vec<Fact>,
}

/// Something that `after` asks of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fact {
    /// Its number in the record.
    pub number: u32,
    /// The operand of the node's interrupt that has to be the cause; none if any cause will do.
    pub operand: Option<u32>,
}

impl Fact {
    /// Whether it is so once the node has ended by this operand of its interrupt, or by something else.
    #[must_use]
    pub fn holds(&self, operand: Option<u32>) -> bool {
        self.operand.is_none() || self.operand == operand
    }
}

/// The interrupt of a scope.
#[derive(Debug, Clone, PartialEq)]
pub struct Interrupt {
    /// What it waits for.
    pub condition: Condition,
    /// Its condition text, also where it was removed.
    pub text: String,
    /// Condition text with parentheses around each OR that is directly in an OR; `None` without such an OR.
    pub nested: Option<Box<str>>,
    /// The places of its operands: of the [joined](Condition::joined) parts of its condition.
    pub operands: Box<[OperandPlace]>,
    /// How many memories of RISING it has in each scope entered.
    pub memories: u32,
    /// Whether an outer scope repeats it, so that it was replaced by the null interrupt.
    pub removed: bool,
    /// Where it is; the scope's own place if it has none.
    pub span: Span,
}

impl Interrupt {
    /// The interrupt of a scope at `scope` that has none: it never fires.
    #[must_use]
    pub fn none(scope: Span) -> Self {
        let operands = Box::default();
        Self {
            condition: Condition::Null,
            text: "null".into(),
            nested: None,
            operands,
            memories: 0,
            removed: false,
            span: scope,
        }
    }

    /// Returns the condition text of its operand of this number, the [joined](Condition::joined) part `part`, by the texts
    /// of the quarks.
    pub fn operand_text(&self, number: usize, part: &Condition, quark: &impl Fn(QuarkId) -> String) -> String {
        let own = self.operands.get(number).and_then(|operand| operand.text.as_deref());
        own.map_or_else(|| condition_text(part, quark), String::clone)
    }
}

/// The place of an operand as it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OperandPlace {
    /// From its first word to its last.
    pub span: Span,
    /// The ends of the signals that it compares, if it is a comparison, or NOT or RISING of one.
    pub signals: [Option<NonZeroU32>; 2],
    /// Condition text of the operand where the condition has another one, as after a `wait inf` has become null. It is boxed
    /// because most operands have none.
    pub text: Option<Box<String>>,
}
