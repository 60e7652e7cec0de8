//! Frames of the commands that the driver sends to an rFLEX controller. See docs/src/reference/protocols.md, 2.3.

use crate::avoid::{ESCAPE, avoided};
use crate::frame::{FrameBytes, Packet, check};

/// Maximum number of data bytes of a command.
const MOST: usize = 14;
/// Maximum amount by which a number is reduced so that the checksum of the frame is not 1B.
const NUDGES: u32 = 8;

/// An axis of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Motion forward and backward; forward is positive.
    Translation,
    /// Rotation; counter-clockwise is positive.
    Rotation,
}

/// Motion of an axis, in the controller's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisMotion {
    /// Velocity of the axis; forward or counter-clockwise is positive.
    pub velocity: i32,
    /// Maximum change of the velocity per second.
    pub acceleration: u32,
    /// Maximum torque.
    pub torque: u32,
}

/// A command. Times are in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Report the battery's voltage and the state of the brake.
    Status,
    /// Move the axis with these parameters.
    Move(Axis, AxisMotion),
    /// Restore the default settings.
    Defaults,
    /// Set the brake.
    Brake,
    /// Release the brake.
    Release,
    /// Report the positions of both axes at this interval; 0 stops the reports.
    Reports(u32),
    /// Report the digital inputs at this interval; 0 stops the reports.
    Inputs(u32),
    /// Switch the sonars on, and let each sonar wait for its echo for this time.
    Sonars(u32),
    /// Switch the sonars off.
    Deaf,
}

/// Treatment of bytes with the value 1B.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Escape {
    /// Numbers are changed so that no byte has the value 1B.
    Avoid,
    /// Bytes with the value 1B are escaped, that is, sent as a two-byte mark.
    Mark,
}

impl Command {
    /// Returns the frame of this command.
    #[must_use]
    pub fn frame(&self, escape: Escape) -> FrameBytes {
        let mut nudge = 0;
        loop {
            let (port, opcode, data) = self.data(escape, nudge);
            let packet = Packet { port, id: if port == 4 { 4 } else { 0 }, opcode, data: data.get() };
            let head = [packet.port, packet.id, packet.opcode, packet.data.len() as u8];
            let is_free = check(&head) ^ check(packet.data) != ESCAPE;
            if escape == Escape::Mark || is_free || nudge == NUDGES {
                return packet.written(escape == Escape::Mark);
            }
            nudge += 1;
        }
    }

    /// Returns the port, the opcode and the data of the command. To change the checksum, the first number in the data
    /// that is greater than [`NUDGES`] is reduced by `nudge`.
    fn data(&self, escape: Escape, nudge: u32) -> (u8, u8, Data) {
        let mut data = Data { escape, nudge, bytes: [0; MOST], count: 0 };
        let (port, opcode) = match *self {
            Self::Status => (1, 1),
            Self::Defaults => (2, 10),
            Self::Brake => (2, 11),
            Self::Release => (2, 12),
            Self::Move(axis, motion) => {
                data.put(&[match axis {
                    Axis::Translation => 0,
                    Axis::Rotation => 1,
                }]);
                data.number(motion.velocity.unsigned_abs());
                data.number(motion.acceleration);
                data.number(motion.torque);
                // The direction is also sent for a velocity of 0.
                data.put(&[u8::from(motion.velocity >= 0)]);
                (2, 7)
            }
            Self::Reports(period) => {
                data.number(period);
                // One bit for each axis.
                data.number(if period == 0 { 0 } else { 3 });
                (2, 34)
            }
            Self::Inputs(period) => {
                data.number(period);
                (5, 0)
            }
            Self::Sonars(echo) => {
                data.number(echo);
                data.number(0);
                data.number(0);
                data.put(&[2]);
                (4, 0)
            }
            Self::Deaf => {
                data.put(&[0; 13]);
                (4, 0)
            }
        };
        (port, opcode, data)
    }
}

/// Data of a command under construction.
struct Data {
    escape: Escape,
    /// Amount by which the first number above [`NUDGES`] is reduced. Smaller numbers, such as 0, are not changed.
    nudge: u32,
    bytes: [u8; MOST],
    count: usize,
}

impl Data {
    fn put(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(place) = self.bytes.get_mut(self.count) {
                *place = *byte;
                self.count += 1;
            }
        }
    }

    fn number(&mut self, number: u32) {
        let nudged = if number > NUDGES { number - std::mem::take(&mut self.nudge) } else { number };
        let number = match self.escape {
            Escape::Avoid => avoided(nudged),
            Escape::Mark => nudged,
        };
        self.put(&number.to_be_bytes());
    }

    fn get(&self) -> &[u8] {
        self.bytes.get(..self.count).unwrap_or_default()
    }
}
