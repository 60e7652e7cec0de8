//! Alphabet 𝒜 = U ∪ B′ of a robot: its quarks with the types of their arguments, and its capabilities (paper,
//! Definition 1; docs/src/reference/language.md, 6).

mod checks;
mod combined;
mod decimal;
mod quantity;
mod read;
mod synonyms;
#[cfg(test)]
mod tests;
mod token;

pub use combined::{Alphabet, combine, did_you_mean, nearest};
pub use decimal::Decimal;
pub use quantity::{Kind, Unit, family_to_si};
pub use read::read;

use crate::diagnostic::Span;

/// An alphabet file as read: a target's own, or a shared one that targets `use`.
#[derive(Debug, Clone, PartialEq)]
pub struct AlphabetFile {
    /// Name of the target or of the shared alphabet.
    pub name: String,
    /// Head of a target's alphabet; `None` for a shared one.
    pub target: Option<TargetHead>,
    /// Shared alphabets that the file uses, with the places of their names.
    pub uses: Vec<(String, Span)>,
    /// Quarks and signals that the file declares, in order.
    pub declarations: Vec<Declaration>,
}

/// The head of a target's alphabet.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetHead {
    /// Rust crate that implements the target.
    pub crate_name: String,
    /// Period of a turn, in nanoseconds, if the target declares it.
    pub period: Option<u64>,
    /// Capabilities of the robot.
    pub capabilities: Vec<Capability>,
    /// Capabilities that the robot has if an engine runs its plan, and not in an executable.
    pub engine: Vec<Capability>,
}

/// A capability with its size, such as `sonar[16]`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Capability {
    /// Name of the capability.
    pub name: String,
    /// Number of devices, for capabilities that have one.
    pub size: Option<u32>,
}

/// Kind of a declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeclarationKind {
    /// A law, in U.
    Control,
    /// An interrupt, in B′.
    Interrupt,
    /// A signal, which comparisons read.
    Signal,
}

/// A quark or a signal with its signature.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    /// Doc comment, its lines joined by spaces.
    pub docs: String,
    /// Kind of the quark or signal.
    pub kind: DeclarationKind,
    /// Name of the quark or signal.
    pub name: String,
    /// Parameters, in order.
    pub params: Vec<Param>,
    /// For a signal: its unit, and the tolerance of `==` in that unit.
    pub unit: Option<(Unit, f64)>,
    /// `true` for a law that can complete by itself.
    pub completes: bool,
    /// `true` if the quark has memory.
    pub remembers: bool,
    /// `true` for an interrupt that fires for at most one value of its arguments in a turn.
    pub exclusive: bool,
    /// Capabilities that the robot must have.
    pub needs: Vec<Capability>,
    /// File that declares the quark.
    pub origin: Origin,
    /// Span of the declaration.
    pub span: Span,
}

/// Origin of a declaration, which is also the origin of the implementation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// The target itself.
    Target,
    /// The shared alphabet of this name.
    Shared(String),
}

/// A parameter of a quark.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Name of the parameter.
    pub name: String,
    /// Type of the parameter.
    pub kind: Kind,
    /// Unit of a bare number; the kind's base unit if the alphabet names no other.
    pub unit: Option<Unit>,
    /// Default value as written, in that unit.
    pub default: Option<String>,
    /// Smallest and largest value, in that unit.
    pub range: Option<(f64, f64)>,
    /// Value in the range that is not allowed, in that unit.
    pub except: Option<f64>,
    /// Attributes that the quark reads of a module; a signal without any reads the attribute of its own name.
    pub with: Vec<String>,
}
