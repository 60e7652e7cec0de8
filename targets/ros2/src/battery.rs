//! Conversion of a battery message to the power supply of an output.

use mdle_runtime::{Supply, Volts};

use crate::messages::BatteryState;

/// Value of `power_supply_status` while the battery is charging.
const CHARGING: u8 = 1;
const FULL: u8 = 4;

/// Returns the power supply that `message` reports. The battery is low if its charge, from 0 to 1, is below `low`; a
/// charge that is not a number is never low.
#[must_use]
pub fn supply(message: &BatteryState, low: f64) -> Supply {
    let charge = f64::from(message.percentage);
    Supply {
        battery: Volts(f64::from(message.voltage)),
        is_low: charge < low,
        is_plugged: [CHARGING, FULL].contains(&message.power_supply_status),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_battery_is_low_by_its_charge() {
        let state = |percentage, power_supply_status| {
            let message = BatteryState { voltage: 14.5, percentage, power_supply_status, ..BatteryState::default() };
            supply(&message, 0.15)
        };
        assert_eq!(state(0.1, 2), Supply { battery: Volts(14.5), is_low: true, is_plugged: false });
        assert!(!state(0.15, 2).is_low && !state(f32::NAN, 0).is_low);
        assert!(state(0.1, 1).is_plugged && state(1.0, 4).is_plugged && !state(1.0, 3).is_plugged);
    }
}
