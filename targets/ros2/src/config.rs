//! Configuration of a robot that speaks ROS 2: values from a TOML file and defaults, and the source of each value.

use std::fmt;
use std::path::Path;
use std::time::Duration;

use mdle_runtime::Meters;
use mdle_runtime::Shape;
use mdle_serial::{Key, Settings, Steering, shortened};

use crate::choices::{BumperSource, Distribution, RangeSensors, Stamped};
use crate::names::absolute;

/// Maximum DDS domain id; no ports exist for higher ids.
const LAST_DOMAIN: u64 = 232;

/// Declares the configuration. Each line declares one key: `name: type = default, in range, "unit" "help";`.
macro_rules! configuration {
    ($(
        $(#[$meta:meta])*
        $key:ident: $type:ty = $default:expr, $(in $least:literal..=$most:literal,)? $unit:literal $help:literal;
    )*) => {
        /// Properties of a robot, and its place on the ROS graph.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Config {
            $($(#[$meta])* pub $key: $type,)*
            /// Gains of the laws that steer.
            pub steering: Steering,
        }

        /// Returns the values of `settings`, with the default for each missing key.
        fn values(settings: &mut Settings) -> Result<Config, String> {
            Ok(Config {
                $($key: settings.value(
                    Key {
                        name: stringify!($key),
                        unit: $unit,
                        help: $help,
                        is_verified: true,
                        range: configuration!(@range $($least, $most)?),
                    },
                    $default,
                )?,)*
                steering: settings.steering()?,
            })
        }
    };
    (@range) => { None };
    (@range $least:literal, $most:literal) => { Some(($least as f64, $most as f64)) };
}

configuration! {
    /// ROS 2 distribution on the robot.
    distribution: Distribution = "jazzy".to_owned(), "" "humble, jazzy or kilted";
    /// DDS domain id; the default is the value of the environment variable `ROS_DOMAIN_ID`.
    domain: u64 = given_domain().unwrap_or_default(), in 0..=232, "" "domain id; its default is that of ROS_DOMAIN_ID";
    /// Namespace of relative topics.
    namespace: String = String::new(), "" "namespace of topics without a slash in front";
    /// Address of the only network interface to use; empty for all networks.
    network: String = String::new(), "" "address of the only network to use; empty for all";
    /// Topic of velocity commands.
    cmd_vel: String = "cmd_vel".to_owned(), "" "topic of velocity commands";
    /// Type of velocity commands.
    stamped: Stamped = crate::choices::WrittenStamped::Word("auto".to_owned()),
        "" "commands are TwistStamped; auto: as their subscriber wants";
    /// Frame in the header of stamped commands.
    frame_id: String = "base_link".to_owned(), "" "frame of stamped commands";
    /// Topic of the odometry.
    odom: String = "odom".to_owned(), "" "topic of nav_msgs/Odometry";
    /// Topic of the laser scan; empty if the robot has no scanner.
    scan: String = "scan".to_owned(), "" "topic of sensor_msgs/LaserScan; empty without one";
    /// Distance of the scanner ahead of the body's centre, in metres.
    scan_x: f64 = 0.0, in -10..=10, "m" "from the centre ahead to the scanner";
    /// Distance of the scanner to the left of the body's centre, in metres.
    scan_y: f64 = 0.0, in -10..=10, "m" "from the centre to the left to the scanner";
    /// Direction of the scanner's zero angle, in radians, counter-clockwise from the front.
    scan_yaw: f64 = 0.0, in -6.3..=6.3, "rad" "from the front to the scanner's zero, counter-clockwise";
    /// `true` if the scanner reports a range of 0 where nothing echoes.
    scan_zero_is_free: bool = false, "" "a range of 0 means that nothing echoes";
    /// Range sensors, each with its own topic.
    ranges: RangeSensors = Vec::new(), "" "range sensors: { topic, x, y, yaw } in m and rad";
    /// Source of the states of the bumper switches.
    bumper_type: BumperSource = "none".to_owned(), "" "none, bool, hazard or scan";
    /// Topic of the bumper, if its messages are of type `Bool` or `HazardDetectionVector`.
    bumper: String = "bumper".to_owned(), "" "topic of a bumper that is bool or hazard";
    /// Distance from the body within which an obstacle in the scan is treated as a contact, in metres.
    bumper_margin: f64 = 0.02, in 0.0..=1.0, "m" "around the body, for a bumper by scan";
    /// Topic of the battery; empty if the robot reports no battery.
    battery: String = String::new(), "" "topic of sensor_msgs/BatteryState; empty without one";
    /// Charge below which the battery is low, from 0 to 1.
    low_battery: f64 = 0.15, in 0.0..=1.0, "" "of the charge, below which the battery is low";
    /// Radius of the smallest circle around the body, in metres.
    body_radius: f64 = 0.18, in 0.01..=5.0, "m" "radius of the smallest circle around the body";
    /// Half the length of the body, in metres; 0 for a round body.
    half_length: f64 = 0.0, in 0.0..=5.0, "m" "half the length of the body; 0 for a round one";
    /// Half the width of the body, in metres; 0 for a round body.
    half_width: f64 = 0.0, in 0.0..=5.0, "m" "half the width of the body; 0 for a round one";
    /// Distance between the wheels, in metres.
    wheel_base: f64 = 0.23, in 0.01..=5.0, "m" "between the wheels";
    /// Distance from the centre from which the ranges of the sixteen directions are measured, in metres.
    ring_radius: f64 = 0.18, in 0.0..=5.0, "m" "from the centre to where ranges of directions begin";
    /// Maximum speed, in m/s.
    fastest: f64 = 0.3, in 0.01..=2.0, "m/s" "maximum speed";
    /// Maximum turn rate, in rad/s.
    fastest_turn: f64 = 1.5, in 0.01..=6.0, "rad/s" "maximum turn rate";
    /// Time without odometry after which the robot is stopped, in milliseconds.
    stale_odom: u64 = 500, in 50..=60_000, "ms" "without odometry until the robot is stopped";
    /// Time without a scan or a range after which the robot is stopped, in milliseconds.
    stale_scan: u64 = 1000, in 50..=60_000, "ms" "without a scan or a range until the robot is stopped";
    /// Time without a bumper message after which the robot is stopped, in milliseconds; 0 for no limit.
    stale_bumper: u64 = 0, in 0..=60_000, "ms" "without the bumper until the robot is stopped; 0 for no limit";
    /// Maximum distance, in metres, by which a step of odometry may exceed the longest path that the robot can have
    /// driven in the time of that step.
    jump: f64 = 0.3, in 0.01..=100.0, "m" "by which odometry may differ from the fastest way";
    /// Maximum time to find all topics of the robot, in milliseconds.
    discovery: u64 = 10_000, in 100..=600_000, "ms" "to find all topics";
    /// `true` if time is read from the topic `/clock`.
    use_sim_time: bool = false, "" "time is that of the topic /clock";
    /// Topic of the plan's state as JSON text; empty if it is not published.
    state: String = "mdle/state".to_owned(), "" "topic of the plan's state, as JSON; empty for none";
    /// Topic of the plan's state as a diagnostic array; empty if it is not published.
    diagnostics: String = "/diagnostics".to_owned(), "" "topic of the plan's state, as diagnostics; empty for none";
}

/// Returns the domain id in the environment variable `ROS_DOMAIN_ID`, which all ROS 2 programs read; 0 if it is not
/// set.
///
/// # Errors
/// Returns a sentence if the variable's value is not a domain id.
fn given_domain() -> Result<u64, String> {
    domain_of(&std::env::var_os("ROS_DOMAIN_ID").unwrap_or_default().to_string_lossy())
}

/// Returns the domain id in `text`, the value of `ROS_DOMAIN_ID`; 0 if `text` is empty.
fn domain_of(text: &str) -> Result<u64, String> {
    let number = if text.trim().is_empty() { Ok(0) } else { text.trim().parse() };
    number.ok().filter(|domain| *domain <= LAST_DOMAIN).ok_or_else(|| {
        format!(
            "the variable ROS_DOMAIN_ID is `{}`, and has to be a number from 0 to {LAST_DOMAIN}; a file with `domain` \
             does not need it",
            shortened(text)
        )
    })
}

/// A configuration, with the source of each value.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured {
    /// Values of the configuration.
    pub config: Config,
    settings: Settings,
}

impl Configured {
    /// Reads the configuration file `file`. Without a file, the configuration consists of the defaults.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not TOML, or has an unknown key or an invalid value. The message contains
    /// the place in the file and the reason.
    pub fn read(file: Option<&Path>) -> Result<Self, String> {
        let mut settings = Settings::read(file)?;
        if !settings.has("domain") {
            given_domain()?;
        }
        let config = values(&mut settings)?;
        settings.check()?;
        config.check().map_err(|why| settings.blamed(&why))?;
        Ok(Self { config, settings })
    }
}

/// Prints the configuration as TOML that the option `--config` can read. The default domain is printed as a comment,
/// because a domain in the file would override `ROS_DOMAIN_ID`.
impl fmt::Display for Configured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.settings.to_string().lines() {
            let is_default = line.starts_with("domain = ") && line.ends_with("(default)");
            writeln!(f, "{}{line}", if is_default { "# " } else { "" })?;
        }
        Ok(())
    }
}

