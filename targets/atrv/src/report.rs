//! What an rFLEX controller tells: where its axes are, what its sonars hear, its bumpers, its brake.
//! See docs/src/reference/protocols.md, 2.4.

use crate::command::Axis;
use crate::frame::Packet;

/// What a packet from the robot says, in the controller's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Report<'a> {
    /// Where an axis is, how far it has gone since it was switched on, and how fast it moves.
    Axis {
        /// Which.
        axis: Axis,
        /// It goes on at the other end where its 32 bits end.
        position: i32,
        /// Per second.
        velocity: i32,
        /// When, by the controller's clock, in milliseconds.
        time: u32,
    },
    /// What some of the sonars have heard.
    Sonars(Echoes<'a>),
    /// A digital input: a bumper, or something else.
    Input {
        /// Which.
        address: u8,
        /// What it says.
        state: u16,
    },
    /// The battery and the brake.
    Status {
        /// Hundredths of a volt, less what the electronics take.
        battery: u32,
        /// Whether it holds the robot.
        is_braked: bool,
    },
    /// Something that a driver does not need.
    Other,
}

/// Why a packet says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// No part of an rFLEX sends it: its port and opcode.
    Unknown(u8, u8),
    /// A report of this port and opcode with so little data.
    Short(u8, u8, usize),
}

/// What sonars have heard: three bytes for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Echoes<'a>(&'a [u8]);

impl Echoes<'_> {
    /// The number of each sonar with the range that it tells.
    pub fn each(&self) -> impl Iterator<Item = (u8, u16)> {
        self.0.chunks_exact(3).filter_map(|echo| match echo {
            [sonar, high, low] => Some((*sonar, u16::from_be_bytes([*high, *low]))),
            _ => None,
        })
    }
}

impl<'a> Report<'a> {
    /// What this packet says.
    ///
    /// # Errors
    /// No rFLEX sends such packets, or it is shorter than it can be.
    pub fn read(packet: &Packet<'a>) -> Result<Self, Unreadable> {
        let short = || Unreadable::Short(packet.port, packet.opcode, packet.data.len());
        match (packet.port, packet.opcode) {
            (2, 33) => axis(packet.data).ok_or_else(short),
            (4, 2) => packet.data.get(8..).map(|echoes| Self::Sonars(Echoes(echoes))).ok_or_else(short),
            (5, 1 | 3) => input(packet.data).ok_or_else(short),
            (1, 1) => status(packet.data).ok_or_else(short),
            (1..=6, _) => Ok(Self::Other),
            (port, opcode) => Err(Unreadable::Unknown(port, opcode)),
        }
    }
}

/// A return value and the time, which axis, its position, its velocity; behind them what the controller was told.
fn axis(data: &[u8]) -> Option<Report<'static>> {
    // Twenty-five bytes have come, or it is not what it says.
    let [_, _, _, _, t0, t1, t2, t3, axis, p0, p1, p2, p3, v0, v1, v2, v3, _, _, _, _, _, _, _, _, ..] = data else {
        return None;
    };
    let axis = match axis {
        0 => Axis::Translation,
        1 => Axis::Rotation,
        _ => return Some(Report::Other),
    };
    let position = i32::from_be_bytes([*p0, *p1, *p2, *p3]);
    let time = u32::from_be_bytes([*t0, *t1, *t2, *t3]);
    Some(Report::Axis { axis, position, velocity: i32::from_be_bytes([*v0, *v1, *v2, *v3]), time })
}

/// The time, an address, and what is there: some controllers leave a byte out.
fn input(data: &[u8]) -> Option<Report<'static>> {
    match data {
        [_, _, _, _, address, high, low] => {
            Some(Report::Input { address: *address, state: u16::from_be_bytes([*high, *low]) })
        }
        [_, _, _, _, address, state] => Some(Report::Input { address: *address, state: u16::from(*state) }),
        _ => None,
    }
}

/// The time, the voltage, the brake.
fn status(data: &[u8]) -> Option<Report<'static>> {
    let [_, _, _, _, b0, b1, b2, b3, brake, ..] = data else { return None };
    Some(Report::Status { battery: u32::from_be_bytes([*b0, *b1, *b2, *b3]), is_braked: *brake != 0 })
}
