//! Resolved plans: names, arguments and units are resolved, and plans used by name are copied in (paper, Definition 2).
//!
//! Later stages refer to a quark by its id instead of its text. Arguments have their exact decimal values and their
//! unit families.

mod angle;
mod arguments;
mod compared_timer;
mod comparisons;
mod condition;
mod definitions;
pub(crate) mod families;
mod formal;
mod functions;
mod labels;
pub mod lints;
mod moves;
mod nondegenerate;
mod parameters;
mod plan_arguments;
mod print;
mod quarks;
mod resolve;
mod resolve_conditions;
mod size;
#[cfg(test)]
mod tests;
pub(crate) mod untyped;
mod walk;
mod words;

pub use crate::syntax::tree::Comparison as Operator;
pub use angle::{HERE, frame_text, in_degrees};
pub use arguments::signature;
pub use comparisons::{is_time, is_way};
pub use condition::{After, Condition, Situation};
pub use functions::{Function, Functions};
pub use nondegenerate::{Nondegenerate, remove_degeneracy};
pub use resolve::{resolve, roots};
pub use resolve_conditions::condition_text;
pub use size::Bounds;
pub use walk::{PlanPart, Visit, Walk};
pub(crate) use words::Words;

use std::num::NonZeroU32;

use crate::alphabet::{Decimal, ParameterKind, Unit, family_to_si};
use crate::diagnostic::Span;

/// A plan: the outermost scope, and the quarks used anywhere in the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The outermost scope, with the plan's name.
    pub root: Scope,
    /// All quarks with their arguments, in order of first appearance; each quark is listed once.
    pub quarks: Vec<Quark>,
}

impl Plan {
    /// Returns the quark with this id.
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

/// Index in [`Plan::quarks`] of a quark with its arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct QuarkId(pub u32);

/// A quark with its arguments.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quark {
    /// Name of the quark in the alphabet; for a comparison, the operator.
    pub name: String,
    /// Index of the quark's declaration among the declarations with the same name, in the order of the alphabet.
    pub overload: usize,
    /// Arguments of the quark, including defaults.
    pub args: Vec<Value>,
    /// `true` for a law that can complete by itself.
    pub completes: bool,
    /// `true` if the quark has a memory; it is then never the same function in two scopes.
    pub remembers: bool,
    /// `true` for an interrupt that fires in one turn for at most one value of its arguments.
    pub exclusive: bool,
    /// The parts of a comparison of signals; `None` for any other quark.
    pub comparison: Option<Comparison>,
    /// Text of the quark (docs/src/reference/language.md, 7).
    pub text: String,
}

/// A comparison of a signal: an interrupt quark that fires while the comparison is true.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Comparison {
    /// Signal on the left-hand side.
    pub signal: QuarkId,
    /// Unit of the signal, which is also the unit of values in texts.
    pub unit: Unit,
    /// Operator of the comparison.
    pub operator: Operator,
    /// Right-hand side of the comparison.
    pub with: Compared,
    /// Maximum difference between two values that are treated as equal.
    pub tolerance: Value,
}

/// Right-hand side of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compared {
    /// Another signal of the same kind.
    Signal(QuarkId),
    /// A value of the signal's kind.
    Value(Value),
}

/// The value of an argument. Values are compared exactly, in all digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Value {
    /// A number with a kind.
    Quantity {
        /// Kind of the quantity.
        kind: ParameterKind,
        /// Exact value in the unit of its family.
        exact: Decimal,
        /// Unit family of the value; empty for a number without a unit. Degrees and radians are different families.
        family: &'static str,
    },
    /// The value `inf` of a time or a count.
    Infinity(ParameterKind),
    /// Bits in the order of the text, as in `atIsection 0100`.
    Bits(Vec<bool>),
    /// A whole number.
    Integer(i64),
    /// Number of a sonar, 0 to 15.
    Sonar(u8),
    /// Name of a robot, a module or a file.
    Name(ParameterKind, String),
}

impl Value {
    /// Returns the value of a quantity in SI units, which are used to compare signals; `f64::MAX` for `inf`, and 0 for
    /// a value of any other kind.
    #[must_use]
    pub fn in_si(&self) -> f64 {
        match self {
            Self::Quantity { exact, family, .. } => exact.to_f64() * family_to_si(family),
            Self::Infinity(_) => f64::MAX,
            Self::Bits(_) | Self::Integer(_) | Self::Sonar(_) | Self::Name(..) => 0.0,
        }
    }
}

/// A scope, which the paper calls a closed string: a sequence of elements that has its own interrupt.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    /// Name of the scope; empty in formal notation.
    pub name: String,
    /// Interrupt of the scope.
    pub interrupt: Interrupt,
    /// Elements of the scope, in order; never empty.
    pub body: Vec<Node>,
    /// `true` if the scope has `FRAME here`: its frame is then the robot's heading at the time of entry.
    pub here: bool,
    /// Record of the labelled elements that ended last, if this is the outermost scope of a plan that uses `after`;
    /// `None` for any other scope.
    pub record: Option<Record>,
    /// Labels of the elements that end together with the scope.
    pub marks: Vec<Mark>,
    /// Span of the scope's definition.
    pub span: Span,
}

