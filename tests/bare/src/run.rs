//! Runs a plan on outputs from standard input, and prints its turns.

use core::ffi::c_int;
use core::fmt::{self, Write};

use mdle_runtime::trace::Line;
use mdle_runtime::{Machine, Measured, Plan, Transition, Turn, Watch};

use crate::sensed::Sensed;
use crate::system::{Printed, bytes};
use crate::{Input, Output};

/// Runs `plan` until it is over or standard input ends. For each turn, prints a line of the trace, and a line with `u`
/// and the input as two integers, in mm/s and mrad/s. Returns the exit status: 0 if everything was printed, 1 if not.
pub fn run(plan: impl Plan<Output = Output, Input = Input>) -> c_int {
    match turns(plan) {
        Ok(()) => 0,
        Err(fmt::Error) => 1,
    }
}

fn turns(plan: impl Plan<Output = Output, Input = Input>) -> fmt::Result {
    let mut next = bytes().map(|record| Sensed::read(&record));
    let Some((t, y)) = &next else { return Ok(()) };
    let mut machine = Machine::begin(plan, y, *t);
    let mut turn: u64 = 0;
    while let Some((t, y)) = next.filter(|_| !machine.is_over()) {
        let mut transitions = Transitions::default();
        let outcome = machine.turn(&y, t, &mut transitions);
        let law = match outcome {
            Turn::Law(_) => machine.atom().map(|atom| machine.plan().law(atom)),
            Turn::Cut | Turn::Over => None,
        };
        let source = machine.plan().source();
        let fired = transitions.made.iter().flatten().map(|ReportedTransition { transition, operands }| {
            let texts = source.operands_of(transition.scope).zip(0_u32..);
            let fired = texts.filter(|(_, number)| operands.iter().flatten().any(|operand| operand == number));
            transition.fired(machine.plan(), fired.map(|(words, _)| words.text))
        });
        let frame = machine.frame().filter(|_| law.is_some());
        let Input { v, omega } = outcome.input();
        writeln!(Printed, "{}", Line { turn, t, state: machine.state(), law, frame, fired })?;
        writeln!(Printed, "u {} {}", (v.0 * 1000.0) as i32, (omega.0 * 1000.0) as i32)?;
        turn = turn.saturating_add(1);
        next = bytes().map(|record| Sensed::read(&record));
    }
    Ok(())
}

/// The first 8 transitions of a turn.
#[derive(Default)]
struct Transitions {
    /// Operands that have fired since the last transition.
    operands: [Option<u32>; 8],
    made: [Option<ReportedTransition>; 8],
}

/// A transition, with the numbers of the first 8 operands that fired.
struct ReportedTransition {
    transition: Transition,
    operands: [Option<u32>; 8],
}

impl Watch for Transitions {
    fn operand(&mut self, number: u32, _: Measured) {
        if let Some(free) = self.operands.iter_mut().find(|place| place.is_none()) {
            *free = Some(number);
        }
    }

    fn transition(&mut self, transition: Transition) {
        let operands = core::mem::take(&mut self.operands);
        if let Some(free) = self.made.iter_mut().find(|place| place.is_none()) {
            *free = Some(ReportedTransition { transition, operands });
        }
    }
}
