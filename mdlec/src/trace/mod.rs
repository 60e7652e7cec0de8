//! The machines of `mdlec trace`: the same plan, run by ways of working that share no stepping code
//! (docs/src/reference/semantics.md, 9).

mod counted;
mod matrix;
mod script;
mod table;
mod tree;
mod write;

pub use counted::Counted;
pub use matrix::MatrixProduct;
use script::Moment;
pub use script::{Reports, Script, ScriptError};
pub use table::Table;
pub use tree::Tree;
pub use write::{Applied, COMPLETED, Fired, Line, Outcome};

/// A way of running a plan.
pub trait Machine<'p> {
    /// One turn; not called again once the plan is over.
    fn turn(&mut self, reports: &Reports) -> Outcome<'p>;
}

/// The trace of a machine that has not yet begun: it ends with the turn in which the plan is over, or with the script.
pub fn run<'p, 's>(mut machine: impl Machine<'p> + 's, script: &'s Script) -> impl Iterator<Item = Line<'p>> {
    let mut over = false;
    script.turns().iter().enumerate().map_while(move |(turn, reports)| {
        if over {
            return None;
        }
        let outcome = machine.turn(reports);
        over = outcome.applied == Applied::Over;
        Some(Line { turn, t: reports.t, outcome })
    })
}