/// An element of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// An atom.
    Atom(Atom),
    /// A behavior.
    Scope(Scope),
    /// A loop: a string that runs several times.
    Loop(Loop),
}

/// An atom: a law that runs until its interrupt fires or the law completes.
#[derive(Debug, Clone, PartialEq)]
pub struct Atom {
    /// Law of the atom.
    pub law: QuarkId,
    /// Interrupt of the atom.
    pub interrupt: Interrupt,
    /// Angle, in radians, by which the atom's frame is turned counter-clockwise. It is relative to the innermost
    /// enclosing `FRAME here`; if there is none, it is relative to the plan's frame.
    pub frame: f64,
    /// `true` if the atom has `FRAME here`: its frame is then the robot's heading at the time of entry.
    pub here: bool,
    /// Labels of the elements that end together with the atom.
    pub marks: Vec<Mark>,
    /// Span of the atom.
    pub span: Span,
}

/// A loop: a sequence, and the number of its passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Number of passes, at least 1; `None` for an endless loop.
    pub times: Option<u64>,
    /// Elements of a pass, in order; never empty.
    pub body: Vec<Node>,
    /// Labels of the elements that end together with the loop's last pass.
    pub marks: Vec<Mark>,
    /// Span of the loop.
    pub span: Span,
}

impl Node {
    /// Returns the labels of the elements that end together with the node, so that they can be changed.
    pub(crate) fn marks_mut(&mut self) -> &mut Vec<Mark> {
        match self {
            Self::Atom(atom) => &mut atom.marks,
            Self::Scope(scope) => &mut scope.marks,
            Self::Loop(repeated) => &mut repeated.marks,
        }
    }
}

/// Identifier of a record, which belongs to one use of a plan's definition; `after` reads it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RecordId(pub u32);

/// Record of the labelled elements that ended last, in one use of a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Record {
    /// Identifier of the record.
    pub id: RecordId,
    /// Number of different facts that `after` conditions read from the record.
    pub facts: u32,
}

/// A label of an element that ends together with a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Record of the use of the definition that contains the label.
    pub record: RecordId,
    /// Text of the label.
    pub label: String,
    /// Facts about the label that `after` conditions read.
    pub facts: Vec<Fact>,
}

/// A fact that an `after` condition reads from a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fact {
    /// Index of the fact in the record.
    pub number: u32,
    /// Index of the operand, in the node's interrupt, that must be the cause; `None` if any cause is accepted.
    pub operand: Option<u32>,
}

impl Fact {
    /// Returns `true` if the fact is true after the node has ended by `operand` of its interrupt; `None` means another
    /// cause.
    #[must_use]
    pub fn holds(&self, operand: Option<u32>) -> bool {
        self.operand.is_none() || self.operand == operand
    }
}

/// The interrupt of a scope or an atom.
#[derive(Debug, Clone, PartialEq)]
pub struct Interrupt {
    /// Condition that fires the interrupt.
    pub condition: Condition,
    /// Text of the condition. It is kept even if the condition was removed.
    pub text: String,
    /// Text of the condition with parentheses around each OR that is an operand of another OR; `None` if there is no
    /// such OR.
    pub nested: Option<Box<str>>,
    /// Positions of the operands, which are the [joined](Condition::joined) parts of the condition.
    pub operands: Box<[OperandPlace]>,
    /// Number of memories that the RISINGs of the condition need in each entered scope.
    pub memories: u32,
    /// `true` if the interrupt was replaced by the null interrupt, because an outer scope repeats it.
    pub removed: bool,
    /// Span of the interrupt; the span of the scope or atom if there is no interrupt.
    pub span: Span,
}

impl Interrupt {
    /// Returns the interrupt of a scope without a condition, which never fires; `scope` is the span of the scope.
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

    /// Returns the condition text of operand `number`, given its [joined](Condition::joined) part `part` and
    /// the texts of the quarks.
    pub fn operand_text(&self, number: usize, part: &Condition, quark: &impl Fn(QuarkId) -> String) -> String {
        let own = self.operands.get(number).and_then(|operand| operand.text.as_deref());
        own.map_or_else(|| condition_text(part, quark), String::clone)
    }
}

/// Position of an operand in the text of the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OperandPlace {
    /// Span from the operand's first word to its last.
    pub span: Span,
    /// Offsets of the ends of the compared signals, if the operand is a comparison, or a NOT or RISING of a comparison.
    pub signals: [Option<NonZeroU32>; 2],
    /// Text of the operand if it differs from the text of its condition, for example after a `wait inf` has
    /// become null. It is boxed because most operands have no such text.
    pub text: Option<Box<String>>,
}
