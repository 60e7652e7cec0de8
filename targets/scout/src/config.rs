//! What differs from Scout to Scout: a TOML file, the defaults, and where each value came from.

use std::fmt;
use std::path::Path;
use std::time::Duration;

use mdle_runtime::capability::Steering;
use mdle_serial::{Settings, can_steer, within};
use serde::Deserialize;

/// The order in which everybody fires a Scout's sonars.
const ORDER: [u8; 16] = [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8];

/// What is known of the robot at hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Its serial port, or `tcp:ADDRESS:PORT`.
    pub device: String,
    /// The fastest that a wheel may go, in m/s.
    pub fastest: f64,
    /// The greatest acceleration of a wheel, in m/s².
    pub acceleration: f64,
    /// After how many seconds without a command the robot stops itself.
    pub watchdog: u8,
    /// How long an answer may take, in milliseconds.
    pub answer: u64,
    /// After how many milliseconds in which its clock stands what it says is old; 0 for never.
    pub stale: u64,
    /// How far it may go while its sonars say the same, in metres; 0 for ever.
    pub frozen: f64,
    /// The longest time in which the robot moves faster than commanded, or in the opposite direction, in milliseconds; 0 for no limit.
    pub disobey: u64,
    /// Which sonars ping, in which order.
    pub sonars: Vec<u8>,
    /// The time between two pings, in milliseconds.
    pub gap: u64,
    /// The distance of the transducers from the centre, in metres.
    pub ring_radius: f64,
    /// Below which voltage the battery is low.
    pub low_battery: f64,
    /// How hard laws steer.
    pub steering: Steering,
}

/// The file: whatever it does not say stays as it is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct File {
    device: Option<String>,
    fastest: Option<f64>,
    acceleration: Option<f64>,
    watchdog: Option<u8>,
    answer: Option<u64>,
    stale: Option<u64>,
    frozen: Option<f64>,
    disobey: Option<u64>,
    sonars: Option<Vec<u8>>,
    gap: Option<u64>,
    ring_radius: Option<f64>,
    low_battery: Option<f64>,
    rotate_gain: Option<f64>,
    align_gain: Option<f64>,
    avoid_gain: Option<f64>,
}

/// A configuration, and where each of its values came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured {
    /// The values.
    pub config: Config,
    settings: Settings,
}

impl Configured {
    /// What the file says, if there is one, and `device`, if it was given; for the rest the defaults.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, has a key that there is not, or a value that makes no sense: where and why.
    pub fn read(file: Option<&Path>, device: Option<&str>) -> Result<Self, String> {
        let (said, mut made) = Settings::read::<File>(file)?;
        let config = Config {
            device: made.device(device, said.device),
            fastest: made.value("fastest", said.fastest, 1.0, "m/s of a wheel; unverified"),
            acceleration: made.value("acceleration", said.acceleration, 2.0, "m/s² of a wheel; unverified"),
            watchdog: made.value("watchdog", said.watchdog, 1, "s without a command until the robot stops itself"),
            answer: made.value("answer", said.answer, 300, "ms that an answer may take"),
            stale: made.value("stale", said.stale, 500, "ms that its clock may stand, 0 for ever; unverified"),
            frozen: made.value("frozen", said.frozen, 1.0, "m of way on which its sonars may say the same, 0 for ever"),
            disobey: made.value(
                "disobey",
                said.disobey,
                500,
                "ms that it may move faster than commanded, or in the opposite direction, 0 for no limit; unverified",
            ),
            sonars: made.value("sonars", said.sonars, ORDER.to_vec(), "which ping, in this order"),
            gap: made.value("gap", said.gap, 60, "ms between two pings"),
            ring_radius: made.value("ring-radius", said.ring_radius, 0.19, "m from the centre to a sonar; unverified"),
            low_battery: made.value("low-battery", said.low_battery, 10.8, "V below which the battery is low"),
            steering: made.steering(said.rotate_gain, said.align_gain, said.avoid_gain),
        };
        config.check().map_err(|why| made.blamed(&why))?;
        Ok(Self { config, settings: made })
    }
}

impl Config {
    fn check(&self) -> Result<(), String> {
        within("fastest", self.fastest, 0.01, 1.0)?;
        within("acceleration", self.acceleration, 0.1, 10.0)?;
        within("watchdog", f64::from(self.watchdog), 1.0, 60.0)?;
        within("answer", self.answer as f64, 50.0, 400.0)?;
        within("stale", self.stale as f64, 0.0, 60_000.0)?;
        within("frozen", self.frozen, 0.0, 100.0)?;
        within("disobey", self.disobey as f64, 0.0, 60_000.0)?;
        within("gap", self.gap as f64, 4.0, 1020.0)?;
        within("ring-radius", self.ring_radius, 0.0, 0.5)?;
        within("low-battery", self.low_battery, 5.0, 12.0)?;
        can_steer(&self.steering)?;
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

/// As TOML that can be given back with `--config`.
impl fmt::Display for Configured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.settings.fmt(f)
    }
}
