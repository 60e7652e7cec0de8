//! The interrupts `lowBattery` and `charger` and the signal `battery`, for plans that bring their robot back to its
//! charger (not in the paper).

use mdle_runtime::capability::Power;
use mdle_runtime::{Interrupt, Signal};

/// The interrupt `lowBattery`, which fires while the robot reports a low battery. The robot's own limit determines when
/// the battery is low.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LowBattery;

impl LowBattery {
    /// Creates the quark `lowBattery`.
    #[must_use]
    pub const fn new() -> Self {
        Self
    }
}

impl<Y: Power> Interrupt<Y> for LowBattery {
    fn fired(&self, y: &Y) -> bool {
        y.is_low()
    }
}

/// The interrupt `charger`, which fires while the robot is on its charger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Charger;

impl Charger {
    /// Creates the quark `charger`.
    #[must_use]
    pub const fn new() -> Self {
        Self
    }
}

impl<Y: Power> Interrupt<Y> for Charger {
    fn fired(&self, y: &Y) -> bool {
        y.is_plugged()
    }
}

/// The voltage of the battery, in volts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Battery;

impl Battery {
    /// Creates the signal `battery`.
    #[must_use]
    pub const fn new() -> Self {
        Self
    }
}

impl<Y: Power> Signal<Y> for Battery {
    fn value(&self, y: &Y) -> f64 {
        y.battery().0
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Supply, Volts};

    use super::*;
    use crate::trial::Sensed;

    #[test]
    fn each_says_what_the_robot_says_of_it() {
        let says = |supply| {
            let y = Sensed { supply, ..Sensed::default() };
            (Battery::new().value(&y), LowBattery::new().fired(&y), Charger::new().fired(&y))
        };
        let full = Supply { battery: Volts(12.5), is_low: false, is_plugged: true };
        assert_eq!(says(full), (12.5, false, true));
        assert_eq!(says(Supply { battery: Volts(10.5), is_low: true, is_plugged: false }), (10.5, true, false));
    }
}
