//! The tree of a plan file as it is written (language, section 3): every node with its span, nothing resolved.

use crate::diagnostic::Span;

/// Something with the place where it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spanned<T> {
    /// The thing.
    pub node: T,
    /// Its place.
    pub span: Span,
}

/// A name as written.
pub type Name = Spanned<String>;

/// A file: `{ use | plan }`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct File {
    /// The files it uses, as written between the quotes.
    pub uses: Vec<Name>,
    /// Its plans, in order.
    pub plans: Vec<Plan>,
}

/// A plan or a behavior: a closed string in braces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// The doc comment before it, its lines without the slashes.
    pub docs: Vec<String>,
    /// `Γ_from^to`, normalized: `Γ_`, then the text without braces and typesetting marks.
    pub label: Option<Name>,
    /// Its name.
    pub name: Name,
    /// Its parameters.
    pub params: Vec<Param>,
    /// Its interrupt; without one it has the null interrupt.
    pub condition: Option<Condition>,
    /// Its elements, in order.
    pub elements: Vec<Element>,
    /// From its label or brace to its closing brace.
    pub span: Span,
}

/// A parameter of a plan: `NAME ":" TYPE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its type as written, such as `speed` or `bits[4]`.
    pub type_name: Name,
}

/// An element of a string: `[ NAME ":" ] [ "FRAME" NUMBER ] primary [ "^" count ]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Its label, for `after`.
    pub label: Option<Name>,
    /// The angle that its frame is turned by.
    pub frame: Option<Number>,
    /// What it is.
    pub primary: Primary,
    /// How often it is run.
    pub power: Option<Count>,
    /// From its first token to its last.
    pub span: Span,
}

/// What an element is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Primary {
    /// `(Atom condition control)`.
    Atom {
        /// The atom's interrupt.
        condition: Condition,
        /// Its law.
        control: Call,
    },
    /// A behavior in place.
    Plan(Box<Plan>),
    /// A plan by name, with arguments if it takes some.
    Ref(Call),
    /// `ExecPlan n { … }` or `ExecPlan n Name`.
    Exec {
        /// How often.
        count: Count,
        /// The body; a plan by name is a single element.
        body: Vec<Element>,
    },
    /// An open string in parentheses.
    String(Vec<Element>),
    /// Formal notation `(s, ξ, T)`, and `(u, ξ, T)` where `u` is one call.
    Formal {
        /// The string, or a single [`Primary::Ref`] that may be a law.
        body: Vec<Element>,
        /// Its interrupt.
        condition: Condition,
        /// Its timer.
        time: Option<Arg>,
    },
    /// What could not be read; a diagnostic says why.
    Broken,
}

/// A condition: quarks joined by AND, OR and NOT.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// What it is.
    pub node: ConditionNode,
    /// Its place, parentheses included where they are its own.
    pub span: Span,
}

/// What a condition is; OR and AND hold two operands or more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConditionNode {
    /// At least one has fired.
    Or(Vec<Condition>),
    /// All have fired.
    And(Vec<Condition>),
    /// It has not fired.
    Not(Box<Condition>),
    /// It has fired, and once since the scope was entered it had not.
    Rising(Box<Condition>),
    /// An interrupt quark.
    Call(Call),
    /// A comparison of a signal.
    Comparison {
        /// The signal.
        left: Call,
        /// How it is compared.
        operator: Comparison,
        /// With what.
        right: Operand,
    },
    /// `null`: never fires.
    Null,
    /// `after LABEL [cause]`.
    After {
        /// The label of the element that has to have ended.
        label: Name,
        /// The operand that has to be the cause.
        cause: Option<Box<Condition>>,
    },
    /// What could not be read; a diagnostic says why.
    Broken,
}

/// The right side of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Operand {
    /// Another signal.
    Signal(Call),
    /// A value.
    Number(Number),
}

/// How a signal is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `==`, within the signal's tolerance.
    Equal,
    /// `<`.
    Less,
    /// `<=`, `≤`.
    LessOrEqual,
    /// `>`.
    Greater,
    /// `>=`, `≥`.
    GreaterOrEqual,
}

/// A name with its arguments: a quark, a signal or a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// The name.
    pub name: Name,
    /// The arguments, flattened: parentheses around several of them mean nothing.
    pub args: Vec<Arg>,
    /// From the name to the last argument or the closing parenthesis.
    pub span: Span,
}

/// An argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Arg {
    /// A number, or bits where these are asked for.
    Number(Number),
    /// `inf` and its other spellings.
    Infinity(Span),
    /// A string in quotes, without them.
    String(Name),
    /// A robot, a file, a parameter.
    Name(Name),
    /// `NAME module`.
    Module(Name),
}

impl Arg {
    /// Its place.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Number(number) => number.span,
            Self::Infinity(span) => *span,
            Self::String(name) | Self::Name(name) | Self::Module(name) => name.span,
        }
    }
}

/// A number as written: digits are kept, since `0100` may be four bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Number {
    /// Sign, digits, fraction and exponent as written.
    pub digits: String,
    /// The unit that touches it.
    pub unit: Option<String>,
    /// Its place, unit included.
    pub span: Span,
}

/// A loop count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Count {
    /// Digits as written.
    Number(Number),
    /// For ever.
    Infinity(Span),
    /// A parameter.
    Name(Name),
}

impl Count {
    /// Its place.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Number(number) => number.span,
            Self::Infinity(span) => *span,
            Self::Name(name) => name.span,
        }
    }
}
