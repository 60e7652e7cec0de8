//! The three cases that are measured, and the loop that runs the turns.

use core::hint::black_box;

use mdle_runtime::{Nanos, Turn};

use crate::Output;
use crate::machines::Robot;

/// A case: the sequence of outputs on which a machine runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// No condition fires, and the law of the first atom writes in every turn.
    Steady,
    /// In each turn the current atom ends and the next one writes. After the last atom the plan restarts.
    Each,
    /// In each turn the plan's own interrupt ends the plan, which then restarts.
    Halt,
}

impl Case {
    /// All cases.
    pub const ALL: [Self; 3] = [Self::Steady, Self::Each, Self::Halt];

    /// Returns the output of the first turn, and the growth of the measurement from turn to turn.
    fn outputs(self) -> (Output, f64) {
        match self {
            Self::Steady => (Output { measured: 0.5, halt: false }, 0.0),
            Self::Each => (Output { measured: 1.0, halt: false }, 1.0),
            Self::Halt => (Output { measured: 0.5, halt: true }, 0.0),
        }
    }
}

/// Runs `turns` turns, and restarts the plan each time it is over. Returns the sum of all numbers that were written.
///
/// The loop differs between the cases only in the first output and the growth of the measurement, so it costs the same
/// in all cases.
pub fn run<M: Robot>(case: Case, turns: u32) -> f64 {
    let (first, step) = case.outputs();
    let (mut y, mut sum) = (first, 0.0);
    let mut machine = M::begin(&y, Nanos(0));
    for turn in 0..turns {
        let t = Nanos(u64::from(turn));
        match machine.turn(black_box(&y), t) {
            Turn::Law(input) => {
                sum += input.left + input.right;
                y.measured += step;
            }
            Turn::Cut => {}
            Turn::Over => {
                y = first;
                machine = M::begin(&y, t);
            }
        }
    }
    sum
}
