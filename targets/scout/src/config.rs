//! What differs from Scout to Scout: a TOML file, the defaults, and where each value came from.

use std::time::Duration;

/// The order in which everybody fires a Scout's sonars.
const ORDER: [u8; 16] = [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8];

/// A configuration, and where each of its values came from.
pub type Configured = mdle_serial::Configured<Config>;

mdle_serial::configuration! {
    /// What is known of the robot at hand.
    Config;

    /// The fastest that a wheel may go, in m/s.
    fastest: f64 = 1.0, in 0.01..=1.0, "m/s" "of a wheel", unverified;
    /// The greatest acceleration of a wheel, in m/s².
    acceleration: f64 = 2.0, in 0.1..=10.0, "m/s²" "of a wheel", unverified;
    /// After how many seconds without a command the robot stops itself.
    watchdog: u8 = 1, in 1..=60, "s" "without a command until the robot stops itself";
    /// How long an answer may take, in milliseconds.
    answer: u64 = 300, in 50..=400, "ms" "that an answer may take";
    /// After how many milliseconds in which its clock stands what it says is old; 0 for never.
    stale: u64 = 500, in 0..=60_000, "ms" "that its clock may stand, 0 for ever", unverified;
    /// How far it may go while its sonars say the same, in metres; 0 for ever.
    frozen: f64 = 1.0, in 0.0..=100.0, "m" "of way on which its sonars may say the same, 0 for ever";
    /// The longest time in which the robot moves faster than commanded, or in the opposite direction, in milliseconds; 0 for no limit.
    disobey: u64 = 500, in 0..=60_000,
        "ms" "that it may move faster than commanded, or in the opposite direction, 0 for no limit", unverified;
    /// Which sonars ping, in which order.
    sonars: Vec<u8> = ORDER.to_vec(), "" "which ping, in this order";
    /// The time between two pings, in milliseconds.
    gap: u64 = 60, in 4..=1020, "ms" "between two pings";
    /// The distance of the transducers from the centre, in metres.
    ring_radius: f64 = 0.19, in 0.0..=0.5, "m" "from the centre to a sonar", unverified;
    /// Below which voltage the battery is low.
    low_battery: f64 = 10.8, in 5.0..=12.0, "V" "below which the battery is low";
}

impl Config {
    /// Checks what a range does not say.
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

    /// The order of the sonars as the robot takes it: what is not used ends with 255.
    #[must_use]
    pub fn order(&self) -> [u8; 16] {
        std::array::from_fn(|place| self.sonars.get(place).copied().unwrap_or(255))
    }

    /// How long an answer may take.
    #[must_use]
    pub const fn patience(&self) -> Duration {
        Duration::from_millis(self.answer)
    }
}
