//! What differs from ATRV to ATRV: a TOML file, the defaults, and where each value came from.

use std::fmt;
use std::path::Path;
use std::time::Duration;

use mdle_runtime::capability::Steering;
use mdle_serial::{Settings, can_steer, within};
use serde::Deserialize;

use crate::command::Escape;

/// What is known of the robot at hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Its serial port, or `tcp:ADDRESS:PORT`.
    pub device: String,
    /// What the controller counts for a metre.
    pub units_per_metre: f64,
    /// And for a radian.
    pub units_per_radian: f64,
    /// What a sonar counts for a metre.
    pub counts_per_metre: f64,
    /// The fastest that a side may go, in m/s.
    pub fastest: f64,
    /// The distance between the sides, as laws are to take it, in metres.
    pub wheel_base: f64,
    /// How fast the speed changes, in m/s².
    pub acceleration: f64,
    /// How fast the turn rate changes, in the controller's units.
    pub rotation_acceleration: u32,
    /// The most torque forward, in the controller's units.
    pub translation_torque: u32,
    /// And in turns.
    pub rotation_torque: u32,
    /// Whether a speed of 0 is sent as 1 unit.
    pub zero_as_one: bool,
    /// What is done about bytes that are 1B.
    pub escape: Escape,
    /// Sonars: 24 on four boards, or 16 on two.
    pub sonars: u8,
    /// How long a board waits for echoes, in microseconds.
    pub echo: u32,
    /// Ranges beyond this are none, in metres.
    pub reach: f64,
    /// The address of the first bumper.
    pub bumper_address: u8,
    /// Whether both bumpers are bits of one address, and not addresses of their own.
    pub bumpers_are_bits: bool,
    /// How often the robot tells where it is, in milliseconds.
    pub reports: u64,
    /// How often it is asked for its brake, in milliseconds.
    pub status: u64,
    /// How long it may say nothing, in milliseconds.
    pub answer: u64,
    /// The longest time between two reports of a bumper, in milliseconds; 0 for ever.
    pub inputs: u64,
    /// The longest time in which the robot moves faster than commanded, or in the opposite direction, in milliseconds; 0 for no limit.
    pub disobey: u64,
    /// After how many milliseconds without a turn it is stopped.
    pub watchdog: u64,
    /// How long it is left alone after each command, in milliseconds.
    pub pause: u64,
    /// By how much the battery's voltage is above what the controller says, in volts.
    pub battery_offset: f64,
    /// Below which voltage the battery is low.
    pub low_battery: f64,
    /// Above which voltage it is being charged.
    pub plugged_above: f64,
    /// How hard laws steer.
    pub steering: Steering,
}

/// The file: whatever it does not say stays as it is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct File {
    device: Option<String>,
    units_per_metre: Option<f64>,
    units_per_radian: Option<f64>,
    counts_per_metre: Option<f64>,
    fastest: Option<f64>,
    wheel_base: Option<f64>,
    acceleration: Option<f64>,
    rotation_acceleration: Option<u32>,
    translation_torque: Option<u32>,
    rotation_torque: Option<u32>,
    zero_as_one: Option<bool>,
    escape: Option<String>,
    sonars: Option<u8>,
    echo: Option<u32>,
    reach: Option<f64>,
    bumper_address: Option<u8>,
    bumpers: Option<String>,
    reports: Option<u64>,
    status: Option<u64>,
    answer: Option<u64>,
    inputs: Option<u64>,
    disobey: Option<u64>,
    watchdog: Option<u64>,
    pause: Option<u64>,
    battery_offset: Option<f64>,
    low_battery: Option<f64>,
    plugged_above: Option<f64>,
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
        let config = said.completed(&mut made, device).and_then(|config| config.check().map(|()| config));
        let config = config.map_err(|why| made.blamed(&why))?;
        Ok(Self { config, settings: made })
    }
}

