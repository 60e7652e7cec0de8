//! Tree of a plan file as it is written (docs/src/reference/language.md, 3): every node has its span, and names are not
//! resolved.
//!
//! Nodes borrow their text from the source, and are allocated once in an arena: a parser that allocates and copies each
//! node spends most of its time doing so.

use crate::diagnostic::Span;

/// A node with its span in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spanned<T> {
    /// Node of the tree, without its span.
    pub node: T,
    /// Span of the node.
    pub span: Span,
}

/// A name as written.
pub type Name<'s> = Spanned<&'s str>;

/// A plan file, with the syntax `{ use | plan }`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct File<'s> {
    /// Names of the used files, as written between the quotes.
    pub uses: Vec<Name<'s>>,
    /// Plans of the file, in order.
    pub plans: Vec<Plan<'s>>,
    /// `true` if a plan is missing because its head could not be read.
    pub is_incomplete: bool,
}

/// A plan or a behavior: a scope that is written in braces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan<'s> {
    /// Lines of the doc comment before the plan, without the slashes.
    pub docs: &'s [&'s str],
    /// Label of the plan in normalized form: `Γ_from^to`, without braces and typesetting.
    pub label: Option<Name<'s>>,
    /// Name of the plan.
    pub name: Name<'s>,
    /// Robots of a group, as written between the brackets of the group's plan; `None` for the plan of one robot.
    pub group: Option<&'s [Arg<'s>]>,
    /// Parameters of the plan.
    pub params: &'s [Param<'s>],
    /// Interrupt of the plan; `None` for the null interrupt.
    pub condition: Option<Condition<'s>>,
    /// Elements of the plan, in order.
    pub elements: &'s [Element<'s>],
    /// Span from the plan's label or brace to its closing brace.
    pub span: Span,
}

/// A parameter of a plan, with the syntax `NAME ":" TYPE`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Param<'s> {
    /// Name of the parameter.
    pub name: Name<'s>,
    /// Type of the parameter as written, such as `speed` or `bits[4]`.
    pub type_name: Name<'s>,
}

/// An element of a string, with the syntax `[ NAME ":" ] [ frame ] primary [ "^" count ]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Element<'s> {
    /// Main part of the element, without its label, frame and count.
    pub primary: Primary<'s>,
    /// Label, frame and count of the element; `None` for most elements.
    pub marks: Option<&'s Marks<'s>>,
    /// Span from the element's first token to its last.
    pub span: Span,
}

/// Optional parts of an element: label, frame and loop count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Marks<'s> {
    /// Label of the element, to which `after` can refer.
    pub label: Option<Name<'s>>,
    /// Frame of the element.
    pub frame: Option<Frame<'s>>,
    /// Loop count after `^`, which is the number of times that the element runs.
    pub power: Option<Count<'s>>,
}

impl<'s> Element<'s> {
    /// Returns the label of the element, to which `after` can refer.
    #[must_use]
    pub fn label(&self) -> Option<Name<'s>> {
        self.marks?.label
    }

    /// Returns the frame of the element.
    #[must_use]
    pub fn frame(&self) -> Option<&'s Frame<'s>> {
        self.marks?.frame.as_ref()
    }

    /// Returns the loop count after `^`, which is the number of times that the element runs.
    #[must_use]
    pub fn power(&self) -> Option<&'s Count<'s>> {
        self.marks?.power.as_ref()
    }
}

/// The frame of an element, with the syntax `"FRAME" ( NUMBER | "here" )`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame<'s> {
    /// The enclosing frame, turned by this angle.
    Turned(Number<'s>),
    /// The robot's heading at the time when the element is entered.
    Here,
}

/// Main part of an element. It is stored as a reference, so that a list of elements needs little memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Primary<'s> {
    /// An atom, with the syntax `(Atom condition control)`.
    Atom(&'s Atom<'s>),
    /// A behavior that is defined inside the string.
    Plan(&'s Plan<'s>),
    /// A plan used by name, with its arguments if it has any.
    Ref(&'s Call<'s>),
    /// A loop, with the syntax `ExecPlan n { … }` or `ExecPlan n Name`.
    Exec(&'s Exec<'s>),
    /// An open string in parentheses.
    String(&'s &'s [Element<'s>]),
    /// Formal notation: `(s, ξ, T)`, or `(u, ξ, T)` with a single call `u`.
    Formal(&'s Formal<'s>),
    /// Text that could not be parsed; a diagnostic gives the reason.
    Broken,
}

/// An atom, with the syntax `(Atom condition control)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Atom<'s> {
    /// Interrupt of the atom.
    pub condition: Condition<'s>,
    /// Law of the atom.
    pub control: &'s Call<'s>,
}

/// A loop: `ExecPlan` with a count and a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exec<'s> {
    /// Number of passes.
    pub count: Count<'s>,
    /// Body of the loop. A plan used by name is a single element.
    pub body: &'s [Element<'s>],
}

/// A scope or an atom in formal notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formal<'s> {
    /// String of the scope, or a single [`Primary::Ref`], which may be a law.
    pub body: &'s [Element<'s>],
    /// Interrupt of the scope or atom.
    pub condition: Condition<'s>,
    /// Timer of the scope or atom.
    pub time: Option<Arg<'s>>,
}

