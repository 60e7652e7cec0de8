//! What can go wrong with a Scout, each in a sentence for the operator that says what to do.

use std::fmt;

use rustix::io::Errno;

use crate::frame::Garbled;

/// Why the robot cannot be driven, or no longer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// This device cannot be opened, and why.
    Open(String, String),
    /// Somebody else has this device.
    Busy(String),
    /// This device is no serial port.
    NotSerial(String),
    /// No answer came in time.
    Silent,
    /// What came is no frame.
    Garbled(Garbled),
    /// The answer to this command is of that type.
    Wrong {
        /// The type of the command.
        asked: u8,
        /// That of the answer.
        answered: u8,
    },
    /// The robot does not take commands of this type.
    Refused(u8),
    /// The answer has the right type, and too few bytes to be a state.
    Short(usize),
    /// The line was closed at the other end.
    Closed,
    /// The line failed.
    Line(String),
    /// The robot's emergency stop is pressed.
    EmergencyStop,
}

impl Fault {
    /// A failure of the line: what is unplugged reads as an error of input and output.
    pub(crate) fn of_line(error: Errno) -> Self {
        match error {
            Errno::IO | Errno::NXIO | Errno::NODEV | Errno::CONNRESET | Errno::PIPE => Self::Closed,
            _ => Self::Line(error.to_string()),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open(device, why) => {
                write!(f, "the Scout's line {device} cannot be opened: {why}; name its device with `--device`")
            }
            Self::Busy(device) => write!(f, "another program has the Scout's line {device}: end that one first"),
            Self::NotSerial(device) => write!(f, "{device} is no serial port: name the Scout's with `--device`"),
            Self::Silent => f.write_str("the Scout does not answer: is it switched on, and is this its line?"),
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
            Self::Closed => f.write_str("the Scout's line was cut: check the cable"),
            Self::Line(why) => write!(f, "the Scout's line failed: {why}"),
            Self::EmergencyStop => f.write_str("the Scout's emergency stop is pressed: release it and start again"),
        }
    }
}

impl std::error::Error for Fault {}
