//! The alphabet 𝒜 = U ∪ B′ of a robot: its quarks with the types of their arguments, and what the robot can do
//! (paper, Definition 1; docs/src/reference/language.md, 6).

mod checks;
mod combined;
mod decimal;
mod quantity;
mod read;
mod synonyms;
#[cfg(test)]
mod tests;
mod token;

pub use combined::{Alphabet, combine, nearest};
pub use decimal::Decimal;
pub use quantity::{Kind, Unit, family_to_si};
pub use read::read;

use crate::diagnostic::Span;

/// An alphabet file as read: a target's own, or a shared one that targets `use`.
#[derive(Debug, Clone, PartialEq)]
pub struct AlphabetFile {
    /// Its name.
    pub name: String,
    /// What only a target has.
    pub target: Option<TargetHead>,
    /// The shared alphabets it uses, with the place of the name.
    pub uses: Vec<(String, Span)>,
    /// Its quarks and signals, in order.
    pub declarations: Vec<Declaration>,
}

/// The head of a target's alphabet.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetHead {
    /// The Rust crate that implements it.
    pub crate_name: String,
    /// The period of a turn, in nanoseconds, if it says so.
    pub period: Option<u64>,
    /// What the robot can do.
    pub capabilities: Vec<Capability>,
}

/// A capability with its size, such as `sonar[16]`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Capability {
    /// Its name.
    pub name: String,
    /// How many, where that matters.
    pub size: Option<u32>,
}

/// What a name of the alphabet is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeclarationKind {
    /// A law, in U.
    Control,
    /// An interrupt, in B′.
    Interrupt,
    /// What comparisons read.
    Signal,
}

/// A quark or a signal with its signature.
#[derive(Debug, Clone, PartialEq)]
pub struct Declaration {
    /// The doc comment, its lines joined by spaces.
    pub docs: String,
    /// What it is.
    pub kind: DeclarationKind,
    /// Its name.
    pub name: String,
    /// Its parameters, in order.
    pub params: Vec<Param>,
    /// For a signal: its unit and the tolerance of `==` in that unit.
    pub unit: Option<(Unit, f64)>,
    /// Whether the law can be done by itself.
    pub completes: bool,
    /// Whether the quark has a memory of its own.
    pub remembers: bool,
    /// What the robot must be able to do.
    pub needs: Vec<Capability>,
    /// Who declares it.
    pub origin: Origin,
    /// Where.
    pub span: Span,
}

/// Who declares a quark: its implementation stands there too.
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
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Kind,
    /// The unit that a bare number has; the kind's base unit if the alphabet names none.
    pub unit: Option<Unit>,
    /// The value it has when it is left out, as written, in that unit.
    pub default: Option<String>,
    /// The values it may have, in that unit.
    pub range: Option<(f64, f64)>,
    /// The one value that it may not have, in that unit.
    pub except: Option<f64>,
}
