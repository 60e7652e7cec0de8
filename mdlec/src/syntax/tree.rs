//! The tree of a plan file as it is written (docs/src/reference/language.md, 3): every node with its span, nothing
//! resolved.
//!
//! What is written is borrowed from the text, and the nodes stand in an arena, each once, where it stays: a parser that allocates
//! and copies them spends most of its time on that.

use crate::diagnostic::Span;

/// Something with the place where it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spanned<T> {
    /// The thing.
    pub node: T,
    /// Its place.
    pub span: Span,
}

/// A name as written.
pub type Name<'s> = Spanned<&'s str>;

/// A file: `{ use | plan }`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct File<'s> {
    /// The files it uses, as written between the quotes.
    pub uses: Vec<Name<'s>>,
    /// Its plans, in order.
    pub plans: Vec<Plan<'s>>,
    /// Whether a plan is left out, since its head could not be read.
    pub is_incomplete: bool,
}

/// A plan or a behavior: a closed string in braces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan<'s> {
    /// The doc comment before it, its lines without the slashes.
    pub docs: &'s [&'s str],
    /// `Γ_from^to`, normalized: `Γ_`, then the text without braces and typesetting marks.
    pub label: Option<Name<'s>>,
    /// Its name.
    pub name: Name<'s>,
    /// Its parameters.
    pub params: &'s [Param<'s>],
    /// Its interrupt; without one it has the null interrupt.
    pub condition: Option<Condition<'s>>,
    /// Its elements, in order.
    pub elements: &'s [Element<'s>],
    /// From its label or brace to its closing brace.
    pub span: Span,
}

/// A parameter of a plan: `NAME ":" TYPE`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Param<'s> {
    /// Its name.
    pub name: Name<'s>,
    /// Its type as written, such as `speed` or `bits[4]`.
    pub type_name: Name<'s>,
}

/// An element of a string: `[ NAME ":" ] [ frame ] primary [ "^" count ]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Element<'s> {
    /// What it is.
    pub primary: Primary<'s>,
    /// What stands before and behind that; most elements have nothing there.
    pub marks: Option<&'s Marks<'s>>,
    /// From its first token to its last.
    pub span: Span,
}

/// What an element may have besides what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Marks<'s> {
    /// Its label, for `after`.
    pub label: Option<Name<'s>>,
    /// Frame of the element.
    pub frame: Option<Frame<'s>>,
    /// How often it is run.
    pub power: Option<Count<'s>>,
}

impl<'s> Element<'s> {
    /// Its label, for `after`.
    #[must_use]
    pub fn label(&self) -> Option<Name<'s>> {
        self.marks?.label
    }

    /// Frame of the element.
    #[must_use]
    pub fn frame(&self) -> Option<&'s Frame<'s>> {
        self.marks?.frame.as_ref()
    }

    /// How often it is run.
    #[must_use]
    pub fn power(&self) -> Option<&'s Count<'s>> {
        self.marks?.power.as_ref()
    }
}

/// The frame of an element: `"FRAME" ( NUMBER | "here" )`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame<'s> {
    /// The frame around it, turned by this angle.
    Turned(Number<'s>),
    /// The heading of the robot at the moment the element is entered.
    Here,
}

/// What an element is: a reference, so that a list of elements is short.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Primary<'s> {
    /// `(Atom condition control)`.
    Atom(&'s Atom<'s>),
    /// A behavior in place.
    Plan(&'s Plan<'s>),
    /// A plan by name, with arguments if it takes some.
    Ref(&'s Call<'s>),
    /// `ExecPlan n { … }` or `ExecPlan n Name`.
    Exec(&'s Exec<'s>),
    /// An open string in parentheses.
    String(&'s &'s [Element<'s>]),
    /// Formal notation `(s, ξ, T)`, and `(u, ξ, T)` where `u` is one call.
    Formal(&'s Formal<'s>),
    /// What could not be read; a diagnostic says why.
    Broken,
}

/// `(Atom condition control)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Atom<'s> {
    /// The atom's interrupt.
    pub condition: Condition<'s>,
    /// Its law.
    pub control: &'s Call<'s>,
}

