//! The topics that the driver reads, and their types, as the configuration determines them.

use crate::choices::{BumperSource, Distribution, RANGES};
use crate::config::{Config, has_topic};

/// The purpose of a topic that the driver reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TopicPurpose {
    /// Odometry, of type `nav_msgs/msg/Odometry`.
    Odometry,
    /// Laser scan, of type `sensor_msgs/msg/LaserScan`.
    Scan,
    /// Range of type `sensor_msgs/msg/Range`, from the sensor with this index in the configuration.
    Range(usize),
    /// Bumper switches, of a type that the configuration names.
    Bumper,
    /// Battery, of type `sensor_msgs/msg/BatteryState`.
    Battery,
    /// Clock of a simulation, of type `rosgraph_msgs/msg/Clock`.
    Clock,
}

impl TopicPurpose {
    /// Returns the configuration key that names the topic, and `true` if the only topic of its type on the graph may be
    /// proposed. A bumper topic must not be proposed, because its type is common. Returns `None` for the clock, because
    /// its topic has a fixed name.
    #[must_use]
    pub const fn key(self) -> Option<(&'static str, bool)> {
        match self {
            Self::Odometry => Some(("odom", true)),
            Self::Scan => Some(("scan", true)),
            Self::Battery => Some(("battery", true)),
            Self::Bumper => Some(("bumper", false)),
            Self::Range(_) => Some((RANGES, false)),
            Self::Clock => None,
        }
    }
}

/// A topic that the driver reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Purpose of the topic.
    pub source: TopicPurpose,
    /// Absolute name of the topic.
    pub topic: String,
    /// Type of the messages, such as `std_msgs/msg/Bool`.
    pub kind: &'static str,
    /// Maximum age of the last message, in milliseconds; 0 for no limit.
    pub limit: u64,
}

/// Returns the topics that the driver reads according to `config`, in the order in which a turn processes their
/// messages.
///
/// # Errors
/// Returns a sentence if a topic name is invalid.
pub fn inputs(config: &Config) -> Result<Vec<Input>, String> {
    let mut inputs = Vec::new();
    let mut add = |source, name: &str, kind, limit| {
        config.topic(name).map(|topic| inputs.push(Input { source, topic, kind, limit }))
    };
    if config.use_sim_time {
        add(TopicPurpose::Clock, "/clock", "rosgraph_msgs/msg/Clock", 0)?;
    }
    // The odometry comes before the scan, because it provides the pose of the scan.
    add(TopicPurpose::Odometry, &config.odom, "nav_msgs/msg/Odometry", config.stale_odom)?;
    if has_topic(config.bumper_type) {
        let kind = match config.bumper_type {
            BumperSource::Hazard => "irobot_create_msgs/msg/HazardDetectionVector",
            BumperSource::None | BumperSource::Bool | BumperSource::Scan => "std_msgs/msg/Bool",
        };
        add(TopicPurpose::Bumper, &config.bumper, kind, config.stale_bumper)?;
    }
    if !config.scan.is_empty() {
        add(TopicPurpose::Scan, &config.scan, "sensor_msgs/msg/LaserScan", config.stale_scan)?;
    }
    for (number, sensor) in config.ranges.0.iter().enumerate() {
        add(TopicPurpose::Range(number), &sensor.topic, "sensor_msgs/msg/Range", config.stale_scan)?;
    }
    if !config.battery.is_empty() {
        add(TopicPurpose::Battery, &config.battery, "sensor_msgs/msg/BatteryState", 0)?;
    }
    Ok(inputs)
}

/// Returns `true` if `sensor_msgs/msg/Range` has a variance in this distribution.
#[must_use]
pub fn has_variance(distribution: Distribution) -> bool {
    match distribution {
        Distribution::Humble => false,
        Distribution::Jazzy | Distribution::Kilted => true,
    }
}
