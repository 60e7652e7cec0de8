//! Faults of a Scout. Each has a message that explains to the operator how to correct the fault.

use std::fmt;

use mdle_serial::LineFault;

use crate::frame::Garbled;

/// Reason why the robot is not ready to drive, or can no longer be driven.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// The run was asked to end while the robot was being prepared. Contains the fault if the robot could not be
    /// stopped.
    Ended(Option<Box<Self>>),
    /// The line cannot be opened or is closed, or no answer arrived in time.
    Line(LineFault),
    /// The received bytes are not a frame.
    Garbled(Garbled),
    /// The type of the answer differs from the type of the command.
    Wrong {
        /// Type of the command.
        asked: u8,
        /// Type of the answer.
        answered: u8,
    },
    /// The robot refused a command of this type.
    Refused(u8),
    /// The answer has the right type, but is too short for a state; contains the number of its bytes.
    Short(usize),
    /// The robot's emergency stop is pressed.
    EmergencyStop,
    /// The robot repeats the same state: its clock has not advanced for this number of milliseconds.
    Hung(u64),
    /// The sonars no longer ping, because their ranges have not changed although the robot has moved.
    Frozen,
    /// The robot has moved faster than commanded, or in the opposite direction, for too long. Contains this time in
    /// milliseconds.
    Disobeys(u64),
    /// Consecutive reported positions are too far from each other.
    Leaps,
    /// The robot has stopped itself, because no command arrived for this number of seconds.
    Overslept(u8),
    /// The robot has not come to rest after the command to stop.
    Moves,
}

impl From<LineFault> for Fault {
    fn from(fault: LineFault) -> Self {
        Self::Line(fault)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ended(None) => f.write_str("the run was asked to end before it began"),
            Self::Ended(Some(fault)) => fault.fmt(f),
            Self::Line(fault) => fault.tell("the Scout", f),
            Self::Garbled(garbled) => {
                write!(f, "the Scout's answers are garbled ({garbled}): check the cable and the speed of the line")
            }
            Self::Wrong { asked, answered } => {
                write!(
                    f,
                    "the Scout answered a command of type {asked} with one of type {answered}: does another program use its line?"
                )
            }
            Self::Refused(command) => {
                write!(f, "the Scout refuses commands of type {command}: is its software older than these?")
            }
            Self::Short(bytes) => {
                write!(f, "the Scout's state has {bytes} bytes instead of 42: is this another robot?")
            }
            Self::Hung(stale) => write!(
                f,
                "the Scout's clock has not advanced for {stale} ms: its data are stale; switch it off and on, or, if its clock \
                 never runs, set `stale` to 0 in the configuration"
            ),
            Self::Frozen => f.write_str(
                "the Scout's sonars say the same wherever it moves: are they on? `frozen` in the configuration says how \
                 far they may",
            ),
            Self::Disobeys(limit) => write!(
                f,
                "the Scout does not obey: for {limit} ms it has moved faster than commanded, or in the opposite direction; \
                 `disobey` in the configuration sets that time"
            ),
            Self::Leaps => f.write_str(
                "the Scout's positions leap by metres, so its position is unknown: are its encoders and its line in order?",
            ),
            Self::Overslept(seconds) => write!(
                f,
                "the Scout has stopped itself, as no command came for {seconds} s: was this computer suspended, or too busy?"
            ),
            Self::Moves => f.write_str(
                "the Scout still moved when its time to stop was over: press its emergency stop",
            ),
            Self::EmergencyStop => f.write_str("the Scout's emergency stop is pressed: release it and start again"),
        }
    }
}

impl std::error::Error for Fault {}
