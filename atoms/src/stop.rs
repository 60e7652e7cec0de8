//! `stop`: the null input, for ever (docs/src/reference/language.md, 4).

use mdle_runtime::capability::DiffDrive;
use mdle_runtime::{Begin, Control, Law, Nanos, Twist};

/// The control `stop`: `u = 0`. It has no state, so it is its own law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stop;

impl Stop {
    /// Creates the quark `stop`.
    #[must_use]
    pub const fn new() -> Self {
        Self
    }
}

impl<Y: DiffDrive> Control<Y> for Stop {
    type Law = Self;

    fn begin(&self, _: &Y, _: Begin) -> Self {
        *self
    }
}

impl<Y: DiffDrive> Law<Y> for Stop {
    type Input = Twist;

    fn input(&mut self, _: &Y, _: Nanos) -> Twist {
        Twist::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun};

    #[test]
    fn asks_for_nothing() {
        let y = Sensed::default();
        let mut law = Stop::new().begin(&y, begun());
        assert_eq!(Law::<Sensed>::input(&mut law, &y, Nanos(0)), Twist::default());
    }
}
