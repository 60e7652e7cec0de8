//! Traces as JSON lines: the one form in which every machine tells what it did (docs/src/reference/interfaces.md, 4).

use std::fmt;

pub use mdle_runtime::trace::COMPLETED;
use mdle_runtime::{Frame, Nanos, trace};

/// A transition with the condition texts of the operands that had fired.
pub type Fired<'p> = trace::Fired<'p, Vec<String>>;

/// What came of one turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Line<'p> {
    /// The number of the turn, from 0.
    pub turn: usize,
    /// Its time.
    pub t: Nanos,
    /// What the machine did in it.
    pub outcome: Outcome<'p>,
}

/// What a machine did in one turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<'p> {
    /// The state it ended in, numbered in the expanded plan.
    pub state: u64,
    /// The input it ended with.
    pub applied: Applied<'p>,
    /// The frame of the law, if one is applied and a `FRAME here` is around its atom.
    pub frame: Option<Frame>,
    /// Its transitions, in order.
    pub fired: Vec<Fired<'p>>,
}

/// The input of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Applied<'p> {
    /// The law of this quark text.
    Law(&'p str),
    /// The null input, because the limit of transitions cut the turn.
    Cut,
    /// The null input, because the plan is over.
    Over,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outcome { state, applied, frame, fired } = &self.outcome;
        let law = match applied {
            Applied::Law(text) => Some(*text),
            Applied::Cut | Applied::Over => None,
        };
        let fired = fired.iter().cloned();
        trace::Line { turn: self.turn as u64, t: self.t, state: *state, law, frame: *frame, fired }.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_look_as_the_interface_says() {
        let outcome = Outcome { state: 1, applied: Applied::Law("goAvoid 90 40 20"), frame: None, fired: Vec::new() };
        let line = Line { turn: 0, t: Nanos::ZERO, outcome };
        assert_eq!(line.to_string(), r#"{"turn":0,"t":0.0,"state":1,"law":"goAvoid 90 40 20","fired":[]}"#);

        let fired = vec![
            Fired { from: 1, level: 2, by: "completed", operands: Vec::new() },
            Fired { from: 2, level: 0, by: "bumper OR path \"x\"", operands: vec!["bumper".to_owned()] },
        ];
        let line = Line {
            turn: 1,
            t: Nanos(100_000_000),
            outcome: Outcome { state: 9, applied: Applied::Over, frame: None, fired },
        };
        assert_eq!(
            line.to_string(),
            concat!(
                r#"{"turn":1,"t":0.1,"state":9,"law":null,"fired":[{"from":1,"level":2,"by":"completed","operands":[]},"#,
                r#"{"from":2,"level":0,"by":"bumper OR path \"x\"","operands":["bumper"]}]}"#
            )
        );
    }
}
