//! ROS 2 messages that the driver sends and receives. The fields have the order of the ROS 2 message definitions.

use std::fmt;

use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{SerializeTuple, Serializer};
use serde::{Deserialize, Serialize};

/// Nanoseconds in a second.
const NANOS: i64 = 1_000_000_000;

/// Declares message types with public fields, named as in the ROS 2 definitions.
macro_rules! messages {
    ($($(#[$meta:meta])* $name:ident { $($field:ident: $type:ty,)* })*) => {
        $(
            $(#[$meta])*
            #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
            #[allow(missing_docs, reason = "the fields are those of the message's definition")]
            pub struct $name { $(pub $field: $type,)* }
        )*
    };
}

messages! {
    /// The message `builtin_interfaces/msg/Time`.
    Time { sec: i32, nanosec: u32, }
    /// The message `std_msgs/msg/Header`.
    Header { stamp: Time, frame_id: String, }
    /// The message `std_msgs/msg/Bool`.
    Bool { data: bool, }
    /// The message `std_msgs/msg/String`.
    Text { data: String, }
    /// The messages `geometry_msgs/msg/Vector3` and `geometry_msgs/msg/Point`, which have the same fields.
    Vector3 { x: f64, y: f64, z: f64, }
    /// The message `geometry_msgs/msg/Quaternion`.
    Quaternion { x: f64, y: f64, z: f64, w: f64, }
    /// The message `geometry_msgs/msg/Twist`.
    TwistMessage { linear: Vector3, angular: Vector3, }
    /// The message `geometry_msgs/msg/TwistStamped`.
    TwistStamped { header: Header, twist: TwistMessage, }
    /// The message `geometry_msgs/msg/Pose`.
    PoseMessage { position: Vector3, orientation: Quaternion, }
    /// The message `geometry_msgs/msg/PoseWithCovariance`.
    PoseWithCovariance { pose: PoseMessage, covariance: Covariance, }
    /// The message `geometry_msgs/msg/TwistWithCovariance`.
    TwistWithCovariance { twist: TwistMessage, covariance: Covariance, }
    /// The message `nav_msgs/msg/Odometry`.
    Odometry { header: Header, child_frame_id: String, pose: PoseWithCovariance, twist: TwistWithCovariance, }
    /// The message `sensor_msgs/msg/LaserScan`.
    LaserScan {
        header: Header,
        angle_min: f32,
        angle_max: f32,
        angle_increment: f32,
        time_increment: f32,
        scan_time: f32,
        range_min: f32,
        range_max: f32,
        ranges: Vec<f32>,
        intensities: Vec<f32>,
    }
    /// The message `sensor_msgs/msg/Range` up to the distribution Humble.
    ShortRange {
        header: Header,
        radiation_type: u8,
        field_of_view: f32,
        min_range: f32,
        max_range: f32,
        range: f32,
    }
    /// The message `sensor_msgs/msg/Range` since the distribution Iron.
    Range {
        header: Header,
        radiation_type: u8,
        field_of_view: f32,
        min_range: f32,
        max_range: f32,
        range: f32,
        variance: f32,
    }
    /// The message `irobot_create_msgs/msg/HazardDetection`; its field `type` is called `kind` here.
    HazardDetection { header: Header, kind: u8, }
    /// The message `irobot_create_msgs/msg/HazardDetectionVector`.
    HazardDetectionVector { header: Header, detections: Vec<HazardDetection>, }
    /// The message `sensor_msgs/msg/BatteryState`.
    BatteryState {
        header: Header,
        voltage: f32,
        temperature: f32,
        current: f32,
        charge: f32,
        capacity: f32,
        design_capacity: f32,
        percentage: f32,
        power_supply_status: u8,
        power_supply_health: u8,
        power_supply_technology: u8,
        present: bool,
        cell_voltage: Vec<f32>,
        cell_temperature: Vec<f32>,
        location: String,
        serial_number: String,
    }
    /// The message `rosgraph_msgs/msg/Clock`.
    ClockMessage { clock: Time, }
    /// The message `diagnostic_msgs/msg/KeyValue`.
    KeyValue { key: String, value: String, }
    /// The message `diagnostic_msgs/msg/DiagnosticStatus`.
    DiagnosticStatus { level: u8, name: String, message: String, hardware_id: String, values: Vec<KeyValue>, }
    /// The message `diagnostic_msgs/msg/DiagnosticArray`.
    DiagnosticArray { header: Header, status: Vec<DiagnosticStatus>, }
    /// The message `rmw_dds_common/msg/NodeEntitiesInfo`, with ids of `N` bytes.
    NodeEntitiesInfo {
        node_namespace: String,
        node_name: String,
        reader_gid_seq: Vec<Gid>,
        writer_gid_seq: Vec<Gid>,
    }
    /// The message `rmw_dds_common/msg/ParticipantEntitiesInfo`: the nodes of a program, which `ros2 node list` shows.
    ParticipantEntitiesInfo { gid: Gid, node_entities_info_seq: Vec<NodeEntitiesInfo>, }
}

impl From<ShortRange> for Range {
    fn from(short: ShortRange) -> Self {
        let ShortRange { header, radiation_type, field_of_view, min_range, max_range, range } = short;
        Self { header, radiation_type, field_of_view, min_range, max_range, range, variance: 0.0 }
    }
}

impl Time {
    /// Returns the time since the epoch, in nanoseconds.
    #[must_use]
    pub fn nanos(&self) -> i64 {
        i64::from(self.sec) * NANOS + i64::from(self.nanosec)
    }

    /// Returns the time `nanos` nanoseconds after the epoch. If the result would be out of range, returns the nearest
    /// valid time.
    #[must_use]
    pub fn of(nanos: i64) -> Self {
        let sec = i32::try_from(nanos.div_euclid(NANOS)).unwrap_or(if nanos < 0 { i32::MIN } else { i32::MAX });
        Self { sec, nanosec: nanos.rem_euclid(NANOS) as u32 }
    }
}

/// A six-dimensional covariance matrix, row by row.
#[derive(Clone, Copy, PartialEq)]
pub struct Covariance(pub [f64; 36]);

impl Default for Covariance {
    fn default() -> Self {
        Self([0.0; 36])
    }
}

impl fmt::Debug for Covariance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0).finish()
    }
}

