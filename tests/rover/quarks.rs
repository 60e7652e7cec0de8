//! Quarks of the rover's alphabet.

use mdle_runtime::{Begin, Control, Interrupt, Law, Nanos, Volts};

use crate::Sensed;

/// The interrupt `low`.
#[derive(Debug)]
pub struct Low(Volts);

impl Low {
    /// Returns an interrupt that fires below this voltage.
    pub const fn new(limit: Volts) -> Self {
        Self(limit)
    }
}

impl Interrupt<Sensed> for Low {
    fn fired(&self, y: &Sensed) -> bool {
        y.0 < self.0
    }
}

/// The law `count`.
#[derive(Debug, Clone, Copy)]
pub struct Count(i64);

impl Count {
    /// Returns a law whose input is always `first`.
    pub const fn new(first: i64) -> Self {
        Self(first)
    }
}

impl Control<Sensed> for Count {
    type Law = Self;

    fn begin(&self, _: &Sensed, _: Begin) -> Self {
        *self
    }
}

impl Law<Sensed> for Count {
    type Input = i64;

    fn input(&mut self, _: &Sensed, _: Nanos) -> i64 {
        self.0
    }
}
