//! The machines of `mdlec trace`. They run the same plan in different ways, and share no stepping code
//! (docs/src/reference/semantics.md, 9).

mod counted;
mod matrix;
mod script;
mod table;
mod tree;
mod write;

pub use counted::CountedRun;
pub use matrix::MatrixProduct;
use script::EntryTime;
pub use script::{Reports, Script, ScriptError};
pub use table::TableMachine;
pub use tree::{OpenPart, TreeStep, TreeWalk};
pub use write::{COMPLETED, Fired, ScriptedInput, TraceLine, TurnResult};

/// An interpreter of a plan.
pub trait Machine<'p> {
    /// Runs one turn. Must not be called after the plan has ended.
    fn turn(&mut self, reports: &Reports) -> TurnResult<'p>;
}

/// Traces a machine from its first turn to the turn in which the plan ends, or to the end of the script.
pub fn run<'p, 's>(mut machine: impl Machine<'p> + 's, script: &'s Script) -> impl Iterator<Item = TraceLine<'p>> {
    let mut over = false;
    script.turns().iter().enumerate().map_while(move |(turn, reports)| {
        if over {
            return None;
        }
        let outcome = machine.turn(reports);
        over = outcome.applied == ScriptedInput::Over;
        Some(TraceLine { turn, t: reports.t, outcome })
    })
}
