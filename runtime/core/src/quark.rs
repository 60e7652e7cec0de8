//! Quarks as code: interrupts, control laws and their completion (paper, Definition 1; docs/src/reference/semantics.md,
//! 1 and 4).

use crate::{Frame, Measured, Nanos, Radians};

/// An interrupt quark: a condition on the output.
pub trait Interrupt<Y: ?Sized> {
    /// Returns `true` if the interrupt has fired: where the paper's active-low function is 0.
    fn fired(&self, y: &Y) -> bool;

    /// Returns `true` if the interrupt has fired, where the law of the turn before reports that it is `stalled`
    /// ([`Law::stalled`]). Called instead of [`Interrupt::fired`]; only `stuck` reads the report.
    #[inline(always)]
    fn fired_during(&self, y: &Y, _stalled: Option<Nanos>) -> bool {
        self.fired(y)
    }

    /// Returns the values that it compares, for reports; not asked while nothing fires.
    fn measured(&self, _y: &Y) -> Measured {
        Measured::Nothing
    }
}

/// Time and frame in which an atom begins, for its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Begin {
    /// The time of the turn in which the atom is entered.
    pub now: Nanos,
    /// The frame of the atom, `FRAME`s included.
    pub frame: Frame,
}

impl Begin {
    /// Returns this moment in a frame turned counter-clockwise.
    #[must_use]
    pub fn turned(self, by: Radians) -> Self {
        Self { frame: self.frame.turned(by), ..self }
    }
}

/// A control quark with its arguments; an atom that begins makes a [`Law`] of it.
pub trait Control<Y: ?Sized> {
    /// The law with its state.
    type Law: Law<Y>;

    /// Returns the law as it is when its atom is entered. Has no effect outside: a skipped atom's law is created and
    /// never run.
    fn begin(&self, y: &Y, begin: Begin) -> Self::Law;
}

/// A control law `u(y, t)` with its state since its atom began.
pub trait Law<Y: ?Sized> {
    /// The input it computes.
    type Input;

    /// The input for this turn; called once a turn while the atom runs, with the output and the time of the turn.
    fn input(&mut self, y: &Y, t: Nanos) -> Self::Input;

    /// Returns how long the law has made no progress towards its goal; `None` for a law without a goal. Read at the
    /// start of each turn, for the interrupt `stuck`.
    fn stalled(&self, _y: &Y, _t: Nanos) -> Option<Nanos> {
        None
    }
}

/// A law that can end its atom, as the alphabet declares with `completes`.
pub trait Completes<Y: ?Sized>: Law<Y> {
    /// Returns `true` if the law is done; called before the input is computed, also in the turn in which the atom
    /// begins.
    fn completed(&self, y: &Y, t: Nanos) -> bool;
}
