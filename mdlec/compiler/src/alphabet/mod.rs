//! Alphabet of a robot: its quarks (control laws and interrupts) with the types of their arguments, and its
//! capabilities (𝒜 = U ∪ B′ in the paper, Definition 1; docs/src/reference/language.md, 6).

mod checks;
mod combined;
mod decimal;
mod name;
mod quantity;
mod read;
mod synonyms;
#[cfg(test)]
mod tests;
mod token;

pub use combined::{Alphabet, combine};
pub use decimal::Decimal;
pub use mdle_quantity::{did_you_mean, nearest};
pub(crate) use name::{name, word};
pub use quantity::{ParameterKind, Unit, family_to_si, has_direction};
pub use read::read;

use crate::diagnostic::Span;

/// Contents of an alphabet file: either a target's own alphabet, or a shared alphabet that targets `use`.
#[derive(Debug, Clone, PartialEq)]
pub struct AlphabetFile {
    /// Name of the target or of the shared alphabet.
    pub name: String,
    /// Head of a target's alphabet; `None` for a shared alphabet.
    pub target: Option<TargetHead>,
    /// Shared alphabets that the file uses, with the spans of their names.
    pub uses: Vec<(String, Span)>,
    /// Quarks and signals that the file declares, in order.
    pub declarations: Vec<Declaration>,
}

/// The head of a target's alphabet.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetHead {
    /// Rust crate that implements the target.
    pub crate_name: String,
    /// Period of a turn, in nanoseconds; `None` if the target does not declare it.
    pub period: Option<u64>,
    /// Capabilities of the robot.
    pub capabilities: Vec<Capability>,
    /// Capabilities that the robot has if an engine runs its plan, but not in an executable.
    pub engine: Vec<Capability>,
}

/// A capability and its size, such as `sonar[16]`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Capability {
    /// Name of the capability.
    pub name: String,
    /// Number of devices; `None` for a capability without a number.
    pub size: Option<u32>,
}

/// Kind of a declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeclarationKind {
    /// A control law (an element of the set U in the paper).
    Control,
    /// An interrupt (an element of the set B′ in the paper).
    Interrupt,
    /// A signal: a value that comparisons can read.
    Signal,
}

/// Declaration of a quark or a signal with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    /// Doc comment, with its lines joined by spaces.
    pub docs: String,
    /// Kind of the quark or signal.
    pub kind: DeclarationKind,
    /// Name of the quark or signal.
    pub name: String,
    /// Parameters, in order.
    pub params: Vec<Param>,
    /// Unit of a signal, and the tolerance of `==` in this unit; `None` for a quark.
    pub unit: Option<(Unit, f64)>,
    /// `true` for a law that can complete by itself.
    pub completes: bool,
    /// `true` if the quark has a memory.
    pub remembers: bool,
    /// `true` for an interrupt that fires in one turn for at most one value of its arguments.
    pub exclusive: bool,
    /// Capabilities that the quark or signal needs.
    pub needs: Vec<Capability>,
    /// File that declares the quark.
    pub origin: Origin,
    /// Span of the declaration.
    pub span: Span,
}

/// Origin of a declaration and of its implementation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// The target's own alphabet and crate.
    Target,
    /// The shared alphabet with this name.
    Shared(String),
}

/// A parameter of a quark.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Name of the parameter.
    pub name: String,
    /// Type of the parameter.
    pub kind: ParameterKind,
    /// Unit that is assumed for a bare number (a number that is written without a unit). This is the base unit of the
    /// kind, unless the alphabet declares another unit; `None` if the kind has no unit.
    pub unit: Option<Unit>,
    /// Default value as written, in the unit of a number that is written without a unit.
    pub default: Option<String>,
    /// Minimum and maximum value, in the unit that is assumed for a bare number.
    pub range: Option<(f64, f64)>,
    /// The only value in the range that is not allowed, in the unit that is assumed for a bare number.
    pub except: Option<f64>,
    /// Attributes of a module that the quark reads. If a signal lists no attributes, it reads the attribute that has
    /// the signal's name.
    pub with: Vec<String>,
}
