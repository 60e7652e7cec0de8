//! Configuration of an ATRV: values from a TOML file and defaults, and the source of each value.

use std::time::Duration;

use mdle_serial::{Key, Setting, one_of, quoted, within};

use crate::command::Escape;

/// A configuration with the source of each value.
pub type Configured = mdle_serial::Configured<Config>;

mdle_serial::configuration! {
    /// Properties of an ATRV.
    Config;

    /// Number of controller units per metre.
    units_per_metre: f64 = 139_654.7, in 1000.0..=1e6, "" "what the controller counts", unverified;
    /// Number of controller units per radian.
    units_per_radian: f64 = 49_784.5, in 1000.0..=1e6, "" "what the controller counts", unverified;
    /// Number of sonar counts per metre.
    counts_per_metre: f64 = 1550.0, in 100.0..=10_000.0, "" "what a sonar counts", unverified;
    /// Maximum speed of the wheels of one side, in m/s.
    fastest: f64 = 1.2, in 0.01..=1.5, "m/s" "of a side", unverified;
    /// Distance between the wheels of the left and of the right side, as laws use it, in metres.
    wheel_base: f64 = 0.4, in 0.1..=1.0, "m" "between the sides", unverified;
    /// Acceleration of the robot, in m/s².
    acceleration: f64 = 1.0, in 0.1..=5.0, "m/s²" "", unverified;
    /// Acceleration of a rotation, in the controller's units per second squared.
    rotation_acceleration: u32 = 100_000, in 1000..=1e6, "units/s²" "";
    /// Maximum torque of a translation, in the controller's units.
    translation_torque: u32 = 30_000, in 1..=1e6, "units" "";
    /// Maximum torque of a rotation, in the controller's units.
    rotation_torque: u32 = 35_000, in 1..=1e6, "units" "";
    /// `true` if a speed of 0 is sent as a speed of 1 unit.
    zero_as_one: bool = true, "" "tells speed 0 as 1 unit", unverified;
    /// Treatment of bytes with the value 1B.
    escape: Escape = "avoid".to_owned(), "" "bytes 1B: \"avoid\" or \"mark\"", unverified;
    /// Number of sonars: 24 on four boards, or 16 on two boards.
    sonars: u8 = 24, "" "24 on four boards, or 16 on two", unverified;
    /// Maximum time for which a board waits for echoes, in microseconds.
    echo: u32 = 30_000, in 1000..=100_000, "µs" "that a board waits for echoes";
    /// Range beyond which an echo is ignored, in metres.
    reach: f64 = 4.0, in 0.2..=10.0, "m" "beyond which there is no echo", unverified;
    /// Address of the front bumper.
    bumper_address: u8 = 0x40, "" "of the front bumper";
    /// Form in which the controller reports bumpers.
    bumpers: Bumpers = "addresses".to_owned(), "" "\"addresses\": one each; \"bits\": of one", unverified;
    /// Interval of position reports, in milliseconds.
    reports: u64 = 50, in 20..=200, "ms" "between two reports of where it is";
    /// Interval of requests for the state of the brake, in milliseconds.
    status: u64 = 1000, in 200..=60_000, "ms" "between two questions for its brake";
    /// Maximum time without a position report, in milliseconds.
    answer: u64 = 300, in 50..=400, "ms" "that it may say nothing";
    /// Maximum time without a report of a bumper, in milliseconds; 0 for no limit.
    inputs: u64 = 1000, in 0..=60_000, "ms" "that a bumper may say nothing, 0 for ever", unverified;
    /// Maximum time for which the robot moves faster than commanded, or in the opposite direction, in milliseconds;
    /// 0 for no limit.
    disobey: u64 = 500, in 0..=60_000,
        "ms" "that it may move faster than commanded, or in the opposite direction, 0 for no limit", unverified;
    /// Time without a motion command after which the watchdog stops the robot, in milliseconds.
    watchdog: u64 = 500, in 150..=5000, "ms" "without a turn until it is stopped";
    /// Pause after each command, in milliseconds.
    pause: u64 = 1, in 0..=10, "ms" "after each command";
    /// Difference between the battery's voltage and the voltage that the controller reports, in volts.
    battery_offset: f64 = 1.82, in -5.0..=5.0, "V" "by which it is above what it tells", unverified;
    /// Voltage below which the battery is low, in volts.
    low_battery: f64 = 21.0, in 10.0..=30.0, "V" "below which the battery is low", unverified;
    /// Voltage above which the battery is being charged, in volts.
    plugged_above: f64 = 27.6, "V" "above which it is being charged", unverified;
}

/// Form in which the controller reports bumpers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bumpers {
    /// Each bumper has its own address.
    Addresses,
    /// Both bumpers are bits of one address.
    Bits,
}

impl Setting for Bumpers {
    type Written = String;

    fn expected(_: &Key) -> String {
        quoted(&["addresses", "bits"])
    }

    fn of(key: &Key, written: String) -> Result<Self, String> {
        one_of(key, &written, &[("addresses", Self::Addresses), ("bits", Self::Bits)])
    }
}

impl Setting for Escape {
    type Written = String;

    fn expected(_: &Key) -> String {
        quoted(&["avoid", "mark"])
    }

    fn of(key: &Key, written: String) -> Result<Self, String> {
        one_of(key, &written, &[("avoid", Self::Avoid), ("mark", Self::Mark)])
    }
}

impl Config {
    /// Checks conditions on the values that cannot be expressed as the range of a single value.
    fn check(&self) -> Result<(), String> {
        within("inputs", self.inputs as f64, if self.inputs == 0 { 0.0 } else { 300.0 }, 60_000.0)?;
        within("plugged-above", self.plugged_above, self.low_battery, 40.0)?;
        if ![16, 24].contains(&self.sonars) {
            return Err(format!("`sonars` is {}, and robots with 24 or 16 are known", self.sonars));
        }
        if self.reports >= self.answer {
            return Err(format!(
                "`answer` is {}, and has to be more than the {} ms between two `reports`",
                self.answer, self.reports
            ));
        }
        Ok(())
    }

    /// Returns the maximum time without a position report.
    #[must_use]
    pub const fn patience(&self) -> Duration {
        Duration::from_millis(self.answer)
    }
}