impl Serialize for Covariance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|value| tuple.serialize_element(value))?;
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for Covariance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Values;

        impl<'de> Visitor<'de> for Values {
            type Value = [f64; 36];

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("36 numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<[f64; 36], A::Error> {
                let mut values = [0.0; 36];
                for (number, value) in values.iter_mut().enumerate() {
                    *value = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(number, &self))?;
                }
                Ok(values)
            }
        }

        deserializer.deserialize_tuple(36, Values).map(Self)
    }
}

/// Id of a participant, reader or writer. It has 16 bytes; up to the distribution Humble, 8 zeros follow.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gid {
    /// First 16 bytes of the id.
    pub bytes: [u8; 16],
    /// `true` for the layout of Humble, in which 8 zeros follow the id.
    pub is_long: bool,
}

impl Serialize for Gid {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let zeros = if self.is_long { 8 } else { 0 };
        let mut tuple = serializer.serialize_tuple(self.bytes.len() + zeros)?;
        self.bytes.iter().chain(&[0; 8][..zeros]).try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for Gid {
    /// Reads the 16 bytes of the layout since the distribution Iron.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[u8; 16]>::deserialize(deserializer).map(|bytes| Self { bytes, is_long: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_split_into_seconds() {
        for nanos in [0, 1, NANOS, -1, i64::from(i32::MAX) * NANOS] {
            assert_eq!(Time::of(nanos).nanos(), nanos);
        }
        assert_eq!(Time::of(i64::MAX).sec, i32::MAX);
    }
}