impl File {
    /// With a default for whatever it does not say.
    fn completed(self, made: &mut Settings, device: Option<&str>) -> Result<Config, String> {
        Ok(Config {
            device: made.device(device, self.device),
            units_per_metre: made.value(
                "units-per-metre",
                self.units_per_metre,
                139_654.7,
                "what the controller counts; unverified",
            ),
            units_per_radian: made.value(
                "units-per-radian",
                self.units_per_radian,
                49_784.5,
                "what the controller counts; unverified",
            ),
            counts_per_metre: made.value(
                "counts-per-metre",
                self.counts_per_metre,
                1550.0,
                "what a sonar counts; unverified",
            ),
            fastest: made.value("fastest", self.fastest, 1.2, "m/s of a side; unverified"),
            wheel_base: made.value("wheel-base", self.wheel_base, 0.4, "m between the sides; unverified"),
            acceleration: made.value("acceleration", self.acceleration, 1.0, "m/s²; unverified"),
            rotation_acceleration: made.value("rotation-acceleration", self.rotation_acceleration, 100_000, "units/s²"),
            translation_torque: made.value("translation-torque", self.translation_torque, 30_000, "units"),
            rotation_torque: made.value("rotation-torque", self.rotation_torque, 35_000, "units"),
            zero_as_one: made.value("zero-as-one", self.zero_as_one, true, "tells speed 0 as 1 unit; unverified"),
            escape: escape(&made.value(
                "escape",
                self.escape,
                "avoid".to_owned(),
                "bytes 1B: \"avoid\" or \"mark\"; unverified",
            ))?,
            sonars: made.value("sonars", self.sonars, 24, "24 on four boards, or 16 on two; unverified"),
            echo: made.value("echo", self.echo, 30_000, "µs that a board waits for echoes"),
            reach: made.value("reach", self.reach, 4.0, "m beyond which there is no echo; unverified"),
            bumper_address: made.value("bumper-address", self.bumper_address, 0x40, "of the front bumper"),
            bumpers_are_bits: bumpers_are_bits(&made.value(
                "bumpers",
                self.bumpers,
                "addresses".to_owned(),
                "\"addresses\": one each; \"bits\": of one; unverified",
            ))?,
            reports: made.value("reports", self.reports, 50, "ms between two reports of where it is"),
            status: made.value("status", self.status, 1000, "ms between two questions for its brake"),
            answer: made.value("answer", self.answer, 300, "ms that it may say nothing"),
            inputs: made.value("inputs", self.inputs, 1000, "ms that a bumper may say nothing, 0 for ever; unverified"),
            disobey: made.value(
                "disobey",
                self.disobey,
                500,
                "ms that it may move faster than commanded, or in the opposite direction, 0 for no limit; unverified",
            ),
            watchdog: made.value("watchdog", self.watchdog, 500, "ms without a turn until it is stopped"),
            pause: made.value("pause", self.pause, 1, "ms after each command"),
            battery_offset: made.value(
                "battery-offset",
                self.battery_offset,
                1.82,
                "V by which it is above what it tells; unverified",
            ),
            low_battery: made.value(
                "low-battery",
                self.low_battery,
                21.0,
                "V below which the battery is low; unverified",
            ),
            plugged_above: made.value(
                "plugged-above",
                self.plugged_above,
                27.6,
                "V above which it is being charged; unverified",
            ),
            steering: made.steering(self.rotate_gain, self.align_gain, self.avoid_gain),
        })
    }
}

fn escape(said: &str) -> Result<Escape, String> {
    match said {
        "avoid" => Ok(Escape::Avoid),
        "mark" => Ok(Escape::Mark),
        other => Err(format!("`escape` is {other:?}, and has to be \"avoid\" or \"mark\"")),
    }
}

fn bumpers_are_bits(said: &str) -> Result<bool, String> {
    match said {
        "addresses" => Ok(false),
        "bits" => Ok(true),
        other => Err(format!("`bumpers` is {other:?}, and has to be \"addresses\" or \"bits\"")),
    }
}

impl Config {
    fn check(&self) -> Result<(), String> {
        within("units-per-metre", self.units_per_metre, 1000.0, 1e6)?;
        within("units-per-radian", self.units_per_radian, 1000.0, 1e6)?;
        within("counts-per-metre", self.counts_per_metre, 100.0, 10_000.0)?;
        within("fastest", self.fastest, 0.01, 1.5)?;
        within("wheel-base", self.wheel_base, 0.1, 1.0)?;
        within("acceleration", self.acceleration, 0.1, 5.0)?;
        within("rotation-acceleration", f64::from(self.rotation_acceleration), 1000.0, 1e6)?;
        within("translation-torque", f64::from(self.translation_torque), 1.0, 1e6)?;
        within("rotation-torque", f64::from(self.rotation_torque), 1.0, 1e6)?;
        within("echo", f64::from(self.echo), 1000.0, 100_000.0)?;
        within("reach", self.reach, 0.2, 10.0)?;
        within("reports", self.reports as f64, 20.0, 200.0)?;
        within("status", self.status as f64, 200.0, 60_000.0)?;
        within("answer", self.answer as f64, 50.0, 400.0)?;
        within("inputs", self.inputs as f64, if self.inputs == 0 { 0.0 } else { 300.0 }, 60_000.0)?;
        within("disobey", self.disobey as f64, 0.0, 60_000.0)?;
        within("watchdog", self.watchdog as f64, 150.0, 5000.0)?;
        within("pause", self.pause as f64, 0.0, 10.0)?;
        within("battery-offset", self.battery_offset, -5.0, 5.0)?;
        within("low-battery", self.low_battery, 10.0, 30.0)?;
        within("plugged-above", self.plugged_above, self.low_battery, 40.0)?;
        can_steer(&self.steering)?;
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

    /// How long the robot may say nothing.
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
