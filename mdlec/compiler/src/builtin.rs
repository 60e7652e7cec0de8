//! The alphabets that are part of mdlec: the shared one and those of its targets.

/// An alphabet that is part of mdlec.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alphabet {
    /// Name of the alphabet in `--target` or `use`.
    pub name: &'static str,
    /// Name of the file in messages.
    pub file: &'static str,
    /// Text of the file.
    pub text: &'static str,
    /// `true` for the alphabet of a target, `false` for a shared one.
    pub target: bool,
}

/// The alphabets that are part of mdlec: the shared ones first, then those of the targets in the order of their names.
#[must_use]
pub fn alphabets() -> &'static [Alphabet] {
    ALPHABETS
}

include!(concat!(env!("OUT_DIR"), "/alphabets.rs"));
