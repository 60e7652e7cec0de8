//! Pictures of a plan: drawn as nested boxes, and as text that other tools draw or run (Graphviz, mermaid, SCXML).
//!
//! A picture shows the plan as it is written: loops are not expanded. Only the SCXML machine, which is to do what the plan
//! does, has a state for each atom of the expanded plan.

mod dot;
mod exits;
mod layout;
mod measure;
mod mermaid;
mod places;
mod scxml;
mod svg;
mod texts;
mod xml;

pub use dot::dot;
pub use mermaid::mermaid;
pub use scxml::scxml;
pub use svg::svg;

use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::Machine;

/// The most atoms, and the most scopes and loops, that a picture shows: a person does not find his way in more.
const SHOWN: usize = 1000;

/// Whether there are not too many atoms and brackets for a picture.
fn can_be_shown(lowered: &Machine) -> Result<(), Diagnostic> {
    let atoms = lowered.atoms.len();
    let brackets = lowered.brackets.len().saturating_sub(atoms);
    let (count, what) = if atoms > SHOWN { (atoms, "atoms") } else { (brackets, "scopes and loops") };
    if count > SHOWN { Err(too_many(lowered, count, what, SHOWN)) } else { Ok(()) }
}

/// The diagnostic of a plan that has too much of something for a picture.
fn too_many(lowered: &Machine, count: usize, what: &str, most: usize) -> Diagnostic {
    let message = format!("this plan has {count} {what}; a picture shows {most} at most");
    let help = "draw a part of it: `--plan NAME` takes any plan of the file, also one that others use";
    Diagnostic::new(Code::E0502, message, whole(lowered), "this plan").help(help)
}

/// The place of the plan, or of its interrupt.
fn whole(lowered: &Machine) -> Span {
    lowered
        .scopes
        .iter()
        .flatten()
        .next()
        .map_or(Span::new(crate::diagnostic::SourceId(0), 0, 0), |plan| plan.interrupt.span)
}
