//! Rust representation of quarks: interrupts, control laws and their completion (paper, Definition 1;
//! docs/src/reference/semantics.md, 1 and 4).

use crate::{Frame, Measured, Nanos, Radians};

/// An interrupt quark: a condition on the output.
pub trait Interrupt<Y: ?Sized> {
    /// Returns `true` if the interrupt has fired. The paper's function is active low: it is 0 when the interrupt has
    /// fired.
    fn fired(&self, y: &Y) -> bool;

    /// Returns `true` if the interrupt has fired. `stalled` is the time for which the law of the previous turn has made
    /// no progress ([`Law::stalled`]). For `stuck`, this function is called instead of [`Interrupt::fired`]; other
    /// interrupts ignore `stalled`.
    #[inline(always)]
    fn fired_during(&self, y: &Y, _stalled: Option<Nanos>) -> bool {
        self.fired(y)
    }

    /// Returns the values that the interrupt compares, for reports and explanations. A turn calls this only when a
    /// scope ends.
    fn measured(&self, _y: &Y) -> Measured {
        Measured::Nothing
    }
}

/// Time and frame in which an atom begins; the law of the atom needs both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Begin {
    /// Time of the turn in which the atom is entered.
    pub now: Nanos,
    /// Frame of the atom, which includes the enclosing `FRAME`s.
    pub frame: Frame,
}

impl Begin {
    /// Returns `self` with its frame turned counter-clockwise by `by`; the time stays the same.
    #[must_use]
    pub fn turned(self, by: Radians) -> Self {
        Self { frame: self.frame.turned(by), ..self }
    }
}

/// A control quark with its arguments. Each atom that begins creates a [`Law`] from it.
pub trait Control<Y: ?Sized> {
    /// Type of the running law, which contains the law's state.
    type Law: Law<Y>;

    /// Creates the law in its initial state when an atom is entered. The function must have no side effects, because
    /// the law of a skipped atom is created but never applied.
    fn begin(&self, y: &Y, begin: Begin) -> Self::Law;
}

/// A control law `u(y, t)` and its state since its atom began.
pub trait Law<Y: ?Sized> {
    /// Type of the input that the law computes.
    type Input;

    /// Returns the input for this turn. Called once a turn while the atom runs, with the output `y` and the
    /// time `t` of the turn.
    fn input(&mut self, y: &Y, t: Nanos) -> Self::Input;

    /// Returns how long the law has made no progress towards its goal; `None` for a law without a goal. Called at the
    /// start of each turn for the interrupt `stuck`.
    fn stalled(&self, _y: &Y, _t: Nanos) -> Option<Nanos> {
        None
    }
}

/// A law that can end its atom, as the alphabet declares with `completes`.
pub trait Completes<Y: ?Sized>: Law<Y> {
    /// Returns `true` if the law is done. Called before the input is computed, also in the turn in which the
    /// atom begins.
    fn completed(&self, y: &Y, t: Nanos) -> bool;
}