/// A condition: quarks joined by AND, OR and NOT.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition<'s> {
    /// Kind and operands of the condition.
    pub node: ConditionNode<'s>,
    /// Span of the condition, including its parentheses.
    pub span: Span,
}

/// Kind of a condition with its operands; OR and AND have at least two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConditionNode<'s> {
    /// A disjunction, which fires if at least one operand fires.
    Or(&'s &'s [Condition<'s>]),
    /// A conjunction, which fires if all operands fire.
    And(&'s &'s [Condition<'s>]),
    /// A negation, which fires if the operand does not fire.
    Not(&'s Condition<'s>),
    /// RISING, which fires if the operand fires and did not fire in an earlier turn of the scope.
    Rising(&'s Condition<'s>),
    /// An interrupt quark.
    Call(&'s Call<'s>),
    /// A comparison of a signal.
    Comparison(&'s Compared<'s>),
    /// The interrupt `null`, which never fires.
    Null,
    /// A test of a record, with the syntax `after LABEL [cause]`.
    After(&'s After<'s>),
    /// Text that could not be parsed; a diagnostic gives the reason.
    Broken,
}

/// A comparison of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compared<'s> {
    /// Signal on the left side.
    pub left: &'s Call<'s>,
    /// Operator of the comparison.
    pub operator: Comparison,
    /// Operand on the right side.
    pub right: Operand<'s>,
}

/// A test of a record, with the syntax `after LABEL [cause]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct After<'s> {
    /// Label of the element that must have ended last.
    pub label: Name<'s>,
    /// Operand that must have caused the end of the element; `None` if any cause is accepted.
    pub cause: Option<Condition<'s>>,
}

/// The right side of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand<'s> {
    /// Another signal.
    Signal(&'s Call<'s>),
    /// A number with or without a unit.
    Number(Number<'s>),
    /// An infinite time, `inf`.
    Infinity(Span),
}

/// Operator of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Comparison {
    /// The operator `==`, which allows a difference up to the signal's tolerance.
    Equal,
    /// The operator `<`.
    Less,
    /// The operator `<=` or `≤`.
    LessOrEqual,
    /// The operator `>`.
    Greater,
    /// The operator `>=` or `≥`.
    GreaterOrEqual,
}

impl Comparison {
    /// Returns the operator as written.
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
    /// Name of the quark, signal or plan.
    pub name: &'s str,
    /// Arguments of the call. Parentheses around several arguments are omitted, because they have no meaning.
    pub args: &'s [Arg<'s>],
    /// Span from the name to the last argument or the closing parenthesis.
    pub span: Span,
}

impl Call<'_> {
    /// Returns the span of the name, with which the call begins.
    #[must_use]
    pub fn name_span(&self) -> Span {
        let length = u32::try_from(self.name.len()).unwrap_or(u32::MAX);
        Span { end: self.span.start.saturating_add(length), ..self.span }
    }
}

/// An argument of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arg<'s> {
    /// A number, or bits if the parameter has that type.
    Number(Number<'s>),
    /// An infinite value: `inf`, or another spelling of `inf`.
    Infinity(Span),
    /// A string, without the quotes.
    String(Name<'s>),
    /// The name of a robot, a file or a parameter.
    Name(Name<'s>),
    /// The name of a module, with the syntax `NAME module`.
    Module(Name<'s>),
}

impl Arg<'_> {
    /// Returns the span of the argument.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Number(number) => number.span,
            Self::Infinity(span) => *span,
            Self::String(name) | Self::Name(name) | Self::Module(name) => name.span,
        }
    }
}

/// A number as written. Its digits are kept, because `0100` may be four bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number<'s> {
    /// Digits and unit as written.
    text: &'s str,
    /// Span of the number, including its unit.
    pub span: Span,
}

impl<'s> Number<'s> {
    /// Creates the number with this text: digits, and optionally a unit.
    #[must_use]
    pub fn new(text: &'s str, span: Span) -> Self {
        Self { text, span }
    }

    /// Returns the sign, digits, fraction and exponent as written.
    #[must_use]
    pub fn digits(&self) -> &'s str {
        // A number ends with a digit, and a unit contains none.
        self.text.trim_end_matches(|c: char| !c.is_ascii_digit())
    }

    /// Returns the unit that touches the digits.
    #[must_use]
    pub fn unit(&self) -> Option<&'s str> {
        self.text.get(self.digits().len()..).filter(|unit| !unit.is_empty())
    }
}

/// A loop count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count<'s> {
    /// A number, with the digits as written.
    Number(Number<'s>),
    /// An infinite count, `inf`, which means that the loop never ends.
    Infinity(Span),
    /// A parameter's name.
    Name(Name<'s>),
}

impl Count<'_> {
    /// Returns the span of the count.
    #[must_use]
    pub fn span(&self) -> Span {
        match self {
            Self::Number(number) => number.span,
            Self::Infinity(span) => *span,
            Self::Name(name) => name.span,
        }
    }
}
