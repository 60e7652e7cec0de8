//! `go v ω`: drives with a constant speed and turn rate, for ever (paper, section IV-A).

use mdle_runtime::capability::DiffDrive;
use mdle_runtime::{Begin, Control, Law, MetersPerSecond, Nanos, RadiansPerSecond, Twist};

/// The control `go`: `u = (v, ω)`. It has no state, so it is its own law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Go {
    input: Twist,
}

impl Go {
    /// Creates the quark `go v omega`: forward speed, and turn rate, counter-clockwise positive.
    #[must_use]
    pub const fn new(v: MetersPerSecond, omega: RadiansPerSecond) -> Self {
        Self { input: Twist { v, omega } }
    }
}

impl<Y: DiffDrive> Control<Y> for Go {
    type Law = Self;

    fn begin(&self, _: &Y, _: Begin) -> Self {
        *self
    }
}

impl<Y: DiffDrive> Law<Y> for Go {
    type Input = Twist;

    fn input(&mut self, _: &Y, _: Nanos) -> Twist {
        self.input
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun};

    #[test]
    fn asks_for_its_arguments_always() {
        let y = Sensed::default();
        let go = Go::new(MetersPerSecond(0.2), RadiansPerSecond(-0.36));
        let twist = Twist { v: MetersPerSecond(0.2), omega: RadiansPerSecond(-0.36) };
        let mut law = go.begin(&y, begun());
        assert_eq!(Law::<Sensed>::input(&mut law, &y, Nanos(0)), twist);
        assert_eq!(Law::<Sensed>::input(&mut law, &y, Nanos(7)), twist);
    }
}
