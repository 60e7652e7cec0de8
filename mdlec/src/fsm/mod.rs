//! State machine of a plan: lowering, validation, matrices, files. [`lower`] alone makes a [`Machine`]; everything
//! reads it by its elements.

mod draft;
mod equation;
mod expand;
mod file;
mod lower;
mod machine;
mod matrices;
mod matrix_market;
mod observation;
mod terms;
#[cfg(test)]
mod tests;
mod validation;

pub use draft::{Draft, LawMeaning, RecordPlace, ScopeMeaning, Sizes};
pub use equation::{equation, most_states};
pub use expand::{expand, expanded_states};
pub use file::{FsmFile, InterruptEntry, Moves, ScopeEntry, fsm_file};
pub use lower::{STATES, lower};
pub use machine::{Atom, Element, ElementKind, Exit, Machine, Visit};
pub use matrices::{Matrices, Matrix, Transition, UnitVector, matrices};
pub use matrix_market::{MatrixFiles, matrix_files};
pub use observation::observation1;
pub use terms::{Extent, Term, Terms, terms};
pub use validation::validate;
