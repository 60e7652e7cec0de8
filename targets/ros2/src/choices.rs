//! Configuration values that are selected by one of a few words, and the mounting of range sensors on the body.

use std::fmt;

use mdle_serial::{Key, Setting, one_of, quoted, shortened};
use serde::Deserialize;

/// ROS 2 distribution, which determines the layout of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// The distribution Humble Hawksbill.
    Humble,
    /// The distribution Jazzy Jalisco.
    Jazzy,
    /// The distribution Kilted Kaiju, whose messages have the layouts of Jazzy.
    Kilted,
}

/// Type of the velocity command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamped {
    /// The type to which a program on the graph subscribes; if programs subscribe to both types, the type without a
    /// time stamp.
    Auto,
    /// The type `geometry_msgs/msg/TwistStamped`.
    Yes,
    /// The type `geometry_msgs/msg/Twist`.
    No,
}

/// Source of the states of the bumper switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BumperSource {
    /// The robot has no bumper.
    None,
    /// A topic of type `std_msgs/msg/Bool`.
    Bool,
    /// A topic of type `irobot_create_msgs/msg/HazardDetectionVector`.
    Hazard,
    /// The laser scan. An obstacle within the margin around the body activates a switch.
    Scan,
}

/// Implements [`Setting`] for enumerations; a word in the configuration selects each variant.
macro_rules! words {
    ($($type:ident: $($word:literal $variant:ident),*;)*) => {
        $(impl Setting for $type {
            type Written = String;

            fn expected(_: &Key) -> String {
                quoted(&[$($word),*])
            }

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

/// Value of the key `stamped` in a configuration file: `true`, `false` or a word.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
pub enum WrittenStamped {
    /// The value `true` or `false`.
    Flag(bool),
    /// A word, such as `auto`.
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

    fn expected(_: &Key) -> String {
        "true or false or \"auto\"".to_owned()
    }

    fn of(key: &Key, written: WrittenStamped) -> Result<Self, String> {
        match written {
            WrittenStamped::Flag(true) => Ok(Self::Yes),
            WrittenStamped::Flag(false) => Ok(Self::No),
            WrittenStamped::Word(word) if word == "auto" => Ok(Self::Auto),
            WrittenStamped::Word(word) => {
                let word = shortened(&format!("{word:?}"));
                Err(format!("`stamped` is {word}, and has to be {}", Self::expected(key)))
            }
        }
    }
}

/// A range sensor with its own topic, and its mounting on the body.
#[derive(Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeSensor {
    /// Topic of the sensor's `sensor_msgs/msg/Range` messages.
    pub topic: String,
    /// Distance of the sensor ahead of the body's centre, in metres.
    #[serde(default)]
    pub x: f64,
    /// Distance of the sensor to the left of the body's centre, in metres.
    #[serde(default)]
    pub y: f64,
    /// Direction of the sensor's axis, in radians, counter-clockwise from the front.
    #[serde(default)]
    pub yaw: f64,
}

/// Prints the sensor as an inline table of TOML.
impl fmt::Debug for RangeSensor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { topic, x, y, yaw } = self;
        write!(f, "{{ topic = {topic:?}, x = {x:?}, y = {y:?}, yaw = {yaw:?} }}")
    }
}

/// The range sensors of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeSensors(pub Vec<RangeSensor>);

/// Maximum number of range sensors in a configuration.
const MOST: usize = 64;
/// Key of the range sensors, whose value is a list of tables.
pub(crate) const RANGES: &str = "ranges";

impl Setting for RangeSensors {
    type Written = Vec<RangeSensor>;

    fn expected(_: &Key) -> String {
        "a list of sensors { topic = \"…\", x = 0.1, y = 0.0, yaw = 0.0 }, in m and rad and without other keys"
            .to_owned()
    }

    fn of(_: &Key, written: Vec<RangeSensor>) -> Result<Self, String> {
        if written.len() > MOST {
            return Err(format!("`ranges` has {} sensors, and {MOST} are the limit", written.len()));
        }
        for sensor in &written {
            for (key, value, most, unit) in
                [("x", sensor.x, 10.0, "m"), ("y", sensor.y, 10.0, "m"), ("yaw", sensor.yaw, 6.3, "rad")]
            {
                // NaN is outside the limits as well.
                if !(-most..=most).contains(&value) {
                    let topic = shortened(&sensor.topic);
                    let value = if value.abs() < 1e6 { value.to_string() } else { format!("{value:e}") };
                    return Err(format!(
                        "`{key}` of the range sensor `{topic}` is {value}, and has to be a number from -{most} to \
                         {most}, in {unit}"
                    ));
                }
            }
        }
        Ok(Self(written))
    }
}