/// A loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exec<'s> {
    /// How often.
    pub count: Count<'s>,
    /// The body; a plan by name is a single element.
    pub body: &'s [Element<'s>],
}

/// A scope or an atom in formal notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formal<'s> {
    /// The string, or a single [`Primary::Ref`] that may be a law.
    pub body: &'s [Element<'s>],
    /// Its interrupt.
    pub condition: Condition<'s>,
    /// Its timer.
    pub time: Option<Arg<'s>>,
}

/// A condition: quarks joined by AND, OR and NOT.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition<'s> {
    /// What it is.
    pub node: ConditionNode<'s>,
    /// Its place, parentheses included where they are its own.
    pub span: Span,
}

/// What a condition is; OR and AND hold two operands or more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConditionNode<'s> {
    /// At least one has fired.
    Or(&'s &'s [Condition<'s>]),
    /// All have fired.
    And(&'s &'s [Condition<'s>]),
    /// It has not fired.
    Not(&'s Condition<'s>),
    /// It has fired, and once since the scope was entered it had not.
    Rising(&'s Condition<'s>),
    /// An interrupt quark.
    Call(&'s Call<'s>),
    /// A comparison of a signal.
    Comparison(&'s Compared<'s>),
    /// `null`: never fires.
    Null,
    /// `after LABEL [cause]`.
    After(&'s After<'s>),
    /// What could not be read; a diagnostic says why.
    Broken,
}

/// A comparison of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compared<'s> {
    /// The signal.
    pub left: &'s Call<'s>,
    /// How it is compared.
    pub operator: Comparison,
    /// With what.
    pub right: Operand<'s>,
}

/// `after LABEL [cause]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct After<'s> {
    /// The label of the element that has to have ended.
    pub label: Name<'s>,
    /// The operand that has to be the cause.
    pub cause: Option<Condition<'s>>,
}

/// The right side of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand<'s> {
    /// Another signal.
    Signal(&'s Call<'s>),
    /// A value.
    Number(Number<'s>),
    /// `inf`, for a time.
    Infinity(Span),
}

/// How a signal is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
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

impl Comparison {
    /// As it is written.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Equal => "==",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
        }
    }
}

/// A name with its arguments: a quark, a signal or a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Call<'s> {
    /// The name.
    pub name: &'s str,
    /// The arguments, flattened: parentheses around several of them mean nothing.
    pub args: &'s [Arg<'s>],
    /// From the name to the last argument or the closing parenthesis.
    pub span: Span,
}

impl Call<'_> {
    /// The place of its name, which it begins with.
    #[must_use]
    pub fn name_span(&self) -> Span {
        let length = u32::try_from(self.name.len()).unwrap_or(u32::MAX);
        Span { end: self.span.start.saturating_add(length), ..self.span }
    }
}

/// An argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arg<'s> {
    /// A number, or bits where these are asked for.
    Number(Number<'s>),
    /// `inf` and its other spellings.
    Infinity(Span),
    /// A string in quotes, without them.
    String(Name<'s>),
    /// A robot, a file, a parameter.
    Name(Name<'s>),
    /// `NAME module`.
    Module(Name<'s>),
}

impl Arg<'_> {
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number<'s> {
    /// Its digits and its unit.
    text: &'s str,
    /// Its place, unit included.
    pub span: Span,
}

impl<'s> Number<'s> {
    /// The number of this text: digits, and perhaps a unit.
    #[must_use]
    pub fn new(text: &'s str, span: Span) -> Self {
        Self { text, span }
    }

    /// Sign, digits, fraction and exponent as written.
    #[must_use]
    pub fn digits(&self) -> &'s str {
        // A unit is letters, and a number ends with a digit.
        self.text.trim_end_matches(|c: char| !c.is_ascii_digit())
    }

    /// The unit that touches it.
    #[must_use]
    pub fn unit(&self) -> Option<&'s str> {
        self.text.get(self.digits().len()..).filter(|unit| !unit.is_empty())
    }
}

/// A loop count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count<'s> {
    /// Digits as written.
    Number(Number<'s>),
    /// For ever.
    Infinity(Span),
    /// A parameter.
    Name(Name<'s>),
}

impl Count<'_> {
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