impl Config {
    /// Returns the absolute name of the topic `name`.
    ///
    /// # Errors
    /// Returns the reason, as a sentence, if `name` is not a valid topic name.
    pub fn topic(&self, name: &str) -> Result<String, String> {
        absolute(&self.namespace, name)
    }

    /// Returns the maximum time between two commands to the robot.
    #[must_use]
    pub fn longest_gap(&self) -> Duration {
        Duration::from_millis(self.stale_odom.max(self.stale_scan))
    }

    /// Returns the shape of the body, as laws use it.
    #[must_use]
    pub fn shape(&self) -> Shape {
        let half = |length: f64| Meters(if length > 0.0 { length } else { self.body_radius });
        Shape {
            body_radius: Meters(self.body_radius),
            half_length: half(self.half_length),
            half_width: half(self.half_width),
            sonars_apart: None,
            wheel_base: Meters(self.wheel_base),
            ring_radius: Meters(self.ring_radius),
            confirmation: 3,
            steering: self.steering,
        }
    }
}

/// Returns `true` if `bumper` has its own topic.
pub(crate) fn has_topic(bumper: BumperSource) -> bool {
    match bumper {
        BumperSource::Bool | BumperSource::Hazard => true,
        BumperSource::None | BumperSource::Scan => false,
    }
}

mod checks;
#[cfg(test)]
mod tests;
