//! A plan with everything resolved: names, arguments, units, plans by name (paper, Definition 2).
//!
//! After this stage no string is looked up again: a quark is an id, an argument its exact decimal, its unit and its SI value.

mod angle;
mod arguments;
mod comparisons;
mod conditions;
mod definitions;
mod nondegenerate;
mod parameters;
mod print;
mod quarks;
mod resolve;
#[cfg(test)]
mod tests;

pub use crate::syntax::tree::Comparison as Operator;
pub use angle::{frame_text, in_degrees};
pub use arguments::signature;
pub use nondegenerate::{Nondegenerate, remove_degeneracy};
pub use resolve::resolve;

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
    /// Its quark text (language, section 7).
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
    /// The angle by which its frame is turned, in radians, counter-clockwise.
    pub frame: f64,
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
    /// Where it is.
    pub span: Span,
}

/// The interrupt of a scope.
#[derive(Debug, Clone, PartialEq)]
pub struct Interrupt {
    /// What it waits for.
    pub condition: Condition,
    /// Its condition text, also where it was removed.
    pub text: String,
    /// Whether an outer scope repeats it, so that it was replaced by the null interrupt.
    pub removed: bool,
    /// Where it is; the scope's own place if it has none.
    pub span: Span,
}

impl Interrupt {
    /// The interrupt of a scope at `scope` that has none: it never fires.
    #[must_use]
    pub fn none(scope: Span) -> Self {
        Self { condition: Condition::Null, text: "null".into(), removed: false, span: scope }
    }
}

/// A condition; `true` is "has fired".
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// Never fires: `null`, `wait inf`, or what degeneracy removal left.
    Null,
    /// An interrupt quark.
    Quark(QuarkId),
    /// Fires once this many nanoseconds have passed since the scope of the interrupt was entered.
    Wait {
        /// The nanoseconds.
        nanos: u64,
        /// The quark, for its text and its exact value.
        quark: QuarkId,
    },
    /// Fires while the time since the scope of the interrupt was entered is in this interval: a comparison of `t`.
    Elapsed {
        /// From so many nanoseconds on ...
        from: u64,
        /// ... and until so many have passed.
        until: Option<u64>,
        /// The comparison, for its text.
        quark: QuarkId,
    },
    /// At least one of these, two or more.
    Or(Vec<Condition>),
    /// All of these, two or more.
    And(Vec<Condition>),
    /// Not this.
    Not(Box<Condition>),
}

impl Condition {
    /// Whether it has a `wait` in it, and so asks when its scope was entered.
    #[must_use]
    pub fn waits(&self) -> bool {
        match self {
            Self::Null | Self::Quark(_) => false,
            Self::Wait { .. } | Self::Elapsed { .. } => true,
            Self::Or(operands) | Self::And(operands) => operands.iter().any(Self::waits),
            Self::Not(operand) => operand.waits(),
        }
    }

    /// Whether this is so of the condition or any of its operands.
    pub fn any(&self, is_so: &impl Fn(&Self) -> bool) -> bool {
        is_so(self)
            || match self {
                Self::Null | Self::Quark(_) | Self::Wait { .. } | Self::Elapsed { .. } => false,
                Self::Or(operands) | Self::And(operands) => operands.iter().any(|operand| operand.any(is_so)),
                Self::Not(operand) => operand.any(is_so),
            }
    }

    /// Its value, given what each quark says and whether a `wait` of so many nanoseconds is over. Reads every operand.
    pub fn fired(&self, quark: &impl Fn(QuarkId) -> bool, wait: &impl Fn(u64) -> bool) -> bool {
        match self {
            Self::Null => false,
            Self::Quark(id) => quark(*id),
            Self::Wait { nanos, .. } => wait(*nanos),
            Self::Elapsed { from, until, .. } => wait(*from) & !until.is_some_and(wait),
            Self::Or(operands) => operands.iter().fold(false, |fired, operand| fired | operand.fired(quark, wait)),
            Self::And(operands) => operands.iter().fold(true, |fired, operand| fired & operand.fired(quark, wait)),
            Self::Not(operand) => !operand.fired(quark, wait),
        }
    }
}
