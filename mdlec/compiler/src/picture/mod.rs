//! Pictures of a plan: drawn as nested boxes, and as text that other tools draw or run (Graphviz, mermaid, SCXML).
//!
//! A picture shows the plan as it is written: loops are not expanded. Only the SCXML machine, which is to do what the
//! plan does, has a state for each atom of the expanded plan.

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
pub use svg::svg;

use crate::diagnostic::{Code, Diagnostic};
use crate::fsm::Machine;

/// Maximum number of atoms, and of scopes and loops, that a picture shows: a person does not find his way in more.
const SHOWN: usize = 1000;

/// Refuses a machine with too many atoms, or scopes and loops, for a picture.
fn can_be_shown(machine: &Machine) -> Result<(), Diagnostic> {
    let atoms = machine.atoms().len();
    let others = machine.elements().len() - atoms;
    let (count, what) = if atoms > SHOWN { (atoms, "atoms") } else { (others, "scopes and loops") };
    if count > SHOWN { Err(too_many(machine, count, what, SHOWN)) } else { Ok(()) }
}

/// Reports a plan that is too large for a picture: `count` exceeds `most`.
fn too_many(machine: &Machine, count: usize, what: &str, most: usize) -> Diagnostic {
    let message = format!("this plan has {count} {what}; a picture shows {most} at most");
    let help = "draw a part of it: `--plan NAME` takes any plan of the file, also one that others use";
    let root = machine.root();
    let place = root.interrupt().map_or(root.span(), |interrupt| interrupt.span);
    Diagnostic::new(Code::E0502, message, place, "this plan").help(help)
}
