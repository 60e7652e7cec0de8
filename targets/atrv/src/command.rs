//! What an rFLEX controller is told: the commands of its language that a driver needs, as frames.
//! See docs/src/reference/protocols.md, 2.3.

use crate::avoid::{ESCAPE, avoided};
use crate::frame::{Packet, Written, check};

/// The most data of a command here.
const MOST: usize = 14;
/// By how much a number is changed at most, so that the check is none that has to be avoided.
const NUDGES: u32 = 8;

/// An axis of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Forward.
    Translation,
    /// Counter-clockwise.
    Rotation,
}

/// How an axis is to move: in the controller's own units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Motion {
    /// Forward, or counter-clockwise, positive.
    pub velocity: i32,
    /// How fast that may change.
    pub acceleration: u32,
    /// The most torque.
    pub torque: u32,
}

/// A command. Times are microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Tell the battery's voltage and the brake.
    Status,
    /// Go at this velocity.
    Move(Axis, Motion),
    /// Forget what was set.
    Defaults,
    /// Set the brake.
    Brake,
    /// Release it.
    Release,
    /// Tell where both axes are, so often; 0 for never.
    Reports(u32),
    /// Tell the digital inputs, so often; 0 for never.
    Inputs(u32),
    /// Run the sonars, and wait so long for each echo.
    Sonars(u32),
    /// Switch them off.
    Deaf,
}

/// What is done about bytes that are 1B.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Escape {
    /// Numbers are changed so that there are none.
    Avoid,
    /// They are marked.
    Mark,
}

impl Command {
    /// The frame that says it.
    #[must_use]
    pub fn frame(&self, escape: Escape) -> Written {
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

    /// Port, opcode and data, with its first number changed by so much.
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
                // A velocity of 0 has a direction too.
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

/// The data of a command, as it is put together.
struct Data {
    escape: Escape,
    /// What the first number is changed by, if it is one that can be changed at all: 0 means what it says.
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
