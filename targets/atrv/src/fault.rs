//! Faults of an ATRV. Each has a message that explains to the operator how to correct the fault.

use std::fmt;

use mdle_serial::LineFault;

use crate::command::Axis;
use crate::frame::Garbled;
use crate::report::Unreadable;

/// Reason why the robot is not ready to drive, or can no longer be driven.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// The run was asked to end while the robot was being prepared. Contains the fault if the robot could not be
    /// stopped.
    Ended(Option<Box<Self>>),
    /// The line cannot be opened or is closed, or no report arrived in time.
    Line(LineFault),
    /// The received bytes are not a frame, and no position report arrived.
    Garbled(Garbled),
    /// A received frame is not a report that the driver can read.
    Unreadable(Unreadable),
    /// The robot repeats its last position report: the time in the report does not advance.
    Repeated,
    /// The brake holds the robot, although the command to release it was sent.
    Braked,
    /// The sonars of this direction, from 0 to 15, do not report.
    Deaf(u8),
    /// The watchdog has stopped the robot, because no motion was commanded for too long. Contains this time in
    /// milliseconds.
    Overslept(u64),
    /// The robot sends reports, but does not answer requests, because the line from the driver to the robot is cut.
    Unheard,
    /// The robot does not report this axis.
    NoAxis(Axis),
    /// The robot does not report this bumper.
    Numb(u8),
    /// The robot has moved faster than commanded, or in the opposite direction, for too long. Contains this time in
    /// milliseconds.
    Disobeys(u64),
    /// Consecutive reported positions are too far from each other.
    Leaps,
    /// The robot has not come to rest after the command to stop.
    Moves,
    /// The brake was not set after the command to brake.
    Unbraked,
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
            Self::Line(fault) => fault.tell("the ATRV", f),
            Self::Garbled(garbled) => write!(
                f,
                "what the ATRV says is garbled ({garbled}): check the cable, the speed of the line, and whether another \
                 program uses it"
            ),
            Self::Unreadable(Unreadable::Unknown(port, opcode)) => {
                write!(f, "no ATRV says what came (port {port}, opcode {opcode}): is this another robot?")
            }
            Self::Unreadable(Unreadable::Short(port, opcode, bytes)) => write!(
                f,
                "a report of the ATRV (port {port}, opcode {opcode}) has {bytes} bytes, which is too few: is this another \
                 robot?"
            ),
            Self::Repeated => f.write_str(
                "the ATRV's clock has not advanced: its data are stale; switch its controller off and on",
            ),
            Self::Braked => f.write_str(
                "the ATRV's brake is set: release its emergency stop, or the brake at its display, and start again",
            ),
            Self::Deaf(sonar) => write!(
                f,
                "the ATRV's sonars in direction {sonar} of 16 say nothing: are they on, and is `sonars` right in the \
                 configuration?"
            ),
            Self::Unheard => f.write_str(
                "the ATRV does not receive commands: it sends reports, but answers no question; check the wires of the cable that \
                 lead to it",
            ),
            Self::NoAxis(Axis::Translation) => f.write_str(
                "the ATRV does not report how far it has moved, only how far it has turned: check the cable, or switch its controller off and on",
            ),
            Self::NoAxis(Axis::Rotation) => f.write_str(
                "the ATRV does not report how far it has turned, only how far it has moved: check the cable, or switch its controller off and on",
            ),
            Self::Numb(bumper) => write!(
                f,
                "the ATRV does not report its {} bumper: is `bumpers` right in the configuration? If it reports contacts only, \
                 set `inputs` to 0",
                if *bumper == 0 { "front" } else { "rear" }
            ),
            Self::Disobeys(limit) => write!(
                f,
                "the ATRV does not obey: for {limit} ms it has moved faster than commanded, or in the opposite direction; \
                 `disobey` in the configuration sets that time"
            ),
            Self::Leaps => f.write_str(
                "the ATRV's positions leap by metres, so its position is unknown: are its encoders and its line in order?",
            ),
            Self::Moves => f.write_str(
                "the ATRV still moved when its time to stop was over: press its emergency stop",
            ),
            Self::Unbraked => f.write_str("the ATRV's brake is not set, although it got the command: press its emergency stop"),
            Self::Overslept(limit) => write!(
                f,
                "the ATRV was stopped, as no command came for {limit} ms: was this computer suspended, or too busy? \
                 `watchdog` in the configuration sets that time"
            ),
        }
    }
}

impl std::error::Error for Fault {}
