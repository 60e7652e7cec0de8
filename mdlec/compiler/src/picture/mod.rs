//! Pictures of a plan: a drawing of nested boxes, and texts that other tools draw or run (Graphviz, mermaid, SCXML).
//!
//! A picture shows the plan as written, without expanding loops. Only the SCXML machine, which behaves like the plan,
//! has a state for each atom of the expanded plan.

mod arrows;
mod dot;
mod exits;
mod layout;
mod measure;
mod mermaid;
mod scxml;
mod svg;
mod texts;
mod xml;

pub use dot::dot;
pub use mermaid::mermaid;
pub use scxml::scxml;
pub use svg::{counted_svg, svg};

use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::Machine;
use crate::plan::Nondegenerate;

/// Maximum number of atoms in a picture, and maximum number of scopes and loops together. A larger picture would not be
/// readable.
const SHOWN: usize = 1000;

/// Checks that a plan can be drawn.
///
/// # Errors
/// Fails with E0502 for a plan of more than 1,000 atoms, or of more than 1,000 scopes and loops together.
pub fn fits(plan: &Nondegenerate) -> Result<(), Diagnostic> {
    let plan = plan.plan();
    let (elements, atoms) =
        plan.parts().fold((0, 0), |(all, atoms), part| (all + 1, atoms + usize::from(part.atom().is_some())));
    within(elements, atoms, plan.root.interrupt.span)
}

/// Returns an error if [`fits`] would reject the machine's plan.
fn can_be_shown(machine: &Machine) -> Result<(), Diagnostic> {
    within(machine.elements().len(), machine.atoms().len(), place(machine))
}

/// Returns an error if there are too many atoms, or too many scopes and loops, for a picture.
fn within(elements: usize, atoms: usize, place: Span) -> Result<(), Diagnostic> {
    let (count, what) = if atoms > SHOWN { (atoms, "atoms") } else { (elements - atoms, "scopes and loops") };
    if count > SHOWN { Err(too_many(place, count, what, SHOWN)) } else { Ok(()) }
}

/// Returns the span of the plan in its text.
fn place(machine: &Machine) -> Span {
    let root = machine.root();
    root.interrupt().map_or(root.span(), |interrupt| interrupt.span)
}

/// Returns the error about a plan that is too large for a picture, because `count` exceeds `most`.
fn too_many(place: Span, count: usize, what: &str, most: usize) -> Diagnostic {
    let message = format!("this plan has {count} {what}; a picture shows {most} at most");
    let help = "draw a part of it: `--plan NAME` takes any plan of the file, also one that others use";
    Diagnostic::new(Code::E0502, message, place, "this plan").help(help)
}
