//! The quarks of the workload: a comparison, a switch, and a law that writes two numbers.

use mdle_runtime::{Begin, Control, Interrupt, Law, Nanos};

use crate::{Input, Output};

/// The interrupt `reached limit`.
#[derive(Debug, Clone, Copy)]
pub struct Reached(f64);

impl Reached {
    /// Returns an interrupt that fires once the measurement is at least `limit`.
    #[must_use]
    pub const fn new(limit: f64) -> Self {
        Self(limit)
    }
}

impl Interrupt<Output> for Reached {
    fn fired(&self, y: &Output) -> bool {
        y.measured >= self.0
    }
}

/// The interrupt `halt`.
#[derive(Debug, Clone, Copy)]
pub struct Halt;

impl Halt {
    /// Returns an interrupt that fires while the switch is on.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "as bound alphabets have it")]
    pub const fn new() -> Self {
        Self
    }
}

impl Interrupt<Output> for Halt {
    fn fired(&self, y: &Output) -> bool {
        y.halt
    }
}

/// The law `write left right`.
#[derive(Debug, Clone, Copy)]
pub struct Write(Input);

impl Write {
    /// Returns a law that writes two numbers.
    #[must_use]
    pub const fn new(left: f64, right: f64) -> Self {
        Self(Input { left, right })
    }
}

impl Control<Output> for Write {
    type Law = Self;

    fn begin(&self, _: &Output, _: Begin) -> Self {
        *self
    }
}

impl Law<Output> for Write {
    type Input = Input;

    fn input(&mut self, _: &Output, _: Nanos) -> Input {
        self.0
    }
}
