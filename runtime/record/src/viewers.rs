//! Writes the channels for viewers: JSON messages with schemas that Foxglove, Lichtblick and PlotJuggler support.

use std::fmt::{self, Write as _};

use mdle_runtime::{Nanos, SONARS};

use crate::RecordedTurn;

/// A channel for viewers: its topic, the name of its schema, and the schema.
pub(crate) struct Channel {
    pub(crate) topic: &'static str,
    pub(crate) schema: &'static str,
    pub(crate) text: &'static str,
    /// Writes the message of a turn.
    pub(crate) message: fn(&RecordedTurn, &mut String) -> fmt::Result,
}

/// Channels with a message for each turn.
pub(crate) const CHANNELS: [Channel; 4] = [
    Channel {
        topic: "/robot/pose",
        schema: "foxglove.PoseInFrame",
        text: include_str!("schemas/pose.json"),
        message: pose,
    },
    Channel {
        topic: "/robot/ranges",
        schema: "foxglove.LaserScan",
        text: include_str!("schemas/ranges.json"),
        message: ranges,
    },
    Channel {
        topic: "/robot/command",
        schema: "mdle.Command",
        text: include_str!("schemas/command.json"),
        message: command,
    },
    Channel { topic: "/plan/state", schema: "mdle.State", text: include_str!("schemas/state.json"), message: state },
];

/// A number in JSON; a number that is not finite becomes `null`.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_finite() { write!(f, "{}", self.0) } else { f.write_str("null") }
    }
}

fn time(t: Nanos) -> String {
    format!("{{\"sec\":{},\"nsec\":{}}}", t.0 / 1_000_000_000, t.0 % 1_000_000_000)
}

/// Rounds a number to three decimal places, because a picture shows no more than millimetres.
fn short(value: f64) -> Number {
    // Adding zero turns -0 into 0.
    Number(libm::round(value * 1e3) / 1e3 + 0.0)
}

/// Returns the beginning of a message: the time, and the pose by odometry in metres and as a quaternion.
fn begin(turn: &RecordedTurn) -> String {
    let pose = &turn.y.odometry;
    let (sin, cos) = libm::sincos(pose.theta.0 / 2.0);
    let [z, w] = [sin, cos].map(|part| Number(libm::round(part * 1e4) / 1e4 + 0.0));
    format!(
        "{{\"timestamp\":{},\"frame_id\":\"odometry\",\"pose\":{{\"position\":{{\"x\":{},\"y\":{},\"z\":0}},\
         \"orientation\":{{\"x\":0,\"y\":0,\"z\":{z},\"w\":{w}}}}}",
        time(turn.t),
        short(pose.x.0),
        short(pose.y.0),
    )
}

/// Writes the pose by odometry.
fn pose(turn: &RecordedTurn, to: &mut String) -> fmt::Result {
    write!(to, "{}}}", begin(turn))
}

/// Writes the last range of each sonar, measured from the robot's centre, in metres, counter-clockwise from the front;
/// 0 if no echo returned. Viewers draw the ranges at the robot's pose.
fn ranges(turn: &RecordedTurn, to: &mut String) -> fmt::Result {
    let last = libm::round(core::f64::consts::TAU * (SONARS - 1) as f64 / SONARS as f64 * 1e6) / 1e6;
    write!(to, "{},\"start_angle\":0,\"end_angle\":{last},\"ranges\":[", begin(turn))?;
    for (sonar, pings) in turn.y.pings.iter().enumerate() {
        let range = pings.newest_first().next().and_then(|ping| ping.range);
        let range = range.map_or(0.0, |range| range.0 + turn.y.shape.ring_radius.0);
        write!(to, "{}{}", if sonar == 0 { "" } else { "," }, short(range))?;
    }
    to.write_str("],\"intensities\":[]}")
}

/// Writes the input that was sent.
fn command(turn: &RecordedTurn, to: &mut String) -> fmt::Result {
    write!(to, "{{\"v\":{},\"omega\":{}}}", Number(turn.sent.v.0), Number(turn.sent.omega.0))
}

/// Writes the state and the number of the plan.
fn state(turn: &RecordedTurn, to: &mut String) -> fmt::Result {
    write!(to, "{{\"state\":{},\"plan\":{}}}", turn.state, turn.plan)
}
