//! Runs a plan over a script and writes its trace as `mdlec trace` does.

use alloc::vec::Vec;
use core::fmt::{self, Write};
use core::mem::take;

use mdle_runtime::trace::Line;
use mdle_runtime::{Frame, Machine, Measured, Nanos, Plan, Transition, Turn, Watch};

use crate::{Input, LAWS, Output};

/// Writes the trace of `plan` on a script: one JSON object for each turn, up to the turn in which the plan is over.
///
/// The field `law` comes from the input, not from the plan's own texts. It is `broken`, so that a comparison fails, in
/// three cases: the input and the text differ, the law was not created when its atom began, or a machine without an
/// observer behaves differently.
///
/// # Errors
/// Fails if `trace` cannot be written.
pub fn drive<P>(plan: impl Fn() -> P, script: &[(Nanos, Output)], trace: &mut impl Write) -> fmt::Result
where
    P: Plan<Output = Output, Input = Input, Entered: PartialEq, Left: PartialEq>,
{
    let Some((start, first)) = script.first() else { return Ok(()) };
    let mut machine = Machine::begin(plan(), first, *start);
    let mut unwatched = Machine::begin(plan(), first, *start);
    let (mut began, mut computed) = (*start, 0_u32);
    for (turn, (t, y)) in (0..).zip(script) {
        let mut transitions = Transitions { operands: Vec::new(), made: Vec::new() };
        let outcome = machine.turn(y, *t, &mut transitions);
        if !transitions.made.is_empty() {
            (began, computed) = (*t, 0);
        }
        let is_same = unwatched.turn(y, *t, &mut ()) == outcome && unwatched.cursor() == machine.cursor();
        let given = match &outcome {
            Turn::Law(input) => Some(Frame(input.frame)),
            Turn::Cut | Turn::Over => None,
        };
        let law = match outcome {
            _ if !is_same => Some("broken"),
            Turn::Law(input) => {
                computed = computed.saturating_add(1);
                let named = machine.atom().map_or("", |atom| machine.plan().law(atom));
                Some(applied(input, named, began, computed))
            }
            Turn::Cut | Turn::Over => None,
        };
        let source = machine.plan().source();
        let fired = transitions.made.iter().map(|(transition, operands)| {
            let text = |number: &u32| source.operand(transition.scope, *number).map_or("unknown", |words| words.text);
            transition.fired(machine.plan(), operands.iter().map(text).collect::<Vec<_>>())
        });
        // The law contains the angle that it was given; the machine knows whether the frame comes from `FRAME here`.
        let frame = machine.frame().and(given);
        writeln!(trace, "{}", Line { turn, t: *t, state: machine.state(), law, frame, fired })?;
        if machine.is_over() {
            break;
        }
    }
    Ok(())
}

/// Returns the law that computed this input, or `broken` if it is not the law `named` or was not created when its atom
/// began.
fn applied(input: Input, named: &str, began: Nanos, computed: u32) -> &'static str {
    match input.law.and_then(|law| LAWS.get(law)) {
        Some(law) if *law == named && input.began == began && input.computed == computed => law,
        Some(_) | None => "broken",
    }
}

/// Transitions of a turn, each with the numbers of the operands that fired.
struct Transitions {
    /// Operands of the next transition.
    operands: Vec<u32>,
    made: Vec<(Transition, Vec<u32>)>,
}

impl Watch for Transitions {
    fn operand(&mut self, number: u32, _: Measured) {
        self.operands.push(number);
    }

    fn transition(&mut self, transition: Transition) {
        self.made.push((transition, take(&mut self.operands)));
    }
}
