//! Values of the configuration that are one of a few words, and places on the body.

use std::fmt;

use mdle_serial::{Key, Setting, one_of};
use serde::Deserialize;

/// Distribution of ROS 2, by the layout of its messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Humble Hawksbill.
    Humble,
    /// Jazzy Jalisco.
    Jazzy,
    /// Kilted Kaiju, whose messages have the layouts of Jazzy.
    Kilted,
}

/// Type of the velocity command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamped {
    /// The type that the subscriber on the graph has.
    Auto,
    /// `geometry_msgs/msg/TwistStamped`.
    Yes,
    /// `geometry_msgs/msg/Twist`.
    No,
}

/// Source of the bumper switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BumperSource {
    /// The robot has no bumper.
    None,
    /// `std_msgs/msg/Bool`.
    Bool,
    /// `irobot_create_msgs/msg/HazardDetectionVector`.
    Hazard,
    /// Rays of the scan that are shorter than the body and a margin.
    Scan,
}

/// Declares the words of an enumeration.
macro_rules! words {
    ($($type:ident: $($word:literal $variant:ident),*;)*) => {
        $(impl Setting for $type {
            type Written = String;

            fn of(key: &Key, written: String) -> Result<Self, String> {
                one_of(key, &written, &[$(($word, Self::$variant)),*])
            }
        })*
    };
}

words! {
    Distribution: "humble" Humble, "jazzy" Jazzy, "kilted" Kilted;
    BumperSource: "none" None, "bool" Bool, "hazard" Hazard, "scan" Scan;
}

/// `stamped` as it is written: `true`, `false` or a word.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
pub enum WrittenStamped {
    /// `true` or `false`.
    Flag(bool),
    /// A word.
    Word(String),
}

impl fmt::Debug for WrittenStamped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Word(word) => write!(f, "{word:?}"),
        }
    }
}

impl Setting for Stamped {
    type Written = WrittenStamped;

    fn of(_: &Key, written: WrittenStamped) -> Result<Self, String> {
        match written {
            WrittenStamped::Flag(true) => Ok(Self::Yes),
            WrittenStamped::Flag(false) => Ok(Self::No),
            WrittenStamped::Word(word) if word == "auto" => Ok(Self::Auto),
            WrittenStamped::Word(word) => {
                Err(format!("`stamped` is {word:?}, and has to be true or false or \"auto\""))
            }
        }
    }
}

/// A range sensor with a topic of its own, and its place on the body.
#[derive(Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeSensor {
    /// Topic of its `sensor_msgs/msg/Range`.
    pub topic: String,
    /// Distance ahead of the centre, in metres.
    #[serde(default)]
    pub x: f64,
    /// Distance to the left of the centre, in metres.
    #[serde(default)]
    pub y: f64,
    /// Direction of its axis, in radians, counter-clockwise from the front.
    #[serde(default)]
    pub yaw: f64,
}

/// Prints the sensor as TOML.
impl fmt::Debug for RangeSensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { topic, x, y, yaw } = self;
        write!(f, "{{ topic = {topic:?}, x = {x:?}, y = {y:?}, yaw = {yaw:?} }}")
    }
}

/// The range sensors of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeSensors(pub Vec<RangeSensor>);

/// Maximum number of range sensors.
const MOST: usize = 64;

impl Setting for RangeSensors {
    type Written = Vec<RangeSensor>;

    fn of(_: &Key, written: Vec<RangeSensor>) -> Result<Self, String> {
        if written.len() > MOST {
            return Err(format!("`ranges` has {} sensors, and {MOST} are the limit", written.len()));
        }
        match written.iter().find(|sensor| ![sensor.x, sensor.y, sensor.yaw].iter().all(|value| value.abs() <= 10.0)) {
            Some(sensor) => Err(format!("the place of the range sensor `{}` is more than 10 m away", sensor.topic)),
            None => Ok(Self(written)),
        }
    }
}
