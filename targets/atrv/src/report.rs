//! Reports of an rFLEX controller: positions of the axes, sonar echoes, bumpers, and the brake. See
//! docs/src/reference/protocols.md, 2.4.

use crate::command::Axis;
use crate::frame::Packet;

/// Content of a packet from the robot, in the controller's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Report<'a> {
    /// Position of an axis, relative to its position when the robot was switched on, and its velocity.
    Axis {
        /// Reported axis.
        axis: Axis,
        /// Position of the axis, in the controller's units; it wraps at 32 bits.
        position: i32,
        /// Velocity of the axis, in the controller's units per second.
        velocity: i32,
        /// Time of the report by the controller's clock, in milliseconds.
        time: u32,
    },
    /// Echoes of some sonars.
    Sonars(Echoes<'a>),
    /// A digital input, which may be a bumper.
    Input {
        /// Address of the input.
        address: u8,
        /// State of the input.
        state: u16,
    },
    /// The battery and the brake.
    Status {
        /// Voltage of the battery minus the voltage drop across the electronics, in hundredths of a volt.
        battery: u32,
        /// `true` if the brake holds the robot.
        is_braked: bool,
    },
    /// A report that the driver does not use.
    Other,
}

/// Reason why a packet cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// The packet has this port and opcode, but no part of an rFLEX sends such packets.
    Unknown(u8, u8),
    /// A report with this port and opcode is too short; contains the number of its data bytes.
    Short(u8, u8, usize),
}

/// Echoes of sonars; each consists of three bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Echoes<'a>(&'a [u8]);

impl Echoes<'_> {
    /// Returns the sonar's number and the reported range of each echo.
    pub fn each(&self) -> impl Iterator<Item = (u8, u16)> {
        self.0.chunks_exact(3).filter_map(|echo| match echo {
            [sonar, high, low] => Some((*sonar, u16::from_be_bytes([*high, *low]))),
            _ => None,
        })
    }
}

impl<'a> Report<'a> {
    /// Returns the content of `packet`.
    ///
    /// # Errors
    /// Fails if no rFLEX sends packets of this kind, or if the packet is too short for its content.
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

/// Parses a return value, the time, the axis, its position and its velocity. The remaining bytes repeat the
/// controller's commands.
fn axis(data: &[u8]) -> Option<Report<'static>> {
    // The report has twenty-five bytes; a shorter one is malformed.
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

/// Parses the time, the address of an input, and its state. Some controllers omit one byte of the state.
fn input(data: &[u8]) -> Option<Report<'static>> {
    match data {
        [_, _, _, _, address, high, low] => {
            Some(Report::Input { address: *address, state: u16::from_be_bytes([*high, *low]) })
        }
        [_, _, _, _, address, state] => Some(Report::Input { address: *address, state: u16::from(*state) }),
        _ => None,
    }
}

/// Parses the time, the battery's voltage, and the state of the brake.
fn status(data: &[u8]) -> Option<Report<'static>> {
    let [_, _, _, _, b0, b1, b2, b3, brake, ..] = data else { return None };
    Some(Report::Status { battery: u32::from_be_bytes([*b0, *b1, *b2, *b3]), is_braked: *brake != 0 })
}
