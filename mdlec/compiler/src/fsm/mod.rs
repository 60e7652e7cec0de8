//! The state machine of a plan. Contains the conversion of plans to machines (lowering), the validation of machines,
//! their matrices, and their files. Only [`lower`] constructs a [`Machine`]; all other code accesses a machine by its
//! elements.

mod draft;
mod element;
mod expand;
mod file;
mod lower;
mod machine;
mod matrices;
mod observation;
mod reads;
mod robots;
mod rows;
#[cfg(test)]
mod tests;
mod validation;
mod words;

pub use draft::{LawMeaning, MachineDraft, RecordPlace, ScopeMeaning, Sizes};
pub use element::{Atom, Element, ElementKind, Exit};
pub use expand::{expand, expanded_states, expands};
pub use file::{FsmFile, InterruptEntry, Moves, ScopeEntry, fsm_file};
pub use lower::{STATES, lower};
pub use machine::{Machine, Visit};
pub use matrices::{Matrices, Matrix, Transition, UnitVector, matrices};
pub use observation::observation1;
pub use reads::{AttributeRead, module_reads};
pub use robots::{FormationPlace, Rendezvous, formation_places, meetings, other_robots};
pub use rows::{Rows, replayed_files, rows};
pub use validation::validate;
pub use words::{BracketText, OperandText, PlanWords, words};
