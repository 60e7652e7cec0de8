//! `bumper`: fires on contact of any bumper (paper, section IV-A).

use mdle_runtime::Interrupt;
use mdle_runtime::capability::Bumpers;

/// The interrupt `bumper`, which fires while any bumper is in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Bumper;

impl Bumper {
    /// Creates the quark `bumper`.
    #[must_use]
    pub const fn new() -> Self {
        Self
    }
}

impl<Y: Bumpers> Interrupt<Y> for Bumper {
    fn fired(&self, y: &Y) -> bool {
        y.pressed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    #[test]
    fn fires_while_a_bumper_is_pressed() {
        assert!(!Bumper::new().fired(&Sensed::default()));
        assert!(Bumper::new().fired(&Sensed { pressed: true, ..Sensed::default() }));
    }
}
