//! Reasons why the driver of a robot that speaks ROS 2 ends a run.

use std::fmt;

use mdle_host::Refusal;
use mdle_runtime::Twist;

/// Reason why the driver ends a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The middleware does not work; contains the reason as a sentence.
    Middleware(String),
    /// The configuration names the only network to use, but this computer has no address in it; contains the reason as
    /// a sentence.
    Network(String),
    /// Topics are missing; the text lists the missing topics and the topics on the graph.
    Missing(String),
    /// The run was asked to end while the driver was searching for the robot.
    Ended,
    /// A law has requested a speed that is not a number.
    NoNumber,
    /// The odometry contains an invalid pose.
    NoPose,
    /// The odometry contains a speed that is not a number.
    NoSpeed,
    /// The time of odometry went back by this number of seconds.
    Backwards(f64),
    /// The time of `/clock` went back by this number of seconds.
    ClockReset(f64),
    /// The pose of odometry changed by more than the robot can have moved.
    Jumped {
        /// Distance of the jump, in metres.
        way: f64,
        /// Angle of the jump, in degrees.
        degrees: f64,
        /// Time between the two messages, in seconds.
        seconds: f64,
    },
    /// Several programs publish a topic that must have only one publisher.
    Several {
        /// Name of the topic.
        topic: String,
        /// Number of programs that publish the topic.
        count: usize,
        /// `true` if each publisher began to send only after the previous one had stopped, as happens when the robot is
        /// restarted.
        may_be_restart: bool,
    },
    /// The last message of a topic is too old.
    Stale {
        /// Name of the topic.
        topic: String,
        /// Age of the last message, in milliseconds.
        age: u128,
        /// Maximum age, in milliseconds.
        limit: u64,
        /// Reason why the last message was rejected; empty if no message arrived.
        why: String,
    },
    /// No program subscribes to velocity commands any longer; contains the name of the topic.
    Unheard(String),
    /// Odometry reports that the robot continues to drive after the zero velocity.
    Moving {
        /// Name of the topic of the odometry.
        topic: String,
        /// Absolute speeds of the robot.
        twist: Twist,
    },
    /// Not all subscribers of velocity commands were found again after a long suspension.
    Lost {
        /// Name of the topic.
        topic: String,
        /// Number of subscribers that were found.
        found: i32,
        /// Number of subscribers before the suspension.
        expected: i32,
    },
    /// No subscriber acknowledges commands, and no odometry has arrived since the zero velocity; contains the name of
    /// the odometry's topic.
    Unseen(String),
    /// No subscriber of velocity commands has acknowledged the zero velocity; contains the name of the topic.
    Unacknowledged(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Middleware(sentence) | Self::Network(sentence) | Self::Missing(sentence) => f.write_str(sentence),
            Self::Ended => f.write_str("the run was asked to end"),
            Self::NoNumber => f.write_str("a law has asked for a speed that is no number"),
            Self::NoPose => f.write_str(
                "the odometry has no pose: its position is no number, or the length of its orientation, a quaternion, \
                 is far from 1",
            ),
            Self::NoSpeed => f.write_str("the odometry has a speed or a turn rate that is no number"),
            Self::Backwards(seconds) => write!(
                f,
                "the odometry has gone back in time by {seconds:.1} s, as after a restart of the robot; start the plan \
                 again"
            ),
            Self::ClockReset(seconds) => write!(
                f,
                "`/clock` has gone back by {seconds:.1} s, as after a reset of the simulation; start the plan again"
            ),
            Self::Jumped { way, degrees, seconds } => write!(
                f,
                "the odometry has jumped by {} m and {degrees:.0}° in {seconds:.2} s, further than the robot can \
                 have moved; odometry must be continuous, so take a topic that no localisation corrects, or set \
                 `fastest`, `fastest-turn` and `jump`",
                distance(*way)
            ),
            Self::Several { topic, count, may_be_restart: false } => {
                write!(
                    f,
                    "`{topic}` has {count} publishers, and the pose is that of one; stop the others, or set a namespace"
                )
            }
            Self::Several { topic, count, may_be_restart: true } => write!(
                f,
                "`{topic}` has {count} publishers, and the last one has sent another pose or time than the one before; \
                 stop the others, or, if the robot was restarted, start the plan again"
            ),
            Self::Stale { topic, age, limit, why } => {
                write!(f, "`{topic}` has been silent for {age} ms, and its limit is {limit} ms")?;
                if why.is_empty() { Ok(()) } else { write!(f, "; the last message was left out: {why}") }
            }
            Self::Unheard(topic) => write!(f, "nobody subscribes to `{topic}` any more"),
            Self::Moving { topic, twist } => {
                let (v, omega) = (twist.v.0, twist.omega.0.to_degrees());
                write!(f, "`{topic}` still reports {v:.2} m/s and {omega:.0}°/s, 3 s after the zero velocity")
            }
            Self::Lost { topic, found, expected } => write!(
                f,
                "{found} of {expected} subscribers of `{topic}` were found again within 5 s after the suspension"
            ),
            Self::Unseen(topic) => write!(
                f,
                "no subscriber acknowledges commands, and no message of `{topic}` has come since the zero velocity"
            ),
            Self::Unacknowledged(topic) => {
                write!(f, "no subscriber of `{topic}` has acknowledged the zero velocity within half a second")
            }
        }
    }
}

/// Formats a distance in metres for a message; large distances are written in exponential notation.
fn distance(meters: f64) -> String {
    if meters < 1e6 { format!("{meters:.2}") } else { format!("{meters:.0e}") }
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        if fault == Fault::Ended {
            Self::Ended(Ok(()))
        } else if let Fault::Network(sentence) = fault {
            Self::Usage(sentence)
        } else {
            Self::Fault(fault.to_string())
        }
    }
}
