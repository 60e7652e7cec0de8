//! Configuration of a Scout: values from a TOML file and defaults, and the source of each value.

use std::time::Duration;

/// Usual order in which a Scout's sonars ping.
const ORDER: [u8; 16] = [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8];

/// A configuration with the source of each value.
pub type Configured = mdle_serial::Configured<Config>;

mdle_serial::configuration! {
    /// Properties of a Scout.
    Config;

    /// Maximum speed of a wheel, in m/s.
    fastest: f64 = 1.0, in 0.01..=1.0, "m/s" "of a wheel", unverified;
    /// Maximum acceleration of a wheel, in m/s².
    acceleration: f64 = 2.0, in 0.1..=10.0, "m/s²" "of a wheel", unverified;
    /// Time without a command after which the robot stops itself, in seconds.
    watchdog: u8 = 1, in 1..=60, "s" "without a command until the robot stops itself";
    /// Timeout for an answer, in milliseconds.
    answer: u64 = 300, in 50..=400, "ms" "that an answer may take";
    /// Maximum time without an advance of the robot's clock before its data are stale, in milliseconds; 0 for no limit.
    stale: u64 = 500, in 0..=60_000, "ms" "that its clock may stand, 0 for ever", unverified;
    /// Maximum distance that the robot drives while its sonars report the same ranges, in metres; 0 for no limit.
    frozen: f64 = 1.0, in 0.0..=100.0, "m" "of way on which its sonars may say the same, 0 for ever";
    /// Maximum time for which the robot moves faster than commanded, or in the opposite direction, in milliseconds;
    /// 0 for no limit.
    disobey: u64 = 500, in 0..=60_000,
        "ms" "that it may move faster than commanded, or in the opposite direction, 0 for no limit", unverified;
    /// Sonars that ping, in the order of their pings.
    sonars: Vec<u8> = ORDER.to_vec(), "" "which ping, in this order";
    /// Interval between two pings, in milliseconds.
    gap: u64 = 60, in 4..=1020, "ms" "between two pings";
    /// Distance of the sonars from the body's centre, in metres.
    ring_radius: f64 = 0.19, in 0.0..=0.5, "m" "from the centre to a sonar", unverified;
    /// Voltage below which the battery is low, in volts.
    low_battery: f64 = 10.8, in 5.0..=12.0, "V" "below which the battery is low";
}

impl Config {
    /// Checks conditions on the values that cannot be expressed as the range of a single value.
    fn check(&self) -> Result<(), String> {
        if !self.gap.is_multiple_of(4) {
            return Err(format!("`gap` is {}, and the robot counts it in steps of 4 ms", self.gap));
        }
        if let Some(sonar) = self.sonars.iter().find(|sonar| **sonar > 15) {
            return Err(format!("`sonars` names sonar {sonar}, and they are numbered from 0 to 15"));
        }
        if self.sonars.len() > 16 {
            return Err(format!("`sonars` names {}, and there are 16", self.sonars.len()));
        }
        Ok(())
    }

    /// Returns the order of the sonars in the robot's format. In this format, unused entries are 255.
    #[must_use]
    pub fn order(&self) -> [u8; 16] {
        std::array::from_fn(|place| self.sonars.get(place).copied().unwrap_or(255))
    }

    /// Returns the timeout for an answer.
    #[must_use]
    pub const fn patience(&self) -> Duration {
        Duration::from_millis(self.answer)
    }
}
