//! Writes traces as JSON lines, in the same format for every machine (docs/src/reference/interfaces.md, 4).

use std::fmt;

pub use mdle_runtime::trace::COMPLETED;
use mdle_runtime::{Frame, Nanos, trace};

/// A transition, with the condition texts of the operands that have fired.
pub type Fired<'p> = trace::Fired<'p, Vec<String>>;

/// Result of a turn, with the number and time of the turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceLine<'p> {
    /// Number of the turn, counted from 0.
    pub turn: usize,
    /// Time of the turn.
    pub t: Nanos,
    /// Transitions and applied input of the machine in this turn.
    pub outcome: TurnResult<'p>,
}

/// Transitions and applied input of a machine in one turn.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnResult<'p> {
    /// Number, in the expanded plan, of the state at the end of the turn.
    pub state: u64,
    /// Input at the end of the turn.
    pub applied: ScriptedInput<'p>,
    /// Frame of the applied law, if its atom is inside a `FRAME here`; `None` otherwise.
    pub frame: Option<Frame>,
    /// Transitions of the turn, in order.
    pub fired: Vec<Fired<'p>>,
}

/// The input that is applied in a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScriptedInput<'p> {
    /// The input that the law with this quark text computes.
    Law(&'p str),
    /// The null input, because the turn reached the limit of transitions.
    Cut,
    /// The null input, because the plan has ended.
    Over,
}

impl fmt::Display for TraceLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TurnResult { state, applied, frame, fired } = &self.outcome;
        let law = match applied {
            ScriptedInput::Law(text) => Some(*text),
            ScriptedInput::Cut | ScriptedInput::Over => None,
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
        let outcome =
            TurnResult { state: 1, applied: ScriptedInput::Law("goAvoid 90 40 20"), frame: None, fired: Vec::new() };
        let line = TraceLine { turn: 0, t: Nanos::ZERO, outcome };
        assert_eq!(line.to_string(), r#"{"turn":0,"t":0.0,"state":1,"law":"goAvoid 90 40 20","fired":[]}"#);

        let fired = vec![
            Fired { from: 1, level: 2, by: "completed", operands: Vec::new() },
            Fired { from: 2, level: 0, by: "bumper OR path \"x\"", operands: vec!["bumper".to_owned()] },
        ];
        let line = TraceLine {
            turn: 1,
            t: Nanos(100_000_000),
            outcome: TurnResult { state: 9, applied: ScriptedInput::Over, frame: None, fired },
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
