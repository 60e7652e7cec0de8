//! Converts a battery message to the power supply of an output.

use mdle_runtime::{Supply, Volts};

use crate::messages::BatteryState;

/// Value of `power_supply_status` while the battery is charging.
const CHARGING: u8 = 1;
const FULL: u8 = 4;

/// Maximum valid charge, because full batteries report a little more than 1. Percentages, which some robots report by
/// mistake, are rejected.
const MOST: f64 = 1.5;

/// Returns the power supply that `message` reports. The battery is low if its charge is below `low`, where 1 means
/// full.
///
/// # Errors
/// Returns the reason, as the end of a sentence about the message, if the charge is not a number from 0 to 1.5.
pub fn supply(message: &BatteryState, low: f64) -> Result<Supply, String> {
    let charge = f64::from(message.percentage);
    if charge.is_nan() {
        return Err("`percentage` is no number, as where a robot does not measure the charge".to_owned());
    }
    if !(0.0..=MOST).contains(&charge) {
        return Err(format!("`percentage` is {}, and has to be from 0 to {MOST}; 1 is full", message.percentage));
    }
    Ok(Supply {
        battery: Volts(f64::from(message.voltage)),
        is_low: charge < low,
        is_plugged: [CHARGING, FULL].contains(&message.power_supply_status),
    })
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
        let known = |percentage, status| state(percentage, status).unwrap();
        assert_eq!(known(0.1, 2), Supply { battery: Volts(14.5), is_low: true, is_plugged: false });
        assert!(!known(0.15, 2).is_low && !known(1.02, 2).is_low);
        assert!(known(0.1, 1).is_plugged && known(1.0, 4).is_plugged && !known(1.0, 3).is_plugged);
        assert!(state(f32::NAN, 0).unwrap_err().contains("is no number"));
        assert_eq!(state(80.0, 0).unwrap_err(), "`percentage` is 80, and has to be from 0 to 1.5; 1 is full");
        assert!(state(-1.0, 0).is_err() && state(f32::INFINITY, 0).is_err());
    }
}
