//! Frames of the commands that the driver sends to a Scout. See docs/src/reference/protocols.md, 1.3.

use crate::frame::{Arguments, Frame};
use crate::number;

/// Number of sonars.
const SONARS: usize = 16;

/// A command. Lengths are in tenths of an inch, speeds in tenths of an inch per second, and angles in tenths of a
/// degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Report the state (GS).
    State,
    /// Stop, and hold the position (ST).
    Stop,
    /// Switch off the motors' current (LP).
    Limp,
    /// Set the current position and heading to zero (ZR).
    Zero,
    /// Stop if no command arrives for this number of seconds; 0 switches the watchdog off (CONF_TM).
    Watchdog(u8),
    /// Ping with these sonars, one after the other; 255 ends the list (CONF_SN). The first value is the interval
    /// between two pings, in units of 4 ms.
    Sonars(u8, [u8; SONARS]),
    /// Maximum accelerations of the right and the left wheel, in tenths of an inch per second squared (AC).
    Accelerations(u16, u16),
    /// Speeds of the right and the left wheel (VM).
    Velocities(i16, i16),
}

impl Command {
    /// Returns the number that identifies the type of the command on the line. The answer has the same type.
    #[must_use]
    pub const fn kind(&self) -> u8 {
        match self {
            Self::Accelerations(..) => 1,
            Self::Velocities(..) => 5,
            Self::State => 7,
            Self::Stop => 9,
            Self::Limp => 10,
            Self::Zero => 13,
            Self::Sonars(..) => 15,
            Self::Watchdog(_) => 18,
        }
    }

    /// Returns the frame of this command.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let mut arguments = Arguments::new();
        match *self {
            Self::State | Self::Stop | Self::Limp | Self::Zero => {}
            Self::Watchdog(seconds) => arguments.push(seconds),
            Self::Sonars(rate, order) => arguments.extend([rate].into_iter().chain(order)),
            // The third axis is the turret, which a Scout does not have.
            Self::Accelerations(right, left) => {
                arguments.extend([right, left, 0].map(u16::to_le_bytes).into_iter().flatten())
            }
            Self::Velocities(right, left) => {
                arguments.extend([right, left, 0].map(number::signed).into_iter().flatten())
            }
        }
        Frame { kind: self.kind(), arguments }
    }
}
