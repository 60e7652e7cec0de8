//! The transitions of a turn, each with the operands that caused it.

use mdle_runtime::{Measured, Transition, Watch};

/// The transitions of a turn, for reports. The texts of the plan are not accessible while the transitions are made.
#[derive(Debug, Default)]
pub struct Transitions {
    /// Transitions in order. Each has the total number of operands of all transitions up to and including this one.
    transitions: Vec<(Transition, usize)>,
    operands: Vec<Operand>,
}

/// An operand that has fired: its index in the interrupt of the scope that ended, and its values.
pub type Operand = (u32, Measured);

impl Transitions {
    /// Removes the transitions of the previous turn.
    pub fn clear(&mut self) {
        self.transitions.clear();
        self.operands.clear();
    }

    /// Returns `true` if there are no transitions.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.transitions.is_empty()
    }

    /// Returns the transitions in order, each with the operands that fired.
    pub fn iter(&self) -> impl Iterator<Item = (&Transition, &[Operand])> + Clone {
        let begins = std::iter::once(0).chain(self.transitions.iter().map(|(_, end)| *end));
        let operands = |first, end| self.operands.get(first..end).unwrap_or(&[]);
        self.transitions.iter().zip(begins).map(move |((transition, end), first)| (transition, operands(first, *end)))
    }
}

impl Watch for Transitions {
    fn operand(&mut self, number: u32, measured: Measured) {
        self.operands.push((number, measured));
    }

    fn transition(&mut self, transition: Transition) {
        self.transitions.push((transition, self.operands.len()));
    }
}
